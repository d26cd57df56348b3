"""A vehicle with four fixed wheels, or with tracks seen as such, in numbers: each once.

Axes: x forward, y left, z up, origin at the centre of mass. Wheels in the order front left, front
right, rear left, rear right, at (a, c), (a, -c), (-b, c), (-b, -c). SI units and radians.

`HUSKY` is a robot of the size that the source simulates; `PROVENANCE` says where each number comes
from. The excavator of this course as such a vehicle is `travel.BACKHOE_TRACKS`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import not_negative, number, positive
from backhoe.basics.named import named, shown_by_name

WHEELS = ("front left", "front right", "rear left", "rear right")

DRIVEN = {"all": (1.0, 1.0, 1.0, 1.0), "front": (1.0, 1.0, 0.0, 0.0)}
"""Which wheels have a motor, in the order of `WHEELS`."""

_MAY_BE_ZERO = ("clearance", "friction_longitudinal", "friction_lateral", "rolling", "lateral")


@shown_by_name
@dataclass(frozen=True)
class Vehicle:
    """One skid-steer vehicle; make a variant with `replace(HUSKY, mass=70.0)`.

    Attributes:
        mass: of the whole vehicle, wheels included, m [kg].
        inertia: of the whole about the vertical through the centre of mass, I [kg m^2].
        wheel_radius: r [m].
        half_track: from the middle plane to a wheel's contact, c [m].
        front, rear: from the centre of mass to the front and rear axle, a and b [m].
        wheel_mass, wheel_inertia, wheel_width: of one wheel [kg, kg m^2 about its axle, m].
        body_length, body_width, body_height: of the box that is the body [m].
        clearance: from the ground to the bottom of that box [m].
        friction_longitudinal, friction_lateral: Coulomb coefficients mu along and across a wheel.
        smoothing: k_s of the smooth Coulomb law (2.10) [s/m].
        rolling: K_x, resistance to rolling as a share of the weight per speed (2.13a) [s/m].
        lateral: K_y, the linear law (2.11) for lateral slip (2.13b) [s/m].
        speed_gain: K_ptau, torque of one wheel per error of its speed (2.14) [N m s/rad].
        x_icr: longitudinal coordinate of the instantaneous centre of rotation (2.5) [m].
        gravity: g [m/s^2].

    Raises:
        ValueError: a value is not a finite number, has the wrong sign, the wheels are heavier than
            the vehicle, or x_icr is not between the axles.
    """

    mass: float
    inertia: float
    wheel_radius: float
    half_track: float
    front: float
    rear: float
    wheel_mass: float
    wheel_inertia: float
    wheel_width: float
    body_length: float
    body_width: float
    body_height: float
    clearance: float
    friction_longitudinal: float
    friction_lateral: float
    smoothing: float
    rolling: float
    lateral: float
    speed_gain: float
    x_icr: float = 0.0
    gravity: float = 9.81

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            check = not_negative if name in _MAY_BE_ZERO else positive
            check = number if name == "x_icr" else check
            object.__setattr__(self, name, check(value, f"Vehicle.{name}"))
        if 4 * self.wheel_mass >= self.mass:
            raise ValueError(
                f"Vehicle.mass includes the wheels: 4 x {self.wheel_mass} kg leave nothing of "
                f"{self.mass} kg for the body"
            )
        if not -self.rear < self.x_icr < self.front:
            raise ValueError(
                f"Vehicle.x_icr must lie between the axles, in (-{self.rear}, {self.front}) m, got "
                f"{self.x_icr}: beyond them the vehicle slides away sideways (2.5)"
            )

    @property
    def body_mass(self) -> float:
        """Mass without the wheels [kg]."""
        return self.mass - 4 * self.wheel_mass

    @property
    def positions(self) -> NDArray:
        """Contact points of the wheels in the order of `WHEELS`, shape (4, 2) [m]."""
        a, b, c = self.front, self.rear, self.half_track
        return np.array([(a, c), (a, -c), (-b, c), (-b, -c)])

    @property
    def loads(self) -> NDArray:
        """Weight on each wheel from statics, shape (4,) [N]: equal if the axles are equally far."""
        weight = self.mass * self.gravity / (self.front + self.rear) / 2
        return weight * np.array([self.rear, self.rear, self.front, self.front])


HUSKY = named(
    "HUSKY",
    Vehicle(
        mass=56.582,
        inertia=3.679,
        wheel_radius=0.1651,
        half_track=0.2854,
        front=0.256,
        rear=0.256,
        wheel_mass=2.637,
        wheel_inertia=0.04411,
        wheel_width=0.1143,
        body_length=0.9874,
        body_width=0.4565,
        body_height=0.2475,
        clearance=0.13228,
        friction_longitudinal=0.2,
        friction_lateral=0.2,
        smoothing=100.0,
        rolling=0.0149,
        lateral=0.0702,
        speed_gain=8.0,
    ),
)

_PUBLIC = "public description of the Husky (ROS package husky_description)"
_SUM = "sum of body (46.034 kg, 2.0296 kg m^2) and four wheels, each with its distance: " + _PUBLIC
_MIDDLE = "half the wheelbase, 0.5120 m: " + _PUBLIC + "; centre of mass in the middle is ours"
_ERRORS = "ours: with speed_gain it gives the source's steady-state errors (section 2.3.3)"

PROVENANCE = {
    "mass": ("m", "kg", _SUM),
    "inertia": ("I", "kg m^2", _SUM),
    "wheel_radius": ("r", "m", _PUBLIC),
    "half_track": ("c", "m", "half the track, 0.5708 m: " + _PUBLIC),
    "front": ("a", "m", _MIDDLE),
    "rear": ("b", "m", _MIDDLE),
    "wheel_mass": ("", "kg", _PUBLIC),
    "wheel_inertia": ("J", "kg m^2", _PUBLIC + ", its value about the wheel's own axis"),
    "wheel_width": ("", "m", _PUBLIC),
    "body_length": ("", "m", _PUBLIC),
    "body_width": ("", "m", "what is free between the wheels: " + _PUBLIC),
    "body_height": ("", "m", _PUBLIC),
    "clearance": ("", "m", "wheel radius less the axle's height in the body: " + _PUBLIC),
    "friction_longitudinal": ("mu", "1", "D'Angelo 2022, section 4.1"),
    "friction_lateral": ("mu2", "1", "D'Angelo 2022, section 4.1"),
    "smoothing": ("k_s", "s/m", "ours: half of the friction at 1 cm/s of slip"),
    "rolling": ("K_x", "s/m", _ERRORS),
    "lateral": ("K_y", "s/m", _ERRORS),
    "speed_gain": ("K_ptau", "N m s/rad", "ours: the vehicle answers within 0.2 s"),
    "x_icr": ("x_ICR", "m", "D'Angelo 2022, hypothesis 6"),
    "gravity": ("g", "m/s^2", "ours: the source does not print it"),
}
"""Where each number of `HUSKY` comes from: symbol, unit, source."""
