"""The slipping model driven by motors, each wheel's speed controlled by a digital PID."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from backhoe.vehicle.motor import (
    WHEEL_PERIOD,
    Motor,
    WheelGains,
    tune_wheel,
    vehicle_load,
    wheel_pid,
)
from backhoe.vehicle.skid_steer.kinematics import half_track_of
from backhoe.vehicle.skid_steer.vehicle import DRIVEN, Vehicle


class Drives:
    """Motors and wheel PIDs of some vehicles.

    Args:
        vehicles: any number of them.
        motor: the same on every driven wheel.
        gains: of the PIDs, or None for `motor.tune_wheel` on the first vehicle's own load.
        driven: "all" or "front".
        dt: time between commands [s], a whole multiple of `WHEEL_PERIOD`.

    Raises:
        ValueError: driven is no such choice, or dt is no multiple of the period of the PIDs.
    """

    def __init__(
        self,
        vehicles: Sequence[Vehicle],
        motor: Motor,
        gains: WheelGains | None,
        driven: str,
        dt: float,
    ) -> None:
        from backhoe.vehicle.skid_steer import kernels

        if driven not in DRIVEN:
            raise ValueError(f"driven must be one of {', '.join(DRIVEN)}, got {driven!r}")
        self.periods = round(dt / WHEEL_PERIOD)
        if abs(self.periods * WHEEL_PERIOD - dt) > 1e-9 or not self.periods:
            raise ValueError(
                f"with motors dt must be a whole multiple of {WHEEL_PERIOD} s, the period of the "
                f"wheels' PIDs, got {dt!r}"
            )
        self.driven = np.array(DRIVEN[driven])
        if gains is None:
            gains = tune_wheel(motor, vehicle_load(vehicles[0], int(self.driven.sum())))
        self.shape = (len(vehicles), 4)
        self.pid = wheel_pid(motor, gains, wheels=4 * len(vehicles))
        self.torque_per_volt = motor.torque_per_volt * self.driven
        losses, inertia = motor.damping * self.driven, motor.rotor_inertia * self.driven
        self.record = kernels.record(vehicles, losses, inertia)
        self._advance_all = kernels.advance_all
        self.step_length = np.full((len(vehicles), 1), WHEEL_PERIOD)
        self.voltage = np.zeros(self.shape)

    def advance(self, states: NDArray, reference: NDArray, tolerance: float) -> None:
        """Bring states (runs, 10) forward by dt in place, towards wheel speeds (runs, 4)."""
        for _ in range(self.periods):
            output = self.pid(reference.ravel(), states[:, 6:].ravel())
            self.voltage = output.reshape(self.shape) * self.driven
            drive = self.torque_per_volt * self.voltage
            self._advance_all(states, drive, self.record, WHEEL_PERIOD, self.step_length, tolerance)


def drive_block(dt, every, tolerance, half_track, motor, gains, driven):
    """The function that `simulation` runs on each block of runs; logs 10 states and 4 voltages."""

    def block(u: NDArray, vehicles: Sequence[Vehicle], first: NDArray) -> NDArray:
        drives = Drives(vehicles, motor, gains, driven, dt)
        states = np.zeros((len(vehicles), 10))
        states[:, :3] = first
        reference = wheel_references(u, vehicles, half_track)
        log = np.zeros((len(vehicles), u.shape[-1] // every + 1, 14))
        log[:, 0, :10] = states
        for k in range(u.shape[-1]):
            drives.advance(states, reference[:, k], tolerance)
            if (k + 1) % every == 0:
                log[:, (k + 1) // every] = np.c_[states, drives.voltage]
        return log

    return block


def wheel_references(u: NDArray, vehicles: Sequence[Vehicle], half_track: float | None) -> NDArray:
    """Wheel speeds (runs, n, 4) that commands (2, runs, n) ask for, by (2.2)."""
    radius = np.array([[p.wheel_radius] for p in vehicles])
    turn = np.array([[half_track_of(p, half_track)] for p in vehicles]) * u[1]
    left, right = (u[0] - turn) / radius, (u[0] + turn) / radius
    return np.stack([left, right, left, right], axis=-1)
