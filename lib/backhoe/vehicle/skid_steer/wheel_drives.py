"""What turns the wheels of the slipping model: proportional control, or motors with digital PIDs.

Both bring vehicles forward by one sample with `advance(states, reference, tolerance)`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import choice, instance
from backhoe.vehicle.motor import (
    WHEEL_PERIOD,
    Motor,
    WheelGains,
    tune_wheel,
    vehicle_load,
    wheel_pid,
)
from backhoe.vehicle.skid_steer.vehicle import DRIVEN, Vehicle

MODELS = ("kinematic", "linear", "slipping")


class Drive(NamedTuple):
    """How commands become torques of the wheels: the fields are those of `simulate`."""

    half_track: float | None = None
    motor: Motor | None = None
    gains: WheelGains | None = None
    driven: str = "all"


def check_drive(model: str, drive: Drive) -> None:
    """ValueError unless there is the model and it has what the drive asks for."""
    if choice(model, "model", MODELS) != "slipping" and drive != Drive():
        raise ValueError(
            f"the {model} model has no wheels that slip or take torque: half_track, motor, gains "
            'and driven go with model="slipping"'
        )
    choice(drive.driven, "driven", DRIVEN)
    if drive.motor is not None:
        instance(drive.motor, "motor", Motor, "such as motor.ROVER")
    elif drive.gains is not None:
        raise ValueError("gains are those of the motors' PIDs: give a motor as well")


def wheel_drives(
    vehicles: Sequence[Vehicle], drive: Drive, dt: float
) -> ProportionalWheels | WheelMotors:
    """The drives of some vehicles that get a command each dt [s]."""
    kind = ProportionalWheels if drive.motor is None else WheelMotors
    return kind(vehicles, drive, dt)


class ProportionalWheels:
    """Torques K_ptau (reference - speed) on the driven wheels, (2.14); arguments as below."""

    def __init__(self, vehicles: Sequence[Vehicle], drive: Drive, dt: float) -> None:
        from backhoe.vehicle.skid_steer import engine

        self._gain = np.array([[p.speed_gain] for p in vehicles]) * DRIVEN[drive.driven]
        self._fleet, self._advance = engine.fleet(vehicles, self._gain), engine.advance
        self._dt, self._step = dt, np.full(len(vehicles), dt)

    def advance(self, states: NDArray, reference: NDArray, tolerance: float) -> None:
        """Bring states (n, 10) forward by dt in place, towards wheel speeds (n, 4)."""
        torque = self._gain * reference
        self._advance(states, torque, self._fleet, self._dt, self._step, tolerance)


class WheelMotors:
    """Motors and wheel PIDs of some vehicles, with `voltage` (n, 4) [V] of the last sample.

    Args:
        vehicles: n of them.
        drive: its motor is on every driven wheel; without gains those of `motor.tune_wheel` on the
            first vehicle's own load.
        dt: time between commands [s], a whole multiple of `WHEEL_PERIOD`.

    Raises:
        ValueError: dt is no multiple of the period of the PIDs.
    """

    def __init__(self, vehicles: Sequence[Vehicle], drive: Drive, dt: float) -> None:
        from backhoe.vehicle.skid_steer import engine

        self._periods = round(dt / WHEEL_PERIOD)
        if abs(self._periods * WHEEL_PERIOD - dt) > 1e-9 or not self._periods:
            raise ValueError(
                f"with motors dt must be a whole multiple of {WHEEL_PERIOD} s, the period of the "
                f"wheels' PIDs, got {dt!r}"
            )
        motor, self._driven = drive.motor, np.array(DRIVEN[drive.driven])
        gains = drive.gains
        if gains is None:
            gains = tune_wheel(motor, vehicle_load(vehicles[0], int(self._driven.sum())))
        self._pid = wheel_pid(motor, gains, wheels=4 * len(vehicles))
        self._torque_per_volt = motor.torque_per_volt
        losses, inertia = motor.damping * self._driven, motor.rotor_inertia * self._driven
        self._fleet, self._advance = engine.fleet(vehicles, losses, inertia), engine.advance
        self._step = np.full(len(vehicles), WHEEL_PERIOD)
        self.voltage = np.zeros((len(vehicles), 4))

    def advance(self, states: NDArray, reference: NDArray, tolerance: float) -> None:
        """Bring states (n, 10) forward by dt in place, towards wheel speeds (n, 4)."""
        for _ in range(self._periods):
            output = self._pid(reference.ravel(), states[:, 6:].ravel())
            self.voltage = output.reshape(self.voltage.shape) * self._driven
            torque = self._torque_per_volt * self.voltage
            self._advance(states, torque, self._fleet, WHEEL_PERIOD, self._step, tolerance)
