"""Exercise 2.7: which reading of Table A.1 the printed gravity torque belongs to."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics
from backhoe.lessons import published
from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE, variants

OFFSETS = np.degrees(
    [turn for link in BACKHOE.links[1:] for turn in (link.angle_offset, link.com_angle)]
)
"""Where stick, its centre of mass, bucket and its centre of mass point at q = 0 [deg]."""


def same_directions(answer: ArrayLike, reference: ArrayLike) -> bool | str:
    """Compare offsets in degrees up to full turns."""
    answer = np.asarray(answer, dtype=float)
    if answer.shape != (4,):
        return "give four angles in degrees: q3*, q3cm, q4*, q4cm at q = 0"
    miss = np.abs((answer - reference + 180) % 360 - 180)
    if (miss < 0.05).all():
        return True
    if (miss[[0, 1, 3]] < 0.05).all():
        return "three are right; gravity cannot see where the teeth are: use the third clue for q4*"
    if (miss < 1).all():
        return "nearly: take the angles of Table A.2 to a tenth of a degree"
    torque_miss = _torque_miss(answer)
    if torque_miss < 0.3:
        return "the torques fit; now the steel: does each centre of mass lie along its link?"
    return f"with these offsets the gravity torque misses tau_0 by {torque_miss:.1f} kN m"


def _torque_miss(offsets: NDArray) -> float:
    tau_0 = np.array(published.load("mastalli_2013_free_fall")["gravity_torque"])
    machine = variants.reading(offsets)
    torque = dynamics.gravity_torque(np.radians([0.0, 0.0, -10.0, 0.0]), machine=machine)
    return np.abs(torque - tau_0).max() / 1e3


READING = Exercise(
    number="2.7",
    title="which way do stick and bucket hang?",
    reference=OFFSETS,
    oracle="three_clues",
    compare=same_directions,
    tested_on="tau_0 and the shape of the links",
    hints=(
        "g3 - g4 depends on the stick's signs alone: find those first",
        "of two readings that fit, one puts a centre of mass on the far side of its own joint",
    ),
    mistakes={
        "that is Table A.1 as printed: the stick straight out, and g3 would be +22 kN m": (
            np.array([-1.9, -3.8, 14.1, -11.4])
        ),
        "that is all as printed: the stick straight out, its centre of mass upright": (
            np.array([-1.9, 86.2, 14.1, 78.6])
        ),
        "with plus signs the stick stands up: g3 - g4 would be -0.11, not +1.87 kN m": (
            np.array([88.1, 86.2, 104.1, 78.6])
        ),
        "the torques fit, but the stick's centre of mass would lie behind its own joint": (
            np.array([-1.9, -176.2, 14.1, -168.6])
        ),
        (
            "two and two have changed places: theta_3 and theta_4 are the links, theta_cm the "
            "centres of mass"
        ): np.array([-86.2, -88.1, -78.6, -104.1]),
        "minus pi/2 and minus theta together fold the stick back along the boom": (
            np.array([-178.1, -176.2, -194.1, -168.6])
        ),
        "the stick is right; the bucket stands the other way: g3 - g4 fits, tau_0 does not": (
            OFFSETS * np.array([1, 1, -1, -1])
        ),
        "the bucket is right; the stick stands the other way: look at g3 - g4": (
            OFFSETS * np.array([-1, -1, 1, 1])
        ),
        "a quarter turn the other way: theta counts from the link before, not from its normal": (
            OFFSETS + 90
        ),
        "the order is stick, its centre of mass, bucket, its centre of mass": OFFSETS[[0, 2, 1, 3]],
        "the stick's centre of mass lies along the stick, not behind its joint": (
            OFFSETS + np.array([0, 180, 0, 0])
        ),
        "right in radians: give degrees here": np.radians(OFFSETS),
    },
)
