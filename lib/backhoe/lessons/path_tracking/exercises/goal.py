"""Exercise 5.5: where a trajectory wants the vehicle to be at the end of this sample."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.lessons.exercise import Exercise


def goal(time: float, dt: float, points: ArrayLike, times: ArrayLike) -> NDArray:
    """Place on the trajectory at time + dt, shape (2,) [m]; its ends hold before and after it."""
    points, then = np.asarray(points), time + dt
    return np.array([np.interp(then, times, points[:, 0]), np.interp(then, times, points[:, 1])])


def _cases(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(50):
        count = rng.integers(2, 9)
        points = rng.uniform(-3, 3, (count, 2))
        times = np.cumsum(rng.uniform(0.5, 3.0, count)) - 1.0
        time = rng.uniform(times[0] - 1.0, times[-1] + 1.0)
        cases.append((time, rng.uniform(0.05, 0.3), points, times))
    return cases


def _waypoint(number: Callable[[NDArray, float], int]) -> Callable[..., NDArray]:
    """The way-point of a number that depends on the times and the end of the sample."""
    return lambda time, dt, points, times: points[
        np.clip(number(times, time + dt), 0, len(points) - 1)
    ]


def _beyond(time: float, dt: float, points: NDArray, times: NDArray) -> NDArray:
    place = np.clip(np.searchsorted(times, time + dt, "right") - 1, 0, len(times) - 2)
    share = (time + dt - times[place]) / (times[place + 1] - times[place])
    return points[place] + share * (points[place + 1] - points[place])


GOAL = Exercise(
    number="5.5",
    title="Where to be at the end of this sample",
    reference=goal,
    oracle="velocities_add_up",
    cases=_cases,
    mistakes={
        "that is where to be now, sample n: the command works until n + 1, so aim at time + dt": (
            lambda time, dt, points, times: goal(time, 0.0, points, times)
        ),
        "that is where to have been a sample ago: aim at time + dt": (
            lambda time, dt, points, times: goal(time, -dt, points, times)
        ),
        "that is the next way-point: the goal moves along the line between two of them": (
            _waypoint(np.searchsorted)
        ),
        "that is the way-point just passed: the goal moves along the line between two of them": (
            _waypoint(lambda times, then: np.searchsorted(times, then, "right") - 1)
        ),
        "that is the way-point nearest in time: the goal moves along the line between two": (
            _waypoint(lambda times, then: np.abs(times - then).argmin())
        ),
        "you treat the times as evenly spaced: each segment has its own duration": (
            lambda time, dt, points, times: goal(
                time, dt, points, np.linspace(times[0], times[-1], len(times))
            )
        ),
        "the trajectory begins at its first time, not at zero: take that off nowhere else": (
            lambda time, dt, points, times: goal(time, dt, points, times - times[0])
        ),
        "x and y are swapped: the place is x, y": (
            lambda time, dt, points, times: goal(time, dt, points[:, ::-1], times)
        ),
        "right within the trajectory, but it runs on beyond its ends: wait at the ends instead": (
            _beyond
        ),
    },
    hints=(
        "Between t_n and t_{n+1} the goal has gone the share (t - t_n)/(t_{n+1} - t_n).",
        "np.interp does it for one coordinate, and holds the ends; call it for x and for y.",
    ),
    tested_on="50 random trajectories, some before their start or after their end",
)
