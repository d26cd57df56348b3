"""Many extended Kalman filters at once, for Monte Carlo runs: one call moves them all.

The models are those of the single filter, written over leading axes; each filter has the numbers
that it would have alone.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_numbers
from backhoe.localisation.kalman.extended import ExtendedKalmanFilter, complain
from backhoe.localisation.kalman.sensing import Measurement, engine, over_leading_axes


class BatchExtendedKalmanFilter(ExtendedKalmanFilter):
    """N extended Kalman filters that take the same steps with their own data.

    Args:
        f, F, h, H, Q, R: as for `ExtendedKalmanFilter`, functions over leading axes: x (N, n) in,
            (N, n), (N, n, n), (N, m), (N, m, n) out; F, H and Q may also give one matrix for all.
        x0: states at the start, shape (N, n).
        P0: covariance of all, (n, n), or of each, (N, n, n).
        time, angles, measurement_angles: as for `ExtendedKalmanFilter`.

    Attributes:
        x, P, time: shapes (N, n), (N, n, n), [s]; new arrays in each step.
        x_prior, P_prior, F, innovation, S, K, nis: as for `ExtendedKalmanFilter`, with the leading
            axis N (F also without).

    Raises:
        ValueError: as for `ExtendedKalmanFilter`, or if a model does not work over leading axes; of
            a measurement it names the first run concerned.
    """

    _start = ("N", "n"), "the states of N runs"

    def _look(self, h: Measurement, x: NDArray) -> NDArray:
        seen = real_numbers(h(x), "h(x)")
        m = seen.shape[-1] if seen.ndim == 2 else 1
        return over_leading_axes(seen, (len(x), m), "h(x)")

    def _states(self, value: ArrayLike, shape: tuple[int, int], name: str) -> NDArray:
        return _rows(over_leading_axes(value, shape, name)).T

    def _matrices(self, value: ArrayLike, shape: tuple[int, int], name: str) -> NDArray:
        """One matrix for all, or with the leading axis N one for each."""
        value = np.require(real_numbers(value, name), float, ["C", "W", "A"])
        every = (len(self._x), *shape)
        if value.shape not in (shape, every):
            raise ValueError(f"{name} must have shape {every} or {shape}, got shape {value.shape}")
        return value

    def _propagated(self, x: NDArray, F: NDArray, Q: NDArray) -> tuple[NDArray, bool]:
        P = np.empty((self._n, self._n, len(x)))
        engine().propagate(*map(self._elements, (F, self._P, Q)), P)
        diagonal = P[np.arange(len(P)), np.arange(len(P))]
        possible = np.isfinite(x).all() and np.isfinite(P).all() and diagonal.min() >= 0
        return P.transpose(2, 0, 1), possible

    def _correct(self, z: ArrayLike, seen: NDArray, y: NDArray, H: NDArray, R: NDArray) -> None:
        before = _rows(self._x), self._elements(self._P)
        sensor = _rows(y), self._elements(H), self._elements(R)
        (m, N), n = sensor[0].shape, self._n
        x, P, nis = np.empty((n, N)), np.empty((n, n, N)), np.empty(N)
        S, K = np.empty((m, m, N)), np.empty((n, m, N))
        engine().correct(*before, *sensor, x, P, S, K, nis)
        possible = (nis >= 0) & (nis < np.inf)
        if not possible.all():
            run = int(np.argmin(possible))
            z = np.reshape(z, seen.shape)
            try:
                complain(z[run], seen[run], H[run] if H.ndim == 3 else H, S[..., run])
            except ValueError as error:
                raise ValueError(f"in run {run}: {error}") from None
        self._x, self._P, self.innovation, self.nis = x.T, P.transpose(2, 0, 1), y, nis
        self.S, self.K = S.transpose(2, 0, 1), K.transpose(2, 0, 1)

    def _elements(self, matrices: NDArray) -> NDArray:
        """(N, i, j) or (i, j) as (i, j, N), where each element is a row."""
        rows = matrices.transpose(1, 2, 0) if matrices.ndim == 3 else matrices[..., None]
        if rows.shape[-1] == len(self._x) and rows.flags.carray:
            return rows
        spread = np.empty((*rows.shape[:-1], len(self._x)))
        spread[...] = rows
        return spread


def _rows(vectors: NDArray) -> NDArray:
    """(N, n) as (n, N)."""
    return np.require(vectors.T, float, ["C", "W"])
