"""Kinematics of the tracks: sprocket speeds, the machine's own twist, rates in the world.

The machine's axes: x forward, y left; the heading psi turns x forward into the world. Slip is what
the caller says it is: what the ground does is in `travel` and in the simulation.

Source: Mastalli 2013, eqs. (2.8) to (2.10); (2.10) is printed with 1/(2r) for r/2, 1/(rl) for r/l
and a wrong sign in its translation.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers
from backhoe.basics.se2 import twist_of_sides
from backhoe.machine import BACKHOE, Machine

__all__ = ["tracks_twist", "twist_to_world", "world_rates"]


def tracks_twist(
    left: ArrayLike,
    right: ArrayLike,
    machine: Machine = BACKHOE,
    *,
    gauge: float | None = None,
    slip: ArrayLike = (0.0, 0.0),
) -> tuple[NDArray, NDArray]:
    """Forward and turning speed of the machine from its sprockets.

    Source: Mastalli 2013, eq. (2.9).

    Args:
        left, right: speeds of the sprockets, shape (...) [rad/s]; or their turns in a time [rad].
        machine: its sprocket radius and gauge count.
        gauge: an effective gauge instead of the machine's own [m].
        slip: longitudinal slip left, right: the share of the belt's way that the ground does not
            see, below 1 [1].

    Returns:
        v [m/s] and omega [rad/s], shape (...); or a distance [m] and a turn [rad].

    Raises:
        ValueError: left and right differ in shape, a value is not finite, gauge is not positive,
            or a slip is not below 1.
    """
    slip = numbers(slip, "slip", (2,), meaning="two shares below 1 (left, right)")
    if (slip >= 1).any():
        raise ValueError(f"slip must be two shares below 1 (left, right), got {slip.tolist()}")
    grip = machine.tracks.sprocket_radius * (1 - slip)
    left, right = grip[0] * numbers(left, "left"), grip[1] * numbers(right, "right")
    return twist_of_sides(left, right, machine.tracks.gauge if gauge is None else gauge)


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
    twist = numbers(twist, "twist", (..., 2), meaning="values (v, omega)")
    psi = numbers(heading, "heading")
    v, omega = twist[..., 0], twist[..., 1]
    return np.stack(np.broadcast_arrays(v * np.cos(psi), v * np.sin(psi), omega), axis=-1)


def world_rates(
    left: ArrayLike, right: ArrayLike, heading: ArrayLike, machine: Machine = BACKHOE
) -> NDArray:
    """Rates of x, y and heading in the world from the speeds of the sprockets.

    Source: Mastalli 2013, eq. (2.10), corrected; he multiplies a matrix by (right, left).

    Args:
        left, right: speeds of the sprockets, shape (...) [rad/s].
        heading: psi, shape (...) [rad].

    Returns:
        dx, dy, dpsi, shape (..., 3) [m/s, m/s, rad/s].

    Raises:
        ValueError: the shapes do not fit each other, or a value is not a finite number.
    """
    return twist_to_world(np.stack(tracks_twist(left, right, machine), axis=-1), heading)
