"""How far off an estimate is: the root mean square error of signals of different rates.

Source: Mastalli 2013, Algorithm 2, corrected: errors start at infinity, every grid point counts
once, and differences of angles are wrapped. `backhoe.lessons.ekf.printed` has it as printed.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import residual
from backhoe.basics.inputs import alike, numbers, positive, times
from backhoe.localisation.fusion.estimate import Estimate

PERIOD = 0.05
"""Of the grid on which signals are compared [s]: ours, the rate of the truth in the files."""


class Improvement(NamedTuple):
    """`ratio_percent` as the source prints it, 100 odometry/filter; `reduction_percent` the share
    of the odometry's error that is gone, 100 (1 - filter/odometry)."""

    ratio_percent: NDArray
    reduction_percent: NDArray


def rmse(
    time: ArrayLike,
    signal: ArrayLike,
    time_e: ArrayLike,
    estimate: ArrayLike,
    *,
    period: float = PERIOD,
    angles: Sequence[int] = (),
) -> NDArray:
    """Root mean square error of signals with different sampling times.

    Both are read on a common grid of times, each at its own sample nearest to the grid's.

    Source: Mastalli 2013, Algorithm 2, corrected.

    Args:
        time: of the signal, rising, shape (n,) [s].
        signal: the truth, shape (n, k) [own units].
        time_e: of the estimate, rising, shape (m,) [s].
        estimate: shape (..., m, k), in the signal's units.
        period: of the grid [s].
        angles: which of the k components are angles, wrapped [rad].

    Returns:
        Shape (..., k), in the signal's units.

    Raises:
        ValueError: shapes that do not fit, times that do not rise or do not overlap, values
            that are not finite, or a period that is not positive.
    """
    time, time_e = times(time, "time", least=1), times(time_e, "time_e", least=1)
    signal = numbers(signal, "signal", (len(time), "k"))
    estimate = numbers(estimate, "estimate", (..., len(time_e), signal.shape[1]))
    period = positive(period, "period", "s")
    first, last = max(time[0], time_e[0]), min(time[-1], time_e[-1])
    if last < first:
        raise ValueError("signal and estimate must overlap in time: check their clocks")
    grid = first + period * np.arange(int((last - first) / period + 1e-9) + 1)
    at_e, at = nearest(time_e, grid), nearest(time, grid)
    error = residual(estimate[..., at_e, :], signal[at], angles)
    return np.sqrt(np.mean(error**2, axis=-2))


def nearest(time: NDArray, wanted: NDArray) -> NDArray:
    """Indices (k,) of the samples nearest to wanted times (k,); of two as near, the earlier.

    Args:
        time: rising, shape (n,) [s].
        wanted: shape (k,) [s].
    """
    after = np.clip(np.searchsorted(time, wanted), 1, max(len(time) - 1, 1))
    if len(time) == 1:
        return np.zeros(len(wanted), dtype=int)
    return np.where(wanted - time[after - 1] <= time[after] - wanted + 1e-12, after - 1, after)


def pose_rmse(recording: object, estimate: Estimate, period: float = PERIOD) -> NDArray:
    """RMSE of x, y and heading against a recording's truth, shape (..., 3) [m, m, rad].

    Args:
        recording: a `drives.Recording`.
        estimate: of the same drive.
        period: of the grid [s].
    """
    return rmse(
        recording.truth_time,
        recording.truth,
        estimate.time,
        estimate.pose,
        period=period,
        angles=(2,),
    )


def improvement(odometry: ArrayLike, filtered: ArrayLike) -> Improvement:
    """What a filter gains over odometry, as printed and as a reduction.

    Source: Mastalli 2013, Tables 4.1 to 4.3.

    Args:
        odometry: RMSE, shape (...) [own unit].
        filtered: RMSE of the filter, shape (...) [same].

    Returns:
        The two percentages, shape (...) each.

    Raises:
        ValueError: an error that is not positive, or shapes that differ.
    """
    odometry, filtered = numbers(odometry, "odometry"), numbers(filtered, "filtered")
    alike(odometry=odometry, filtered=filtered)
    for name, value in (("odometry", odometry), ("filtered", filtered)):
        if (value <= 0).any():
            raise ValueError(f"{name} must be errors above 0, got {value}")
    return Improvement(100 * odometry / filtered, 100 * (1 - filtered / odometry))
