"""Exercise 1.6: inverse kinematics for any target."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from backhoe.arm import kinematics
from backhoe.arm.kinematics import inverse_kinematics
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.kinematics.exercises.posture import OFFSETS
from backhoe.machine import BACKHOE, replace

_HEIGHT = BACKHOE.base.height + BACKHOE.swing.height


def _target_cases(rng: np.random.Generator) -> list[tuple[NDArray]]:
    postures = rng.uniform(BACKHOE.lower, BACKHOE.upper, (100, 4))
    ends = rng.choice([BACKHOE.lower, BACKHOE.upper], 10)
    ends[:, 0] = rng.uniform(-3, 3, 10)
    straight = [(6.0, 0.0, 2.0, 0.0), (BACKHOE.base.offset, 5.5, 1.0, -0.5)]
    targets = [*kinematics.pose(np.vstack((postures, ends))), *map(np.array, straight)]
    return [(target,) for target in targets]


def _without(**parts: str) -> Callable[[NDArray], NDArray]:
    """Solution with one number of each part left out; NaN where that is out of reach."""
    changed = {part: replace(getattr(BACKHOE, part), **{at: 0.0}) for part, at in parts.items()}
    machine = replace(BACKHOE, **changed)
    return partial(inverse_kinematics, machine=machine, limits=False, on_failure="nan")


def _plus(*change: float) -> Callable[[NDArray], NDArray]:
    return lambda target: inverse_kinematics(target) + change


def _gamma_added(target: NDArray, bend: float = 1.0) -> NDArray:
    swing, boom, stick, bucket = inverse_kinematics(target)
    L2, L3, turn = BACKHOE.boom.length, BACKHOE.stick.length, stick + OFFSETS[1]
    gamma = np.arctan2(-L3 * np.sin(turn), L2 + L3 * np.cos(turn))
    return np.array([swing, boom - 2 * gamma, bend * turn - OFFSETS[1], bucket])


def _slope_swapped(target: NDArray) -> NDArray:
    q = inverse_kinematics(target)
    k = np.hypot(target[0] - BACKHOE.base.offset, target[1]) - BACKHOE.swing.offset
    h = target[2] - _HEIGHT
    return np.add(q, [0.0, np.arctan2(k, h) - np.arctan2(h, k), 0.0, 0.0])


def _swing_by(angle: Callable[[float, float], float]) -> Callable[[NDArray], NDArray]:
    """Solution with another swing, a function of the target's place seen from the swing axis."""

    def solution(target: NDArray) -> NDArray:
        swing = angle(target[0] - BACKHOE.base.offset, target[1])
        return np.append(swing, inverse_kinematics(target)[1:])

    return solution


INVERSE = Exercise(
    number="1.6",
    title="Inverse kinematics",
    reference=inverse_kinematics,
    oracle="back_at_the_target_elbow_up",
    cases=_target_cases,
    mistakes={
        "that is elbow down, outside the limits: take the other sign of the bend": (
            partial(_gamma_added, bend=-1.0)
        ),
        "right but for whole turns of the swing: bring it into -pi..pi": (
            _swing_by(lambda x, y: np.arctan2(y, x) - np.pi / 2)
        ),
        "np.arctan cannot tell left from right: use np.arctan2(-(x - b0), y) for the swing": (
            _swing_by(lambda x, y: np.arctan(-x / y))
        ),
        "np.arctan cannot tell front from back: use np.arctan2 for the swing": (
            _swing_by(lambda x, y: np.arctan(y / x) - np.pi / 2)
        ),
        "np.arctan2 takes first what the sine goes with: arctan2(-(x - b0), y)": (
            _swing_by(lambda x, y: np.arctan2(y, -x))
        ),
        "the swing turns the wrong way: positive is to the left, so -(x - b0)": (
            _swing_by(np.arctan2)
        ),
        "the bucket joint's angle is given: hand it on as it is": _plus(0, 0, 0, -OFFSETS[2]),
        "the slope of d is beta = arctan2(h, k): height first": _slope_swapped,
        "the swing is a quarter turn off: at q1 = 0 the arm points left": _plus(np.pi / 2, 0, 0, 0),
        "the swing axis is not at the base's origin: take b0 off x first": _without(base="offset"),
        "the triangle starts at the boom's joint, b1 away from the swing axis": (
            _without(swing="offset")
        ),
        "the triangle starts at the boom's joint: take L0 + L1 off z": (
            _without(base="height", swing="height")
        ),
        "the boom's joint is L0 + L1 above the ground: L0 is missing": _without(base="height"),
        "the boom's joint is L0 + L1 above the ground: L1 is missing": _without(swing="height"),
        "with the elbow up the boom points above d: the sign of gamma is wrong": _gamma_added,
        "these are q2* and q3*: take the offsets off to get q": _plus(0, *OFFSETS[:2], 0),
    },
    hints=(
        "Swing first; then the triangle of boom, stick and d in the arm's plane; offsets last.",
        "bend = q3* = -arccos((d^2 - L2^2 - L3^2) / (2 L2 L3)); q2* = beta + gamma of the figure.",
    ),
    tested_on="112 targets all round the machine, some at its limits",
)
