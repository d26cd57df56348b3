"""Formulas of Mastalli 2013, chapter 4, exactly as printed. Not for use.

Lesson 07 tests them; `kalman` and `imu` in `backhoe.localisation` have what they should be. (4.26)
and (4.27) are here beside the wrong ones because the thesis's filter needs all four.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
        transition: element [i, j] is P(x_k = i | x_k-1 = j), shape (n, n).
        likelihood: P(z_k | x_k), shape (n,).
        joint: P(x_1:k-1 | z_1:k-1), shape (n,) * (k-1), one axis for each instant.

    Returns:
        Shape (n,) * k.
    """
    likelihood, predicted = np.asarray(likelihood), predict_47(transition, joint)
    evidence = (likelihood * predicted).sum()
    posterior = (likelihood * predicted / evidence)[..., None, :]
    n = len(likelihood)
    return np.broadcast_to(posterior, (*predicted.shape[:-1], n, n))


def predict_47(transition: ArrayLike, joint: ArrayLike) -> NDArray:
    """First line of (4.7), meant as P(x_k | z_1:k-1), with the joint P(x_1:k-1 | z_1:k-1) in it.

    Args:
        transition, joint: as for `posterior_46`.

    Returns:
        Shape (n,) * (k-1): over x_1:k-2 and x_k.
    """
    return np.asarray(joint) @ np.asarray(transition).T


def correct_47(likelihood: ArrayLike, predicted: ArrayLike, instants: int) -> NDArray:
    """Second line of (4.7), meant as P(x_1:k | z_1:k), with P(x_k | z_1:k-1) on the right.

    Args:
        likelihood, predicted: shape (n,).
        instants: k.

    Returns:
        Shape (n,) * k.
    """
    product = np.asarray(likelihood) * np.asarray(predicted)
    return np.broadcast_to(product / product.sum(), (len(product),) * instants)


def error_418(
    truth: ArrayLike, prior: ArrayLike, z: ArrayLike, K: ArrayLike, H: ArrayLike
) -> NDArray:
    """Second line of (4.18): x_k|k - x_k|k-1 - K (z - H xhat_k|k-1).

    x_k|k-1 has no hat there and so is the state itself, as x_k|k is.

    Args:
        truth: x_k, shape (n,).
        prior: xhat_k|k-1, shape (n,).
        z, K, H: shapes (m,), (n, m), (m, n).

    Returns:
        Shape (n,).
    """
    truth, prior, K, H = (np.asarray(value) for value in (truth, prior, K, H))
    return truth - truth - K @ (np.asarray(z) - H @ prior)


def density_footnote_5(x: ArrayLike, mean: ArrayLike, covariance: ArrayLike) -> float:
    """Footnote 5: a normal density whose exponent lacks its 1/2.

    Args:
        x, mean: shape (k,).
        covariance: shape (k, k).
    """
    e, P = np.subtract(x, mean), np.asarray(covariance)
    scale = (2 * np.pi) ** (-len(e) / 2) * np.linalg.det(P) ** -0.5
    return float(scale * np.exp(-e @ np.linalg.solve(P, e)))


def transition_421(A: ArrayLike) -> NDArray:
    """(4.21) with (4.20): the Jacobian of the rate of x, taken for F.

    Args:
        A: df/dx of dx/dt = f, shape (n, n) [1/s].

    Returns:
        A itself.
    """
    return np.array(A, dtype=float)


def attitude_422(a: ArrayLike) -> NDArray:
    """(4.22): roll and pitch from an accelerometer.

    Args:
        a: shape (..., 3) [m/s^2].

    Returns:
        What it calls phi and theta, shape (..., 2) [rad].
    """
    x, y, z = np.moveaxis(np.asarray(a, float), -1, 0)
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
        Shape (..., 6).
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
        Shape (..., 6, 6).
    """
    x = np.asarray(x, float)
    heading = x[..., 5] + np.asarray(omega) * T_s / 2
    F = np.zeros((*x.shape, 6))
    F[...] = np.eye(6)
    F[..., 0, 5] = -speed * np.sin(heading)
    F[..., 1, 5] = speed * np.cos(heading)
    return F
