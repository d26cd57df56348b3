"""A direct-current motor with its gearbox, and what it turns, in numbers.

Speeds, torques and inertias are those at the wheel, behind an ideal gearbox of ratio n, unless the
rotor is named: w_rotor = n w, T_wheel = n T_rotor, and the rotor's inertia counts n^2 J there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

from backhoe.basics.inputs import choice, not_negative, positive
from backhoe.basics.named import named, shown_by_name


@shown_by_name
@dataclass(frozen=True)
class Motor:
    """A motor and its gearbox.

    Attributes:
        resistance, inductance: R, L of the winding [ohm, H].
        torque_constant, back_emf: K_m, K_b [N m/A, V s/rad]: one number in SI units, if no iron
            losses count.
        inertia, friction: J, b of the rotor [kg m^2, N m s/rad].
        gear: n, rotor speed over wheel speed [1].
        voltage, power: rated [V, W].

    Raises:
        ValueError: a value is not a finite number, or not positive (friction may be 0).
    """

    resistance: float
    inductance: float
    torque_constant: float
    back_emf: float
    inertia: float
    friction: float
    gear: float
    voltage: float
    power: float

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            check = not_negative if name == "friction" else positive
            object.__setattr__(self, name, check(value, f"Motor.{name}"))

    @property
    def torque_per_volt(self) -> float:
        """Torque at the wheel of one volt at standstill, n K_m/R [N m/V]."""
        return self.gear * self.torque_constant / self.resistance

    @property
    def damping(self) -> float:
        """Torque at the wheel that speed costs, n^2 (b + K_m K_b/R) [N m s/rad]."""
        lost = self.torque_constant * self.back_emf / self.resistance
        return self.gear**2 * (self.friction + lost)

    @property
    def rotor_inertia(self) -> float:
        """Inertia of the rotor seen at the wheel, n^2 J [kg m^2]."""
        return self.gear**2 * self.inertia

    @property
    def no_load_speed(self) -> float:
        """Speed of the free wheel at the rated voltage [rad/s]."""
        return self.torque_per_volt * self.voltage / self.damping

    @property
    def electric_time_constant(self) -> float:
        """L/R [s]."""
        return self.inductance / self.resistance


WHEELCHAIR = named(
    "WHEELCHAIR",
    Motor(
        resistance=0.15,
        inductance=0.1e-3,
        torque_constant=0.055,
        back_emf=0.055,
        inertia=4.0e-4,
        friction=2.0e-4,
        gear=100.0,
        voltage=24.0,
        power=450.0,
    ),
)
"""The source's motor: 24 V, 450 W and n = 100 are its own, the rest is ours and usual for such a
motor: 4130 rpm without load, 160 A held, 80 % efficient at 450 W and 23 A."""

ROVER = named("ROVER", replace(WHEELCHAIR, gear=32.0))
"""The same motor with the gear of a wheelchair (ours): n = 100 lets a Husky reach 0.7 m/s only."""


@dataclass(frozen=True)
class Load:
    """What a motor turns: inertia [kg m^2] and viscous friction [N m s/rad], both at the wheel.

    Raises:
        ValueError: inertia or friction is negative, or not a finite number.
    """

    inertia: float
    friction: float = 0.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            object.__setattr__(self, name, not_negative(value, f"Load.{name}"))


class Wheeled(Protocol):
    """What a load is made of: the numbers of a `skid_steer.Vehicle` that count for one."""

    mass: float
    gravity: float
    rolling: float
    wheel_radius: float
    wheel_inertia: float


def hanging_wheel(vehicle: Wheeled) -> Load:
    """A wheel of the vehicle that touches nothing."""
    return Load(vehicle.wheel_inertia)


def vehicle_load(vehicle: Wheeled, driven: int = 4) -> Load:
    """A driven wheel's share of a vehicle that goes straight and does not slip.

    Args:
        vehicle: its mass, wheels and resistance to rolling count.
        driven: number of wheels with a motor.

    Raises:
        ValueError: driven is not 2 or 4.
    """
    choice(driven, "driven", (2, 4))
    r, p = vehicle.wheel_radius, vehicle
    return Load(
        (4 * p.wheel_inertia + p.mass * r**2) / driven,
        p.mass * p.gravity * p.rolling * r**2 / driven,
    )
