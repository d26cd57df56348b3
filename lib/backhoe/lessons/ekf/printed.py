"""Formulas of Mastalli 2013, chapter 4, exactly as printed. Not for use.

Lesson 07 tests them; `kalman`, `imu` and `fusion.rmse` in `backhoe.localisation` have what they
should be. (4.26) and (4.27) are here beside the wrong ones because the thesis's filter needs all
four; Algorithm 2 is printed but for what keeps it from running.
"""

from __future__ import annotations

from math import ceil, inf, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, times

__all__ = [
    "H_IMU_427",
    "H_ODOM_426",
    "attitude_422",
    "correct_47",
    "density_footnote_5",
    "error_418",
    "jacobian_425",
    "motion_424",
    "posterior_46",
    "predict_47",
    "rmse_algorithm_2",
    "transition_421",
]

H_ODOM_426 = np.diag([1.0, 1.0, 0.0, 0.0, 0.0, 1.0])
"""(4.26): the integrated odometry as if it were a measurement of x, y and psi."""

H_IMU_427 = np.diag([0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
"""(4.27): the board's phi, theta and psi."""


def posterior_46(transition: ArrayLike, likelihood: ArrayLike, joint: ArrayLike) -> NDArray:
    """(4.6) for finitely many states, meant as P(x_1:k | z_1:k).

    The sum over x_k-1 leaves nothing of it on the right, though the left still has it.

    Args:
        transition: element i, j is P(x_k = i | x_k-1 = j), shape (n, n) [1].
        likelihood: P(z_k | x_k), shape (n,) [1].
        joint: P(x_1:k-1 | z_1:k-1), shape (n,) * (k-1), one axis for each instant [1].

    Returns:
        Shape (n,) * k [1].
    """
    predicted = predict_47(transition, joint)
    product = numbers(likelihood, "likelihood", ("n",)) * predicted
    posterior = (product / product.sum())[..., None, :]
    return np.broadcast_to(posterior, (*predicted.shape, predicted.shape[-1]))


def predict_47(transition: ArrayLike, joint: ArrayLike) -> NDArray:
    """First line of (4.7), meant as P(x_k | z_1:k-1), with the joint P(x_1:k-1 | z_1:k-1) in it.

    Args:
        transition, joint: as for `posterior_46`.

    Returns:
        Shape (n,) * (k-1): over x_1:k-2 and x_k [1].
    """
    return numbers(joint, "joint") @ numbers(transition, "transition", ("n", "n")).T


def correct_47(likelihood: ArrayLike, predicted: ArrayLike, instants: int) -> NDArray:
    """Second line of (4.7), meant as P(x_1:k | z_1:k), with P(x_k | z_1:k-1) on the right.

    Args:
        likelihood, predicted: shape (n,) [1].
        instants: k.

    Returns:
        Shape (n,) * k [1].
    """
    product = numbers(likelihood, "likelihood", ("n",)) * numbers(predicted, "predicted", ("n",))
    return np.broadcast_to(product / product.sum(), (len(product),) * instants)


def error_418(
    truth: ArrayLike, prior: ArrayLike, z: ArrayLike, K: ArrayLike, H: ArrayLike
) -> NDArray:
    """Second line of (4.18): x_k|k - x_k|k-1 - K (z - H xhat_k|k-1).

    x_k|k-1 has no hat there and so is the state itself, as x_k|k is.

    Args:
        truth: x_k, shape (n,) [its own units].
        prior: xhat_k|k-1, shape (n,) [as truth].
        z, K, H: shapes (m,), (n, m), (m, n) [the sensor's own units].

    Returns:
        Shape (n,) [as truth].
    """
    truth, K = numbers(truth, "truth", ("n",)), numbers(K, "K", ("n", "m"))
    expected = numbers(H, "H", ("m", "n")) @ numbers(prior, "prior", truth.shape)
    return truth - truth - K @ (numbers(z, "z", ("m",)) - expected)


def density_footnote_5(x: ArrayLike, mean: ArrayLike, covariance: ArrayLike) -> float:
    """Footnote 5: a normal density whose exponent lacks its 1/2.

    Args:
        x, mean: shape (k,) [their own units].
        covariance: shape (k, k) [their squares].

    Returns:
        The density, of no use as one: it integrates to 2^(-k/2).
    """
    e, P = numbers(x, "x", ("k",)) - numbers(mean, "mean"), numbers(covariance, "covariance")
    scale = (2 * np.pi) ** (-len(e) / 2) * np.linalg.det(P) ** -0.5
    return float(scale * np.exp(-e @ np.linalg.solve(P, e)))


def transition_421(A: ArrayLike) -> NDArray:
    """(4.21) with (4.20): the Jacobian of the rate of x, taken for F.

    Args:
        A: df/dx of dx/dt = f, shape (n, n) [units of x_i / x_j, a second].

    Returns:
        A itself; F has no seconds in its units.
    """
    return numbers(A, "A", ("n", "n")).copy()


def attitude_422(a: ArrayLike) -> NDArray:
    """(4.22): roll and pitch from an accelerometer.

    Args:
        a: shape (..., 3) [m/s^2].

    Returns:
        What it calls phi and theta, shape (..., 2) [rad].
    """
    x, y, z = np.moveaxis(numbers(a, "a", (..., 3)), -1, 0)
    phi = np.arctan(x / np.sqrt(y**2 + z**2))
    theta = np.arctan(y / np.sqrt(x**2 + z**2))
    return np.stack([phi, theta], axis=-1)


def motion_424(x: ArrayLike, speed: ArrayLike, omega: ArrayLike, T_s: float) -> NDArray:
    """(4.24): the state one cycle later.

    Args:
        x: x, y, z, phi, theta, psi, shape (..., 6) [m, rad].
        speed: norm of v, shape (...) [m/s], added as metres.
        omega: shape (...) [rad/s].
        T_s: time of a cycle [s].

    Returns:
        Shape (..., 6) [m, rad].
    """
    x = np.asarray(x, float)
    heading = x[..., 5] + np.asarray(omega) * T_s
    moved = np.zeros_like(x)
    moved[..., 0] = x[..., 0] + speed * np.cos(heading)
    moved[..., 1] = x[..., 1] + speed * np.sin(heading)
    moved[..., 5] = heading
    return moved


def jacobian_425(x: ArrayLike, speed: ArrayLike, omega: ArrayLike, T_s: float) -> NDArray:
    """The matrix of (4.25), with Delta psi = omega T_s.

    Args:
        x, speed, omega, T_s: as for `motion_424`.

    Returns:
        Shape (..., 6, 6) [1, m/rad].
    """
    x = np.asarray(x, float)
    heading = x[..., 5] + np.asarray(omega) * T_s / 2
    F = np.zeros((*x.shape, 6))
    F[...] = np.eye(6)
    F[..., 0, 5] = -speed * np.sin(heading)
    F[..., 1, 5] = speed * np.cos(heading)
    return F


def rmse_algorithm_2(
    t_x: ArrayLike,
    t_y: ArrayLike,
    x: ArrayLike,
    x_e: ArrayLike,
    t_s: float,
    initial: float = inf,
) -> float:
    """Root mean square error of one signal, both read at the sample nearest to i t_s.

    As printed, the errors e_x and e_y are compared before they have a value (here they begin at
    `initial`; with 0 nothing is ever nearer), the inner loops begin one element past the end
    (here at the last one), ceil + 1 terms are summed and divided by ceil, and nothing is wrapped.

    Args:
        t_x, x: of the signal, shape (n,) each [s, its own unit].
        t_y, x_e: of the estimate, shape (m,) each [s, as x].
        t_s: of the grid [s].
        initial: what e_x and e_y hold at first [s].

    Returns:
        The error in the signal's unit.
    """
    t_x, t_y = times(t_x, "t_x"), times(t_y, "t_y")
    x, x_e = numbers(x, "x", t_x.shape), numbers(x_e, "x_e", t_y.shape)
    terms = ceil(t_x[-1] / t_s)

    def on_grid(t: NDArray, values: NDArray) -> NDArray:
        read, nearest = np.zeros(terms + 1), np.full(terms + 1, initial)
        for i in range(terms + 1):
            for j in range(len(t) - 1, -1, -1):
                if abs(t[j] - i * t_s) < nearest[i]:
                    nearest[i], read[i] = abs(t[j] - i * t_s), values[j]
        return read

    return sqrt(np.sum((on_grid(t_x, x) - on_grid(t_y, x_e)) ** 2) / terms)
