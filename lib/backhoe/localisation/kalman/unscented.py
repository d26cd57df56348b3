"""The unscented Kalman filter: no Jacobians, 2 n + 1 points carry the covariance through f and h.

Reference: van der Merwe 2004, scaled sigma points.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import residual
from backhoe.basics.inputs import real_array
from backhoe.localisation.kalman.arguments import covariance, duration, exactly, finite
from backhoe.localisation.kalman.compiled import kernels
from backhoe.localisation.kalman.extended import Motion
from backhoe.localisation.kalman.sensing import Filter, Measurement, innovation, noise


def sigma_points(
    x: ArrayLike, P: ArrayLike, alpha: float = 0.1, beta: float = 2.0, kappa: float = 0.0
) -> tuple[NDArray, NDArray, NDArray]:
    """2 n + 1 points that have the mean x and the covariance P.

    Args:
        x: mean, shape (n,).
        P: covariance, shape (n, n); may be singular.
        alpha: spread of the points, in (0, 1].
        beta: 2 for a Gaussian.
        kappa: n + kappa must be positive.

    Returns:
        Points (2 n + 1, n), x first; weights of the mean and of the covariance, (2 n + 1,) each.

    Raises:
        ValueError: wrong shapes, P no covariance, or parameters out of range.
    """
    x = exactly(x, "x", "the mean")
    P = covariance(P, len(x), "P")
    return _points(x, P, *_weights(len(x), alpha, beta, kappa))


class UnscentedKalmanFilter(Filter):
    """A UKF with the interface of `ExtendedKalmanFilter`, without F and H.

    Args:
        f, h, Q, R, x0, P0, time, angles, measurement_angles: as for `ExtendedKalmanFilter`; f and h
            must work over leading axes, x (2 n + 1, n), and Q is taken at the mean.
        alpha, beta, kappa: as for `sigma_points`.

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
        super().__init__(x0, time, angles, (h, None, R), measurement_angles)
        n = len(self._x)
        self._f, self._n = f, n
        self._Q = Q if callable(Q) else covariance(Q, n, "Q")
        self._P = covariance(P0, n, "P0")
        self._weights = _weights(n, alpha, beta, kappa)
        self.x_prior, self.P_prior = self._x, self._P
        self.innovation = self.S = self.K = self.nis = None

    @property
    def P(self) -> NDArray:
        """Covariance of the estimate's error, shape (n, n)."""
        return self._P

    @P.setter
    def P(self, value: ArrayLike) -> None:
        self._P = covariance(value, self._n, "P")

    def predict(self, u: ArrayLike, dt: float) -> None:
        """Move the estimate on by dt.

        Args:
            u, dt: as for `ExtendedKalmanFilter`.

        Raises:
            ValueError: as for `ExtendedKalmanFilter`.
        """
        dt = duration(dt)
        Q = self._Q
        if callable(Q):
            Q = covariance(Q(self._x, u, dt), self._n, "Q(x, u, dt)")
        points, mean_weights, weights = _points(self._x, self._P, *self._weights)
        moved = over_leading_axes(self._f(points, u, dt), points.shape, "f(x, u, dt)")
        x, away = _mean(moved, mean_weights, self.angles)
        P = (away.T * weights) @ away + Q
        self._x, self._P = finite(x, x.shape, "f(x, u, dt)"), (P + P.T) / 2
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
        self._check_time(time)
        sensor = self._sensor(h, H, R, angles)
        m = len(self._look(sensor.h, self._x))
        R = sensor.R if R is None else noise(R, m)
        points, mean_weights, weights = _points(self._x, self._P, *self._weights)
        seen = over_leading_axes(sensor.h(points), (len(points), m), "h(x)")
        expected, away = _mean(seen, mean_weights, sensor.angles)
        y = finite(innovation(z, expected, sensor.angles), (m,), "z - h(x)")
        S = (away.T * weights) @ away + R
        cross = ((points - self._x).T * weights) @ away
        K = np.linalg.solve(S, cross.T).T
        P = self._P - K @ S @ K.T
        self._x, self._P = self._x + K @ y, (P + P.T) / 2
        self.innovation, self.S, self.K = y, S, K
        self.nis = float(y @ np.linalg.solve(S, y))


def over_leading_axes(value: ArrayLike, shape: tuple[int, ...], name: str) -> NDArray:
    """What a model gives for many states at once."""
    value = real_array(value, f"{name} must be numbers")
    if value.shape == shape[:1] and shape[1:] == (1,):
        return value[:, None]
    if value.shape != shape:
        raise ValueError(
            f"{name} must work over leading axes: for x of {shape[0]} states it must give shape "
            f"{shape}, got {value.shape}; write x[..., 0] for x[0] and stack on axis -1"
        )
    return value


def _weights(n: int, alpha: float, beta: float, kappa: float) -> tuple[float, NDArray, NDArray]:
    """Distance of the points in standard deviations; weights of mean and covariance."""
    if not (0 < alpha <= 1 and np.isfinite(beta) and n + kappa > 0):
        raise ValueError(
            "alpha must be in (0, 1], beta finite and n + kappa positive, got "
            f"alpha={alpha}, beta={beta}, kappa={kappa} for n={n}"
        )
    spread = alpha**2 * (n + kappa)
    mean = np.full(2 * n + 1, 0.5 / spread)
    mean[0] = 1 - n / spread
    weights = mean.copy()
    weights[0] += 1 - alpha**2 + beta
    return float(np.sqrt(spread)), mean, weights


def _points(
    x: NDArray, P: NDArray, distance: float, mean: NDArray, weights: NDArray
) -> tuple[NDArray, NDArray, NDArray]:
    root = kernels().root_all(np.ascontiguousarray(P)[None])[0]
    if np.isnan(root).any():
        raise ValueError("P has a negative eigenvalue: the filter has lost it, raise Q or alpha")
    steps = distance * root.T
    return np.concatenate([x[None], x + steps, x - steps]), mean, weights


def _mean(points: NDArray, weights: NDArray, angles: Sequence[int]) -> tuple[NDArray, NDArray]:
    """Weighted mean, and the points seen from it; angles are compared with the first point's."""
    from_first = residual(points, points[0], angles)
    shift = weights @ from_first
    return points[0] + shift, from_first - shift
