"""How far off an estimate is: the root mean square error of signals of different rates.

Source: Mastalli 2013, Algorithm 2, corrected: errors start at infinity, every grid point counts
once, and differences of angles are wrapped. `backhoe.lessons.ekf.printed` has it as printed.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array
from backhoe.localisation.fusion.estimate import Estimate
from backhoe.localisation.kalman import wrap

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
        time: of the signal, increasing, shape (n,) [s].
        signal: the truth, shape (n, k).
        time_e: of the estimate, increasing, shape (m,) [s].
        estimate: shape (..., m, k).
        period: of the grid [s].
        angles: which of the k components are angles, wrapped [rad].

    Returns:
        Shape (..., k), in the signal's units.

    Raises:
        ValueError: shapes that do not fit, times that do not increase or do not overlap, values
            that are not finite, or a period that is not positive.
    """
    time, time_e = _increasing("time", time), _increasing("time_e", time_e)
    signal, estimate = _columns("signal", signal, time), _columns("estimate", estimate, time_e)
    if signal.shape[-1] != estimate.shape[-1] or signal.ndim != 2:
        raise ValueError(
            f"signal (n, k) and estimate (..., m, k) must have the same components, got shapes "
            f"{signal.shape} and {estimate.shape}"
        )
    if not np.isfinite(period) or period <= 0:
        raise ValueError(f"period must be a positive time [s], got {period!r}")
    first, last = max(time[0], time_e[0]), min(time[-1], time_e[-1])
    if last < first:
        raise ValueError("signal and estimate must overlap in time: check their clocks")
    grid = first + period * np.arange(int((last - first) / period + 1e-9) + 1)
    error = estimate[..., nearest(time_e, grid), :] - signal[nearest(time, grid)]
    for component in angles:
        error[..., component] = wrap(error[..., component])
    return np.sqrt(np.mean(error**2, axis=-2))


def nearest(time: NDArray, wanted: NDArray) -> NDArray:
    """Index of the sample nearest to each wanted time; of two as near, the earlier one.

    Args:
        time: increasing, shape (n,) [s].
        wanted: shape (k,) [s].

    Returns:
        Indices, shape (k,).
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
        odometry: RMSE, shape (...).
        filtered: RMSE of the filter, shape (...), same units.

    Returns:
        The two percentages, shape (...) each.

    Raises:
        ValueError: an error that is not positive, or shapes that differ.
    """
    odometry = real_array(odometry, "odometry must be numbers")
    filtered = real_array(filtered, "filtered must be numbers")
    if odometry.shape != filtered.shape:
        raise ValueError(f"both must have one shape, got {odometry.shape} and {filtered.shape}")
    for name, value in (("odometry", odometry), ("filtered", filtered)):
        if not (np.isfinite(value) & (value > 0)).all():
            raise ValueError(f"{name} must be positive errors, got {value}")
    return Improvement(100 * odometry / filtered, 100 * (1 - filtered / odometry))


def _increasing(name: str, time: ArrayLike) -> NDArray:
    time = real_array(time, f"{name} must be numbers [s]")
    if time.ndim != 1 or not len(time) or not (np.diff(time) > 0).all():
        raise ValueError(f"{name} must be increasing times, shape (n,), got shape {time.shape}")
    return time


def _columns(name: str, values: ArrayLike, time: NDArray) -> NDArray:
    values = real_array(values, f"{name} must be numbers")
    if values.ndim < 2 or values.shape[-2] != len(time):
        raise ValueError(
            f"{name} must have a row for each of its {len(time)} times, shape (..., n, k), got "
            f"shape {values.shape}"
        )
    if not np.isfinite(values).all():
        raise ValueError(f"{name} must be finite")
    return values
