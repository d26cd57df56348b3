"""The unscented Kalman filter: no Jacobians, 2 n + 1 points carry the covariance through f and h.

Reference: van der Merwe 2004, scaled sigma points.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import residual
from backhoe.basics.inputs import covariance, number, numbers
from backhoe.localisation.kalman.sensing import (
    Filter,
    Measurement,
    Motion,
    duration,
    engine,
    innovation,
    noise,
    over_leading_axes,
)


class UnscentedKalmanFilter(Filter):
    """A UKF with the interface of `ExtendedKalmanFilter`, without F and H.

    Args:
        f, h, Q, R, x0, P0, time, angles, measurement_angles: as for `ExtendedKalmanFilter`; f and h
            must work over leading axes, x (2 n + 1, n), and Q is taken at the mean.
        alpha: spread of the points, above 0 and at most 1 [1].
        beta: 2 for a Gaussian [1].
        kappa: above -n [1].

    Attributes:
        x, P, time, innovation, S, K, nis, x_prior, P_prior: as for `ExtendedKalmanFilter`.

    Raises:
        ValueError: as for `ExtendedKalmanFilter`, or if f or h does not work over leading axes.
    """

    def __init__(
        self,
        f: Motion,
        h: Measurement | None,
        Q: Motion | ArrayLike,
        R: ArrayLike | None,
        x0: ArrayLike,
        P0: ArrayLike,
        *,
        alpha: float = 0.1,
        beta: float = 2.0,
        kappa: float = 0.0,
        time: float = 0.0,
        angles: Sequence[int] = (),
        measurement_angles: Sequence[int] = (),
    ) -> None:
        super().__init__(f, Q, x0, P0, (h, None, R), time, angles, measurement_angles)
        alpha, beta = number(alpha, "alpha", above=0, most=1), number(beta, "beta")
        n = self._n
        spread = alpha**2 * (n + number(kappa, "kappa", above=-n))
        self._distance = np.sqrt(spread)
        self._mean_weights = np.full(2 * n + 1, 0.5 / spread)
        self._mean_weights[0] = 1 - n / spread
        self._weights = self._mean_weights.copy()
        self._weights[0] += 1 - alpha**2 + beta

    def predict(self, u: ArrayLike, dt: float) -> None:
        """Move the estimate on by dt.

        Arguments and errors as for `ExtendedKalmanFilter`.
        """
        dt, Q = duration(dt), self._Q
        if callable(Q):
            Q = covariance(Q(self._x, u, dt), "Q(x, u, dt)", self._n)
        points = self._points()
        moved = over_leading_axes(self._f(points, u, dt), points.shape, "f(x, u, dt)")
        x, away = self._mean(moved, self.angles)
        P = (away.T * self._weights) @ away + Q
        self._x, self._P = numbers(x, "f(x, u, dt)"), (P + P.T) / 2
        self.x_prior, self.P_prior = self._x, self._P
        self.time += dt

    def update(
        self,
        z: ArrayLike,
        h: Measurement | None = None,
        H: object = None,
        R: ArrayLike | None = None,
        *,
        angles: Sequence[int] | None = None,
        time: float | None = None,
    ) -> None:
        """Correct the estimate by a measurement.

        Args:
            z, h, R, angles, time: as for `ExtendedKalmanFilter`.
            H: not needed beside h, and taken so that filters can be exchanged; an array alone
                means z = H x.

        Raises:
            ValueError: as for `ExtendedKalmanFilter`.
        """
        if time is not None:
            self._check_time(time)
        sensor = self._sensor(h, H, R, angles)
        m = len(self._look(sensor.h, self._x))
        R = sensor.R if R is None else noise(R, m)
        points = self._points()
        seen = over_leading_axes(sensor.h(points), (len(points), m), "h(x)")
        expected, away = self._mean(seen, sensor.angles)
        y = numbers(innovation(z, expected, sensor.angles), "z - h(x)")
        S = (away.T * self._weights) @ away + R
        cross = ((points - self._x).T * self._weights) @ away
        K = np.linalg.solve(S, cross.T).T
        P = self._P - K @ S @ K.T
        self._x, self._P = self._x + K @ y, (P + P.T) / 2
        self.innovation, self.S, self.K = y, S, K
        self.nis = float(y @ np.linalg.solve(S, y))

    def _points(self) -> NDArray:
        """2 n + 1 points that have the mean x and the covariance P, x first."""
        root = engine().root(np.ascontiguousarray(self._P)[..., None])
        if (root != root).any():
            raise ValueError(
                "P has a negative eigenvalue: the filter has lost it, raise Q or alpha"
            )
        steps = self._distance * root[..., 0].T
        return np.concatenate([self._x[None], self._x + steps, self._x - steps])

    def _mean(self, points: NDArray, angles: Sequence[int]) -> tuple[NDArray, NDArray]:
        """Weighted mean, and the points seen from it; angles are compared with the first's."""
        from_first = residual(points, points[0], angles)
        shift = self._mean_weights @ from_first
        return points[0] + shift, from_first - shift
