"""Sensors at 100 Hz, a filter at 30 Hz: what of the samples goes into one cycle.

Cycles do not fall on samples. Each ends with the newest sample that there is, so its length goes 3,
3, 4 samples; what a sensor turned since the last cycle is the sum of the samples in between. A
filter that takes the newest sample alone, and holds it, throws two thirds of what it was told away.

Source: Mastalli 2013, section 4.5 (100 Hz and 30 Hz; how they are joined it does not say).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, instance, positive, times
from backhoe.localisation.drives import Recording

CYCLE_RATE = 30.0
"""Cycles of the filter a second [Hz]: Mastalli 2013, section 4.5."""

USES = ("all", "latest")


@dataclass(frozen=True, eq=False)
class Increments:
    """What happened in each of K cycles.

    `time` (K+1,) of the cycles' ends, the start first [s]; `dt` (K,) [s]; `samples` (K,) how many;
    `left`, `right` (..., K) turn of the sprockets [rad]; `turn` (..., K) of the machine by the gyro
    [rad]; `yaw` (..., K) the newest absolute yaw [rad]; `use` "all" or "latest".
    """

    time: NDArray
    dt: NDArray
    samples: NDArray
    left: NDArray
    right: NDArray
    turn: NDArray
    yaw: NDArray
    use: str


def cycles(time: ArrayLike, rate: float = CYCLE_RATE) -> NDArray:
    """Index of the newest sample at each cycle.

    Args:
        time: of the samples, increasing, shape (n,) [s].
        rate: cycles a second [Hz]; at most that of the samples.

    Returns:
        Increasing indices, shape (K+1,), from 0.

    Raises:
        ValueError: time is no rising row of two numbers or more, or rate is not positive, or so
            high that a cycle would have no sample.
    """
    time, rate = times(time, "time"), positive(rate, "rate", "Hz")
    count = int((time[-1] - time[0]) * rate + 1e-6)
    ends = time[0] + np.arange(count + 1) / rate
    newest = np.searchsorted(time, ends + 1e-9, side="right") - 1
    if (np.diff(newest) < 1).any():
        raise ValueError(
            f"a rate of {rate:g} Hz is faster than the samples: some cycles would have none"
        )
    return newest


def increments(recording: Recording, rate: float = CYCLE_RATE, *, use: str = "all") -> Increments:
    """Sum the samples of a recording up, cycle by cycle.

    Args:
        recording: of one run or many.
        rate: cycles a second [Hz].
        use: "all" samples, each for the interval that ends with it, or the "latest" one of each
            cycle, held over it.

    Returns:
        The increments.

    Raises:
        ValueError: a rate out of range or an unknown use.
        TypeError: no recording.
    """
    choice(use, "use", USES)
    instance(recording, "recording", Recording, "drives.load or drives.record gives one")
    time, ends = recording.time, cycles(recording.time, rate)
    signals = np.stack([recording.left, recording.right, recording.gyro])
    dt = np.diff(time[ends])
    if use == "latest":
        turned = signals[..., ends[1:]] * dt
    else:
        last = ends[-1]
        parts = signals[..., 1 : last + 1] * np.diff(time[: last + 1])
        turned = np.add.reduceat(parts, ends[:-1], axis=-1)
    left, right, turn = turned
    return Increments(
        time=time[ends],
        dt=dt,
        samples=np.diff(ends),
        left=left,
        right=right,
        turn=turn,
        yaw=recording.yaw[..., ends[1:]],
        use=use,
    )
