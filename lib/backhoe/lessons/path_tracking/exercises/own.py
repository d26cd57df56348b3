"""Exercise 5.8: a tracker of one's own, judged by how it drives."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import wrap
from backhoe.lessons.exercise import Exercise
from backhoe.vehicle import tracking

NEAR_ENOUGH = 0.15
"""Largest mean distance to the goal that counts as tracking [m]."""

Tracker = Callable[[NDArray, NDArray, tracking.Goal, float], ArrayLike]


def own_tracker(wrap: Callable[[float], float] = wrap) -> Tracker:
    """Speed in proportion to how far ahead the goal is, turn to its bearing, cut when far aside."""

    def tracker(
        pose: ArrayLike, twist: ArrayLike, goal: tracking.Goal, dt: float
    ) -> tuple[float, float]:
        dx, dy = goal.position - pose[:2]
        angle = wrap(np.arctan2(dy, dx) - pose[2])
        return 4.0 * np.hypot(dx, dy) * max(np.cos(angle), 0.0), 4.0 * angle

    return tracker


_X = np.linspace(0.0, 6.0, 61)
_PATHS = {
    "bends": tracking.from_points(np.column_stack((_X, np.sin(_X)))).with_times(0.4),
    "circle": tracking.circle(1.0, centre=(0.0, 1.0), start_angle=-np.pi / 2).with_times(0.4),
}
_PATHS["circle to the right"] = tracking.Path(
    _PATHS["circle"].points * (1, -1), _PATHS["circle"].times
)


def _drive(tracker: Tracker, name: str) -> tracking.Follow:
    plant = tracking.IdealPlant(0.05)
    return tracking.follow(tracker, plant, _PATHS[name], mode="trajectory", name="my_tracker()")


def distance_to_goal(tracker: Tracker, name: str) -> float:
    """Mean distance to the goal over a run on the ideal plant, the first 3 s left out [m]."""
    run = _drive(tracker, name)
    return float(np.mean(run.goal_distance[run.time > 3.0]))


def _worst(tracker: Tracker) -> float:
    return max(distance_to_goal(tracker, name) for name in _PATHS)


def _altered(tracker: Tracker, change: NDArray) -> Tracker:
    return lambda *now: change @ np.array(tracker(*now), dtype=float)


_MENDS = {
    "it turns away from the goal: with the other sign of omega it would follow": np.diag((1, -1)),
    "its turns are far too wild: is omega in degrees per second?": np.diag((1, np.pi / 180)),
    "it drives away from the goal: with the other sign of v it would follow": np.diag((-1, 1)),
    "it returns omega first: the order is v, omega": np.eye(2)[::-1],
}
"""What a command is to be multiplied by so that the tracker follows."""

_UNWRAPPED, _STILL, _STRAIGHT, _ONE_WAY, _LATE = (
    "it follows bends but not a circle, where the heading passes pi: take np.arctan2, and wrap the "
    "angle to the goal",
    "it does not drive at all: v stays at zero",
    "it never turns: omega grows with the angle to the goal",
    "it turns to one side only: omega has the sign of the angle to the goal",
    "it keeps to the line but not to the time: let v grow with the distance to the goal",
)


def judged(answer: Tracker, reference: Tracker) -> bool | str:
    """Drive the two trajectories with the tracker and say how it went."""
    if not callable(answer):
        return "my_tracker() must return a function of (pose, twist, goal, dt)"
    far = {name: distance_to_goal(answer, name) for name in _PATHS}
    if max(far.values()) <= NEAR_ENOUGH:
        return True
    for diagnosis, mend in _MENDS.items():
        if _worst(_altered(answer, mend)) <= NEAR_ENOUGH:
            return diagnosis
    if far["bends"] <= NEAR_ENOUGH:
        return _UNWRAPPED
    run = _drive(answer, "bends")
    if np.ptp(run.pose[:, :2], axis=0).max() < 0.05:
        return _STILL
    turns = run.command[:-1, 1]
    if not turns.any():
        return _STRAIGHT
    if min(turns) >= 0 or max(turns) <= 0:
        return _ONE_WAY
    if run.metrics.d_mean <= 0.1:
        return _LATE
    worst = max(far.values())
    return f"it is {worst:.2g} m from its goal on average: {NEAR_ENOUGH} m or less is asked"


OWN = Exercise(
    number="5.8",
    title="A tracker of your own",
    reference=own_tracker,
    oracle="it_trails_by_the_rate_over_the_gain",
    cases=lambda rng: [()],
    compare=judged,
    mistakes={
        **{
            diagnosis: lambda mend=mend: _altered(own_tracker(), np.linalg.inv(mend))
            for diagnosis, mend in _MENDS.items()
        },
        _UNWRAPPED: lambda: own_tracker(wrap=float),
        _STILL: lambda: lambda pose, twist, goal, dt: (0.0, 0.0),
        _STRAIGHT: lambda: lambda pose, twist, goal, dt: (goal.speed, 0.0),
        _ONE_WAY: lambda: lambda *now: np.abs(own_tracker()(*now)),
        _LATE: lambda: lambda *now: np.array(own_tracker()(*now)) * (0.4, 1.0),
    },
    hints=(
        "The bearing of the goal from the vehicle is atan2(dy, dx) - theta, wrapped; the distance "
        "is hypot(dx, dy).",
        "Four lines do: v grows with the distance and with the cosine of the bearing, omega with "
        "the bearing.",
    ),
    tested_on="bends, a circle and one the other way round, as trajectories on the ideal plant",
    timeout=20.0,
)
