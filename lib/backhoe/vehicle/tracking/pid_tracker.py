"""Three PIDs that drive to way-points: D'Angelo 2022, section 5.1.

v is the output of a PID on rho; omega is the sum of a PID on dy and a PID on alpha, the latter
only within rho_alpha of the way-point. Each PID has its own limits and anti-windup; the sum is
limited again, turning first.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple

from numpy.typing import ArrayLike

from backhoe.arm.pid import DigitalPID
from backhoe.vehicle.tracking.limits import Limits
from backhoe.vehicle.tracking.pose_error import errors_in_floats
from backhoe.vehicle.tracking.protocol import Goal, _floats, situation


class LoopGains(NamedTuple):
    """kp, ki [1/s] and kd [s] of one loop, per m or rad of error; ki and kd may be left out."""

    kp: float
    ki: float = 0.0
    kd: float = 0.0


class PIDTracker:
    """Position control by three PIDs.

    Args:
        rho: gains kp, ki, kd from distance to speed [1/s, 1/s^2, 1].
        dy: gains from lateral error to turning speed [rad/(m s), rad/(m s^2), rad/m].
        alpha: gains from angle to turning speed [1/s, 1/s^2, 1].
        rho_alpha: alpha counts within this distance of the way-point [m].
        limits: of the vehicle, for the PIDs' anti-windup; None: no limits.
        reset_at_waypoints: forget the integrals at each new way-point, as Code 5.2 does (5.1
            does not). There are no way-points in trajectory mode.

    Raises:
        ValueError: gains that are not up to three numbers, negative or not finite; a rho_alpha
            that is negative.
    """

    def __init__(
        self,
        rho: ArrayLike = (1.0,),
        dy: ArrayLike = (4.0,),
        alpha: ArrayLike = (1.0,),
        *,
        rho_alpha: float = 0.4,
        limits: Limits | None = None,
        reset_at_waypoints: bool = False,
    ) -> None:
        self.rho, self.dy, self.alpha = (
            _gains(name, gains) for name, gains in (("rho", rho), ("dy", dy), ("alpha", alpha))
        )
        if not rho_alpha >= 0:
            raise ValueError(f"rho_alpha must be a distance, 0 or more [m], got {rho_alpha!r}")
        self.rho_alpha = float(rho_alpha)
        self.limits = limits
        self.reset_at_waypoints = reset_at_waypoints
        self.reset()

    def reset(self) -> None:
        """Forget the integrals, and the sample time that they go with."""
        self._loops: tuple[DigitalPID, DigitalPID, DigitalPID] | None = None
        self._dt: float | None = None
        self._waypoint: int | None = None

    def __call__(
        self, pose: ArrayLike, twist: ArrayLike, goal: Goal, dt: float
    ) -> tuple[float, float]:
        """v, omega [m/s, rad/s] for one sample; see `protocol.Tracker`."""
        now = situation(pose, twist, goal)
        here = _floats(goal.position, 2, "goal.position must be x, y")
        after = _floats(goal.next_position, 2, "goal.next_position must be x, y")
        errors = errors_in_floats(now.dx, now.dy, now.theta, after[0] - here[0], after[1] - here[1])
        drive, turn, align = self._ready(goal, dt)
        v = drive(errors.rho, 0.0)
        near = errors.rho <= self.rho_alpha
        omega = turn(errors.dy, 0.0) + (align(errors.alpha, 0.0) if near else 0.0)
        return (v, omega) if self.limits is None else self.limits.apply(v, omega)

    def _ready(self, goal: Goal, dt: float) -> tuple[DigitalPID, DigitalPID, DigitalPID]:
        if self._loops is None:
            self._loops, self._dt = self._build(dt), dt
        elif dt != self._dt:
            raise ValueError(
                f"the sample time changed from {self._dt} s to {dt} s: "
                "call reset() before a new run"
            )
        if goal.waypoint != self._waypoint:
            if self.reset_at_waypoints:
                for loop in self._loops:
                    loop.reset()
            self._waypoint = goal.waypoint
        return self._loops

    def _build(self, dt: float) -> tuple[DigitalPID, DigitalPID, DigitalPID]:
        speed, rate = (
            (inf, inf)
            if self.limits is None
            else (self.limits.max_speed, self.limits.max_turn_rate)
        )
        return tuple(
            DigitalPID(*gains, dt, limits=(-most, most), derivative_of="error")
            for gains, most in ((self.rho, speed), (self.dy, rate), (self.alpha, rate))
        )


def _gains(name: str, gains: ArrayLike) -> LoopGains:
    try:
        loop = LoopGains(*(float(gain) for gain in gains))
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} must be kp, ki, kd or fewer, got {gains!r}") from error
    if not all(0 <= gain < inf for gain in loop):
        raise ValueError(f"{name} must be gains kp, ki, kd, finite and not negative, got {gains!r}")
    return loop
