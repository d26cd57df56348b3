"""The Kalman filter: the best estimate of a linear system with Gaussian noise.

    x_k = F x_{k-1} + B u_k + d_k,   z_k = H x_k + v_k,   d ~ N(0, Q), v ~ N(0, R)

It is the extended filter with straight models, and runs on the same code.

Source: Mastalli 2013, eq. (4.10) and section 4.2.2.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers
from backhoe.localisation.kalman.extended import ExtendedKalmanFilter
from backhoe.localisation.kalman.sensing import plain

OfTime = Callable[[float], ArrayLike]


class KalmanFilter(ExtendedKalmanFilter):
    """A Kalman filter with the interface of the extended one; x, z and u have their own units.

    Args:
        F: shape (n, n), or F(dt) if it depends on the step.
        H: what the own sensor shows, z = H x, shape (m, n); None if every update names a sensor.
        Q: covariance that one prediction adds, shape (n, n), or Q(dt).
        R: covariance of the own sensor's noise, positive definite, shape (m, m).
        x0, P0: state at the start and its covariance, shapes (n,), (n, n).
        B: of the input, shape (n, k), or B(dt); None: u is None.
        time, angles, measurement_angles: as for `ExtendedKalmanFilter`.

    Raises:
        ValueError: as for `ExtendedKalmanFilter`; in `predict` also if u does not fit B, in
            `update` if a sensor is curved (has an h).
    """

    def __init__(
        self,
        F: ArrayLike | OfTime,
        H: ArrayLike | None,
        Q: ArrayLike | OfTime,
        R: ArrayLike | None,
        x0: ArrayLike,
        P0: ArrayLike,
        *,
        B: ArrayLike | OfTime | None = None,
        time: float = 0.0,
        angles: Sequence[int] = (),
        measurement_angles: Sequence[int] = (),
    ) -> None:
        def transition(x: NDArray, u: ArrayLike, dt: float) -> NDArray:
            return plain(F(dt), 2 * x.shape, "F(dt)") if callable(F) else self._F

        def move(x: NDArray, u: ArrayLike, dt: float) -> NDArray:
            moved = transition(x, u, dt) @ x
            if u is None:
                return moved
            if B is None:
                raise ValueError("u must be None, since the filter has no B; got an input")
            push = numbers(B(dt) if callable(B) else B, "B", (*x.shape, "k"))
            return moved + push @ plain(u, push.shape[1:], "u")

        super().__init__(
            move,
            transition if callable(F) else F,
            None,
            H,
            (lambda x, u, dt: Q(dt)) if callable(Q) else Q,
            R,
            x0,
            P0,
            time=time,
            angles=angles,
            measurement_angles=measurement_angles,
        )

    def _sensor(self, h: object, H: object, R: object, angles: object) -> tuple:
        if h is not None or callable(H):
            raise ValueError(
                "a KalmanFilter takes z = H x with H an array; for a curved sensor "
                "take ExtendedKalmanFilter"
            )
        return super()._sensor(h, H, R, angles)
