"""What the gains leave for alpha, and how far from the goal: three routes, from coarse to exact.

| route | alpha is above, by K_i | V > 0: alpha is below | dV/dt <= 0 for ||q~|| <= r |
|---|---|---|---|
| scalar | extremes of K_i, K_p - k_g | extremes of K_d, M | K_d > alpha (lambda_max + k_C1 r) |
| matrix | alpha (K_p - k_g I) > K_i | K_d > alpha M(q) | K_d > alpha (M(q) + k_C1 r I) |
| exact | alpha (K_p + dg/dq) > K_i | K_d > alpha M(q) | K_d > alpha (M(q) - D/2) |

with D = sum q~_k dM/dq_k, for all q and q~. K_d > alpha M(q) says by its Schur complement that
[alpha K_d, -alpha M; -alpha M, M] is positive definite; nothing is lost in it, while the scalar
(3.17) loses the condition number of M. The last line is (3.18) itself: C is made of Christoffel
symbols, so q~^T C(q, dq)^T dq is dq^T D dq / 2, and g(goal) - g(q) is the mean of dg/dq on the way
between them, times q~.

Source: Mastalli 2013, (3.11) to (3.13), (3.17), (3.21) to (3.24); matrix and exact route are ours.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.dynamics import mass_matrix, mass_matrix_derivative
from backhoe.arm.lyapunov.extremes import Constants, gravity_slope
from backhoe.arm.lyapunov.suprema import Domain, heaviest, largest_norm, supremum
from backhoe.arm.pid import Gains
from backhoe.basics.inputs import choice
from backhoe.machine import Machine


class Scalar:
    """The thesis's route, with the smallest and the largest eigenvalue of every matrix.

    Gains come as matrices; an infinite alpha_low or a zero alpha_high says that nothing is left.
    """

    def stiffness(self, gains: Gains, c: Constants) -> float:
        """Smallest stiffness that is left beside gravity, must be positive [N m/rad]."""
        return lowest(gains.kp) - c.kg

    def alpha_low(self, gains: Gains, c: Constants) -> float:
        """alpha must be above this [1/s]."""
        left = self.stiffness(gains, c)
        return highest(gains.ki) / left if left > 0 else np.inf

    def alpha_positive(self, gains: Gains, c: Constants) -> float:
        """V > 0: alpha must be below this [1/s]."""
        return lowest(gains.kd) / c.ratio

    def alpha_decay(self, gains: Gains, c: Constants, radius: float) -> float:
        """dV/dt <= 0 for errors up to `radius` [rad]: alpha must be below this [1/s]."""
        return lowest(gains.kd) / (c.lambda_max + c.kc1 * radius)

    def region(self, gains: Gains, c: Constants, alpha: float) -> float:
        """Largest ||q~|| with dV/dt <= 0, 0 if none [rad]."""
        return max(0.0, (lowest(gains.kd) / alpha - c.lambda_max) / c.kc1)


class Matrix(Scalar):
    """Gains and M as matrices; gravity and Coriolis by k_g and k_C1."""

    def alpha_low(self, gains: Gains, c: Constants) -> float:
        left = gains.kp - c.kg * np.eye(4)
        return _largest_ratio(gains.ki, left) if lowest(left) > 0 else np.inf

    def alpha_positive(self, gains: Gains, c: Constants) -> float:
        return self.alpha_decay(gains, c, 0.0)

    def alpha_decay(self, gains: Gains, c: Constants, radius: float) -> float:
        W, reach = inverse_root(gains.kd), c.kc1 * radius * np.eye(4)
        top = supremum(
            lambda q: _highest(W @ (mass_matrix(q, c.machine) + reach) @ W), c.over
        ).value
        return 1 / top

    def region(self, gains: Gains, c: Constants, alpha: float) -> float:
        return max(0.0, least(gains.kd / alpha, c.over, c.machine) / c.kc1)


class Exact(Matrix):
    """The Hessian of the potential energy and the derivatives of M in full."""

    def stiffness(self, gains: Gains, c: Constants) -> float:
        shift = 2 * highest(gains.kp) + c.kg
        top = supremum(
            lambda q: _highest(shift * np.eye(4) - gains.kp - gravity_slope(q, machine=c.machine)),
            c.over,
        )
        return shift - top.value

    def alpha_low(self, gains: Gains, c: Constants) -> float:
        if self.stiffness(gains, c) <= 0:
            return np.inf
        root = np.linalg.cholesky(gains.ki)

        def needed(q: NDArray) -> NDArray:
            left = gains.kp + gravity_slope(q, machine=c.machine)
            return _highest(root.T @ np.linalg.solve(left, root))

        return supremum(needed, c.over).value

    def alpha_decay(self, gains: Gains, c: Constants, radius: float) -> float:
        return 1 / damping_per_alpha(gains.kd, radius, c.over, c.machine)

    def alpha_positive(self, gains: Gains, c: Constants) -> float:
        return Matrix.alpha_decay(self, gains, c, 0.0)

    def region(self, gains: Gains, c: Constants, alpha: float) -> float:
        if least(gains.kd / alpha, c.over, c.machine) <= 0:
            return 0.0

        def relative(q: NDArray) -> NDArray:
            left = gains.kd / alpha - mass_matrix(q, c.machine)
            W = np.linalg.inv(np.linalg.cholesky(left))[..., None, :, :]
            return W @ mass_matrix_derivative(q, c.machine) @ np.swapaxes(W, -1, -2) / 2

        return 1 / largest_norm(relative, c.over).value


_ROUTES = {"scalar": Scalar(), "matrix": Matrix(), "exact": Exact()}


def route_named(name: str) -> Scalar:
    """The route of that name.

    Raises:
        ValueError: there is none.
    """
    return _ROUTES[choice(name, "route", _ROUTES)]


def damping_per_alpha(weights: NDArray, radius: float, domain: Domain, machine: Machine) -> float:
    """The smallest s with s weights >= M(q) - sum q~_k dM/dq_k / 2 for all q and ||q~|| <= radius.

    Args:
        weights: positive definite, shape (4, 4).
        radius: r [rad].
    """
    W = inverse_root(weights)

    def parts(q: NDArray) -> tuple[NDArray, NDArray]:
        turned = radius / 2 * (W @ mass_matrix_derivative(q, machine) @ W)
        return W @ mass_matrix(q, machine) @ W, turned

    return heaviest(parts, domain).value


def least(left: NDArray, domain: Domain, machine: Machine) -> float:
    """Smallest eigenvalue of left - M(q) over the domain."""
    shift = highest(left)
    top = supremum(lambda q: _highest(shift * np.eye(4) - left + mass_matrix(q, machine)), domain)
    return shift - top.value


def inverse_root(A: NDArray) -> NDArray:
    """The symmetric W with W A W = I, for A symmetric positive definite (4, 4)."""
    values, vectors = np.linalg.eigh(A)
    return (vectors / np.sqrt(values)) @ vectors.T


def _largest_ratio(A: NDArray, B: NDArray) -> float:
    """Largest x^T A x / x^T B x."""
    W = inverse_root(B)
    return highest(W @ A @ W)


def lowest(A: NDArray) -> float:
    """Smallest eigenvalue of a symmetric matrix."""
    return float(np.linalg.eigvalsh(A)[0])


def highest(A: NDArray) -> float:
    """Largest eigenvalue of a symmetric matrix."""
    return float(np.linalg.eigvalsh(A)[-1])


def _highest(A: NDArray) -> NDArray:
    return np.linalg.eigvalsh(A)[..., -1]
