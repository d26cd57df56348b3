"""Limits that several velocities share, as rows A v <= c for `limited_velocity`: belts, balance.

v is u, omega and the joints' speeds.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.kinematics.forward import joint_vector
from backhoe.basics.inputs import instance, not_negative, number, positive, whole
from backhoe.machine import BACKHOE, Machine
from backhoe.whole_body.stability import (
    centre_of_mass,
    centre_of_mass_jacobian,
    distances,
    gravity_on_slope,
    support_polygon,
)


class Rows(NamedTuple):
    """Limits A v <= c, shapes (k, n) [1, m, m/rad] and (k,) [m/s]."""

    A: NDArray
    c: NDArray


def track_rows(machine: Machine = BACKHOE, velocities: int = 6) -> Rows:
    """No belt runs faster than it can: |u - omega gauge / 2| and |u + omega gauge / 2|.

    Args:
        machine: whose tracks.
        velocities: their number n, u and omega first, 2 or more.

    Returns:
        Left belt ahead, right ahead, left back, right back, shapes (4, n) and (4,) [m/s].

    Raises:
        TypeError: machine is none.
        ValueError: fewer than two velocities.
    """
    tracks = instance(machine, "machine", Machine).tracks
    A = np.zeros((4, whole(velocities, "velocities", least=2, most=1000)))
    A[:, 0] = [1.0, 1.0, -1.0, -1.0]
    A[:, 1] = np.array([-1.0, 1.0, 1.0, -1.0]) * tracks.gauge / 2
    return Rows(A, np.full(4, tracks.max_speed))


def margin_rows(
    q: ArrayLike,
    least: float,
    rate: float,
    *,
    load: float = 0.0,
    slope: float = 0.0,
    uphill: float = 0.0,
    machine: Machine = BACKHOE,
) -> Rows:
    """The static margin does not fall below a least one: it may fall by `rate` times its excess.

    So far as the velocities stay alike, the excess shrinks no faster than exp(-rate t). A margin
    that is below already may not fall further. Accelerations do not count: at creep they are small.

    Args:
        q: joint angles, shape (4,) [rad].
        least: margin that is kept to each edge, 0 or more [m].
        rate: at most half of one over the step [1/s]: the velocity that is left near the limit.
        load: mass in the bucket [kg].
        slope, uphill: of the ground, as for `gravity_on_slope` [rad].
        machine: its numbers.

    Returns:
        A row for each of `EDGES`, for v of 6, shapes (4, 6) [m, m/rad] and (4,) [m/s].

    Raises:
        ValueError: a wrong shape, a value that is not finite, least or load negative, rate not
            positive, or a slope on which the tracks slip.
    """
    q, least, rate = joint_vector(q), not_negative(least, "least", "m"), positive(rate, "rate")
    load, slope = not_negative(load, "load", "kg"), number(slope, "slope", "rad")
    if q.shape != (4,):
        raise ValueError(f"q must be one posture, four joint angles, got shape {q.shape}")
    gx, gy, gz = gravity_on_slope(slope, number(uphill, "uphill", "rad"), machine)
    *point, z = centre_of_mass(q, load, machine)
    # The weight's line meets the ground downhill from below the centre of mass.
    point = np.subtract(point, z * np.array([gx, gy]) / gz)
    moved = np.zeros((2, 6))
    change = centre_of_mass_jacobian(q, load, machine)
    moved[:, 2:] = change[:2] - np.outer([gx, gy], change[2]) / gz
    # Turning the vehicle turns the slope the other way round.
    moved[:, 1] = -z * np.array([gy, -gx]) / gz
    origin, ahead, aside, inside = distances(
        [[0, 0], [1, 0], [0, 1], point], support_polygon(machine)
    )
    inwards = np.stack([ahead - origin, aside - origin], axis=-1)
    return Rows(-inwards @ moved, rate * np.maximum(inside - least, 0.0))
