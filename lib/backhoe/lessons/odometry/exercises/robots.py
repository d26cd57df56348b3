"""Exercise 6.3: the Jacobian of a robot on three omnidirectional wheels."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.lessons.exercise import Exercise


def jacobian(
    radius: float, distance: float, places_deg: ArrayLike = (0.0, 120.0, 240.0)
) -> NDArray:
    """B with (v_x, v_y, omega) = B @ wheel speeds, in the body, shape (3, 3) [m, m, 1]."""
    a = np.radians(places_deg)
    rim_speeds = np.column_stack((-np.sin(a), np.cos(a), np.full(3, distance)))
    return radius * np.linalg.inv(rim_speeds)


JACOBIAN = Exercise(
    number="6.3",
    title="Three wheels that slide sideways",
    reference=jacobian,
    oracle="rims_as_fast_as_their_places",
    cases=lambda rng: [tuple(rng.uniform((0.03, 0.1), (0.12, 0.4))) for _ in range(20)],
    mistakes={
        "that matrix makes wheel speeds from the robot's: the Jacobian is its inverse": (
            lambda radius, distance: np.linalg.inv(jacobian(radius, distance))
        ),
        "the transpose is not the inverse: divide its rows by 3/2, 3/2 and 3 d^2": (
            lambda radius, distance: radius * np.linalg.inv(jacobian(1.0, distance)).T
        ),
        "transposed: a row of J belongs to v_x, v_y or omega, a column to a wheel": (
            lambda radius, distance: jacobian(radius, distance).T
        ),
        "a larger wheel carries the robot farther at the same speed: multiply by the radius": (
            lambda radius, distance: jacobian(1 / radius, distance)
        ),
        "that takes rim speeds in m/s: the wheels turn at Omega rad/s, their rims at r Omega": (
            lambda radius, distance: jacobian(1.0, distance)
        ),
        "the robot turns at the same rate whatever its size: omega moves a rim by d omega": (
            lambda radius, distance: jacobian(radius, 1.0)
        ),
        "all signs are turned round: a wheel at angle a drives along (-sin a, cos a)": (
            lambda radius, distance: -jacobian(radius, distance)
        ),
        "your wheels drive away from the middle: they drive across that, along (-sin a, cos a)": (
            lambda radius, distance: jacobian(radius, distance, (-90.0, 30.0, 150.0))
        ),
        "the wheels go round clockwise: 120 and 240 degrees are to the left of the first": (
            lambda radius, distance: jacobian(radius, distance, (0.0, -120.0, -240.0))
        ),
        "omega has the wrong sign: wheels that turn forwards turn the robot anticlockwise": (
            lambda radius, distance: jacobian(radius, -distance)
        ),
        "the angles 120 and 240 are degrees: np.radians before the sines": (
            lambda radius, distance: jacobian(radius, distance, np.degrees((0.0, 120.0, 240.0)))
        ),
    },
    hints=(
        "First the other way round: which rim speed does each wheel need for v_x, v_y and omega?",
        "Rows (-sin a, cos a, d) for a = 0, 120, 240 deg make the rims' speeds: invert, times r.",
    ),
    tested_on="20 random robots",
)
