"""Speeds that a vehicle can drive, turning before driving: D'Angelo 2022, section 5.1.

The wheels turn at most at omega_max. Within that the source gives the turn what it asks for and
the drive what is left, so that curves stay as tight as ordered and get slower:

    |omega| <= r/c omega_max        |v| <= r omega_max - c |omega|
"""

from __future__ import annotations

from dataclasses import dataclass

from backhoe.basics.inputs import positive
from backhoe.machine import BACKHOE, Machine


@dataclass(frozen=True)
class Limits:
    """What the wheels of a vehicle allow.

    Args:
        wheel_speed: largest speed of a wheel, omega_max [rad/s].
        wheel_radius: r [m].
        half_track: from the middle of the vehicle to its wheels, c [m].

    Raises:
        ValueError: one of them is not a positive number.
    """

    wheel_speed: float
    wheel_radius: float
    half_track: float

    def __post_init__(self) -> None:
        for name, unit in (("wheel_speed", "rad/s"), ("wheel_radius", "m"), ("half_track", "m")):
            object.__setattr__(self, name, positive(getattr(self, name), name, unit))

    @classmethod
    def of(cls, vehicle: object, max_speed: float) -> Limits:
        """Limits of a `skid_steer.Vehicle` whose wheels reach `max_speed` at the ground [m/s]."""
        max_speed = positive(max_speed, "max_speed", "m/s")
        return cls(max_speed / vehicle.wheel_radius, vehicle.wheel_radius, vehicle.half_track)

    @classmethod
    def of_tracks(cls, machine: Machine = BACKHOE) -> Limits:
        """Limits of the tracks of a `machine.Machine`, the backhoe unless told."""
        tracks = machine.tracks
        return cls(
            tracks.max_speed / tracks.sprocket_radius, tracks.sprocket_radius, tracks.gauge / 2
        )

    @property
    def max_speed(self) -> float:
        """Largest forward speed, when driving straight [m/s]."""
        return self.wheel_speed * self.wheel_radius

    @property
    def max_turn_rate(self) -> float:
        """Largest turning speed, when turning on the spot [rad/s]."""
        return self.max_speed / self.half_track

    def apply(self, v: float, omega: float) -> tuple[float, float]:
        """The nearest speeds that the wheels can do, turning first.

        Args:
            v, omega: wanted forward and turning speed [m/s, rad/s].

        Returns:
            v, omega [m/s, rad/s]: omega cut to its limit, then v to what is left of the wheels.
        """
        most = self.max_turn_rate
        omega = min(max(omega, -most), most)
        left = max(self.max_speed - self.half_track * abs(omega), 0.0)
        return min(max(v, -left), left), omega
