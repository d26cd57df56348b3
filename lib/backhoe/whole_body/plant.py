"""A robot that only moves: the model that controllers by linear equations are made for.

Drives follow their wanted velocities with time constants, x' = (wanted - x) / lag, or at once where
that is 0. Then the platform moves along its heading, and nothing slips. Wanted velocities are held
for a step, so speeds and angles are known in closed form; the way of the platform is the integral
of u (cos theta, sin theta), by Gauss's rule.
"""

from __future__ import annotations

from math import ceil

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive
from backhoe.whole_body.robots import BACKHOE, Robot, posture

_AT, _WEIGHT = np.polynomial.legendre.leggauss(6)
_AT, _WEIGHT = (_AT + 1) / 2, _WEIGHT / 2

LONGEST = 1e4
"""What a lag may be at most [s]: longer ones would let the robot coast out of all numbers."""

_TURN, _SHARE = 0.5, 1.0
"""Largest turn [rad] and largest share of the platform's lag in one piece of Gauss's rule."""


class KinematicPlant:
    """A robot in the plane without slip and inertia, moved exactly from step to step.

    Args:
        robot: `BACKHOE`, `SLIDES` or one of your own.
        q: posture at the start as for `hand`, shape (3 + joints,) [m, m, rad, ...].
        dt: how long velocities are held [s].
        lag: time constants of the drives, shape () or (2 + joints,), 0 or more [s].
        fastest: what each drive can give, shape (2 + joints,), positive [m/s, rad/s]; no limits if
            None.

    Attributes:
        q, v: where it is and the velocities that it has, shapes (3 + joints,) and (2 + joints,).
        time: [s].

    Raises:
        ValueError: q or a number is malformed.
        TypeError: robot is none.
    """

    def __init__(
        self,
        robot: Robot = BACKHOE,
        q: ArrayLike | None = None,
        *,
        dt: float = 0.1,
        lag: ArrayLike = 0.0,
        fastest: ArrayLike | None = None,
    ) -> None:
        self.robot, self.dt = robot, positive(dt, "dt", "s")
        self._start = posture(np.zeros(3 + robot.joints) if q is None else q, robot).copy()
        self.lag = lags(lag, robot)
        limits = np.full(2 + robot.joints, np.inf) if fastest is None else fastest
        self.fastest = numbers(limits, "fastest", self.lag.shape, finite=False)
        if not (self.fastest > 0).all():
            raise ValueError(f"fastest must be positive, got {self.fastest.min()}")
        self.reset()

    def reset(self) -> None:
        """Back to the start, at rest, at time 0."""
        self.q, self.v, self.time = self._start.copy(), np.zeros(self.lag.size), 0.0

    def step(self, v: ArrayLike) -> None:
        """Go on for dt with wanted velocities.

        Args:
            v: u, omega and the joints' speeds, shape (2 + joints,) [m/s, rad/s].

        Raises:
            ValueError: not so many finite numbers.
        """
        v = numbers(v, "v", self.lag.shape, meaning="u, omega and the joints' speeds")
        v = np.clip(v, -self.fastest, self.fastest)
        self.q, self.v = moved(self.q, self.v, v, self.lag, self.dt)
        self.time += self.dt


def moved(
    q: NDArray, v: NDArray, wanted: NDArray, lag: NDArray, time: float
) -> tuple[NDArray, NDArray]:
    """Posture and velocities after some time with constant wanted velocities.

    Args:
        q, v: at first, shapes (3 + joints,) and (2 + joints,) [m, m, rad, ...; m/s, rad/s, ...].
        wanted: shape (2 + joints,), [m/s, rad/s].
        lag: as in `KinematicPlant`, shape (2 + joints,) [s].
        time: [s].

    Returns:
        Shapes of q and v.
    """
    turn = max(abs(v[1]), abs(wanted[1])) * time
    drives = [time / constant for constant in lag[:2] if 0 < constant]
    pieces = min(ceil(max([turn / _TURN, *(x / _SHARE for x in drives), 1.0])), 100)
    t = ((np.arange(pieces)[:, None] + _AT) * (time / pieces)).ravel()
    speed, way = _answer(v[:2], wanted[:2], lag[:2], t[:, None])
    heading, weight = q[2] + way[:, 1], np.tile(_WEIGHT, pieces) * (time / pieces)
    now, gone = _answer(v, wanted, lag, np.array([time]))
    ahead = weight * speed[:, 0]
    return q + np.array([ahead @ np.cos(heading), ahead @ np.sin(heading), *gone[1:]]), now


def lags(lag: ArrayLike, robot: Robot) -> NDArray:
    """Time constants checked, one a velocity of the robot, shape (2 + joints,) [s].

    Raises:
        ValueError: neither one number nor one a velocity, or one negative, too long, not finite.
    """
    lag = numbers(lag, "lag", within=LONGEST)
    if lag.ndim == 0:
        lag = np.full(2 + robot.joints, lag)
    lag = numbers(lag, "lag", (2 + robot.joints,), meaning="one time, or one a velocity")
    if (lag < 0).any():
        raise ValueError(f"lag must be 0 s or more, got {lag.min()}")
    return lag


def _answer(v: NDArray, wanted: NDArray, lag: NDArray, t: NDArray) -> tuple[NDArray, NDArray]:
    """Speeds after times t, and the way until then: their integral."""
    time = np.where(lag > 0, lag, 1.0)
    left = np.where(lag > 0, np.exp(-t / time), 0.0)
    gone = np.where(lag > 0, -time * np.expm1(-t / time), 0.0)
    return wanted + left * (v - wanted), wanted * t + gone * (v - wanted)
