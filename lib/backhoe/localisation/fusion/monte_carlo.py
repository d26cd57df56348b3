"""The same drive many times with noise of its own each time: does an estimator know its errors?

On average over runs, the error squared in its own standard deviations (NEES) of a pose is 3. Over
50 runs it lies between 2.36 and 3.72 in 95 % of all instants, if the estimator is consistent.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.angles import residual
from backhoe.basics.inputs import whole
from backhoe.localisation import kalman
from backhoe.localisation.drives import NOISE, SEED, Noise, Recording, record
from backhoe.localisation.fusion.estimate import Estimate
from backhoe.localisation.fusion.estimators import START_STD
from backhoe.localisation.fusion.scores import pose_rmse

RUNS = 50
"""Of a Monte Carlo trial: ours."""


@dataclass(frozen=True, eq=False)
class MonteCarlo:
    """An estimator on many runs of a drive; K cycles after the start.

    Attributes:
        recording, estimate: the drive and what the estimator said of it.
        time: shape (K,) [s].
        error: truth minus estimate, heading wrapped, shape (runs, K, 3) [m, m, rad].
        nees: of the pose, average over the runs, shape (K,); None without a covariance.
        band: where it lies in 95 % of the instants if the estimator is consistent.
        nis: of the heading's measurements, average over the runs, where there is one, shape (j,);
            None without.
        nis_band: the same of the NIS.
        rmse: of x, y, heading, each run's by Algorithm 2 corrected, then root mean square over the
            runs, shape (3,) [m, m, rad].
    """

    recording: Recording
    estimate: Estimate
    time: NDArray
    error: NDArray
    nees: NDArray | None
    band: tuple[float, float]
    nis: NDArray | None
    nis_band: tuple[float, float]
    rmse: NDArray

    @property
    def mean_nees(self) -> float:
        """Average over runs and time; 3 for a consistent estimator."""
        return float(np.mean(self._claimed()))

    @property
    def inside(self) -> float:
        """Share of the instants in which the average NEES is in its band."""
        return kalman.share_inside(self._claimed(), self.band)

    @property
    def sigma_xy(self) -> NDArray:
        """Standard deviation of the position by the estimator, average over runs, (K,) [m]."""
        return self.estimate.sigma_xy[:, 1:].mean(axis=0)

    @property
    def scatter_xy(self) -> NDArray:
        """The same as it was: root mean square of the position's error over runs, (K,) [m]."""
        return np.sqrt(np.mean(self.error[..., 0] ** 2 + self.error[..., 1] ** 2, axis=0))

    def _claimed(self) -> NDArray:
        if self.nees is None:
            raise ValueError(f"{self.estimate.name} says nothing of its errors: it has no NEES")
        return self.nees


def starts(recording: Recording, seed: int = SEED) -> NDArray:
    """Poses at which the runs believe to start: the truth with `START_STD`, shape (runs, 3)
    [m, m, rad]."""
    runs = len(recording.left)
    noise = np.random.default_rng([seed, 2]).standard_normal((runs, 3))
    return recording.truth[0] + noise * START_STD


def monte_carlo(
    name: str,
    estimator: Callable[..., Estimate],
    *,
    runs: int = RUNS,
    turning: float = 1.0,
    seed: int = SEED,
    noise: Noise = NOISE,
    fixes: Callable | None = None,
    **options: object,
) -> MonteCarlo:
    """Run an estimator on many recordings of a scenario, all at once.

    Args:
        name: one of drives.SCENARIOS.
        estimator: `pose_filter`, `dead_reckoning`, or your own:
            estimator(recording, start=poses, **options) -> Estimate.
        runs: how many, at least 2.
        turning: share of the ideal turn rate that the tracks give.
        seed: of the noise and of the errors at the start.
        noise: of the sensors.
        fixes: function of the recording and a random generator that gives fixes, such as
            lambda recording, rng: total_station(recording, 10.0, rng); None for none.
        options: further arguments of the estimator.

    Returns:
        Errors, NEES and NIS with their bands, RMSE.

    Raises:
        ValueError: as `drives.record` and the estimator raise, or fewer than 2 runs.
    """
    runs = whole(runs, "runs", least=2)
    recording = record(name, turning=turning, runs=runs, seed=seed, noise=noise)
    if fixes is not None:
        options["fixes"] = fixes(recording, np.random.default_rng([seed, 3]))
    estimate = estimator(recording, start=starts(recording, seed), **options)
    error = residual(recording.truth_at(estimate.time[1:]), estimate.pose[:, 1:], (2,))
    covariance = estimate.covariance
    nees = None if covariance is None else kalman.nees(error, covariance[:, 1:]).mean(axis=0)
    nis = estimate.nis
    if nis is not None:
        nis = nis[:, ~np.isnan(nis[0])].mean(axis=0)
    return MonteCarlo(
        recording=recording,
        estimate=estimate,
        time=estimate.time[1:],
        error=error,
        nees=nees,
        band=kalman.chi_square_band(3, runs),
        nis=nis,
        nis_band=kalman.chi_square_band(1, runs),
        rmse=np.sqrt(np.mean(pose_rmse(recording, estimate) ** 2, axis=0)),
    )
