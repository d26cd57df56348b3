"""Kinematics of the tracks: sprocket speeds, the machine's own twist, rates in the world.

Ideal tracks that roll without slip, which real ones do not: the simulation has slip. The machine's
axes as in `forward`: x forward, y left; the heading psi turns x forward into the world.

Source: Mastalli 2013, eqs. (2.8) to (2.10); (2.10) is printed with 1/(2r) for r/2, 1/(rl) for r/l
and a wrong sign in its translation.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.machine import BACKHOE, Machine
from backhoe.reals import real_array

__all__ = ["sprocket_speeds", "tracks_twist", "twist_to_world", "world_rates"]


def tracks_twist(
    omega_right: ArrayLike, omega_left: ArrayLike, machine: Machine = BACKHOE
) -> NDArray:
    """Forward and turning speed of the machine from the speeds of its sprockets.

    Source: Mastalli 2013, eq. (2.9) with v_r = r omega_r and v_l = r omega_l.

    Args:
        omega_right: speed of the right sprocket, shape (...) [rad/s].
        omega_left: speed of the left sprocket, shape (...) [rad/s].

    Returns:
        v and omega, anticlockwise from above, shape (..., 2) [m/s, rad/s].

    Raises:
        ValueError: the shapes do not fit each other, or a value is not a finite number.
    """
    right = machine.tracks.sprocket_radius * _finite(omega_right, "omega_right")
    left = machine.tracks.sprocket_radius * _finite(omega_left, "omega_left")
    return np.stack(
        np.broadcast_arrays((right + left) / 2, (right - left) / machine.tracks.gauge), -1
    )


def sprocket_speeds(twist: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """Speeds of the sprockets for a twist: the inverse of `tracks_twist`.

    Args:
        twist: forward speed v and turning speed omega, shape (..., 2) [m/s, rad/s].

    Returns:
        omega_right and omega_left, shape (..., 2) [rad/s].

    Raises:
        ValueError: the last axis is not 2, or a value is not a finite number.
    """
    v, omega = _pair(twist)
    half = omega * machine.tracks.gauge / 2
    return np.stack([v + half, v - half], axis=-1) / machine.tracks.sprocket_radius


def twist_to_world(twist: ArrayLike, heading: ArrayLike) -> NDArray:
    """Rates of x, y and heading in the world from the machine's own twist: the unicycle model.

    Source: Mastalli 2013, eq. (2.8), where theta and psi are one angle.

    Args:
        twist: forward speed v and turning speed omega, shape (..., 2) [m/s, rad/s].
        heading: psi, anticlockwise from the world's x axis, shape (...) [rad].

    Returns:
        dx, dy, dpsi, shape (..., 3) [m/s, m/s, rad/s].

    Raises:
        ValueError: the last axis of twist is not 2, or a value is not a finite number.
    """
    v, omega = _pair(twist)
    psi = _finite(heading, "heading")
    return np.stack(np.broadcast_arrays(v * np.cos(psi), v * np.sin(psi), omega), axis=-1)


def world_rates(
    omega_right: ArrayLike, omega_left: ArrayLike, heading: ArrayLike, machine: Machine = BACKHOE
) -> NDArray:
    """Rates of x, y and heading in the world from the speeds of the sprockets.

    Source: Mastalli 2013, eq. (2.10), corrected.

    Args:
        omega_right: speed of the right sprocket, shape (...) [rad/s].
        omega_left: speed of the left sprocket, shape (...) [rad/s].
        heading: psi, shape (...) [rad].

    Returns:
        dx, dy, dpsi, shape (..., 3) [m/s, m/s, rad/s].

    Raises:
        ValueError: the shapes do not fit each other, or a value is not a finite number.
    """
    return twist_to_world(tracks_twist(omega_right, omega_left, machine), heading)


def _finite(values: ArrayLike, name: str) -> NDArray:
    array = real_array(values, f"{name} must be numbers")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, got {values!r}")
    return array


def _pair(twist: ArrayLike) -> tuple[NDArray, NDArray]:
    twist = _finite(twist, "twist")
    if twist.ndim == 0 or twist.shape[-1] != 2:
        raise ValueError(f"twist must end in 2 values (v, omega), got shape {twist.shape}")
    return twist[..., 0], twist[..., 1]
