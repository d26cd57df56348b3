"""Three PIDs that drive to way-points: D'Angelo 2022, section 5.1.

v is the output of a PID on rho; omega is the sum of a PID on dy and a PID on alpha, the latter
only within rho_alpha of the way-point. Each PID has its own limits and anti-windup; the sum is
limited again, turning first.
"""

from __future__ import annotations

from math import inf

from numpy.typing import ArrayLike

from backhoe.arm.pid import DigitalPID
from backhoe.basics.inputs import not_negative, numbers
from backhoe.vehicle.tracking.limits import Limits
from backhoe.vehicle.tracking.pose_error import pose_errors
from backhoe.vehicle.tracking.protocol import Goal


class PIDTracker:
    """Position control by three PIDs.

    Args:
        rho: gains kp, ki, kd, or the first of them, from distance to speed, shape (1,) to (3,)
            [1/s, 1/s^2, 1].
        dy: the same from lateral error to turning speed [rad/(m s), rad/(m s^2), rad/m].
        alpha: the same from angle to turning speed [1/s, 1/s^2, 1].
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
            _gains(gains, name) for name, gains in (("rho", rho), ("dy", dy), ("alpha", alpha))
        )
        self.rho_alpha = not_negative(rho_alpha, "rho_alpha", "m")
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
        numbers(twist, "twist", (2,), meaning="v, omega")
        errors = pose_errors(pose, goal.position, goal.next_position)
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


def _gains(gains: ArrayLike, name: str) -> tuple[float, float, float]:
    """kp, ki, kd; those that are left out are 0."""
    wanted = "gains kp, ki, kd or fewer"
    given = [not_negative(gain, name) for gain in numbers(gains, name, ("n",), meaning=wanted)]
    if len(given) > 3:
        raise ValueError(f"{name} must be {wanted}, got {len(given)}")
    return (*given, 0.0, 0.0)[:3]
