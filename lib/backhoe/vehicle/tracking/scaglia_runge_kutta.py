"""Scaglia's tracker by Runge-Kutta: D'Angelo 2022, eqs. (6.8) and (7.1), and its repair.

A sample is integrated with the rates at its start, where the vehicle drives V_n, and at its end,
where it shall drive V. With weight w for the end, and 1 - w for the start,

    dx = T0 ((1 - w) V_n cos(theta_n) + w V cos(theta_d)),  dy likewise with sin

so that (V cos(theta_d), V sin(theta_d)) = (dx, dy) / (w T0) - (1 - w)/w V_n (cos, sin)(theta_n).
With k_v on the first term and w = 1/2, the trapezoid of (6.8), this is (7.1) as printed:

    V = k_v 2/T0 (dx cos(theta_d) + dy sin(theta_d)) - V_n cos(theta_d - theta_n)
    W = k_w (2/T0 (theta_d - theta_n) - W_n)

The trapezoid rings: an error e of the speed asks for -e in the next sample and for e in the one
after, whatever k_v is. Its factor is -(1 - w)/w, which is -1 for w = 1/2: the mode that the
trapezoid rule (Crank and Nicolson's) is known for, and cured as there, by giving the end more
weight. `speed_modes` has the eigenvalues. w = 1 is the implicit Euler rule, without V_n at all.

That is for a speed that ramps, as (6.8) supposes. Where the order is held instead, (7.1a) is
unstable for every k_v. (7.1b) multiplies W_n by k_w as well, which is calm on a ramp; held, its
factors are the roots of l^2 - (1 - 3 k_w) l - k_w = 0, one of them exactly -1 at the printed
k_w = 1/2: turning on the spot, the vehicle swings for ever.

Where the wanted speed points backwards, (7.1c) turns the vehicle round, and a step too fast makes
it spin. The repaired tracker brakes instead: it takes theta_d the other way and V negative.
"""

from __future__ import annotations

from math import atan2, cos, exp, hypot, pi, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import wrap
from backhoe.basics.inputs import choice, not_negative, number, positive
from backhoe.vehicle.tracking.protocol import Goal, situation
from backhoe.vehicle.tracking.scaglia_taylor import STILL


class ScagliaRungeKutta:
    """Scaglia's tracker by two-stage Runge-Kutta. It remembers nothing: V_n, W_n are measured.

    Args:
        kv, kw: gains of (7.1), each above 0 and at most 1; the source's code has 0.4 and 0.5.
        weight: w of the new speeds, from 1/2 (as printed: rings or grows) to 1.
        brake: drive backwards rather than turn round where the wanted speed points backwards;
            False as printed.
        period: sample time T0 that `follow` shall call it with [s]; None: the plant's.

    Raises:
        ValueError: a gain outside (0, 1], a weight outside [1/2, 1], a period that is not positive.
    """

    def __init__(
        self,
        kv: float = 0.4,
        kw: float = 0.5,
        *,
        weight: float = 0.75,
        brake: bool = True,
        period: float | None = None,
    ) -> None:
        self.kv = number(kv, "kv", above=0.0, most=1.0)
        self.kw = number(kw, "kw", above=0.0, most=1.0)
        self.weight, self.brake = number(weight, "weight", least=0.5, most=1.0), brake
        self.period = None if period is None else positive(period, "period", "s")

    @classmethod
    def printed(
        cls, kv: float = 0.4, kw: float = 0.5, *, period: float | None = None
    ) -> ScagliaRungeKutta:
        """The tracker of (7.1) as printed, undamped mode included."""
        return cls(kv, kw, weight=0.5, brake=False, period=period)

    def __call__(
        self, pose: ArrayLike, twist: ArrayLike, goal: Goal, dt: float
    ) -> tuple[float, float]:
        """v, omega [m/s, rad/s] for one sample; see `protocol.Tracker`."""
        now = situation(pose, twist, goal)
        ahead, memory = self.kv / (self.weight * dt), (1 - self.weight) / self.weight
        ux = ahead * now.dx - memory * now.v * cos(now.theta)
        uy = ahead * now.dy - memory * now.v * sin(now.theta)
        V = hypot(ux, uy)
        turn = wrap(atan2(uy, ux) - now.theta) if V * dt >= STILL else 0.0
        if self.brake and abs(turn) > pi / 2:
            V, turn = -V, wrap(turn + pi)
        return V, self.kw * (turn / (self.weight * dt) - memory * now.omega)


def speed_modes(
    kv: float, weight: float = 0.5, *, motion: str = "held", lag: float = 0.0
) -> NDArray:
    """Eigenvalues, from sample to sample, of speed and lag along a straight trajectory.

    The state is (e, V T0), with e how far the vehicle is behind. The tracker gives
    U T0 = k_v/w (e + L) - (1 - w)/w V T0, L the way of one sample.

    Args:
        kv: gain k_v, above 0 and at most 1.
        weight: w, from 1/2 (as printed) to 1.
        motion: "ramp": the speed changes evenly from V_n to U during the sample, as (6.8)
            supposes; "held": the vehicle is given U during the sample, as a computer gives it.
        lag: of "held", time constant of the vehicle's speed in samples, tau/T0; 0 obeys at once.

    Returns:
        Two eigenvalues, complex, shape (2,) [1], the largest modulus first. Below 1 it dies away.

    Raises:
        ValueError: gain, weight or lag out of range, another word for motion.
    """
    kv = number(kv, "kv", above=0.0, most=1.0)
    w, lag = number(weight, "weight", least=0.5, most=1.0), not_negative(lag, "lag", "samples")
    if choice(motion, "motion", ("ramp", "held")) == "ramp" and lag:
        raise ValueError(f'lag must be 0 with "ramp", got {lag}')
    command = np.array([kv / w, -(1 - w) / w])
    state = np.array([0.0, 1.0])
    if motion == "ramp":
        speed, way = command, (state + command) / 2
    else:
        keeps = exp(-1 / lag) if lag else 0.0
        speed = keeps * state + (1 - keeps) * command
        way = command + lag * (1 - keeps) * (state - command)
    modes = np.linalg.eigvals(np.array([np.array([1.0, 0.0]) - way, speed])).astype(complex)
    return modes[np.argsort(-np.abs(modes))]
