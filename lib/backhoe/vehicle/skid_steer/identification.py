"""How a vehicle really turns, from logs of its encoders and its pose.

A slipping vehicle turns less than (2.3) says. Two numbers make up for most of it: an effective half
track, larger than c, and x_ICR, about which the centre of mass swings sideways.

Source: D'Angelo 2022, eq. (2.7), corrected. As printed it lacks the wheel radius, and with it what
it gives is no longitudinal coordinate but a lateral one, the effective half track. x_ICR is the
radius of the circle that the centre of mass describes while the vehicle turns in place.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers, times
from backhoe.vehicle.skid_steer.vehicle import HUSKY, Vehicle

MIN_TURN = 0.1
"""Least turn that says something [rad]."""

MIN_TRAVEL = 0.1
"""Spread of the travelled way below which its scale is not identified [m]."""


@dataclass(frozen=True)
class Identification:
    """What the logs tell, each with its standard deviation if the residuals were white noise.

    Slip that changes along the way is no white noise, nor is what a noisy heading adds up to along
    the path: with them the deviations are too small, and the residuals are what to look at.

    Attributes:
        half_track, half_track_std: effective half track y_ICR [m].
        x_icr, x_icr_std: longitudinal coordinate of the centre of rotation [m].
        path_scale, path_scale_std: way over the way of the wheels [1], below 1 if the wheels slip;
            nan and 0 if the vehicle hardly travelled (`MIN_TRAVEL`).
        ratio: half_track over the vehicle's own c [1].
        turn_residual: root mean square of what is left of the heading [rad].
        path_residual: the same of the position, both coordinates together [m].
    """

    half_track: float
    half_track_std: float
    x_icr: float
    x_icr_std: float
    path_scale: float
    path_scale_std: float
    ratio: float
    turn_residual: float
    path_residual: float


def effective_half_track(
    time: ArrayLike,
    left: ArrayLike,
    right: ArrayLike,
    turn: float,
    vehicle: Vehicle = HUSKY,
) -> float:
    """Half track that explains one turn, r (int omega_R - int omega_L)/(2 phi).

    Source: D'Angelo 2022, eq. (2.7), times r, and named for what it is.

    Args:
        time: shape (n,) [s].
        left, right: wheel speeds, shape (n,) [rad/s]; integrated by the trapezoidal rule.
        turn: by how much the vehicle turned, phi, not wrapped [rad].
        vehicle: its wheel radius counts.

    Returns:
        y_ICR [m].

    Raises:
        ValueError: rows of different length, time that does not increase, a value that is not
            finite, or a turn below `MIN_TURN`.
    """
    time, left, right = _logs(time, left, right)
    if abs(number(turn, "turn", "rad")) < MIN_TURN:
        raise ValueError(f"turn must be at least {MIN_TURN} rad either way, got {turn}")
    return float(vehicle.wheel_radius * _integral(time, right - left)[-1] / (2 * turn))


def identify(
    time: ArrayLike,
    left: ArrayLike,
    right: ArrayLike,
    pose: ArrayLike,
    vehicle: Vehicle = HUSKY,
) -> Identification:
    """Effective half track and centre of rotation by least squares over a whole log.

    The heading follows theta = theta_0 + r int (omega_R - omega_L) dt / (2 y_ICR). The point of the
    vehicle at x_ICR never moves sideways, so by (2.6)

        (X, Y) = (X_0, Y_0) + scale int v (cos theta, sin theta) dt - x_ICR (cos theta, sin theta)

    with v = r (omega_L + omega_R)/2. Both are linear in what is sought.

    Args:
        time: shape (n,) [s].
        left, right: wheel speeds, shape (n,) [rad/s].
        pose: X, Y, theta, shape (n, 3) [m, m, rad]; theta not wrapped.
        vehicle: its wheel radius counts.

    Returns:
        The estimates with what is left unexplained.

    Raises:
        ValueError: rows of different length, time that does not increase, a value that is not
            finite, a heading that jumps by more than half a turn, or less than `MIN_TURN` of turn.
    """
    time, left, right = _logs(time, left, right)
    pose = _poses(pose, len(time))
    theta = pose[:, 2]
    turned = _integral(time, vehicle.wheel_radius * (right - left) / 2)
    share, share_std, turn_residual = _least_squares(turned[:, None], theta[:, None])
    half_track = 1 / share[0]
    way = _integral(time, vehicle.wheel_radius * (left + right) / 2 * np.exp(1j * theta))
    arm = -np.exp(1j * theta)
    columns = [arm, way] if way.std() >= MIN_TRAVEL else [arm]
    regressors = np.stack([np.r_[c.real, c.imag] for c in columns], axis=-1)
    found, std, path_residual = _least_squares(regressors, pose[:, :2])
    travelled = len(columns) == 2
    return Identification(
        half_track=float(half_track),
        half_track_std=float(share_std[0] * half_track**2),
        x_icr=float(found[0]),
        x_icr_std=float(std[0]),
        path_scale=float(found[1]) if travelled else nan,
        path_scale_std=float(std[1]) if travelled else 0.0,
        ratio=float(half_track / vehicle.half_track),
        turn_residual=turn_residual,
        path_residual=path_residual,
    )


def _least_squares(regressors: NDArray, measured: NDArray) -> tuple[NDArray, NDArray, float]:
    """Fit measured (n, k), its columns one below the other, each with an offset of its own.

    Returns the coefficients of the regressors (k n, p), their standard deviations and the root mean
    square of the residuals, taken over rows.
    """
    n, k = measured.shape
    offsets = np.kron(np.eye(k), np.ones((n, 1)))
    matrix, target = np.hstack([regressors, offsets]), measured.T.ravel()
    found, _, rank, _ = np.linalg.lstsq(matrix, target, rcond=None)
    if rank < matrix.shape[1]:
        raise ValueError("the log does not tell the parameters apart: drive turns and straights")
    left = target - matrix @ found
    free = max(target.size - matrix.shape[1], 1)
    spread = np.sqrt(left @ left / free * np.diag(np.linalg.inv(matrix.T @ matrix)))
    p = regressors.shape[1]
    return found[:p], spread[:p], float(np.sqrt(left @ left / n))


def _integral(time: NDArray, rate: NDArray) -> NDArray:
    """Running integral by the trapezoidal rule, from 0, shape (n,)."""
    return np.r_[0.0, np.cumsum((rate[1:] + rate[:-1]) / 2 * np.diff(time))]


def _logs(time: ArrayLike, left: ArrayLike, right: ArrayLike) -> tuple[NDArray, NDArray, NDArray]:
    time = times(time, "time", least=3)
    return time, numbers(left, "left", time.shape), numbers(right, "right", time.shape)


def _poses(pose: ArrayLike, n: int) -> NDArray:
    pose = numbers(pose, "pose", (n, 3), meaning="rows X, Y, theta")
    jumps = np.abs(np.diff(pose[:, 2]))
    if jumps.max() > np.pi:
        k = int(jumps.argmax())
        raise ValueError(
            f"theta jumps by {jumps[k]:.2f} rad after row {k}: unwrap it first with np.unwrap"
        )
    if np.ptp(pose[:, 2]) < MIN_TURN:
        raise ValueError(f"the vehicle must turn by at least {MIN_TURN} rad to be identified")
    return pose
