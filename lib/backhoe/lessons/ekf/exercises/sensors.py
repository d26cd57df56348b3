"""Exercise 7.4: roll and pitch from what an accelerometer feels at rest."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise


def attitude_from_gravity(force: NDArray) -> NDArray:
    """Roll and pitch of a machine at rest, shape (2,) [rad]: (4.22) repaired."""
    a_x, a_y, a_z = force
    return np.array([np.arctan2(a_y, a_z), np.arctan2(-a_x, np.hypot(a_y, a_z))])


def _cases(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(40):
        roll, pitch = rng.uniform((-2.8, -1.2), (2.8, 1.2))
        level = np.array(
            [-np.sin(pitch), np.sin(roll) * np.cos(pitch), np.cos(roll) * np.cos(pitch)]
        )
        cases.append((9.81 * level,))
    return cases


def _printed(force: NDArray) -> NDArray:
    a_x, a_y, a_z = force
    return np.arctan(np.array([a_x / np.hypot(a_y, a_z), a_y / np.hypot(a_x, a_z)]))


GRAVITY = Exercise(
    number="7.4",
    title="Repair (4.22)",
    reference=attitude_from_gravity,
    cases=_cases,
    mistakes={
        "that is (4.22) as printed: roll and pitch are swapped, and a sign is lost": _printed,
        "the names are right now; the sign of the pitch and the formula of the roll are not": (
            lambda force: _printed(force)[::-1]
        ),
        "the pitch is right; arctan(a_y / sqrt(a_x^2 + a_z^2)) is no Euler angle": (
            lambda force: np.array([_printed(force)[1], attitude_from_gravity(force)[1]])
        ),
        "the sign of the pitch: nose down, x tips towards gravity and feels less than 0": (
            lambda force: attitude_from_gravity(force) * (1, -1)
        ),
        "the sign of the roll: left side up, y points up a little and feels more than 0": (
            lambda force: attitude_from_gravity(force) * (-1, 1)
        ),
        "roll and pitch are swapped: roll first": (
            lambda force: attitude_from_gravity(force)[::-1]
        ),
        "a machine on its roof looks upright: np.arctan2 keeps the quadrant": (
            lambda force: np.array(
                [np.arctan(force[1] / force[2]), attitude_from_gravity(force)[1]]
            )
        ),
        "these are degrees: radians inside, degrees only at the edge": (
            lambda force: np.degrees(attitude_from_gravity(force))
        ),
        "the pitch forgets a_y: what is left of gravity is sqrt(a_y^2 + a_z^2)": (
            lambda force: np.array(
                [np.arctan2(force[1], force[2]), np.arctan2(-force[0], force[2])]
            )
        ),
    },
    hints=(
        "At rest the force is g (-sin pitch, sin roll cos pitch, cos roll cos pitch).",
        "Roll from a_y and a_z, where cos pitch cancels; then pitch from -a_x and what is left.",
    ),
    tested_on="40 random attitudes, some of them upside down",
)
