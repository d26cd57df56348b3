"""The Kalman filter: the best estimate of a linear system with Gaussian noise.

    x_k = F x_{k-1} + B u_k + d_k,   z_k = H x_k + v_k,   d ~ N(0, Q), v ~ N(0, R)

It is the extended filter with straight models, and runs on the same code.

Source: Mastalli 2013, eq. (4.10) and section 4.2.2.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array
from backhoe.localisation.kalman.arguments import exactly, plain
from backhoe.localisation.kalman.extended import ExtendedKalmanFilter

OfTime = Callable[[float], ArrayLike]


class KalmanFilter(ExtendedKalmanFilter):
    """A Kalman filter with the interface of the extended one.

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
        n = len(exactly(x0, "x0", "the state at the start"))
        constant = None if callable(F) else plain(F, (n, n), "F")

        def transition(x: NDArray, u: ArrayLike, dt: float) -> NDArray:
            return plain(F(dt), (n, n), "F(dt)") if constant is None else constant

        def move(x: NDArray, u: ArrayLike, dt: float) -> NDArray:
            return transition(x, u, dt) @ x + _push(B, u, dt, n)

        def noise(x: NDArray, u: ArrayLike, dt: float) -> ArrayLike:
            return Q(dt)

        super().__init__(
            move,
            transition if constant is None else constant,
            None,
            H,
            noise if callable(Q) else Q,
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


def _push(B: ArrayLike | OfTime | None, u: ArrayLike | None, dt: float, n: int) -> NDArray | float:
    if u is None:
        return 0.0
    if B is None:
        raise ValueError("u must be None, since the filter has no B; got an input")
    B = real_array(B(dt) if callable(B) else B, "B must be numbers")
    if B.ndim != 2 or len(B) != n:
        raise ValueError(f"B must have shape ({n}, k), got shape {B.shape}")
    return B @ plain(u, B.shape[1:], "u")
