"""What an estimator says of a drive."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backhoe.localisation.fusion.cycle import Increments


@dataclass(frozen=True, eq=False)
class Estimate:
    """An estimate over time, of one run, or of many with a leading axis.

    Attributes:
        name: of the estimator.
        time: shape (K+1,) [s].
        pose: x, y, heading, shape (..., K+1, 3) [m, m, rad]; the heading is not wrapped.
        covariance: what the estimator says of the pose's error, shape (..., K+1, 3, 3); None if it
            says nothing.
        state, std: whole state and its standard deviations, shape (..., K+1, n); None without.
        nis: of the heading's measurement in each cycle, one degree of freedom, shape (..., K);
            None without.
    """

    name: str
    time: NDArray
    pose: NDArray
    covariance: NDArray | None = None
    state: NDArray | None = None
    std: NDArray | None = None
    nis: NDArray | None = None

    @property
    def sigma_xy(self) -> NDArray:
        """Standard deviation of the position, sqrt(var x + var y), shape (..., K+1) [m].

        Raises:
            ValueError: the estimator says nothing of its errors.
        """
        if self.covariance is None:
            raise ValueError(f"{self.name} says nothing of its errors: it has no covariance")
        return np.sqrt(self.covariance[..., 0, 0] + self.covariance[..., 1, 1])


class Log:
    """Collects a batch filter's state cycle by cycle, preallocated: (runs, K+1, ...)."""

    def __init__(self, x: NDArray, P: NDArray, steps: Increments, pose: list[int]) -> None:
        cycles, (runs, n) = len(steps.dt), x.shape
        self._pose, self._at = pose, 0
        self.state = np.empty((cycles + 1, runs, n))
        self.std = np.empty((cycles + 1, runs, n))
        self.covariance = np.empty((cycles + 1, runs, 3, 3))
        self.nis = np.full((cycles, runs), np.nan)
        self._keep(x, P)

    def add(self, x: NDArray, P: NDArray, nis: NDArray | None) -> None:
        """One cycle: state (runs, n), covariance (runs, n, n), NIS (runs,) or None."""
        if nis is not None:
            self.nis[self._at - 1] = nis
        self._keep(x, P)

    def _keep(self, x: NDArray, P: NDArray) -> None:
        self.state[self._at] = x
        self.std[self._at] = np.sqrt(np.einsum("rii->ri", P))
        self.covariance[self._at] = P[:, self._pose][:, :, self._pose]
        self._at += 1

    def estimate(self, name: str, time: NDArray, single: bool) -> Estimate:
        """All of it; `single` drops the axis of the runs."""
        state, std, covariance, nis = (
            np.moveaxis(values, 1, 0)
            for values in (self.state, self.std, self.covariance, self.nis)
        )
        if np.isnan(nis).all():
            nis = None
        if single:
            state, std, covariance = state[0], std[0], covariance[0]
            nis = None if nis is None else nis[0]
        return Estimate(name, time, state[..., self._pose], covariance, state, std, nis)
