"""What all filters share: a state with its time, and sensors of which each update may name one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import indices, wrap_components
from backhoe.basics.inputs import real_array
from backhoe.localisation.kalman.arguments import covariance, exactly, finite, plain

_SAME_TIME = 1e-9
_FLOAT = np.dtype(float)

Measurement = Callable[[NDArray], ArrayLike]


class Sensor(NamedTuple):
    """z = h(x) + noise: h; its Jacobian H, a function, an array or None; R; angles in z."""

    h: Measurement
    H: Measurement | NDArray | None
    R: ArrayLike
    angles: Sequence[int]


class Filter:
    """State `x` (n,), `time` [s], and the sensor that `update` means when it names none."""

    def __init__(
        self,
        x0: ArrayLike,
        time: float,
        angles: Sequence[int],
        sensor: tuple,
        measurement_angles: Sequence[int],
    ) -> None:
        self._x = exactly(x0, "x0", "the state at the start")
        self.time = float(finite(time, (), "time"))
        self.angles = indices("angles", angles, len(self._x))
        self._own = self._own_sensor(*sensor, measurement_angles)

    @property
    def x(self) -> NDArray:
        """The estimate, shape (n,)."""
        return self._x

    @x.setter
    def x(self, value: ArrayLike) -> None:
        self._x = finite(value, self._x.shape, "x")

    def _own_sensor(
        self, h: Measurement | None, H: object, R: ArrayLike | None, angles: Sequence[int]
    ) -> Sensor | None:
        if h is None and H is None:
            return None
        sensor = self._sensor(h, H, R, angles)
        m = self._look(sensor.h, self._x).shape[-1]
        return sensor._replace(
            R=covariance(sensor.R, m, "R", definite=True),
            angles=indices("measurement_angles", angles, m),
        )

    def _sensor(
        self,
        h: Measurement | None,
        H: Measurement | ArrayLike | None,
        R: ArrayLike | None,
        angles: Sequence[int] | None,
    ) -> Sensor:
        """The sensor that an update means."""
        if h is None and H is None:
            own = self._own
            if own is None:
                raise ValueError("this filter has no sensor of its own: give h (or H) and R")
            if R is not None:
                own = own._replace(R=R)
            return own if angles is None else own._replace(angles=angles)
        if R is None:
            raise ValueError("R, the covariance of its noise, must come with a sensor's h or H")
        if h is None:
            if callable(H):
                raise ValueError("h must come with an H that is a function: H is its derivative")
            H = real_array(H, "H must be numbers")
            n = self._x.shape[-1]
            if H.ndim != 2 or H.shape[1] != n:
                raise ValueError(f"H must have shape (m, {n}), got shape {H.shape}")
            return Sensor(_linear(H), H, R, () if angles is None else angles)
        return Sensor(h, H, R, () if angles is None else angles)

    def _look(self, h: Measurement, x: NDArray) -> NDArray:
        """h(x) as an array of shape (m,)."""
        seen = h(x)
        if type(seen) is np.ndarray and seen.ndim == 1 and seen.dtype is _FLOAT:
            return seen
        seen = real_array(seen, "h(x) must be numbers")
        if seen.ndim == 0:
            seen = seen.reshape(1)
        if seen.ndim != 1:
            raise ValueError(f"h(x) must have shape (m,), got shape {seen.shape}")
        return seen

    def _check_time(self, time: float | None) -> None:
        if time is None:
            return
        time = float(finite(time, (), "time"))
        if time < self.time - _SAME_TIME:
            raise ValueError(
                f"the measurement of {time:g} s is older than the state of {self.time:g} s: "
                "put measurements in order, or drop it"
            )
        if time > self.time + _SAME_TIME:
            raise ValueError(
                f"the measurement of {time:g} s is newer than the state of {self.time:g} s: "
                "predict up to it first"
            )


def innovation(z: ArrayLike, seen: NDArray, angles: Sequence[int]) -> NDArray:
    """z - h(x) with angles wrapped, shape (..., m)."""
    y = plain(z, seen.shape, "z") - seen
    if len(angles):
        wrap_components(y, indices("angles", angles, seen.shape[-1]))
    return y


def noise(R: ArrayLike, m: int) -> NDArray:
    """R as a positive definite array, shape (m, m)."""
    if m == 1:
        value = real_array(R, "R must be numbers")
        if value.shape == (1, 1) and 0 < value[0, 0] < np.inf:
            return value if value.flags.carray else value.copy()
    return covariance(R, m, "R", definite=True)


def _linear(H: NDArray) -> Measurement:
    def measured(x: NDArray) -> NDArray:
        return x @ H.T

    return measured
