"""Gains that satisfy the conditions, and what they cost.

Start from what the drives can do: K_p asks for the torque limit at a stated error, K_d damps the
heaviest posture, K_i is a share of K_p. Then K_d is raised to what the conditions need, and
compared with what a controller that samples every dt can bear.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.dynamics import mass_matrix, mass_matrix_derivative
from backhoe.arm.lyapunov.certificate import Certificate, check_gains
from backhoe.arm.lyapunov.conditions import damping_per_alpha, route_named
from backhoe.arm.lyapunov.extremes import Constants, constants_of
from backhoe.arm.lyapunov.gains import gain_matrix
from backhoe.arm.lyapunov.sampled_loop import effective_inertia, sampled_radius
from backhoe.arm.lyapunov.suprema import supremum
from backhoe.arm.pid import Gains
from backhoe.basics.inputs import number, numbers, positive
from backhoe.machine import JOINTS

SATURATION_ERROR = 0.2
"""Position error at which the default K_p asks for the torque limit [rad]."""
INTEGRAL_TIME = 10.0
"""K_p/K_i of the default K_i, where sampling allows it [s]."""
_SHARE = 0.5


@dataclass(frozen=True)
class Tuning:
    """Gains with their certificate and their cost; vectors are per joint, shape (4,).

    Of the `gains`' kd, `kd_needed` is the least that the conditions ask for, `kd_limit` = 2 J/dt
    the most that sampling bears [N m s/rad]. `spectral_radius` of the sampled loop, the worst over
    the domain's grid. `saturation_error` [rad] and `saturation_speed` [rad/s]: where K_p or K_d
    alone reaches the machine's torque limit.
    """

    gains: Gains
    kd_needed: NDArray
    kd_limit: NDArray
    alpha: float
    certificate: Certificate
    spectral_radius: float
    saturation_error: NDArray
    saturation_speed: NDArray

    @property
    def stable(self) -> bool:
        """Whether the sampled loop is stable in every posture tried."""
        return self.spectral_radius < 1

    @property
    def possible(self) -> float:
        """By how much K_i could be multiplied until the K_d it needs reaches the sampling limit.

        Below 1 no K_d both satisfies the conditions for this K_i and can be sampled.
        """
        return float((self.kd_limit / self.kd_needed).min())

    def table(self) -> str:
        """Gains and costs, a line a joint."""
        head = (
            f"{'joint':<8}{'K_p':>10}{'K_d':>10}{'K_i':>10}{'K_d needed':>12}{'K_d limit':>11}"
            f"{'full at e, rad':>16}{'full at dq, rad/s':>19}"
        )
        lines, (kp, ki, kd) = [head], self.gains
        for j, joint in enumerate(JOINTS):
            lines.append(
                f"{joint:<8}{kp[j]:>10.3g}{kd[j]:>10.3g}{ki[j]:>10.3g}"
                f"{self.kd_needed[j]:>12.3g}{self.kd_limit[j]:>11.3g}"
                f"{self.saturation_error[j]:>16.3g}{self.saturation_speed[j]:>19.3g}"
            )
        verdict = "stable" if self.stable else "UNSTABLE"
        lines.append(
            f"{self.certificate.route} conditions "
            f"{'hold' if self.certificate.holds else 'FAIL'}; sampled: {verdict}"
        )
        if self.possible < 1:
            lines.append(
                "no K_d that can be sampled satisfies them: "
                f"K_i must be {1 / self.possible:.3g} times smaller"
            )
        return "\n".join(lines)


def tune(
    route: str = "matrix",
    *,
    kp: ArrayLike | None = None,
    ki: ArrayLike | None = None,
    error: float = np.pi / 2,
    damping: float = 0.7,
    margin: float = 1.2,
    dt: float = 0.001,
    constants: Constants | None = None,
) -> Tuning:
    """PID gains that satisfy the conditions of one route.

    Source: Mastalli 2013, section 3.2, whose procedure (3.27) gives bounds; the rules are ours.

    Args:
        route: "scalar", "matrix" or "exact", as for `check_gains`.
        kp: (4,) [N m/rad]; None for the torque limit at 0.2 rad.
        ki: (4,) [N m/(rad s)]; None for a share of what K_p has left beside gravity: a tenth a
            second, or less where K_d could not be sampled.
        error: size of the position error up to which dV/dt <= 0 is asked [rad].
        damping: damping ratio of each joint by itself in its heaviest posture.
        margin: by how much alpha and K_d are above their bounds, more than 1.
        dt: time for which a torque is held [s].
        constants: of the arm over a domain; None for the tight ones of the joint box. The gains are
            for their machine.

    Returns:
        Tuning. Where nothing satisfies both the conditions and sampling, it says so: `possible`.

    Raises:
        ValueError: a gain is not positive, K_p does not outweigh gravity, or another argument is
            out of its range.
    """
    c = constants_of(constants)
    judge = route_named(route)
    error, dt = positive(error, "error", "rad"), positive(dt, "dt", "s")
    damping, margin = positive(damping, "damping"), number(margin, "margin", above=1.0)
    kp = c.machine.torque_limit / SATURATION_ERROR if kp is None else _vector(kp, "K_p")
    left = kp - c.kg
    if left.min() <= 0:
        worst = JOINTS[int(np.argmin(left))]
        raise ValueError(
            f"K_p must outweigh gravity: that of the {worst} is {kp.min():.6g}, "
            f"k_g is {c.kg:.6g} N m/rad"
        )
    limit = 2 * _least_inertia(c) / dt
    shape = _shape(route, error, c)
    wanted = left / INTEGRAL_TIME if ki is None else _vector(ki, "K_i")
    if route == "scalar" and ki is None:
        wanted = np.full(4, wanted.min())
    alpha = margin * judge.alpha_low(Gains(np.diag(kp), np.diag(wanted), np.eye(4)), c)
    needed = margin * alpha * shape
    if ki is None:
        less = min(1.0, _SHARE * float((limit / needed).min()))
        wanted, alpha, needed = less * wanted, less * alpha, less * needed
    kd = np.maximum(needed, 2 * damping * np.sqrt(kp * _heaviest_diagonal(c)))
    gains, torque = Gains(kp, wanted, kd), c.machine.torque_limit
    certificate = check_gains(gains, constants=c, route=route, error=error, alpha=alpha)
    radius = float(sampled_radius(gains, c.over.q, dt, machine=c.machine).max())
    return Tuning(gains, needed, limit, alpha, certificate, radius, torque / kp, torque / kd)


def _shape(route: str, error: float, c: Constants) -> NDArray:
    """The least K_d over alpha that the conditions ask for, joint by joint [kg m^2]."""
    if route == "scalar":
        return np.full(4, max(c.ratio, c.lambda_max + c.kc1 * error))
    if route == "matrix":
        weights = _heaviest_diagonal(c) + c.kc1 * error
        W, reach = np.diag(1 / np.sqrt(weights)), c.kc1 * error * np.eye(4)
        top = supremum(
            lambda q: np.linalg.eigvalsh(W @ (mass_matrix(q, c.machine) + reach) @ W)[:, -1], c.over
        )
        return top.value * weights
    weights = _heaviest_diagonal(c, error)
    return damping_per_alpha(np.diag(weights), error, c.over, c.machine) * weights


def _heaviest_diagonal(c: Constants, error: float = 0.0) -> NDArray:
    """Largest M_jj, with what the Coriolis term adds for errors up to `error`, (4,) [kg m^2]."""

    def diagonal(q: NDArray) -> NDArray:
        slopes = np.diagonal(mass_matrix_derivative(q, c.machine), axis1=-2, axis2=-1)
        steady = np.diagonal(mass_matrix(q, c.machine), axis1=-2, axis2=-1)
        return steady + error / 2 * np.linalg.norm(slopes, axis=-2)

    return np.array([supremum(lambda q, j=j: diagonal(q)[:, j], c.over).value for j in range(4)])


def _least_inertia(c: Constants) -> NDArray:
    if c.domain == "postures":
        return effective_inertia(c.q, machine=c.machine).min(axis=0)
    return effective_inertia(domain=c.domain, machine=c.machine)


def _vector(gain: ArrayLike, name: str) -> NDArray:
    """One positive gain a joint."""
    values = numbers(gain, name, (4,), meaning="gains, one a joint")
    gain_matrix(values, name)
    return values
