"""Exercises 1.6 and 1.7: inverse kinematics for any target; the damped inverse of (2.4)."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from backhoe.arm import kinematics
from backhoe.arm.kinematics import damped_inverse, inverse_kinematics
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.kinematics import printed
from backhoe.lessons.kinematics.exercises.posture import OFFSETS
from backhoe.machine import BACKHOE, replace


def _target_cases(rng: np.random.Generator) -> list[tuple[NDArray]]:
    postures = rng.uniform(BACKHOE.lower, BACKHOE.upper, (100, 4))
    return [(target,) for target in kinematics.pose(postures)]


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


def _swing_by(angle: Callable[[float, float], float]) -> Callable[[NDArray], NDArray]:
    def solution(target: NDArray) -> NDArray:
        swing = angle(target[1], target[0] - BACKHOE.base.offset) - np.pi / 2
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
        "right but for whole turns of the swing: bring it into -pi..pi": _swing_by(np.arctan2),
        "np.arctan cannot tell front from back: use np.arctan2 for the swing": (
            _swing_by(lambda y, x: np.arctan(y / x))
        ),
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
    tested_on="100 random targets all round the machine",
)


def _damped_cases(rng: np.random.Generator) -> list[tuple[NDArray, float]]:
    cases = []
    for index, q in enumerate(rng.uniform(BACKHOE.lower, BACKHOE.upper, (40, 4))):
        if index % 2:
            q[2] = -BACKHOE.stick.angle_offset - rng.uniform(0.02, 0.2)
        rows = 3 if index % 4 == 3 else 4
        cases.append((kinematics.task_jacobian(q)[:rows], rng.uniform(0.05, 0.4)))
    return cases


def _from_svd(
    V: Callable = np.transpose, sign: float = 1.0, full: bool = True
) -> Callable[[NDArray, float], NDArray]:
    def inverse(J: NDArray, damping: float) -> NDArray:
        U, sigma, V_T = np.linalg.svd(J, full_matrices=full)
        return V(V_T) @ np.diag(sigma / (sigma**2 + sign * damping**2)) @ U.T

    return inverse


DAMPED = Exercise(
    number="1.7",
    title="Repair (2.4)",
    reference=damped_inverse,
    oracle="gradient_of_damped_least_squares_is_zero",
    cases=_damped_cases,
    mistakes={
        "that is (2.4) as printed: J + lambda^2 I can be singular itself": printed.inverse_24,
        "that is the middle of (2.5): 1/(sigma + lambda^2) never gets small near sigma = 0": (
            printed.inverse_25
        ),
        "there is no damping in it: near the stretched arm it asks for enormous steps": (
            lambda J, damping: np.linalg.inv(J)
        ),
        "that is the pseudoinverse, which has no damping: near the stretched arm it explodes": (
            lambda J, damping: np.linalg.pinv(J)
        ),
        (
            "right while J is square: with three rows svd(J, full_matrices=False) makes the "
            "shapes fit"
        ): _from_svd(),
        "np.linalg.svd returns U, sigma and V^T, transposed already: V is V_T.T": (
            _from_svd(np.asarray)
        ),
        "the damping enters squared: lambda^2 I": (
            lambda J, damping: damped_inverse(J, np.sqrt(damping))
        ),
        "a J^T is missing: J^T (J J^T + lambda^2 I)^-1": (
            lambda J, damping: np.linalg.inv(J @ J.T + damping**2 * np.eye(len(J)))
        ),
        "J^T (J J^T + ...)^-1 or (J^T J + ...)^-1 J^T: you have mixed the two forms": (
            lambda J, damping: J.T @ np.linalg.inv(J.T @ J + damping**2 * np.eye(4))
        ),
        "the damping is added to sigma^2, not taken off": _from_svd(sign=-1.0, full=False),
    },
    hints=(
        "Minimise |J dq - e|^2 + lambda^2 |dq|^2: set its gradient to zero, and take e out of dq.",
        "(J^T J + lambda^2 I)^-1 J^T; or with the SVD: the weights of (2.6), which are right.",
    ),
    tested_on="40 random Jacobians, half near the stretched arm, some with three wishes only",
)
