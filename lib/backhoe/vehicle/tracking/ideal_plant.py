"""The plant that trackers are derived for: a unicycle that does what it is told, at once."""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive


def arc(pose: ArrayLike, v: float, omega: float, time: float) -> NDArray:
    """Pose after driving with constant speeds: an arc of a circle, exactly.

    The chord is v T sin(h)/h long, with h = omega T / 2, and lies h to the left of the heading.

    Args:
        pose: x, y, heading, shape (3,) [m, m, rad].
        v, omega: forward and turning speed [m/s, rad/s].
        time: how long, T [s].

    Returns:
        Shape (3,) [m, m, rad], the heading not wrapped.
    """
    x, y, theta = numbers(pose, "pose", (3,), meaning="x, y, heading").tolist()
    half = omega * time / 2
    chord = v * time * (sin(half) / half if half else 1.0)
    return np.array(
        [x + chord * cos(theta + half), y + chord * sin(theta + half), theta + 2 * half]
    )


class IdealPlant:
    """A unicycle without slip, inertia or limits, moved exactly from sample to sample.

    Args:
        dt: sample time [s].
        pose: x, y, heading at the start, shape (3,) [m, m, rad].

    Raises:
        ValueError: dt is not positive, or pose not three finite numbers.
    """

    def __init__(self, dt: float = 0.02, pose: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        self.dt = positive(dt, "dt", "s")
        self._start = numbers(pose, "pose", (3,), meaning="x, y, heading").copy()
        self.reset()

    def reset(self) -> None:
        """Back to the start, at rest, at time 0."""
        self.pose, self.twist, self.time = self._start.copy(), np.zeros(2), 0.0

    def step(self, v: float, omega: float) -> None:
        """Drive for dt seconds with v [m/s] and omega [rad/s]."""
        self.pose = arc(self.pose, v, omega, self.dt)
        self.twist = np.array([v, omega])
        self.time += self.dt
