"""Exercises 1.4 and 1.5: the angular Jacobian repaired; speeds that level the ground."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.kinematics import printed
from backhoe.machine import BACKHOE


def angular_jacobian(q: ArrayLike, link: int) -> NDArray:
    """J_w of link 1 (swing) to 4 (bucket), (3, 4): the axes of the joints that turn it, or 0."""
    direction = q[0] + np.pi / 2
    swing_axis = [0.0, 0.0, 1.0]
    across = [np.sin(direction), -np.cos(direction), 0.0]
    J = np.column_stack((swing_axis, across, across, across))
    J[:, link:] = 0.0
    return J


def _columns_times(*factors: float) -> Callable[[NDArray, int], NDArray]:
    return lambda q, link: angular_jacobian(q, link) * factors


def _turn_cases(rng: np.random.Generator) -> list[tuple[NDArray, int]]:
    q = [*rng.uniform(BACKHOE.lower, BACKHOE.upper, (40, 4)), np.zeros(4), BACKHOE.lower]
    return [(one, 1 + place % 4) for place, one in enumerate(q)]


ANGULAR = Exercise(
    number="1.4",
    title="Repair a turn",
    reference=angular_jacobian,
    oracle="spin_of_the_turning_link",
    cases=_turn_cases,
    mistakes={
        "stick and bucket do not turn about the vertical: that is the form to repair": (
            lambda q, link: printed.angular_jacobians(q)[link - 1]
        ),
        "the ones are still in the last row: stick and bucket have no vertical part": (
            lambda q, link: angular_jacobian(q, link) + np.outer((0, 0, 1), np.arange(4) // 2 > 0)
        ),
        "the axes use q1 where q1* = q1 + pi/2 belongs": (
            lambda q, link: angular_jacobian(q - np.pi / 2, link)
        ),
        "those axes point along the arm: the joints' axes lie across it": (
            lambda q, link: angular_jacobian(q + np.pi / 2, link)
        ),
        "joints beyond the link do not turn it: their columns are zero": (
            lambda q, link: angular_jacobian(q, 4)
        ),
        "links count from 1: the swing, 1, is turned by its own joint": (
            lambda q, link: angular_jacobian(q, link - 1)
        ),
        "that is one joint too many: link 1, the swing, is turned by joint 1 alone": (
            lambda q, link: angular_jacobian(q, link + 1)
        ),
        "the three horizontal axes point the other way: positive turns lift the link": (
            _columns_times(1, -1, -1, -1)
        ),
        "the bucket joint turns the bucket as well: its column is missing": (
            _columns_times(1, 1, 1, 0)
        ),
        "the swing turns the bucket too: its column is (0, 0, 1)": _columns_times(0, 1, 1, 1),
    },
    hints=(
        "Column i is the unit vector of the axis that joint i turns about, 0 beyond the link.",
        "T_01, third column: the axis of the boom's joint. How do the three horizontal axes lie?",
    ),
    tested_on="four links in 42 postures",
)


def grading_speeds(q: ArrayLike, speed: float) -> NDArray:
    """Joint speeds that move the teeth level and outwards, the bucket's pitch kept [rad/s]."""
    J = kinematics.jacobian(q, "tip")
    direction = q[0] + np.pi / 2
    outwards = np.cos(direction) * J[0] + np.sin(direction) * J[1]
    pitch = np.array([0.0, 1.0, 1.0, 1.0])
    task = np.stack((outwards, J[2], pitch))
    return np.append(0.0, np.linalg.solve(task[:, 1:], (speed, 0.0, 0.0)))


def _graded(
    solve: Callable = np.linalg.solve,
    pitch: ArrayLike = (1.0, 1.0, 1.0),
    wish: ArrayLike = (1.0, 0.0, 0.0),
) -> Callable[[NDArray, float], NDArray]:
    def speeds(q: NDArray, speed: float) -> NDArray:
        J = kinematics.jacobian(q, "tip")[:, 1:]
        task = np.stack((np.cos(q[0]) * J[1] - np.sin(q[0]) * J[0], J[2], pitch))
        return np.append(0.0, solve(task, speed * np.array(wish)))

    return speeds


GRADING = Exercise(
    number="1.5",
    title="Level the ground",
    reference=grading_speeds,
    oracle="teeth_a_moment_later",
    cases=lambda rng: [
        (q, speed)
        for q, speed in zip(
            rng.uniform(BACKHOE.lower, BACKHOE.upper, (40, 4)),
            (0.0, *rng.uniform(0.1, 0.6, 20), *rng.uniform(-0.6, -0.1, 19)),
            strict=True,
        )
    ],
    mistakes={
        "the bucket joint stands still, so the bucket turns with the stick: pitch is a sum": (
            _graded(pitch=(0.0, 0.0, 1.0))
        ),
        "the teeth move level, but the bucket's pitch changes: add a row that keeps it": (
            _graded(lambda task, wish: np.linalg.pinv(task[:2]) @ wish[:2])
        ),
        "that is for 1 m/s whatever is asked: the wanted speed is not used": (
            lambda q, speed: grading_speeds(q, 1.0)
        ),
        "the teeth move towards the machine: the sign is wrong": (
            lambda q, speed: grading_speeds(q, -speed)
        ),
        "the teeth move straight up: the speed belongs to the horizontal row": (
            _graded(wish=(0.0, 1.0, 0.0))
        ),
        "the speed along x is right, but outwards is along x only when the arm points forward": (
            lambda q, speed: grading_speeds(q, -speed / np.sin(q[0]))
        ),
        "that is the transpose of the Jacobian: it maps forces; velocities need the inverse": (
            _graded(lambda task, wish: task.T @ wish)
        ),
    },
    hints=(
        "Three unknowns (boom, stick, bucket), three wishes: outward speed, no lift, no tilt.",
        "Rows: cos(q1*) J[0] + sin(q1*) J[1], J[2], (0, 1, 1, 1); drop column 0; np.linalg.solve.",
    ),
    tested_on="40 random postures, outwards, inwards and at rest",
)
