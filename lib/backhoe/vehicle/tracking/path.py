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

from backhoe.basics.inputs import real_array
from backhoe.vehicle.tracking import waypoint_file
from backhoe.vehicle.tracking.polyline import arc_length, points_array, subdivide


@dataclass(frozen=True, eq=False, repr=False)
class Path:
    """Way-points, and the times to be there if it is a trajectory.

    Args:
        points: x, y of each, shape (n, 2), n >= 2 [m]; copied.
        times: when to be at each, shape (n,), rising from 0 or later [s]; or None.

    Raises:
        ValueError: fewer than two points, all points the same, another shape, a value that is not
            a finite number, times that do not rise or that are negative.
    """

    points: NDArray
    times: NDArray | None = None

    def __post_init__(self) -> None:
        points = points_array(self.points, "a path's points").copy()
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
    def closed(self) -> bool:
        """Whether the last point is the first one again, to a millionth of the length."""
        gap = np.hypot(*(self.points[-1] - self.points[0]))
        return bool(gap <= 1e-6 * self.length)

    @property
    def duration(self) -> float:
        """Time from the first point to the last [s]; ValueError without times."""
        times = self._times()
        return float(times[-1] - times[0])

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
        times, t = self._times(), _finite(t, "t")
        x, y = self.points.T
        return np.stack([np.interp(t, times, x), np.interp(t, times, y)], axis=-1)

    def speed_at(self, t: ArrayLike) -> NDArray:
        """Speed of the trajectory at time t, shape of t [m/s]: 0 before it starts and after it.

        Raises:
            ValueError: the path has no times, or t is not finite numbers.
        """
        times, t = self._times(), _finite(t, "t")
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


def with_times(path: Path, speed: float) -> Path:
    """`path` as a trajectory driven at one speed [m/s]; see `Path.with_times`."""
    return path.with_times(speed)


def positive(value: float, name: str, unit: str) -> float:
    """`value` as a float; ValueError unless it is one finite number above 0."""
    number = real_array(value, f"{name} must be a number above 0 [{unit}]")
    if number.ndim or not np.isfinite(number) or number <= 0:
        raise ValueError(f"{name} must be one number above 0 [{unit}], got {value!r}")
    return float(number)


def _finite(values: ArrayLike, name: str) -> NDArray:
    array = real_array(values, f"{name} must be numbers")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, got {values!r}")
    return array


def _rising(times: ArrayLike, count: int) -> NDArray:
    times = real_array(times, "a path's times must be numbers [s]").copy()
    if times.shape != (count,):
        raise ValueError(f"times must be one for each of {count} points, got shape {times.shape}")
    if not np.isfinite(times).all():
        raise ValueError(f"times must be finite, got {times[~np.isfinite(times)][0]}")
    falls = np.flatnonzero(np.diff(times) <= 0)
    if len(falls):
        k = falls[0]
        raise ValueError(
            f"times must rise from point to point: point {k} at {times[k]} s is followed by "
            f"point {k + 1} at {times[k + 1]} s"
        )
    if times[0] < 0:
        raise ValueError(f"times must start at 0 or later, the first is {times[0]} s")
    times.setflags(write=False)
    return times
