"""Scaglia's tracker by linear interpolation: D'Angelo 2022, eqs. (6.5) to (6.7).

The source gives the method and leaves out its result for the vehicle; this is our derivation. With
theta on a straight line between the samples (6.5), theta(s) = theta + W s, the integrals (6.7) are

    dx = V int_0^T0 cos(theta + W s) ds = V T0 sin(h)/h cos(theta + h)
    dy = V int_0^T0 sin(theta + W s) ds = V T0 sin(h)/h sin(theta + h)        h = W T0 / 2

The chord to the goal lies h to the left of the heading, so h = atan2(dy, dx) - theta, and

    W = 2 h / T0        V = D h / (T0 sin(h))        D = sqrt(dx^2 + dy^2)

A unicycle turns at a constant rate while W is held, so (6.5) is no approximation of it: one sample
ends exactly on the goal. The heading there is as far beyond the chord as it was short of it, and
swings to and fro for ever. Gains k_v, k_w below 1 damp that, as they do for the Taylor series.

A goal behind the vehicle is driven to backwards, with the chord turned by half a turn: |h| never
exceeds pi/2 and V stays below pi/2 D/T0, where it would grow beyond bounds as h goes to pi.
"""

from __future__ import annotations

from math import atan2, hypot, pi, sin

from numpy.typing import ArrayLike

from backhoe.basics.angles import wrap
from backhoe.basics.inputs import number, positive
from backhoe.vehicle.tracking.protocol import Goal, situation
from backhoe.vehicle.tracking.scaglia_taylor import STILL


class ScagliaLinear:
    """Scaglia's tracker by linear interpolation. It remembers nothing.

    Args:
        kv, kw: gains of V and W, each above 0 and at most 1; 1 and 1 end every sample on the goal.
        period: sample time T0 that `follow` shall call it with [s]; None: the plant's.

    Raises:
        ValueError: a gain outside (0, 1], a period that is not positive.
    """

    def __init__(self, kv: float = 0.4, kw: float = 0.4, *, period: float | None = None) -> None:
        self.kv = number(kv, "kv", above=0.0, most=1.0)
        self.kw = number(kw, "kw", above=0.0, most=1.0)
        self.period = None if period is None else positive(period, "period", "s")

    def __call__(
        self, pose: ArrayLike, twist: ArrayLike, goal: Goal, dt: float
    ) -> tuple[float, float]:
        """v, omega [m/s, rad/s] for one sample; see `protocol.Tracker`."""
        now = situation(pose, twist, goal)
        D = hypot(now.dx, now.dy)
        if D < STILL:
            return 0.0, 0.0
        h = wrap(atan2(now.dy, now.dx) - now.theta)
        if abs(h) > pi / 2:
            h, D = wrap(h + pi), -D
        V = D / dt * (h / sin(h) if h else 1.0)
        return self.kv * V, self.kw * 2 * h / dt
