"""Measurements of where the machine is: what alone can end the growth of its uncertainty.

A total station on a tripod follows a prism on the machine and gives x and y.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import generator, not_negative, numbers, positive
from backhoe.localisation.drives import Recording
from backhoe.localisation.fusion.cycle import CYCLE_RATE, cycles

STATION_STD = 0.02
"""Of each coordinate [m]: ours, a total station that follows a moving prism."""


@dataclass(frozen=True, eq=False)
class Fix:
    """A measured position `value` (..., 2) [m] at `time` [s], of standard deviation `std` [m].

    Raises:
        ValueError: a wrong shape, a value that is not finite, a std that is not positive.
    """

    time: float
    value: NDArray
    std: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "time", not_negative(self.time, "time", "s"))
        object.__setattr__(self, "value", numbers(self.value, "value", (..., 2)))
        object.__setattr__(self, "std", positive(self.std, "std", "m"))


def total_station(
    recording: Recording,
    period: float,
    rng: np.random.Generator,
    *,
    start: float = 0.0,
    std: float = STATION_STD,
    rate: float = CYCLE_RATE,
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
    period, start = positive(period, "period", "s"), not_negative(start, "start", "s")
    rng, std = generator(rng), positive(std, "std", "m")
    ends = recording.time[cycles(recording.time, rate)][1:]
    wanted = np.arange(max(start, ends[0]), ends[-1] + 1e-9, period)
    shape = (*recording.left.shape[:-1], 2)
    fixes = []
    for time in ends[np.unique(np.abs(ends - wanted[:, None]).argmin(axis=1))]:
        place = recording.truth_at(time)[:2] + std * rng.standard_normal(shape)
        fixes.append(Fix(time, place, std))
    return fixes
