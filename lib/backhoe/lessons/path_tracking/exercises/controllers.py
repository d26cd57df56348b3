"""Exercise 5.6: Scaglia's first controller, the least of its cost."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import wrap
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.path_tracking.printed import taylor_613


def scaglia(pose: ArrayLike, goal: ArrayLike, dt: float, kv2: float, kw2: float) -> NDArray:
    """V [m/s] and W [rad/s] at the least cost J; kv2 and kw2 are its gains k_v and k_w."""
    x, y, theta = pose
    dx, dy = goal[0] - x, goal[1] - y
    theta_d = np.arctan2(dy, dx)
    turn = wrap(theta_d - theta)
    V = kv2 * (dx * np.cos(theta) + dy * np.sin(theta)) / dt
    return np.array([V, kw2 * turn / dt])


def _cases(rng: np.random.Generator) -> list[tuple]:
    low, high = (-3, -3, -7, -0.5, -0.5, 0.02, 0.2, 0.2), (3, 3, 7, 0.5, 0.5, 0.2, 0.95, 0.95)
    rows = rng.uniform(low, high, (60, 8))
    rows[0, 2], rows[1, 2] = 0.0, np.arctan2(*rows[1, 4:2:-1]) + np.pi / 2
    return [(row[:3], row[:2] + row[3:5], *row[5:].tolist()) for row in rows]


def _printed(*columns: int) -> Callable[..., NDArray]:
    """V or W, or both, as in (6.13) with atan2."""

    def wrong(pose: NDArray, goal: NDArray, dt: float, kv2: float, kw2: float) -> NDArray:
        mixed = scaglia(pose, goal, dt, kv2, kw2)
        as_printed = taylor_613(pose, goal, dt, kv2, kw2, two_arguments=True)
        mixed[[*columns]] = np.array(as_printed)[[*columns]]
        return mixed

    return wrong


def _one_argument(pose: NDArray, goal: NDArray, dt: float, kv2: float, kw2: float) -> NDArray:
    dx, dy = goal - pose[:2]
    V, _ = scaglia(pose, goal, dt, kv2, kw2)
    return np.array([V, kw2 * wrap(np.arctan(dy / dx) - pose[2]) / dt])


SCAGLIA = Exercise(
    number="5.6",
    title="The least of the cost",
    reference=scaglia,
    oracle="the_least_of_the_cost",
    cases=_cases,
    mistakes={
        "V is a speed with a sign: for a goal behind the vehicle backs up": (
            lambda *given: scaglia(*given) * 0 + (abs(scaglia(*given)[0]), scaglia(*given)[1])
        ),
        (
            "V is k_v times the whole distance over dt: at the least of J it is the way along the "
            "vehicle's own axis"
        ): _printed(0),
        "the derivative of the square has lost its minus: the chain rule brings one": (
            lambda pose, goal, dt, kv2, kw2: scaglia(pose, goal, dt, kv2 / (2 * kv2 - 1), kw2)
        ),
        "theta_d - theta is not wrapped: after a full turn the vehicle unwinds it again": (
            _printed(1)
        ),
        "V is k_v times the whole distance, and theta_d - theta is not wrapped": _printed(0, 1),
        "np.arctan cannot tell ahead from behind: use np.arctan2 for theta_d": _one_argument,
        "T_0 is missing: these are a distance and an angle, divide both by dt": (
            lambda pose, goal, dt, *gains: scaglia(pose, goal, 1.0, *gains)
        ),
        "T_0 is missing in W: an angle over dt is a rate": (
            lambda pose, goal, dt, *gains: scaglia(pose, goal, dt, *gains) * (1, dt)
        ),
        "W turns away from the goal: theta_d - theta, not the other way round": (
            lambda *given: scaglia(*given) * (1, -1)
        ),
        "kv2 and kw2 are the gains of J as they are: do not square them": (
            lambda pose, goal, dt, kv2, kw2: scaglia(pose, goal, dt, kv2**2, kw2**2)
        ),
        "the weights are swapped: kv2 belongs to V, kw2 to W": (
            lambda pose, goal, dt, kv2, kw2: scaglia(pose, goal, dt, kw2, kv2)
        ),
        "all of the error in one sample: the gains kv2 and kw2 are left out": (
            lambda pose, goal, dt, *gains: scaglia(pose, goal, dt, 1.0, 1.0)
        ),
        "W is in degrees per second: everything inside the course is in radians": (
            lambda *given: scaglia(*given) * (1, 180 / np.pi)
        ),
    },
    hints=(
        "J has V in the two misses and in its effort: set dJ/dV to zero, then dJ/dW.",
        "V = kv2 (dx cos(theta) + dy sin(theta))/dt; W = kw2 times the wrapped theta_d - theta, "
        "over dt.",
    ),
    tested_on="60 random poses and goals",
)
