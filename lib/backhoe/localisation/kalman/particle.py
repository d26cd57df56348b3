"""The particle filter: the density as a swarm of weighted states, for any f, h and shape of noise.

Resampling is systematic: one random number, and particles at equal distances along the summed
weights.

Reference: Thrun, Burgard and Fox 2005, chapter 4.3.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import residual, wrap_components
from backhoe.basics.inputs import covariance, generator, number, numbers, whole
from backhoe.localisation.kalman.bayes import distribution
from backhoe.localisation.kalman.sensing import (
    Filter,
    Measurement,
    Motion,
    duration,
    engine,
    noise,
    over_leading_axes,
)


def systematic_resample(weights: ArrayLike, offset: float) -> NDArray:
    """Which particles go on: index i about M weights[i] times.

    Args:
        weights: not negative, of sum 1, shape (M,) [1].
        offset: the one random number, from 0 to below 1 [1].

    Returns:
        Indices, shape (M,), in order; each i is there floor(M w) or ceil(M w) times.

    Raises:
        ValueError: weights negative or of another sum, offset outside [0, 1).
    """
    weights = distribution(numbers(weights, "weights", ("M",)), "weights")
    M = len(weights)
    places = (np.arange(M) + number(offset, "offset", least=0, below=1)) / M
    return np.minimum(np.searchsorted(np.cumsum(weights), places, side="right"), M - 1)


class ParticleFilter(Filter):
    """A particle filter with the interface of `ExtendedKalmanFilter`, without F and H.

    Args:
        f, h, Q, R, x0, P0, time, angles, measurement_angles: as for `ExtendedKalmanFilter`; f, h
            (and Q, if it is a function) must work over leading axes, x (M, n). The first particles
            are drawn from N(x0, P0), the noise of the motion from N(0, Q).
        particles: M.
        rng: a NumPy generator, or a seed.
        threshold: resample when the effective size is below threshold * M [1].

    Attributes:
        particles, weights: shapes (M, n), (M,).
        x, P: their mean and covariance; mean directions for angles.
        effective_size: 1 / sum of the squared weights, before resampling.
        time: [s].

    Raises:
        ValueError: as for `ExtendedKalmanFilter`; fewer than two particles; no generator or seed.
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
        particles: int = 1000,
        rng: np.random.Generator | int,
        threshold: float = 0.5,
        time: float = 0.0,
        angles: Sequence[int] = (),
        measurement_angles: Sequence[int] = (),
    ) -> None:
        super().__init__(f, Q, x0, P0, (h, None, R), time, angles, measurement_angles)
        particles = whole(particles, "particles", least=2)
        self._threshold = number(threshold, "threshold", least=0, most=1)
        self._rng = generator(rng)
        self.particles = self._x + self._draw(self._P, (particles, self._n))
        self.weights = np.full(particles, 1 / particles)
        self.effective_size = float(particles)

    @property
    def x(self) -> NDArray:
        """Mean of the particles, shape (n,) [own units]."""
        mean = self.weights @ self.particles
        for i in self.angles:
            away = self.particles[:, i] - mean[i]
            mean[i] += np.arctan2(self.weights @ np.sin(away), self.weights @ np.cos(away))
        return mean

    @property
    def P(self) -> NDArray:
        """Covariance of the particles, shape (n, n) [products of their units]."""
        away = residual(self.particles, self.x, self.angles)
        return (away.T * self.weights) @ away

    def predict(self, u: ArrayLike, dt: float) -> None:
        """Move each particle on by dt, with its own draw of the noise.

        Arguments and errors as for `ExtendedKalmanFilter`.
        """
        dt, old, Q = duration(dt), self.particles, self._Q
        if callable(Q):
            Q = covariance(Q(old, u, dt), "Q(x, u, dt)", self._n, runs=len(old))
        moved = over_leading_axes(self._f(old.copy(), u, dt), old.shape, "f(x, u, dt)")
        self.particles = numbers(moved, "f(x, u, dt)") + self._draw(Q, old.shape)
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
        """Weigh each particle by the probability of the measurement, and resample if few count.

        Args:
            z, h, R, angles, time: as for `ExtendedKalmanFilter`.
            H: as for `UnscentedKalmanFilter`.

        Raises:
            ValueError: as for `ExtendedKalmanFilter`. A measurement far from all particles is no
                error: it leaves few of them, which `effective_size` shows.
        """
        if time is not None:
            self._check_time(time)
        sensor = self._sensor(h, H, R, angles)
        m = len(self._look(sensor.h, self.particles[0]))
        R = sensor.R if R is None else noise(R, m)
        seen = over_leading_axes(sensor.h(self.particles), (len(self.particles), m), "h(x)")
        z = numbers([z] if np.ndim(z) == 0 else z, "z", (m,))
        away = z - numbers(seen, "h(x)")
        wrap_components(away, tuple(sensor.angles))
        exponent = -0.5 * np.einsum("ki,ki->k", away, np.linalg.solve(R, away.T).T)
        with np.errstate(divide="ignore"):
            exponent += np.log(self.weights)
        weights = np.exp(exponent - exponent.max())
        self.weights = weights / weights.sum()
        self.effective_size = float(1 / (self.weights @ self.weights))
        if self.effective_size < self._threshold * len(weights):
            self._resample()

    def _resample(self) -> None:
        chosen = systematic_resample(self.weights, self._rng.random())
        self.particles = self.particles[chosen]
        self.weights = np.full(len(chosen), 1 / len(chosen))

    def _draw(self, P: NDArray, shape: tuple[int, int]) -> NDArray:
        roots = engine().root(np.array(np.atleast_3d(P.T), order="C"))
        normal = self._rng.standard_normal(shape)
        return normal @ roots[..., 0].T if P.ndim == 2 else np.einsum("ijk,kj->ki", roots, normal)
