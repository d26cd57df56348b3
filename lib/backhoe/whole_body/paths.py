"""Paths for the hand, in time: sine, tilted circle, figure of eight.

A path is a place that drifts and swings,

    p(phi) = start + drift phi / 2 pi + sum of c_k (cos k phi - 1) + s_k sin k phi,

and a phase phi(t) that starts and ends softly, so that the wanted velocity has no jump. Lengths in
m, angles in rad, time in s.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers, positive

NONE = ((0.0, 0.0, 0.0),)


@dataclass(frozen=True, eq=False)
class HandPath:
    """Where the hand should be at each time; call it, or ask its `velocity`.

    Attributes:
        start: place at time 0, shape (3,) [m].
        drift: way of one turn of the phase, shape (3,) [m].
        cosines, sines: c_k and s_k for k = 1, 2, ..., shapes (K, 3) [m].
        duration: [s].
        turns: of the phase.
        soft: how long it takes to get up to speed, and to stop [s].

    Raises:
        ValueError: a shape is wrong, a value is not finite, or soft is above half the duration.
    """

    start: NDArray
    drift: NDArray
    cosines: NDArray
    sines: NDArray
    duration: float
    turns: float = 1.0
    soft: float = 1.0

    def __post_init__(self) -> None:
        for name in ("start", "drift"):
            object.__setattr__(self, name, numbers(getattr(self, name), name, (3,)).copy())
        cosines = numbers(self.cosines, "cosines", ("K", 3), meaning="a row for each k")
        sines = numbers(self.sines, "sines", cosines.shape, meaning="like cosines")
        for name, value in (("cosines", cosines), ("sines", sines)):
            object.__setattr__(self, name, value.copy())
        positive(self.duration, "duration", "s"), positive(self.turns, "turns")
        number(self.soft, "soft", "s", above=0.0, most=self.duration / 2)

    def __call__(self, t: ArrayLike) -> NDArray:
        """Places at times t, shape (...) [s] to (..., 3) [m]; before and after it stands."""
        phase, _ = self._phase(t)
        place = self.start + self.drift * (phase / (2 * pi))[..., None]
        for k, (c, s) in enumerate(zip(self.cosines, self.sines, strict=True), start=1):
            angle = k * phase[..., None]
            place = place + c * (np.cos(angle) - 1) + s * np.sin(angle)
        return place

    def velocity(self, t: ArrayLike) -> NDArray:
        """Velocity at times t, shape (...) [s] to (..., 3) [m/s]; continuous."""
        phase, rate = self._phase(t)
        by_phase = np.broadcast_to(self.drift / (2 * pi), (*phase.shape, 3))
        for k, (c, s) in enumerate(zip(self.cosines, self.sines, strict=True), start=1):
            angle = k * phase[..., None]
            by_phase = by_phase + k * (s * np.cos(angle) - c * np.sin(angle))
        return by_phase * rate[..., None]

    def _phase(self, t: ArrayLike) -> tuple[NDArray, NDArray]:
        """phi and its rate: 3 x^2 - 2 x^3 of the full rate while x = t / soft goes from 0 to 1."""
        t = np.clip(numbers(t, "t"), 0.0, self.duration)
        fast = 2 * pi * self.turns / (self.duration - self.soft)
        x, y = (np.minimum(left / self.soft, 1.0) for left in (t, self.duration - t))
        ramp, stop = (z**3 * (1 - z / 2) for z in (x, y))
        even = np.clip(t - self.soft, 0.0, self.duration - 2 * self.soft)
        phase = fast * (self.soft * (ramp + 0.5 - stop) + even)
        return phase, fast * np.minimum(x * x * (3 - 2 * x), y * y * (3 - 2 * y))


def sine_path(
    start: ArrayLike,
    duration: float = 30.0,
    *,
    length: float = 3.0,
    waves: float = 2.0,
    sideways: float = 0.3,
    upwards: float = 0.0,
    heading: float = 0.0,
    soft: float = 1.0,
) -> HandPath:
    """Ahead, and to and fro like a sine: sideways, upwards or both.

    Args:
        start: where it begins, shape (3,) [m].
        duration, soft: as for `HandPath` [s].
        length: of all waves together [m].
        waves: how many.
        sideways, upwards: how far to the left, then to the right, and up, then down [m].
        heading: direction of the whole [rad].

    Raises:
        ValueError: as for `HandPath`.
    """
    ahead, left = _axes(heading)
    waves = number(waves, "waves", least=1e-3)
    drift = ahead * (positive(length, "length", "m") / waves)
    rise = np.array([0.0, 0.0, number(upwards, "upwards", "m")])
    swing = number(sideways, "sideways", "m") * left + rise
    return HandPath(start, drift, NONE, [swing], duration, waves, soft)


def circle_path(
    start: ArrayLike,
    duration: float = 20.0,
    *,
    radius: float = 0.5,
    tilt: float = 0.0,
    heading: float = 0.0,
    turns: float = 1.0,
    soft: float = 1.0,
) -> HandPath:
    """A circle that begins at its nearest point and goes to the right; its far side tilts up.

    Args:
        start: where it begins and ends, shape (3,) [m].
        duration, soft, turns: as for `HandPath`; it ends where it began if turns is whole.
        radius: [m].
        tilt: of its plane [rad]; 0 for level, pi/2 for upright.
        heading: where its middle is, seen from the start [rad].

    Raises:
        ValueError: as for `HandPath`.
    """
    ahead, left = _axes(heading)
    tilt, radius = number(tilt, "tilt", "rad"), positive(radius, "radius", "m")
    up = np.array([0.0, 0.0, 1.0])
    inwards = radius * (cos(tilt) * ahead + sin(tilt) * up)
    return HandPath(start, np.zeros(3), [-inwards], [-radius * left], duration, turns, soft)


def eight_path(
    start: ArrayLike,
    duration: float = 30.0,
    *,
    length: float = 1.0,
    width: float = 0.5,
    height: float = 0.3,
    heading: float = 0.0,
    turns: float = 1.0,
    soft: float = 1.0,
) -> HandPath:
    """A figure of eight in space, begun at its middle: both of its ends rise.

    Args:
        start: where it begins and ends, shape (3,) [m].
        duration, soft, turns: as for `HandPath`; it ends where it began if turns is whole.
        length, width, height: from end to end, across, and how far its ends rise [m].
        heading: along its length [rad].

    Raises:
        ValueError: as for `HandPath`.
    """
    ahead, left = _axes(heading)
    length, width = positive(length, "length", "m"), positive(width, "width", "m")
    rise = np.array([0.0, 0.0, number(height, "height", "m") / 2])
    rows = [length / 2 * ahead, width / 2 * left]
    return HandPath(start, np.zeros(3), [np.zeros(3), -rise], rows, duration, turns, soft)


def _axes(heading: float) -> tuple[NDArray, NDArray]:
    """Unit vectors ahead and to the left, level."""
    heading = number(heading, "heading", "rad")
    c, s = cos(heading), sin(heading)
    return np.array([c, s, 0.0]), np.array([-s, c, 0.0])
