"""Measurements of where the machine is: what alone can end the growth of its uncertainty.

A total station on a tripod follows a prism on the machine and gives x and y. A landmark of known
place is seen by the machine itself: range and bearing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array
from backhoe.localisation.drives import Recording
from backhoe.localisation.fusion.checks import deviations, not_negative
from backhoe.localisation.fusion.sampling import RATE, cycles

STATION_STD = 0.02
"""Of each coordinate [m]: ours, a total station that follows a moving prism."""

LANDMARK_STD = (0.1, 0.02)
"""Of range [m] and bearing [rad]: ours."""


@dataclass(frozen=True, eq=False)
class Fix:
    """A measurement `value` (..., 2) at `time` [s] with standard deviations `std` (2,).

    Without a `landmark` it is the position x, y [m, m]; with one, at x, y (2,) [m], the range [m]
    and bearing [rad] to it.

    Raises:
        ValueError: a wrong shape, a value that is not finite, a std that is not positive.
    """

    time: float
    value: NDArray
    std: NDArray
    landmark: NDArray | None = None

    def __post_init__(self) -> None:
        value = real_array(self.value, "value must be numbers")
        if value.shape[-1:] != (2,) or not np.isfinite(value).all():
            raise ValueError(f"value must end in 2 finite numbers, got {value!r}")
        object.__setattr__(self, "time", not_negative("time", self.time))
        object.__setattr__(self, "value", value)
        object.__setattr__(self, "std", deviations("std", self.std, 2))
        if self.landmark is not None:
            place = real_array(self.landmark, "landmark must be x, y [m]")
            if place.shape != (2,) or not np.isfinite(place).all():
                raise ValueError(f"landmark must be 2 finite numbers [m], got {place!r}")
            object.__setattr__(self, "landmark", place)


def total_station(
    recording: Recording,
    period: float,
    rng: np.random.Generator,
    *,
    start: float = 0.0,
    std: float = STATION_STD,
    rate: float = RATE,
) -> list[Fix]:
    """Positions of a drive as a total station would give them.

    Args:
        recording: the drive; its runs get noise of their own.
        period: between two fixes [s].
        rng: of the noise.
        start: time of the first one [s].
        std: of each coordinate [m].
        rate: of the filter's cycles [Hz]: the fixes fall on the nearest ones.

    Returns:
        The fixes in the order of their times.

    Raises:
        ValueError: a number out of range.
    """
    pair = np.full(2, std)
    shape = (*recording.left.shape[:-1], 2)
    fixes = []
    for time in _times(recording, period, start, rate):
        place = recording.truth_at(time)[:2]
        fixes.append(Fix(time, place + std * rng.standard_normal(shape), pair))
    return fixes


def landmarks(
    recording: Recording,
    points: ArrayLike,
    period: float,
    rng: np.random.Generator,
    *,
    start: float = 0.0,
    std: Sequence[float] = LANDMARK_STD,
    rate: float = RATE,
) -> list[Fix]:
    """Ranges and bearings to landmarks on a drive, to all of them each time.

    Args:
        recording: the drive; its runs get noise of their own.
        points: x, y of the landmarks, shape (n, 2) [m].
        period: between two looks [s].
        rng: of the noise.
        start: time of the first look [s].
        std: of range [m] and bearing [rad], shape (2,).
        rate: of the filter's cycles [Hz]: the fixes fall on the nearest ones.

    Returns:
        The fixes in the order of their times.

    Raises:
        ValueError: a number out of range, or points that are no (n, 2).
    """
    points, std = real_array(points, "points must be numbers [m]"), deviations("std", std, 2)
    if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
        raise ValueError(f"points must be finite, shape (n, 2) [m], got shape {points.shape}")
    shape = (*recording.left.shape[:-1], 2)
    fixes = []
    for time in _times(recording, period, start, rate):
        x, y, psi = recording.truth_at(time)
        for point in points:
            to_x, to_y = point - (x, y)
            seen = np.array([np.hypot(to_x, to_y), np.arctan2(to_y, to_x) - psi])
            fixes.append(Fix(time, seen + std * rng.standard_normal(shape), std, point))
    return fixes


def _times(recording: Recording, period: float, start: float, rate: float) -> NDArray:
    period, start = not_negative("period", period), not_negative("start", start)
    if period == 0:
        raise ValueError("period must be above 0 s, got 0")
    ends = recording.time[cycles(recording.time, rate)][1:]
    wanted = np.arange(max(start, ends[0]), ends[-1] + 1e-9, period)
    return ends[np.unique(np.abs(ends - wanted[:, None]).argmin(axis=1))]
