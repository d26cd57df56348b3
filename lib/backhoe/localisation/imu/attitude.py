"""Attitude: from gravity, and from turning.

Roll phi, pitch theta and yaw psi, with R_world_body = R_z(psi) R_y(theta) R_x(phi); world z up,
body x forward, y left, z up. A positive pitch lowers the nose.

Source: Mastalli 2013, section 4.4, eqs. (4.22) mended and (4.23).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive

_SINGULAR = 1e-6
"""How near to 90 degrees a pitch has no Euler rates [rad]."""

_ANGLES = "angles (roll, pitch, yaw)"


def rotation(attitude: ArrayLike) -> NDArray:
    """R_world_body = R_z(psi) R_y(theta) R_x(phi).

    Args:
        attitude: roll, pitch, yaw, shape (..., 3) [rad].

    Returns:
        Shape (..., 3, 3): v_world = R @ v_body.

    Raises:
        ValueError: last axis is not 3, or a value is not finite.
    """
    attitude = numbers(attitude, "attitude", (..., 3), meaning=_ANGLES)
    (cr, cp, cy), (sr, sp, sy) = (np.moveaxis(g(attitude), -1, 0) for g in (np.cos, np.sin))
    rows = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def attitude_from_gravity(force: ArrayLike) -> NDArray:
    """Roll and pitch of a board at rest, or at constant velocity, from its accelerometer.

    Source: Mastalli 2013, eq. (4.22), with the right labels, the sign of the pitch and the whole
    circle of the roll. Yaw does not show in gravity.

    Args:
        force: specific force, shape (..., 3) [m/s^2].

    Returns:
        Roll in (-pi, pi], pitch in [-pi/2, pi/2], shape (..., 2) [rad].

    Raises:
        ValueError: last axis is not 3, not finite, or zero (free fall shows no direction).
    """
    force = numbers(force, "force", (..., 3), meaning="values (x, y, z)")
    x, y, z = np.moveaxis(force, -1, 0)
    if not (np.abs(force).max(axis=-1) > 0).all():
        raise ValueError("force must not be zero: in free fall gravity does not show")
    return np.stack([np.arctan2(y, z), np.arctan2(-x, np.hypot(y, z))], axis=-1)


def euler_rates(attitude: ArrayLike, omega: ArrayLike) -> NDArray:
    """Rates of roll, pitch and yaw from the turning speed in the body's axes.

    Source: Mastalli 2013, eq. (4.23).

    Args:
        attitude: roll, pitch, yaw, shape (..., 3) [rad].
        omega: shape (..., 3) [rad/s].

    Returns:
        Shape (..., 3) [rad/s].

    Raises:
        ValueError: last axis is not 3, not finite, or a pitch of 90 degrees, where roll and yaw
            turn about the same axis and have no rates of their own.
    """
    attitude = numbers(attitude, "attitude", (..., 3), meaning=_ANGLES)
    omega = numbers(omega, "omega", (..., 3), meaning="values (x, y, z)")
    x, y, z = np.moveaxis(omega, -1, 0)
    roll, pitch = attitude[..., 0], attitude[..., 1]
    if (np.abs(np.cos(pitch)) < _SINGULAR).any():
        raise ValueError(
            "pitch must not be 90 degrees: roll and yaw then turn about the same axis and (4.23) "
            "divides by zero; integrate the rotation itself (imu.integrate)"
        )
    turning = np.sin(roll) * y + np.cos(roll) * z
    pitching = np.cos(roll) * y - np.sin(roll) * z
    yaw_rate = turning / np.cos(pitch)
    return np.stack([x + np.sin(pitch) * yaw_rate, pitching, yaw_rate], axis=-1)


def integrate(attitude: ArrayLike, omega: ArrayLike, dt: float) -> NDArray:
    """Attitude after each sample of a gyroscope, each reading held over its sample.

    The rotation itself is turned on, so that no pitch is singular on the way; angles are read off
    at the samples. Errors of the readings add up.

    Args:
        attitude: roll, pitch, yaw at the start, shape (3,) [rad].
        omega: readings, shape (N, 3) [rad/s].
        dt: time between them, positive [s].

    Returns:
        Shape (N+1, 3) [rad], roll and yaw without jumps.

    Raises:
        ValueError: other shapes, not finite, dt not positive.
    """
    omega = numbers(omega, "omega", ("N", 3))
    attitude = numbers(attitude, "attitude", (3,), meaning=_ANGLES)
    R, angles = rotation(attitude), [attitude]
    for turn in _rotations(omega * positive(dt, "dt", "s")):
        R = R @ turn
        pitch = np.arctan2(-R[2, 0], np.hypot(R[2, 1], R[2, 2]))
        angles.append([np.arctan2(R[2, 1], R[2, 2]), pitch, np.arctan2(R[1, 0], R[0, 0])])
    return np.unwrap(np.array(angles), axis=0)


def _rotations(turns: NDArray) -> NDArray:
    """Rodrigues' formula: rotations by the vectors `turns`, shape (N, 3) [rad] -> (N, 3, 3)."""
    angle = np.linalg.norm(turns, axis=-1)[:, None, None]
    x, y, z = turns.T
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(-1, 3, 3)
    half = np.sinc(angle / (2 * np.pi))
    return np.eye(3) + np.sinc(angle / np.pi) * cross + half**2 / 2 * cross @ cross
