"""What the four metrics of a path cannot see of a run: how late it was, and what it cost."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from backhoe.vehicle.tracking.follow import Follow
from backhoe.vehicle.tracking.metrics import metrics

_LONGEST_LAG = 10.0


class Assessment(NamedTuple):
    """The metrics of a run, its time error and its effort.

    Attributes:
        d_mean, d_std, d_max, d_ratio: as in `Metrics` [m, m, m, 1].
        time_error_mean, time_error_max: distance to where the trajectory wanted the vehicle at
            that time [m]; NaN in path mode, which has no times.
        lag: the delay that explains the run best, `time_lag` [s]; NaN in path mode.
        effort_v, effort_omega: integrals of v^2 [m^2/s] and omega^2 [rad^2/s] as commanded.
        change_v, change_omega: sums of the steps |dv| [m/s] and |domega| [rad/s] of the command.
    """

    d_mean: float
    d_std: float
    d_max: float
    d_ratio: float
    time_error_mean: float
    time_error_max: float
    lag: float
    effort_v: float
    effort_omega: float
    change_v: float
    change_omega: float


def assess(follow: Follow) -> Assessment:
    """Metrics, time error and effort of a run.

    Args:
        follow: what `tracking.follow` returned.

    Returns:
        The Assessment; its time fields are NaN in path mode.
    """
    position, path = follow.pose[:, :2], follow.path
    late = np.full(2, np.nan)
    lag = np.nan
    if follow.mode == "trajectory":
        error = np.hypot(*(position - path.position(follow.time)).T)
        late = np.array([error.mean(), error.max()])
        lag = time_lag(follow)
    held = follow.command[:-1]
    effort = (held**2 * np.diff(follow.time)[:, None]).sum(axis=0)
    change = np.abs(np.diff(held, axis=0)).sum(axis=0)
    numbers = (*late, lag, *effort, *change)
    return Assessment(*metrics(position, path.points), *map(float, numbers))


def time_lag(follow: Follow) -> float:
    """How late the vehicle drove: the delay s of the trajectory that fits the run best.

    It makes the mean of |p(t) - p_ref(t - s)|^2 over the run least, within 10 s and half the run
    either way, to a thousandth of a second. Negative: the vehicle was early.

    Args:
        follow: a run in trajectory mode.

    Returns:
        The lag s [s].

    Raises:
        ValueError: the run's path has no times.
    """
    time, position = follow.time, follow.pose[:, :2]
    half = min(_LONGEST_LAG, time[-1] / 2)
    low, high, count, best = -half, half, 81, 0.0
    while high - low > 1e-4:
        delays = np.linspace(low, high, count)
        misses = [_miss(follow, position, time - delay) for delay in delays]
        best = delays[int(np.argmin(misses))]
        step = (high - low) / (count - 1)
        low, high, count = max(best - step, -half), min(best + step, half), 11
    return float(best)


def _miss(follow: Follow, position: NDArray, at: NDArray) -> float:
    return float(np.square(position - follow.path.position(at)).sum(axis=1).mean())
