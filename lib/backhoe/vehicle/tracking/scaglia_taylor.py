"""Scaglia's tracker by Taylor series: D'Angelo 2022, section 6.2.1 and appendix 9.1.

The vehicle is taken to move for one sample T0 as it moves now (6.10), which cannot bring it to a
goal that is not straight ahead. So the speeds are those that make a cost J (6.12) least: k1 and k3
weigh the errors of position and heading, k2 and k4 what is spent. Setting the derivatives of J to
zero gives

    V = k_v^2 (dx cos(theta) + dy sin(theta)) / T0        k_v^2 = k1^2 / (k1^2 + k2^2 / T0^2)
    W = k_w^2 (theta_d - theta) / T0                       k_w^2 = k3^2 / (k3^2 + k4^2 / T0^2)

with theta_d = atan2(dy, dx), the direction of the goal. Printed in (6.13a) and (9.14a) is V with
theta_d in place of theta, a step that the source does not give a reason for: it is no minimum of J,
and drives on at full speed V = k_v^2 D / T0 however far the goal lies to the side or behind.

The weights matter through their ratio only: k^2 = 0.4 means k1^2 = k2^2 / (1.5 T0^2), so "10 times
heavier" is so for T0 = 0.258 s alone (`weight_ratio`).
"""

from __future__ import annotations

from math import atan2, cos, hypot, sin

from numpy.typing import ArrayLike

from backhoe.basics.angles import wrap
from backhoe.basics.inputs import number, positive
from backhoe.vehicle.tracking.protocol import Goal, situation

STILL = 1e-4
"""Closer to the goal than this [m] its direction is noise, and the heading is kept: atan2(0, 0)."""


class ScagliaTaylor:
    """Scaglia's tracker by Taylor series. It remembers nothing.

    Args:
        kv2, kw2: the gains k_v^2 and k_w^2, each above 0 and at most 1; the source takes 0.4.
        optimum: take theta in V, the minimum of J; otherwise theta_d as in (6.13a).
        period: sample time T0 that `follow` shall call it with [s]; None: the plant's.

    Raises:
        ValueError: a gain outside (0, 1], a period that is not positive.
    """

    def __init__(
        self,
        kv2: float = 0.4,
        kw2: float = 0.4,
        *,
        optimum: bool = False,
        period: float | None = None,
    ) -> None:
        self.kv2 = number(kv2, "kv2", above=0.0, most=1.0)
        self.kw2 = number(kw2, "kw2", above=0.0, most=1.0)
        self.optimum = optimum
        self.period = None if period is None else positive(period, "period", "s")

    def __call__(
        self, pose: ArrayLike, twist: ArrayLike, goal: Goal, dt: float
    ) -> tuple[float, float]:
        """v, omega [m/s, rad/s] for one sample; see `protocol.Tracker`."""
        now = situation(pose, twist, goal)
        if hypot(now.dx, now.dy) < STILL:
            return 0.0, 0.0
        theta_d = atan2(now.dy, now.dx)
        along = now.theta if self.optimum else theta_d
        V = self.kv2 * (now.dx * cos(along) + now.dy * sin(along)) / dt
        W = self.kw2 * wrap(theta_d - now.theta) / dt
        return V, W


def weight_ratio(k2: float, T0: float) -> float:
    """The ratio k1^2/k2^2 (or k3^2/k4^2) that a gain k^2 stands for: k^2 / ((1 - k^2) T0^2).

    Source: D'Angelo 2022, eq. (6.14) solved for the ratio.

    Args:
        k2: k_v^2 or k_w^2, above 0 and below 1.
        T0: sample time [s].

    Returns:
        The ratio [1/s^2].

    Raises:
        ValueError: k2 outside (0, 1), where 1 would be an infinite ratio; T0 not positive.
    """
    k2 = number(k2, "k2", above=0.0, below=1.0)
    return k2 / ((1 - k2) * positive(T0, "T0", "s") ** 2)
