"""What turns the wheels of the slipping model: proportional control, or motors with digital PIDs.

Both bring vehicles forward by one sample with `advance(states, reference)`.
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


class WheelControl(NamedTuple):
    """How commands become torques of the wheels: the fields are those of `simulate`."""

    half_track: float | None = None
    motor: Motor | None = None
    gains: WheelGains | None = None
    driven: str = "all"


def check_control(model: str, control: WheelControl) -> None:
    """ValueError unless there is the model and it has the wheels to control."""
    if choice(model, "model", MODELS) != "slipping" and control != WheelControl():
        raise ValueError(
            f"the {model} model has no wheels that slip or take torque: half_track, motor, gains "
            'and driven go with model="slipping"'
        )
    choice(control.driven, "driven", DRIVEN)
    if control.motor is not None:
        instance(control.motor, "motor", Motor, "such as motor.ROVER")
    elif control.gains is not None:
        raise ValueError("gains are those of the motors' PIDs: give a motor as well")


def controlled_wheels(
    vehicles: Sequence[Vehicle], control: WheelControl, dt: float, tolerance: float
) -> ProportionalWheels | WheelMotors:
    """The wheels of n vehicles that get a command each dt [s]; `tolerance` as for `simulate`."""
    kind = ProportionalWheels if control.motor is None else WheelMotors
    return kind(vehicles, control, dt, tolerance)


class ProportionalWheels:
    """Torques K_ptau (reference - speed) on the driven wheels, (2.14), in place of motors."""

    def __init__(
        self, vehicles: Sequence[Vehicle], control: WheelControl, dt: float, tolerance: float
    ) -> None:
        from backhoe.vehicle.skid_steer import engine

        self._gain = np.array([[p.speed_gain] for p in vehicles]) * DRIVEN[control.driven]
        self._fleet, self._advance = engine.fleet(vehicles, self._gain), engine.advance
        self._dt, self._tolerance = dt, tolerance
        self._step = np.full(len(vehicles), dt)
        self.voltage = np.zeros((len(vehicles), 0))

    def advance(self, states: NDArray, reference: NDArray) -> None:
        """Bring states (n, 10) forward by dt in place, towards wheel speeds (n, 4)."""
        torque = self._gain * reference
        self._advance(states, torque, self._fleet, self._dt, self._step, self._tolerance)


class WheelMotors:
    """Motors and wheel PIDs of n vehicles, with `voltage` (n, 4) [V] of the last sample.

    The motor of the control is on every driven wheel; without gains they are those of
    `motor.tune_wheel` on the first vehicle's own load.

    Raises:
        ValueError: dt is no whole multiple of `WHEEL_PERIOD`, the period of the PIDs.
    """

    def __init__(
        self, vehicles: Sequence[Vehicle], control: WheelControl, dt: float, tolerance: float
    ) -> None:
        from backhoe.vehicle.skid_steer import engine

        self._periods = round(dt / WHEEL_PERIOD)
        if abs(self._periods * WHEEL_PERIOD - dt) > 1e-9 or not self._periods:
            raise ValueError(
                f"with motors dt must be a whole multiple of {WHEEL_PERIOD} s, the period of the "
                f"wheels' PIDs, got {dt!r}"
            )
        motor, gains, self._driven = control.motor, control.gains, np.array(DRIVEN[control.driven])
        if gains is None:
            gains = tune_wheel(motor, vehicle_load(vehicles[0], int(self._driven.sum())))
        self._pid = wheel_pid(motor, gains, wheels=4 * len(vehicles))
        self._torque_per_volt, self._tolerance = motor.torque_per_volt, tolerance
        losses, inertia = motor.damping * self._driven, motor.rotor_inertia * self._driven
        self._fleet, self._advance = engine.fleet(vehicles, losses, inertia), engine.advance
        self._step = np.full(len(vehicles), WHEEL_PERIOD)
        self.voltage = np.zeros((len(vehicles), 4))

    def advance(self, states: NDArray, reference: NDArray) -> None:
        """Bring states (n, 10) forward by dt in place, towards wheel speeds (n, 4)."""
        for _ in range(self._periods):
            output = self._pid(reference.ravel(), states[:, 6:].ravel())
            self.voltage = output.reshape(self.voltage.shape) * self._driven
            torque = self._torque_per_volt * self.voltage
            self._advance(states, torque, self._fleet, WHEEL_PERIOD, self._step, self._tolerance)
