"""Incremental encoders: angles become whole numbers in a counter that overflows.

A counter of b bits holds the ticks modulo 2^b. The difference of two readings, taken modulo 2^b
into [-2^(b-1), 2^(b-1)), is the number of ticks between them as long as that is below half the
counter: nothing in the readings tells more ticks forwards from fewer backwards. So the sampling
time bounds the speed; `Encoder.fastest` says to what.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers, positive, whole


@dataclass(frozen=True)
class Encoder:
    """An incremental encoder with its counter.

    Attributes:
        ticks: counts in a turn of the wheel, gear and quadrature included.
        bits: of the counter, 2 to 52.
        signed: whether the counter runs from -2^(bits-1) instead of from 0.

    Raises:
        ValueError: ticks is not a whole number above 0, or bits not one from 2 to 52.
    """

    ticks: int
    bits: int = 16
    signed: bool = False

    def __post_init__(self) -> None:
        whole(self.ticks, "Encoder.ticks", least=1, most=2**52)
        whole(self.bits, "Encoder.bits", least=2, most=52)

    @property
    def resolution(self) -> float:
        """Angle of one tick [rad]."""
        return 2 * pi / self.ticks

    @property
    def modulus(self) -> int:
        """Number of readings that the counter has, 2^bits."""
        return 2**self.bits

    def count(self, angle: ArrayLike) -> NDArray:
        """Readings of the counter at an angle of the wheel.

        Args:
            angle: not wrapped, shape (...) [rad].

        Returns:
            Whole numbers, shape (...) [ticks].

        Raises:
            ValueError: angle is not finite numbers.
        """
        ticks = np.floor(numbers(angle, "angle") / self.resolution).astype(np.int64)
        return self._wrapped(ticks) if self.signed else ticks % self.modulus

    def increments(self, counts: ArrayLike) -> NDArray:
        """Ticks between readings, across overflows of the counter.

        Right only if the wheel turns less than half a counter between readings: see `fastest`.

        Args:
            counts: readings, whole numbers, shape (..., N+1) [ticks].

        Returns:
            Ways forwards, shape (..., N) [ticks].

        Raises:
            ValueError: a reading that is not whole or that the counter cannot show, or a step of
                exactly half a counter, which might be either way.
        """
        counts = self._readings(counts)
        ticks = self._wrapped(np.diff(counts, axis=-1))
        if (ticks == -self.modulus // 2).any():
            index = int(np.argwhere(ticks == -self.modulus // 2)[0][-1])
            raise ValueError(
                f"between readings {index} and {index + 1} the counter moves by exactly half its "
                f"range, {self.modulus // 2}: forwards or backwards cannot be told; sample faster"
            )
        return ticks

    def angles(self, counts: ArrayLike, start: float = 0.0) -> NDArray:
        """Angles of the wheel at the readings, from `start`, across overflows.

        Args:
            counts: as for `increments`, shape (..., N+1) [ticks].
            start: angle at the first reading [rad].

        Returns:
            Shape (..., N+1) [rad], each within a tick of what the wheel has turned.

        Raises:
            ValueError: as for `increments`.
        """
        ticks = self.increments(counts)
        turned = np.zeros((*ticks.shape[:-1], ticks.shape[-1] + 1))
        np.cumsum(ticks, axis=-1, out=turned[..., 1:])
        return number(start, "start", "rad") + self.resolution * turned

    def fastest(self, dt: float) -> float:
        """Speed below which readings every dt seconds are unambiguous [rad/s].

        Raises:
            ValueError: dt is not a positive number.
        """
        return (self.modulus // 2 - 1) * self.resolution / positive(dt, "dt", "s")

    def _wrapped(self, ticks: NDArray) -> NDArray:
        half = self.modulus // 2
        return (ticks + half) % self.modulus - half

    def _readings(self, counts: ArrayLike) -> NDArray:
        values = numbers(counts, "counts", (..., "n"), meaning="readings")
        low = -self.modulus // 2 if self.signed else 0
        bad = (values != np.floor(values)) | (values < low) | (values >= low + self.modulus)
        if bad.any():
            raise ValueError(
                f"a counter of {self.bits} bits shows whole numbers from {low} to "
                f"{low + self.modulus - 1}, got {values[bad][0]:.10g}"
            )
        return values.astype(np.int64)
