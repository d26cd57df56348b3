"""Driving a plant along a path with a tracker, and the record of it.

Path mode (D'Angelo 2022, section 5.1): the goal is a way-point until the vehicle is within
`arrival` of it, then the next one; when is left to the tracker. Trajectory mode (section 6.1): the
goal moves along the trajectory with the mission's time, wherever the vehicle is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import ceil, hypot

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import choice, function, instance, numbers, positive
from backhoe.vehicle.tracking.goals import TrajectoryGoals, WaypointGoals
from backhoe.vehicle.tracking.limits import Limits
from backhoe.vehicle.tracking.metrics import Metrics, metrics
from backhoe.vehicle.tracking.path import Path
from backhoe.vehicle.tracking.protocol import Goal, Plant, Tracker

ARRIVAL = 0.2
"""A way-point is reached within this distance [m]: the source's value (section 5.4.1)."""


@dataclass(frozen=True, eq=False)
class Follow:
    """A run, one row for each sample of the plant and one for the end.

    Attributes:
        time: shape (n,), from 0 [s].
        pose: x, y, heading, shape (n, 3) [m, m, rad].
        twist: measured v, omega, shape (n, 2) [m/s, rad/s].
        command: v, omega given from that time on, after the limits; the last row repeats the
            one before it; shape (n, 2) [m/s, rad/s].
        goal: the goal's position, the same way, shape (n, 2) [m].
        path: the path that was to be followed.
        mode: "path" or "trajectory".
        reached: the vehicle came within `arrival` of the last way-point, in path mode after all
            the others; in trajectory mode it is there at the end.
        name: of the tracker.
    """

    time: NDArray
    pose: NDArray
    twist: NDArray
    command: NDArray
    goal: NDArray
    path: Path
    mode: str
    reached: bool
    name: str = "tracker"

    @cached_property
    def goal_distance(self) -> NDArray:
        """Distance to the goal, shape (n,) [m]: red in the source's Figs. 5.4 and 5.11-5.13."""
        return np.hypot(*(self.goal - self.pose[:, :2]).T)

    @cached_property
    def metrics(self) -> Metrics:
        """The four metrics of the run."""
        return metrics(self.pose[:, :2], self.path.points)


def follow(
    tracker: Tracker,
    plant: Plant,
    path: Path,
    *,
    mode: str = "path",
    arrival: float = ARRIVAL,
    time_limit: float | None = None,
    limits: Limits | None = None,
    speed: float = 0.5,
    period: float | None = None,
    name: str | None = None,
) -> Follow:
    """Drive `plant` along `path` with `tracker`, from where the plant is.

    The tracker's `reset()` is called first, if it has one; the plant is not reset.

    Args:
        tracker: v, omega = tracker(pose, twist, goal, dt); see `protocol.Tracker`.
        plant: what is driven; see `protocol.Plant`.
        path: where to, with times in trajectory mode.
        mode: "path" or "trajectory".
        arrival: a way-point is reached within this distance [m].
        time_limit: end of the run at the latest [s]. None: in path mode ten seconds and four
            times what the way takes at `speed`; in trajectory mode its last time.
        limits: cut what the tracker asks for to this, turning first; None: the plant's `limits`
            if it has any, else none.
        speed: what the goals say of the speed in path mode [m/s].
        period: sample time of the tracker, a whole multiple of plant.dt, its command held
            between [s]; None: the tracker's `period` if it has one, else plant.dt.
        name: of the tracker, for errors and tables; None: its `__name__` or its class's name.

    Returns:
        The record, a Follow.

    Raises:
        TypeError: tracker is not callable, plant lacks something, path is no Path.
        ValueError: an argument out of range, a path without times in trajectory mode, or a tracker
            that returns something else than two finite numbers; the message names the tracker.
    """
    function(tracker, "tracker", "tracker(pose, twist, goal, dt) -> v, omega")
    missing = [part for part in ("pose", "twist", "time", "dt", "step") if not hasattr(plant, part)]
    if missing:
        raise TypeError(f"plant must have {', '.join(missing)}, got {plant!r}")
    instance(path, "path", Path, "make one, such as from_points(points)")
    in_turn = choice(mode, "mode", ("path", "trajectory")) == "path"
    arrival, speed = positive(arrival, "arrival", "m"), positive(speed, "speed", "m/s")
    hold = _samples_held(plant.dt, getattr(tracker, "period", None) if period is None else period)
    period = hold * plant.dt
    longest = _patience(plant, path, speed) if in_turn else path.end_time
    if time_limit is not None:
        limit = positive(time_limit, "time_limit", "s")
        longest = limit if in_turn else min(limit, longest)
    samples = max(ceil(longest / period - 1e-9), 1)
    if in_turn:
        goals = WaypointGoals(path, arrival, speed, period)
    else:
        goals = TrajectoryGoals(path, period, samples)
    limits = getattr(plant, "limits", None) if limits is None else limits
    name = tracker_name(tracker) if name is None else name
    if hasattr(tracker, "reset"):
        tracker.reset()
    command = _checked(tracker, name, period, limits)
    log, arrived = _drive(command, plant, goals, samples, hold)
    time, pose, twist, commands, goal = np.split(np.array(log), (1, 4, 6, 8), axis=1)
    if not in_turn:
        arrived = hypot(*(pose[-1, :2] - path.points[-1])) <= arrival
    return Follow(time[:, 0], pose, twist, commands, goal, path, mode, bool(arrived), name)


def tracker_name(tracker: object) -> str:
    """What errors and tables call a tracker: its `__name__`, or the name of its class."""
    return getattr(tracker, "__name__", type(tracker).__name__)


def _drive(
    command: Callable, plant: Plant, goals: WaypointGoals | TrajectoryGoals, samples: int, hold: int
) -> tuple[list[tuple[float, ...]], bool]:
    """Rows of the log (time, pose, twist, command, goal), and whether the goals came to an end."""
    log, start = [], plant.time
    pose, twist = _state(plant)
    given, arrived = (0.0, 0.0, *pose[:2]), False
    for sample in range(samples):
        goal = goals.at(sample, pose[0], pose[1])
        if goal is None:
            arrived = True
            break
        speeds = command(pose, twist, goal, plant.time - start)
        given = (*speeds, *goal.position.tolist())
        for _ in range(hold):
            log.append((plant.time - start, *pose, *twist, *given))
            plant.step(*speeds)
            pose, twist = _state(plant)
    log.append((plant.time - start, *pose, *twist, *given))
    return log, arrived


def _checked(
    tracker: Tracker, name: str, period: float, limits: Limits | None
) -> Callable[[list[float], list[float], Goal, float], tuple[float, float]]:
    """The tracker with its answer checked and cut to the limits."""

    def command(
        pose: list[float], twist: list[float], goal: Goal, time: float
    ) -> tuple[float, float]:
        try:
            answer = tracker(np.array(pose), np.array(twist), goal, period)
        except Exception as error:
            error.add_note(f"raised by tracker {name!r} at t = {time:.2f} s")
            raise
        try:
            v, omega = numbers(answer, "speeds", (2,)).tolist()
        except ValueError as error:
            raise ValueError(
                f"tracker {name!r} must return v, omega: two finite numbers [m/s, rad/s]; "
                f"at t = {time:.2f} s it returned {answer!r}"
            ) from error
        return (v, omega) if limits is None else limits.apply(v, omega)

    return command


def _state(plant: Plant) -> tuple[list[float], list[float]]:
    pose = numbers(plant.pose, "the plant's pose", (3,), meaning="x, y, heading")
    return pose.tolist(), numbers(plant.twist, "the plant's twist", (2,)).tolist()


def _samples_held(dt: float, period: float | None) -> int:
    if period is None:
        return 1
    samples = positive(period, "period", "s") / dt
    if round(samples) < 1 or abs(samples - round(samples)) > 1e-6:
        raise ValueError(
            f"period must be a whole multiple of the plant's dt = {dt} s, got {period} s"
        )
    return round(samples)


def _patience(plant: Plant, path: Path, speed: float) -> float:
    approach = float(np.hypot(*(path.points[0] - np.asarray(plant.pose)[:2])))
    return 10.0 + 4.0 * (approach + path.length) / speed
