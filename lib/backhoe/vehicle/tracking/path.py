"""Paths and trajectories: way-points in the plane, with or without the times to be there.

A path says where to drive; a trajectory also says when (D'Angelo 2022, section 6.1). Both are a
`Path`: the polyline through its points, in metres and seconds. `waypoint_file` reads and writes
them as text.
"""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive, times
from backhoe.vehicle.tracking import waypoint_file
from backhoe.vehicle.tracking.polyline import arc_length, points_array, subdivide


@dataclass(frozen=True, eq=False, repr=False)
class Path:
    """Way-points, and the times to be there if it is a trajectory.

    Args:
        points: x, y of each, shape (n, 2), n >= 2 [m]; copied.
        times: when to be at each, shape (n,), rising from 0 or later [s]; or None; copied.

    Raises:
        ValueError: fewer than two points, all points the same, another shape, a value that is not
            a finite number, times that do not rise or that are negative.
    """

    points: NDArray
    times: NDArray | None = None

    def __post_init__(self) -> None:
        points = points_array(self.points, "points").copy()
        if not np.ptp(points, axis=0).any():
            raise ValueError(
                f"a path must go somewhere: all its {len(points)} points are {points[0].tolist()}"
            )
        points.setflags(write=False)
        object.__setattr__(self, "points", points)
        if self.times is not None:
            object.__setattr__(self, "times", _rising(self.times, len(points)))

    def __repr__(self) -> str:
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        when = "" if self.times is None else f", {self.times[0]:.2f} to {self.times[-1]:.2f} s"
        return (
            f"Path({len(self.points)} points, {self.length:.3f} m, x {low[0]:.2f} to {high[0]:.2f},"
            f" y {low[1]:.2f} to {high[1]:.2f} m{when})"
        )

    @property
    def arc(self) -> NDArray:
        """Way along the path to each point, shape (n,) [m]."""
        return arc_length(self.points)

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        return float(self.arc[-1])

    @property
    def end_time(self) -> float:
        """When to be at the last point [s]; ValueError without times."""
        return float(self._times()[-1])

    def with_times(self, speed: float) -> Path:
        """The same points as a trajectory driven at one speed [m/s] from time 0.

        Raises:
            ValueError: speed is not a positive number, or two points in a row are the same.
        """
        speed = positive(speed, "speed", "m/s")
        arc = self.arc
        same = np.flatnonzero(np.diff(arc) <= 0)
        if len(same):
            raise ValueError(
                f"points {same[0]} and {same[0] + 1} are the same, {self.points[same[0]].tolist()}:"
                " at a constant speed they would have the same time; take one of them out"
            )
        return Path(self.points, arc / speed)

    def resample(self, spacing: float) -> Path:
        """The path with points added on its segments, `spacing` [m] apart or closer.

        Every point stays, so the shape does; times, if any, are interpolated as in (6.1).

        Raises:
            ValueError: spacing is not a positive number.
        """
        spacing = positive(spacing, "spacing", "m")
        if self.times is None:
            return Path(subdivide(self.points, spacing))
        points, arc = subdivide(self.points, spacing), self.arc
        if (np.diff(arc) <= 0).any():
            raise ValueError("resample cannot add points to a trajectory that stops and waits")
        times = np.interp(arc_length(points), arc, self.times)
        return Path(points, times)

    def position(self, t: ArrayLike) -> NDArray:
        """Where to be at time t: linear between the points, held before the first and after the
        last (D'Angelo 2022, section 6.1 and Fig. 6.1).

        Args:
            t: times, shape (...) [s].

        Returns:
            Shape (..., 2) [m].

        Raises:
            ValueError: the path has no times, or t is not finite numbers.
        """
        times, t = self._times(), numbers(t, "t")
        x, y = self.points.T
        return np.stack([np.interp(t, times, x), np.interp(t, times, y)], axis=-1)

    def speed_at(self, t: ArrayLike) -> NDArray:
        """Speed of the trajectory at time t: 0 before it starts and after it.

        Args:
            t: times, shape (...) [s].

        Returns:
            Shape (...) [m/s].

        Raises:
            ValueError: the path has no times, or t is not finite numbers.
        """
        times, t = self._times(), numbers(t, "t")
        speeds = np.concatenate([[0.0], np.diff(self.arc) / np.diff(times), [0.0]])
        return speeds[np.searchsorted(times, t, side="right")]

    @classmethod
    def read(cls, file: str | PathLike) -> Path:
        """A path from a CSV file of way-points; see `waypoint_file.read`."""
        return cls(*waypoint_file.read(file))

    def write(self, file: str | PathLike) -> None:
        """Write the path as a CSV file that `Path.read` gives back to the last digit."""
        waypoint_file.write(file, self.points, self.times)

    def _times(self) -> NDArray:
        if self.times is None:
            raise ValueError("this path has no times: use path.with_times(speed) for a trajectory")
        return self.times


def _rising(given: ArrayLike, count: int) -> NDArray:
    given = times(given, "times").copy()
    if len(given) != count:
        raise ValueError(f"times must be one for each of {count} points, got {len(given)}")
    if given[0] < 0:
        raise ValueError(f"times must start at 0 or later, the first is {given[0]} s")
    given.setflags(write=False)
    return given
