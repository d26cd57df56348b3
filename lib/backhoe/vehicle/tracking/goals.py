"""Which goal a tracker gets: the way-points one by one, or the trajectory at its time."""

from __future__ import annotations

from math import hypot

import numpy as np

from backhoe.vehicle.tracking.path import Path
from backhoe.vehicle.tracking.protocol import Goal


class WaypointGoals:
    """Path mode: a way-point until the vehicle is near it, then the next.

    Args:
        path: the way-points.
        arrival: how near is near [m].
        speed: what the goal says of the speed [m/s].
        period: sample time of the tracker [s].
    """

    def __init__(self, path: Path, arrival: float, speed: float, period: float) -> None:
        self._places = [tuple(point) for point in path.points.tolist()]
        self._arrival, self._period = arrival, period
        self._goal = Goal(path.points[0], path.points[1], speed, path.points, period, 0)

    def at(self, sample: int, x: float, y: float) -> Goal | None:
        """The goal for the sample number `sample` that starts at (x, y) [m]; None at the end."""
        number = self._goal.waypoint
        while hypot(self._places[number][0] - x, self._places[number][1] - y) <= self._arrival:
            number += 1
            if number == len(self._places):
                return None
        time = (sample + 1) * self._period
        if number == self._goal.waypoint:
            self._goal = self._goal._replace(time=time)
        else:
            points = self._goal.path
            following = points[min(number + 1, len(points) - 1)]
            self._goal = Goal(points[number], following, self._goal.speed, points, time, number)
        return self._goal


class TrajectoryGoals:
    """Trajectory mode: where the trajectory is at the end of the sample.

    Args:
        path: a path with times.
        period: sample time of the tracker [s].
        samples: how many goals will be asked for.

    Raises:
        ValueError: the path has no times.
    """

    def __init__(self, path: Path, period: float, samples: int) -> None:
        times = np.arange(1, samples + 2) * period
        self._points = path.points
        self._places = path.position(times)
        self._speeds = path.speed_at(times - period / 2).tolist()
        self._places.setflags(write=False)
        self._times = times.tolist()

    def at(self, sample: int, x: float, y: float) -> Goal:
        """The goal for the sample number `sample`, wherever the vehicle is."""
        places = self._places
        speed, time = self._speeds[sample], self._times[sample]
        return Goal(places[sample], places[sample + 1], speed, self._points, time)
