"""Many extended Kalman filters at once, for Monte Carlo runs: one call moves them all.

The models are those of the single filter, written over leading axes; each filter has the numbers
that it would have alone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array
from backhoe.localisation.kalman.arguments import covariance, duration, finite
from backhoe.localisation.kalman.compiled import lanes
from backhoe.localisation.kalman.extended import Motion, _complain, _complain_of_sensor
from backhoe.localisation.kalman.sensing import Filter, Measurement, innovation, noise
from backhoe.localisation.kalman.unscented import over_leading_axes


class BatchExtendedKalmanFilter(Filter):
    """N extended Kalman filters that take the same steps with their own data.

    Args:
        f, F, h, H, Q, R: as for `ExtendedKalmanFilter`, functions over leading axes: x (N, n) in,
            (N, n), (N, n, n), (N, m), (N, m, n) out; F, H and Q may also give one matrix for all.
            F and H must be functions or arrays.
        x0: states at the start, shape (N, n).
        P0: covariance of all, (n, n), or of each, (N, n, n).
        time, angles, measurement_angles: as for `ExtendedKalmanFilter`.

    Attributes:
        x, P, time: shapes (N, n), (N, n, n), [s]; new arrays in each step.
        x_prior, P_prior, F, innovation, S, K, nis: as for `ExtendedKalmanFilter`, with the leading
            axis N (F also without).

    Raises:
        ValueError: as for `ExtendedKalmanFilter`, or if a model does not work over leading axes.
    """

    def __init__(
        self,
        f: Motion,
        F: Motion | ArrayLike,
        h: Measurement | None,
        H: Measurement | ArrayLike | None,
        Q: Motion | ArrayLike,
        R: ArrayLike | None,
        x0: ArrayLike,
        P0: ArrayLike,
        *,
        time: float = 0.0,
        angles: Sequence[int] = (),
        measurement_angles: Sequence[int] = (),
    ) -> None:
        x0 = np.array(real_array(x0, "x0 must be numbers"), order="C")
        if x0.ndim != 2 or x0.size == 0:
            raise ValueError(f"x0 must be the states of N runs, shape (N, n), got {x0.shape}")
        super().__init__(x0[0], time, angles, (None, None, None), ())
        self._runs, self._n = x0.shape
        self._x = finite(x0, x0.shape, "x0")
        self._own = self._own_sensor(h, H, R, measurement_angles)
        if F is None:
            raise ValueError(
                "F must be a function or an array: a batch takes no derivatives itself"
            )
        self._f, self._F = f, F
        self._Q = Q if callable(Q) else covariance(Q, self._n, "Q")[None]
        self._Q_checked = not callable(Q)
        P0 = covariance(P0, self._n, "P0", runs=self._runs)
        self._P = np.array(np.broadcast_to(P0, (self._runs, self._n, self._n)))
        self.x_prior, self.P_prior, self.F = self._x, self._P, np.eye(self._n)
        self.innovation = self.S = self.K = self.nis = None
        self.predictions = 0

    @property
    def P(self) -> NDArray:
        """Covariances of the estimates' errors, shape (N, n, n)."""
        return self._P

    @P.setter
    def P(self, value: ArrayLike) -> None:
        value = covariance(value, self._n, "P", runs=self._runs)
        self._P = np.array(np.broadcast_to(value, self._P.shape))

    def predict(self, u: ArrayLike, dt: float) -> None:
        """Move all estimates on by dt.

        Args:
            u: input as f, F and Q take it, shape (N, k) or (k,) [their units]; None if none.
            dt: positive, the same for all [s].

        Raises:
            ValueError: as for `ExtendedKalmanFilter`.
        """
        dt, x, n = duration(dt), self._x, self._n
        F = self._matrices(self._F(x, u, dt) if callable(self._F) else self._F, n, "F(x, u, dt)")
        Q = self._Q
        if callable(Q):
            Q = self._matrices(Q(x, u, dt), n, "Q(x, u, dt)")
            if not self._Q_checked:
                covariance(Q, n, "Q(x, u, dt)", runs=len(Q))
                self._Q_checked = True
        moved = over_leading_axes(self._f(x.copy(order="K"), u, dt), x.shape, "f(x, u, dt)")
        rows = self._rows(self._P)
        P = np.empty_like(rows)
        lanes().propagate(self._rows(F), rows, self._rows(Q), P)
        if not (np.isfinite(moved).all() and np.isfinite(P).all() and _diagonal(P).min() >= 0):
            _complain(moved, F, Q)
        self._x, self._P = _rows(moved).T, P.transpose(2, 0, 1)
        self.x_prior, self.P_prior, self.F = self._x, self._P, F if len(F) > 1 else F[0]
        self.time += dt
        self.predictions += 1

    def update(
        self,
        z: ArrayLike,
        h: Measurement | None = None,
        H: Measurement | ArrayLike | None = None,
        R: ArrayLike | None = None,
        *,
        angles: Sequence[int] | None = None,
        time: float | None = None,
    ) -> None:
        """Correct all estimates by their measurements.

        Args:
            z: measurements, shape (N, m).
            h, H, R, angles, time: as for `ExtendedKalmanFilter`; R one matrix for all.

        Raises:
            ValueError: as for `ExtendedKalmanFilter`; it names the first run concerned.
        """
        self._check_time(time)
        sensor = self._sensor(h, H, R, angles)
        x = self._x
        seen = self._look(sensor.h, x)
        m = seen.shape[-1]
        y = innovation(z, seen, sensor.angles)
        if sensor.H is None:
            raise ValueError("H must be a function or an array in a batch, got None")
        H = self._matrices(sensor.H(x) if callable(sensor.H) else sensor.H, m, "H(x)")
        R = (sensor.R if R is None else noise(R, m))[None]
        (N, n), P = x.shape, self._rows(self._P)
        x_new, P_new, nis = np.empty((n, N)), np.empty((n, n, N)), np.empty(N)
        S, K = np.empty((m, m, N)), np.empty((n, m, N))
        lanes().correct(
            _rows(x), P, _rows(y), self._rows(H), self._rows(R), x_new, P_new, S, K, nis
        )
        possible = (nis >= 0) & (nis < np.inf)
        if not possible.all():
            self._complain_of_run(int(np.argmin(possible)), z, seen, H, S)
        self._x, self._P = x_new.T, P_new.transpose(2, 0, 1)
        self.innovation, self.nis = y, nis
        self.S, self.K = S.transpose(2, 0, 1), K.transpose(2, 0, 1)

    def _look(self, h: Measurement, x: NDArray) -> NDArray:
        seen = real_array(h(x), "h(x) must be numbers")
        if seen.shape == x.shape[:1]:
            seen = seen[:, None]
        if seen.ndim != 2 or len(seen) != len(x):
            raise ValueError(
                f"h(x) must work over leading axes: for {len(x)} runs it must give shape "
                f"({len(x)}, m), got {seen.shape}; write x[..., 0] for x[0]"
            )
        return seen

    def _matrices(self, value: ArrayLike, rows: int, name: str) -> NDArray:
        """One matrix for all, shape (1, rows, n), or one for each, (N, rows, n)."""
        value = np.require(real_array(value, f"{name} must be numbers"), float, ["C", "W", "A"])
        n = self._n
        if value.shape == (rows, n):
            return value[None]
        if value.shape != (self._runs, rows, n):
            raise ValueError(
                f"{name} must have shape ({self._runs}, {rows}, {n}) or ({rows}, {n}), "
                f"got shape {value.shape}"
            )
        return value

    def _rows(self, matrices: NDArray) -> NDArray:
        """(N, i, j) or (1, i, j) as (i, j, N), where each element is a row."""
        rows = matrices.transpose(1, 2, 0)
        if rows.shape[-1] == self._runs and rows.flags.carray:
            return rows
        spread = np.empty((*rows.shape[:-1], self._runs))
        spread[...] = rows
        return spread

    def _complain_of_run(
        self, run: int, z: ArrayLike, seen: NDArray, H: NDArray, S: NDArray
    ) -> None:
        z = np.asarray(z, float).reshape(seen.shape)
        try:
            _complain_of_sensor(z[run], seen[run], H[run if len(H) > 1 else 0], S[..., run])
        except ValueError as error:
            raise ValueError(f"in run {run}: {error}") from None


def _rows(vectors: NDArray) -> NDArray:
    """(N, n) as (n, N)."""
    return np.require(vectors.T, float, ["C", "W"])


def _diagonal(P: NDArray) -> NDArray:
    return P[np.arange(len(P)), np.arange(len(P))]
