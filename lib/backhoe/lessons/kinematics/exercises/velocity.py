"""Exercises 1.4 and 1.5: the printed angular Jacobian repaired; speeds that level the ground."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.kinematics import printed
from backhoe.lessons.kinematics.exercises.posture import random_postures


def angular_jacobian(q: ArrayLike) -> NDArray:
    """J_w of the bucket: its columns are the axes of the four joints, shape (3, 4)."""
    direction = q[0] + np.pi / 2
    swing_axis = [0.0, 0.0, 1.0]
    across = [np.sin(direction), -np.cos(direction), 0.0]
    return np.column_stack((swing_axis, across, across, across))


def _axes(*columns: ArrayLike) -> NDArray:
    return np.column_stack(columns)


def _across(direction: float) -> NDArray:
    return np.array([np.sin(direction), -np.cos(direction), 0.0])


def _along(q: NDArray) -> NDArray:
    direction = q[0] + np.pi / 2
    along = np.array([np.cos(direction), np.sin(direction), 0.0])
    return _axes((0, 0, 1), along, along, along)


def _flipped(q: NDArray) -> NDArray:
    return angular_jacobian(q) * (1, -1, -1, -1)


def _stick_only(q: NDArray) -> NDArray:
    return angular_jacobian(q) * (1, 1, 1, 0)


def _without_swing(q: NDArray) -> NDArray:
    return angular_jacobian(q) * (0, 1, 1, 1)


def _half_repaired(q: NDArray) -> NDArray:
    J = printed.angular_jacobians(q)[3]
    J[:2, 2:] = J[:2, 1:2]
    return J


ANGULAR = Exercise(
    number="1.4",
    title="Repair (A.18)",
    reference=angular_jacobian,
    cases=lambda rng: [(q,) for q in random_postures(rng, 40)],
    mistakes={
        "that is (A.18) as printed: stick and bucket do not turn about the vertical": (
            lambda q: printed.angular_jacobians(q)[3]
        ),
        "the printed ones are still in the last row: those joints have no vertical part": (
            _half_repaired
        ),
        "the axes use q1 where q1* = q1 + pi/2 belongs": (
            lambda q: _axes((0, 0, 1), *(_across(q[0]),) * 3)
        ),
        "those axes point along the arm: the joints' axes lie across it": _along,
        "the three horizontal axes point the other way: positive turns lift the link": _flipped,
        "that is J_w3, of the stick: the bucket joint turns the bucket as well": _stick_only,
        "the swing turns the bucket too: its column is (0, 0, 1)": _without_swing,
    },
    hints=(
        "Column i is the unit vector, in the base frame, of the axis that joint i turns about.",
        "T_01, third column: the axis of the boom's joint. How do the three horizontal axes lie?",
    ),
    tested_on="40 random postures",
)


def grading_speeds(q: ArrayLike, speed: float) -> NDArray:
    """Joint speeds that move the teeth level and outwards, the bucket's pitch kept [rad/s]."""
    J = kinematics.jacobian(q, "tip")
    direction = q[0] + np.pi / 2
    outwards = np.cos(direction) * J[0] + np.sin(direction) * J[1]
    pitch = np.array([0.0, 1.0, 1.0, 1.0])
    task = np.stack((outwards, J[2], pitch))
    return np.append(0.0, np.linalg.solve(task[:, 1:], (speed, 0.0, 0.0)))


def _task(q: NDArray, pitch: ArrayLike = (1.0, 1.0, 1.0)) -> NDArray:
    J = kinematics.jacobian(q, "tip")[:, 1:]
    direction = q[0] + np.pi / 2
    return np.stack((np.cos(direction) * J[0] + np.sin(direction) * J[1], J[2], pitch))


def _solved(task: NDArray, wanted: ArrayLike) -> NDArray:
    return np.append(0.0, np.linalg.solve(task, wanted))


def _along_x(q: NDArray, speed: float) -> NDArray:
    task = _task(q)
    task[0] = kinematics.jacobian(q, "tip")[0, 1:]
    return _solved(task, (speed, 0.0, 0.0))


def _pseudo_inverse(q: NDArray, speed: float) -> NDArray:
    return np.append(0.0, np.linalg.pinv(_task(q)[:2]) @ (speed, 0.0))


GRADING = Exercise(
    number="1.5",
    title="Level the ground",
    reference=grading_speeds,
    cases=lambda rng: [(q, rng.uniform(0.1, 0.6)) for q in random_postures(rng, 40)],
    mistakes={
        "the bucket joint stands still, so the bucket turns with the stick: pitch is a sum": (
            lambda q, speed: _solved(_task(q, (0.0, 0.0, 1.0)), (speed, 0.0, 0.0))
        ),
        "the teeth move level, but the bucket's pitch changes: add a row that keeps it": (
            _pseudo_inverse
        ),
        "that is for 1 m/s whatever is asked: the wanted speed is not used": (
            lambda q, speed: grading_speeds(q, 1.0)
        ),
        "the teeth move towards the machine: the sign is wrong": (
            lambda q, speed: grading_speeds(q, -speed)
        ),
        "the teeth move straight up: the speed belongs to the horizontal row": (
            lambda q, speed: _solved(_task(q), (0.0, speed, 0.0))
        ),
        "the speed along x is right, but outwards is along x only when the arm points forward": (
            _along_x
        ),
        "that is the transpose of the Jacobian: it maps forces; velocities need the inverse": (
            lambda q, speed: np.append(0.0, _task(q).T @ (speed, 0.0, 0.0))
        ),
    },
    hints=(
        "Three unknowns (boom, stick, bucket), three wishes: outward speed, no lift, no tilt.",
        "Rows: cos(q1*) J[0] + sin(q1*) J[1], J[2], (0, 1, 1, 1); drop column 0; np.linalg.solve.",
    ),
    tested_on="40 random postures and speeds",
)
