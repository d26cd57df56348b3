"""What all filters share: a state with its time, and sensors of which each update may name one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from math import inf
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import wrap_components
from backhoe.basics.inputs import covariance, indices, number, numbers, positive, real_numbers

_SAME_TIME = 1e-9
_FLOAT = np.dtype(float)

Motion = Callable[[NDArray, ArrayLike, float], ArrayLike]
Measurement = Callable[[NDArray], ArrayLike]


@cache
def engine() -> ModuleType:
    """The compiled module, imported when a filter first needs it: Numba takes half a second."""
    from backhoe.localisation.kalman import engine

    return engine


class Sensor(NamedTuple):
    """z = h(x) + noise: h; its Jacobian H, a function, an array or None; R; angles in z."""

    h: Measurement
    H: Measurement | NDArray | None
    R: ArrayLike
    angles: Sequence[int]


class Filter:
    """State `x` (n,), covariance `P` (n, n), `time` [s], and the sensor that `update` means when it
    names none; x and P with a leading axis for many filters at once."""

    _start = ("n",), "the state at the start"

    def __init__(
        self,
        f: Motion,
        Q: Motion | ArrayLike,
        x0: ArrayLike,
        P0: ArrayLike,
        sensor: tuple,
        time: float,
        angles: Sequence[int],
        measurement_angles: Sequence[int],
    ) -> None:
        shape, meaning = self._start
        self._x = np.array(numbers(x0, "x0", shape, meaning=meaning), order="C")
        n = self._n = self._x.shape[-1]
        self.time = number(time, "time", "s")
        self.angles = indices(angles, "angles", n)
        self._f = f
        self._Q = Q if callable(Q) else covariance(Q, "Q", n)
        self._set_covariance(P0, "P0")
        self._own = self._own_sensor(*sensor, measurement_angles)
        self.x_prior, self.P_prior = self._x, self._P
        self.innovation = self.S = self.K = self.nis = None

    @property
    def x(self) -> NDArray:
        """The estimate, shape (n,) [own units]."""
        return self._x

    @x.setter
    def x(self, value: ArrayLike) -> None:
        self._x = np.array(numbers(value, "x", self._x.shape))

    @property
    def P(self) -> NDArray:
        """Covariance of the estimate's error, shape (n, n) [products of its units]."""
        return self._P

    @P.setter
    def P(self, value: ArrayLike) -> None:
        self._set_covariance(value, "P")

    def _set_covariance(self, value: ArrayLike, name: str) -> None:
        (*runs, n) = self._x.shape
        value = covariance(value, name, n, runs=runs[0] if runs else None)
        self._P = np.array(np.broadcast_to(value, (*runs, n, n)))

    def _own_sensor(
        self, h: Measurement | None, H: object, R: ArrayLike | None, angles: Sequence[int]
    ) -> Sensor | None:
        if h is None and H is None:
            return None
        sensor = self._sensor(h, H, R, angles)
        m = self._look(sensor.h, self._x).shape[-1]
        return sensor._replace(
            R=covariance(sensor.R, "R", m, definite=True),
            angles=indices(angles, "measurement_angles", m),
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
            H = numbers(H, "H", ("m", self._n), finite=False)
            return Sensor(_linear(H), H, R, () if angles is None else angles)
        return Sensor(h, H, R, () if angles is None else angles)

    def _look(self, h: Measurement, x: NDArray) -> NDArray:
        """h(x) as an array of shape (m,)."""
        seen = h(x)
        if type(seen) is np.ndarray and seen.ndim == 1 and seen.dtype is _FLOAT:
            return seen
        seen = np.atleast_1d(real_numbers(seen, "h(x)"))
        return seen if seen.ndim == 1 else numbers(seen, "h(x)", ("m",))

    def _check_time(self, time: float) -> None:
        time = number(time, "time", "s")
        if abs(time - self.time) <= _SAME_TIME:
            return
        age, advice = "newer", "predict up to it first"
        if time < self.time:
            age, advice = "older", "put measurements in order, or drop it"
        raise ValueError(
            f"the measurement of {time:g} s is {age} than the state of {self.time:g} s: {advice}"
        )


def plain(value: ArrayLike, shape: tuple[int, ...], name: str) -> NDArray:
    """`value` of exactly `shape` as the engine takes it, finite or not: contiguous, writable."""
    if type(value) is np.ndarray and value.dtype is _FLOAT and value.shape == shape:
        return value if value.flags.carray else np.array(value, order="C")
    if shape == (1,) and np.ndim(value) == 0:
        value = [value]
    return np.array(numbers(value, name, shape, finite=False), order="C")


def over_leading_axes(value: ArrayLike, shape: tuple[int, ...], name: str) -> NDArray:
    """What a model gives for many states at once, as an array of `shape`."""
    value = real_numbers(value, name)
    if value.shape == shape[:1] and shape[1:] == (1,):
        return value[:, None]
    if value.shape != shape:
        raise ValueError(
            f"{name} must work over leading axes: for x of {shape[0]} states it must give shape "
            f"{shape}, got {value.shape}; write x[..., 0] for x[0] and stack on axis -1"
        )
    return value


def duration(dt: float) -> float:
    """dt, above 0 [s]."""
    return dt if type(dt) is float and 0 < dt < inf else positive(dt, "dt", "s")


def innovation(z: ArrayLike, seen: NDArray, angles: Sequence[int]) -> NDArray:
    """z - h(x) with angles wrapped, shape (..., m)."""
    y = plain(z, seen.shape, "z") - seen
    if len(angles):
        wrap_components(y, indices(angles, "angles", seen.shape[-1]))
    return y


def noise(R: ArrayLike, m: int) -> NDArray:
    """R as a positive definite array, shape (m, m)."""
    if type(R) is np.ndarray and R.shape == (1, 1) == (m, m) and 0 < R[0, 0] < inf:
        return plain(R, (1, 1), "R")
    return covariance(R, "R", m, definite=True)


def _linear(H: NDArray) -> Measurement:
    def measured(x: NDArray) -> NDArray:
        return x @ H.T

    return measured
