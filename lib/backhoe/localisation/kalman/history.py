"""What a filter knew at each instant, kept for a smoother, a plot or a test of consistency."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.localisation.kalman.batch import BatchExtendedKalmanFilter
from backhoe.localisation.kalman.extended import ExtendedKalmanFilter


class History:
    """Record of a filter that predicts with F: call `add` after each cycle.

    A cycle is one `predict` and the updates after it. The state at the making of the history is its
    first entry.

    Args:
        of: a KalmanFilter, ExtendedKalmanFilter or BatchExtendedKalmanFilter.

    Attributes:
        time: shape (K+1,) [s].
        x, P: shapes (..., K+1, n), (..., K+1, n, n), the leading axis N for a batch.
        x_prior, P_prior, F: of the K predictions, shapes (..., K, n), (..., K, n, n) twice.

    Raises:
        ValueError: another kind of filter.
    """

    def __init__(self, of: ExtendedKalmanFilter | BatchExtendedKalmanFilter) -> None:
        if not isinstance(of, ExtendedKalmanFilter | BatchExtendedKalmanFilter):
            raise ValueError(
                "a history needs a filter that has F (Kalman, extended, batch), got "
                f"{type(of).__name__}"
            )
        self._filter, self._seen = of, of.predictions
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
        """Estimates, shape (..., K+1, n)."""
        return self._stacked("x", 1)

    @property
    def P(self) -> NDArray:
        """Their covariances, shape (..., K+1, n, n)."""
        return self._stacked("P", 2)

    @property
    def x_prior(self) -> NDArray:
        """Predictions, shape (..., K, n)."""
        return self._stacked("x_prior", 1)

    @property
    def P_prior(self) -> NDArray:
        """Their covariances, shape (..., K, n, n)."""
        return self._stacked("P_prior", 2)

    @property
    def F(self) -> NDArray:
        """Jacobians of the predictions, shape (..., K, n, n)."""
        return self._stacked("F", 2)

    def _stacked(self, name: str, inner: int) -> NDArray:
        if not self._rows[name]:
            raise ValueError("the history is empty: call add after each cycle")
        if name == "F":
            shape = np.shape(self._rows["P"][0])
            return np.stack([np.broadcast_to(F, shape) for F in self._rows["F"]], axis=-3)
        return np.stack(self._rows[name], axis=-1 - inner)
