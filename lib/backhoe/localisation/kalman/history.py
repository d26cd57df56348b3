"""What a filter knew at each instant, kept for a smoother, a plot or a test of consistency."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import instance
from backhoe.localisation.kalman.extended import ExtendedKalmanFilter


class History:
    """Record of a filter that predicts with F: call `add` after each cycle.

    A cycle is one `predict` and the updates after it. The state at the making of the history is its
    first entry.

    Args:
        of: a KalmanFilter, ExtendedKalmanFilter or BatchExtendedKalmanFilter.

    Attributes:
        angles: components of the state that are angles, as the filter has them.

    Raises:
        TypeError: another kind of filter.
    """

    def __init__(self, of: ExtendedKalmanFilter) -> None:
        instance(of, "a history's filter", ExtendedKalmanFilter, "it must predict with F")
        self.angles, self._filter, self._seen = of.angles, of, of.predictions
        self._rows = {name: [] for name in ("time", "x", "P", "x_prior", "P_prior", "F")}
        self._keep("time", "x", "P")

    def add(self) -> None:
        """Keep the present state.

        Raises:
            ValueError: not exactly one prediction since the last time.
        """
        since = self._filter.predictions - self._seen
        if since != 1:
            raise ValueError(f"add after each prediction and its updates, got {since} predictions")
        self._seen += 1
        self._keep(*self._rows)

    def _keep(self, *names: str) -> None:
        for name in names:
            self._rows[name].append(getattr(self._filter, name))

    @property
    def time(self) -> NDArray:
        """Instants, shape (K+1,) [s]."""
        return np.array(self._rows["time"])

    @property
    def x(self) -> NDArray:
        """Estimates, shape (..., K+1, n), the leading axis N for a batch [own units]."""
        return np.stack(self._rows["x"], axis=-2)

    @property
    def P(self) -> NDArray:
        """Their covariances, shape (..., K+1, n, n)."""
        return np.stack(self._rows["P"], axis=-3)

    @property
    def x_prior(self) -> NDArray:
        """Predictions, shape (..., K, n)."""
        return np.stack(self._predicted("x_prior"), axis=-2)

    @property
    def P_prior(self) -> NDArray:
        """Their covariances, shape (..., K, n, n)."""
        return np.stack(self._predicted("P_prior"), axis=-3)

    @property
    def F(self) -> NDArray:
        """Jacobians of the predictions, shape (..., K, n, n)."""
        shape = self._rows["P"][0].shape
        return np.stack([np.broadcast_to(F, shape) for F in self._predicted("F")], axis=-3)

    def _predicted(self, name: str) -> list[NDArray]:
        if not self._rows[name]:
            raise ValueError("the history is empty: call add after each cycle")
        return self._rows[name]
