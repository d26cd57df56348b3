"""Exercise 7.4: roll and pitch from what an accelerometer feels at rest."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.ekf.printed import attitude_422
from backhoe.lessons.exercise import Exercise
from backhoe.localisation import imu
from backhoe.localisation.imu import attitude_from_gravity


def _forces(rng: np.random.Generator) -> list[tuple]:
    attitudes = rng.uniform((-2.8, -1.2, -3.0), (2.8, 1.2, 3.0), (40, 3))
    attitudes[:3] = (0.0, 0.0, 0.0), (0.5, 0.0, 1.0), (0.0, -0.5, -1.0)
    return [(force,) for force in imu.specific_force(np.zeros((40, 3)), attitudes)]


def _roll_by(roll: object) -> object:
    """The right pitch beside another roll."""
    return lambda force: np.array([roll(*force), attitude_from_gravity(force)[1]])


def _flat_pitch(force: NDArray) -> NDArray:
    return np.array([attitude_from_gravity(force)[0], np.arctan2(-force[0], force[2])])


GRAVITY = Exercise(
    number="7.4",
    title="Repair roll and pitch",
    reference=attitude_from_gravity,
    cases=_forces,
    oracle="gravity_turned_into_the_machine",
    mistakes={
        "that is tilted as it stands: roll and pitch are swapped, and a sign is lost": attitude_422,
        "the names are right now; the sign of the pitch and the formula of the roll are not": (
            lambda force: attitude_422(force)[::-1]
        ),
        "the pitch is right; arctan(a_y / sqrt(a_x^2 + a_z^2)) is no Euler angle": (
            _roll_by(lambda x, y, z: np.arctan(y / np.hypot(x, z)))
        ),
        "the sign of the pitch: nose down, x tips towards gravity and feels less than 0": (
            lambda force: attitude_from_gravity(force) * (1, -1)
        ),
        "the sign of the roll: left side up, y points up a little and feels more than 0": (
            lambda force: attitude_from_gravity(force) * (-1, 1)
        ),
        "roll and pitch are swapped: roll first": lambda force: attitude_from_gravity(force)[::-1],
        "a machine on its roof looks upright: np.arctan2 keeps the quadrant": (
            _roll_by(lambda x, y, z: np.arctan(y / z))
        ),
        "these are degrees: radians inside, degrees only at the edge": (
            lambda force: np.degrees(attitude_from_gravity(force))
        ),
        "the arguments of arctan2 are the other way round: the side over what is left, (y, z)": (
            _roll_by(lambda x, y, z: np.arctan2(z, y))
        ),
        "both signs are turned round: the accelerometer feels the ground's push, not gravity": (
            lambda force: attitude_from_gravity(-force)
        ),
        "the pitch is right over the nose only: divide by what is left, sqrt(a_y^2 + a_z^2)": (
            lambda force: np.array(
                [attitude_from_gravity(force)[0], np.arctan(-force[0] / force[2])]
            )
        ),
        "the pitch forgets a_y: what is left of gravity is sqrt(a_y^2 + a_z^2)": _flat_pitch,
    },
    hints=(
        "At rest the force is g (-sin pitch, sin roll cos pitch, cos roll cos pitch).",
        "Roll from a_y and a_z, where cos pitch cancels; then pitch from -a_x and what is left.",
    ),
    tested_on="40 random attitudes, some of them upside down",
)
