"""Exercise 6.8: the part `odometry` of the machine, a pose from a pose and two sprocket rates."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.angles import wrap
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.odometry import printed
from backhoe.lessons.odometry.exercises.steps import advanced_by, by_differences
from backhoe.machine import BACKHOE
from backhoe.vehicle.tracks import tracks_twist

_RADIUS = BACKHOE.tracks.sprocket_radius


def odometry(pose: NDArray, left: float, right: float, dt: float, gauge: float) -> NDArray:
    """The next pose from sprocket rates held for dt, shape (3,) [m, m, rad]."""
    way = _RADIUS * (left + right) / 2 * dt
    turn = _RADIUS * (right - left) / gauge * dt
    middle = pose[2] + turn / 2
    return pose + np.array([way * np.cos(middle), way * np.sin(middle), turn])


def _steps(rng: np.random.Generator) -> list[tuple]:
    low, high = (-6.0, -6.0, 0.01, 1.6), (6.0, 6.0, 0.05, 3.2)
    cases = [(rng.uniform(-9, 9, 3), *map(float, rng.uniform(low, high))) for _ in range(30)]
    return [*cases, (np.array([1.0, 2.0, 7.0]), 3.0, 3.0, 0.02, 2.0)]


def _by(step: Callable[..., NDArray]) -> Callable[..., NDArray]:
    return lambda pose, left, right, dt, gauge: step(
        pose, *map(float, tracks_twist(left, right, gauge=gauge)), dt
    )


ODOMETRY = Exercise(
    number="6.8",
    title="Odometry for the machine",
    reference=odometry,
    oracle="exponential_of_the_belts_twist",
    cases=_steps,
    atol=2e-6,
    mistakes={
        "left and right are swapped: a faster right track turns the machine to the left": (
            lambda pose, left, right, *given: odometry(pose, right, left, *given)
        ),
        "it turns twice as much: (2.9) divides by the whole gauge, not by half of it": (
            lambda pose, left, right, dt, gauge: odometry(pose, left, right, dt, gauge / 2)
        ),
        "it turns half as much: divide the difference by the gauge, once": (
            lambda pose, left, right, dt, gauge: odometry(pose, left, right, dt, gauge * 2)
        ),
        "it turns with the gauge of the drawing: use the one that you are given": (
            lambda *given: odometry(*given[:-1], BACKHOE.tracks.gauge)
        ),
        "sprockets turn in rad/s, belts run at r times that: the radius is missing": (
            lambda pose, left, right, *given: odometry(
                pose, left / _RADIUS, right / _RADIUS, *given
            )
        ),
        "twice too far: the middle moves with the mean of the two tracks": (
            lambda pose, *given: pose + (odometry(pose, *given) - pose) * (2, 2, 1)
        ),
        "these are rates: what moves in a step is the rate times dt": (
            lambda pose, left, right, dt, gauge: odometry(pose, left, right, 1.0, gauge)
        ),
        "Euler, along the heading of the start: take the middle of the step, or the arc": (
            _by(advanced_by("euler"))
        ),
        "that is (4.1) as printed, along the heading of the end: take the middle, or the arc": (
            _by(printed.step_41)
        ),
        "that is how far it moved in the step: add it to the pose": (
            lambda pose, *given: odometry(pose, *given) - pose
        ),
        "it divides by omega = 0 when both tracks run alike": _by(by_differences),
        "sine and cosine are swapped: at psi = 0 the machine moves along x": (
            lambda pose, *given: pose + (odometry(pose, *given) - pose)[[1, 0, 2]]
        ),
        "the heading is wrapped: let it count on through full turns": (
            lambda *given: np.append(odometry(*given)[:2], wrap(odometry(*given)[2]))
        ),
    },
    hints=(
        "First way and turn of the step, from (2.9) times dt; then move along psi + turn / 2.",
        "way = r (left + right) / 2 dt, turn = r (right - left) / gauge dt, r of the sprocket.",
    ),
    tested_on="31 random steps of 10 to 50 ms, forwards, backwards and straight ahead",
)
