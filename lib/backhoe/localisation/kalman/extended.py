"""The extended Kalman filter: models that are curved, errors that are taken as straight.

    predict:  x <- f(x, u, dt)          P <- F P F^T + Q,   F = df/dx before the step
    update:   y = z - h(x)              S = H P H^T + R,    H = dh/dx at the prediction
              K = P H^T S^-1            x <- x + K y,       P <- (I - K H) P (I - K H)^T + K R K^T

f is the step from one instant to the next, not a rate: eq. (4.20) of the source writes a rate and
(4.21) takes its Jacobian for F, which `kalman.transition` mends.

Source: Mastalli 2013, section 4.2.3.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import covariance, numbers
from backhoe.localisation.kalman.equations import numerical_jacobian
from backhoe.localisation.kalman.sensing import (
    Filter,
    Measurement,
    Motion,
    duration,
    engine,
    innovation,
    noise,
    plain,
)


class ExtendedKalmanFilter(Filter):
    """One state, one covariance, any number of sensors; x, z and u have their own units.

    Args:
        f: the motion, f(x, u, dt) -> x at the next instant, shape (n,).
        F: its Jacobian df/dx, F(x, u, dt) -> (n, n), taken at the estimate before the step; an
            array (n, n) if it is constant; None for central differences.
        h: what the filter's own sensor shows, h(x) -> (m,); None if every update names a sensor,
            or if H is an array and z = H x.
        H: its Jacobian, H(x) -> (m, n), taken at the prediction; an array, or None likewise.
        Q: covariance that one prediction adds, shape (n, n), or Q(x, u, dt) -> (n, n).
        R: covariance of the own sensor's noise, positive definite, shape (m, m); a number for
            m = 1.
        x0: state at the start, shape (n,).
        P0: its covariance, shape (n, n); zeros for a start that is known exactly.
        time: of the start [s].
        angles: components of the state that are angles [rad]; they keep their turns.
        measurement_angles: components of the own sensor's z that are angles [rad].

    Attributes:
        x, P: estimate (n,) and covariance (n, n), new arrays in each step; may be set.
        time: of the estimate [s].
        x_prior, P_prior, F: of the last prediction, shapes (n,), (n, n), (n, n).
        innovation, S, K: of the last update, shapes (m,), (m, m), (n, m).
        nis: innovation^T S^-1 innovation of the last update [1].

    Raises:
        ValueError: a wrong shape, numbers that are not finite, a covariance that is not symmetric
            or has a negative eigenvalue. The message names the argument.
    """

    def __init__(
        self,
        f: Motion,
        F: Motion | ArrayLike | None,
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
        super().__init__(f, Q, x0, P0, (h, H, R), time, angles, measurement_angles)
        self._square = self._n, self._n
        self._F = F if F is None or callable(F) else np.array(numbers(F, "F", self._square))
        self._Q_checked = not callable(Q)
        self.F = np.eye(self._n)
        self.predictions = 0

    def predict(self, u: ArrayLike, dt: float) -> None:
        """Move the estimate on by dt.

        Args:
            u: input that f, F and Q take, of any shape [its own units]; None if they take none.
            dt: positive [s].

        Raises:
            ValueError: dt is not positive; f, F or Q gives another shape, or numbers that are not
                finite. The filter is as before then.
        """
        dt, x, square = duration(dt), self._x, self._square
        moved = self._states(self._f(x.copy("K"), u, dt), x.shape, "f(x, u, dt)")
        F = self._matrices(self._jacobian(x, u, dt), square, "F(x, u, dt)")
        Q = self._Q
        if callable(Q):
            Q = self._matrices(Q(x, u, dt), square, "Q(x, u, dt)")
            if not self._Q_checked:
                self._check_noise(Q)
                self._Q_checked = True
        P, possible = self._propagated(moved, F, Q)
        if not possible:
            numbers(moved, "f(x, u, dt)")
            numbers(F, "F(x, u, dt)")
            self._check_noise(Q)
            raise ValueError("P became infinite or negative in the prediction: F or Q is too large")
        self._x, self._P, self.F = moved, P, F
        self.x_prior, self.P_prior = moved, P
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
        """Correct the estimate by a measurement, of the own sensor or of the one named here.

        Args:
            z: measurement, shape (m,) [its own units]; a number for m = 1.
            h, H, R: of another sensor, as for the class. H alone, an array: z = H x. R alone: the
                own sensor with other noise.
            angles: components of z that are angles [rad]; None: as for the own sensor, or none.
            time: when z was taken [s]; checked against the time of the state.

        Raises:
            ValueError: z is older or newer than the state, has another shape or is not finite; R is
                missing or not positive definite. The filter is as before then.
        """
        if time is not None:
            self._check_time(time)
        sensor, x = self._sensor(h, H, R, angles), self._x
        seen = self._look(sensor.h, x)
        m = seen.shape[-1]
        y = innovation(z, seen, sensor.angles)
        H = sensor.H
        if H is None:
            H = numerical_jacobian(lambda x: self._look(sensor.h, x), x, sensor.angles)
        elif callable(H):
            H = H(x)
        H = self._matrices(H, (m, self._n), "H(x)")
        self._correct(z, seen, y, H, sensor.R if R is None else noise(R, m))

    def _jacobian(self, x: NDArray, u: ArrayLike, dt: float) -> ArrayLike:
        if callable(self._F):
            return self._F(x, u, dt)
        if self._F is None:
            return numerical_jacobian(lambda x: self._f(x, u, dt), x, self.angles)
        return self._F

    _states = _matrices = staticmethod(plain)

    def _check_noise(self, Q: NDArray) -> None:
        covariance(Q, "Q(x, u, dt)", self._n, runs=len(Q) if Q.ndim == 3 else None)

    def _propagated(self, x: NDArray, F: NDArray, Q: NDArray) -> tuple[NDArray, bool]:
        """F P F^T + Q, and whether that and x can be true."""
        P = np.empty(self._square)
        return P, engine().propagate_one(x, F, self._P, Q, P)

    def _correct(self, z: ArrayLike, seen: NDArray, y: NDArray, H: NDArray, R: NDArray) -> None:
        m, n = H.shape
        x, P, S, K = np.empty(n), np.empty((n, n)), np.empty((m, m)), np.empty((n, m))
        nis = engine().correct_one(self._x, self._P, y, H, R, x, P, S, K)
        if not 0 <= nis < inf:
            complain(z, seen, H, S)
        self._x, self._P = x, P
        self.innovation, self.S, self.K, self.nis = y, S, K, nis


def complain(z: ArrayLike, seen: NDArray, H: NDArray, S: NDArray) -> None:
    """ValueError that names what of a measurement cannot be."""
    numbers(z, "z")
    numbers(seen, "h(x)")
    numbers(H, "H(x)")
    raise ValueError(
        f"S = H P H^T + R must be positive definite, got {S.tolist()}: is P still a covariance?"
    )
