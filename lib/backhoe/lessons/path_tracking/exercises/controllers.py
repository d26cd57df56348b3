"""Exercise 5.6: Scaglia's controller repaired, so that it is the least of its cost."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import wrap
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.path_tracking.printed import taylor_613


def scaglia(pose: ArrayLike, goal: ArrayLike, dt: float, kv2: float, kw2: float) -> NDArray:
    """V [m/s] and W [rad/s] at the least cost J_n (6.12), k_v^2 and k_w^2 of (6.14)."""
    x, y, theta = pose
    dx, dy = goal[0] - x, goal[1] - y
    theta_d = np.arctan2(dy, dx)
    turn = wrap(theta_d - theta)
    V = kv2 * (dx * np.cos(theta) + dy * np.sin(theta)) / dt
    return np.array([V, kw2 * turn / dt])


def _cases(rng: np.random.Generator) -> list[tuple]:
    low, high = (-3, -3, -7, -0.5, -0.5, 0.02, 0.2, 0.2), (3, 3, 7, 0.5, 0.5, 0.2, 0.95, 0.95)
    rows = rng.uniform(low, high, (60, 8))
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
    title="Repair (6.13)",
    reference=scaglia,
    oracle="the_least_of_the_cost",
    cases=_cases,
    mistakes={
        (
            "V is (6.13a) as printed, k_v^2 times the whole distance over dt: the least of J has "
            "theta_n, not theta_d"
        ): _printed(0),
        "that solves (9.13) as printed: the derivative of the square has lost its minus": (
            lambda pose, goal, dt, kv2, kw2: scaglia(pose, goal, dt, kv2 / (2 * kv2 - 1), kw2)
        ),
        "theta_d - theta is not wrapped: after a full turn the vehicle unwinds it again": (
            _printed(1)
        ),
        "V is (6.13a) as printed, and theta_d - theta is not wrapped": _printed(0, 1),
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
        "kv2 and kw2 are k_v^2 and k_w^2 already: do not square them again": (
            lambda pose, goal, dt, kv2, kw2: scaglia(pose, goal, dt, kv2**2, kw2**2)
        ),
        "the weights are swapped: kv2 belongs to V, kw2 to W": (
            lambda pose, goal, dt, kv2, kw2: scaglia(pose, goal, dt, kw2, kv2)
        ),
        "that is (9.11) with theta, the dead beat: the weights kv2 and kw2 are left out": (
            lambda pose, goal, dt, *gains: scaglia(pose, goal, dt, 1.0, 1.0)
        ),
        "W is in degrees per second: everything inside the course is in radians": (
            lambda *given: scaglia(*given) * (1, 180 / np.pi)
        ),
    },
    hints=(
        "J has V only in x_{n+1} = x_n + V cos(theta_n) T_0 and its fellows: set dJ/dV to zero.",
        "V = kv2 (dx cos(theta) + dy sin(theta))/dt; W = kw2 times the wrapped theta_d - theta, "
        "over dt.",
    ),
    tested_on="60 random poses and goals",
)
