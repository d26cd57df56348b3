"""Three scenarios as speeds over time, and the poses that follow from them.

Source: Mastalli 2013, sections 4.6.1 to 4.6.3, for shape and duration; the numbers are ours.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import choice, number

SAMPLE_RATE = 100.0
"""Of the encoders and the IMU [Hz]: Mastalli 2013, section 4.5."""

RAMP = 1.0
"""How long the speeds take from one segment's to the next [s]: ours."""

_FINE = 1000
"""Steps a second in which the truth is integrated; its poses are right to less than 1e-6 m."""


@dataclass(frozen=True)
class Segment:
    """Driving on for `duration` [s] at `v` [m/s] and `omega` [rad/s].

    The speeds ramp up from those of the segment before; with a `wobble` [rad/s] the turn rate also
    swings by so much, as a sine of `period` [s].
    """

    duration: float
    v: float
    omega: float
    wobble: float = 0.0
    period: float = 1.0


@dataclass(frozen=True)
class Scenario:
    """A drive from the origin along x: its name, title and segments."""

    name: str
    title: str
    segments: tuple[Segment, ...]

    @property
    def duration(self) -> float:
        """Of all segments [s]."""
        return float(sum(segment.duration for segment in self.segments))


def _corner(v: float) -> Segment:
    return Segment(4.0, v, pi / 8)


SCENARIOS = {
    scenario.name: scenario
    for scenario in (
        Scenario(
            "rectangle",
            "a quasi-rectangle of 67 s",
            (
                Segment(3.0, 0.0, 0.0),
                Segment(12.0, 0.5, 0.0),
                _corner(0.5),
                Segment(10.0, 0.5, 0.0),
                _corner(0.5),
                Segment(13.0, 0.5, 0.0),
                _corner(0.5),
                Segment(10.0, 0.5, 0.0),
                _corner(0.5),
                Segment(1.0, 0.5, 0.0),
                Segment(2.0, 0.0, 0.0),
            ),
        ),
        Scenario(
            "g",
            "a G of 100 s that ends in a curve",
            (
                Segment(3.0, 0.0, 0.0),
                Segment(12.0, 0.5, 0.0),
                Segment(60.0, 0.5, 1.5 * pi / 60),
                Segment(5.0, 0.5, pi / 10),
                Segment(10.0, 0.5, 0.0),
                Segment(8.0, 0.5, -0.2),
                Segment(2.0, 0.0, 0.0),
            ),
        ),
        Scenario(
            "circle",
            "a circle and an oscillating straight of 180 s",
            (
                Segment(3.0, 0.0, 0.0),
                Segment(94.5, 0.6, 2.25 * pi / 94.5),
                Segment(72.0, 0.6, 0.0, wobble=0.25, period=8.0),
                Segment(8.5, 0.6, 0.0),
                Segment(2.0, 0.0, 0.0),
            ),
        ),
    )
}
"""Name to scenario, in the order of the source."""


@dataclass(frozen=True, eq=False)
class Truth:
    """Where the machine was and how fast: sampled at `time` (n,) [s].

    `pose` (n, 3) = x, y, heading [m, m, rad], the heading counting on; `v` and `omega` (n,) forward
    and turning speed [m/s, rad/s]; `acceleration` (n, 2) forward and to the left [m/s^2].
    """

    time: NDArray
    pose: NDArray
    v: NDArray
    omega: NDArray
    acceleration: NDArray


def truth(name: str, rate: float = SAMPLE_RATE) -> Truth:
    """The true motion of a scenario.

    Source: Mastalli 2013, section 4.6; the numbers ours.

    Args:
        name: one of SCENARIOS.
        rate: samples a second [Hz], a divisor of 1000.

    Returns:
        The motion from t = 0 to the scenario's end, both ends included.

    Raises:
        ValueError: no such scenario, or a rate that is no divisor of 1000 Hz.
    """
    scenario, stride = SCENARIOS[choice(name, "name", SCENARIOS)], _stride(rate)
    instants = np.arange(round(2 * _FINE * scenario.duration) + 1) / (2 * _FINE)
    v, omega = _speeds(scenario.segments, instants)
    step = 1.0 / _FINE
    turned = step / 6 * (omega[:-2:2] + 4 * omega[1:-1:2] + omega[2::2])
    heading = np.concatenate([[0.0], np.cumsum(turned)])
    middle = heading[:-1] + step / 24 * (5 * omega[:-2:2] + 8 * omega[1:-1:2] - omega[2::2])
    ahead = step * v[1:-1:2]
    x, y = (np.concatenate([[0.0], np.cumsum(ahead * f(middle))]) for f in (np.cos, np.sin))
    v, omega = v[::2], omega[::2]
    forward = np.gradient(v, step)
    fine = np.column_stack([x, y, heading, v, omega, forward, v * omega])[::stride]
    pose, v, omega, acceleration = np.split(fine, (3, 4, 5), axis=1)
    return Truth(instants[:: 2 * stride], pose, v[:, 0], omega[:, 0], acceleration)


def _speeds(segments: tuple[Segment, ...], t: NDArray) -> tuple[NDArray, NDArray]:
    """Forward and turning speed at times t (n,), from rest."""
    v, omega = np.zeros_like(t), np.zeros_like(t)
    start, before = 0.0, Segment(0.0, 0.0, 0.0)
    for segment in segments:
        inside = (t >= start - 1e-9) & (t <= start + segment.duration + 1e-9)
        since = t[inside] - start
        share = np.clip(since / RAMP, 0.0, 1.0)
        share = share * share * (3 - 2 * share)
        v[inside] = before.v + share * (segment.v - before.v)
        swing = segment.wobble * np.sin(2 * pi * since / segment.period)
        omega[inside] = before.omega + share * (segment.omega - before.omega) + swing
        start, before = start + segment.duration, segment
    return v, omega


def _stride(rate: float) -> int:
    stride = round(_FINE / number(rate, "rate", "Hz", least=1, most=_FINE))
    if abs(stride * rate - _FINE) > 1e-9 * _FINE:
        raise ValueError(f"rate must divide {_FINE} Hz, such as 100, 50 or 20, got {rate!r}")
    return stride
