"""Many vehicles driven at once: commands in, poses and velocities out.

Three models, from coarse to fine, behind one function:

- kinematic: the twist is the command (2.6), so the vehicle drives arcs of circles;
- linear: the twist follows with the lags and errors of (2.15), repaired;
- slipping: friction at each wheel (`slipping`), with proportional wheel control (2.14) or with
  motors and wheel PIDs.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import alike, numbers, positive, whole
from backhoe.basics.tiles import for_each_tile
from backhoe.vehicle.motor import Motor, WheelGains
from backhoe.vehicle.skid_steer import no_slip
from backhoe.vehicle.skid_steer.kinematics import wheel_speeds
from backhoe.vehicle.skid_steer.vehicle import HUSKY, Vehicle
from backhoe.vehicle.skid_steer.wheel_control import (
    ProportionalWheels,
    WheelControl,
    WheelMotors,
    check_control,
    controlled_wheels,
)

_BLOCK = 32
"""Runs that one thread takes at a time: the engine lets go of Python's lock."""


@dataclass(frozen=True)
class Runs:
    """What happened; the first axis is the run if the commands had one.

    Attributes:
        time: shape (m,) [s].
        pose: X, Y, theta, shape (..., m, 3) [m, m, rad], the angle not wrapped.
        velocity: v_x, v_y, omega in the vehicle's axes, shape (..., m, 3) [m/s, m/s, rad/s].
        wheels: speeds in the order of `WHEELS`, shape (..., m, 4) [rad/s].
        voltage: of the motors up to each time, shape (..., m, 4) [V], 0 at the start; None
            without motors.
    """

    time: NDArray
    pose: NDArray
    velocity: NDArray
    wheels: NDArray
    voltage: NDArray | None = None

    @property
    def twist(self) -> NDArray:
        """v_x and omega, shape (..., m, 2) [m/s, rad/s]."""
        return self.velocity[..., [0, 2]]


def simulate(
    v_ref: ArrayLike,
    omega_ref: ArrayLike,
    dt: float,
    vehicle: Vehicle | Sequence[Vehicle] = HUSKY,
    *,
    model: str = "slipping",
    start: ArrayLike = (0.0, 0.0, 0.0),
    half_track: float | None = None,
    motor: Motor | None = None,
    gains: WheelGains | None = None,
    driven: str = "all",
    every: int = 1,
    tolerance: float = 1e-5,
) -> Runs:
    """Drive from rest under commands held over samples.

    Args:
        v_ref, omega_ref: commanded speeds, shape (n,) or (runs, n), alike [m/s, rad/s].
        dt: sample time [s].
        vehicle: one for all runs, or one for each.
        model: "kinematic", "linear" or "slipping".
        start: first pose, shape (3,) or (runs, 3) [m, m, rad].
        half_track: that turns omega_ref into wheel speeds instead of the vehicle's own c [m]; for
            the slipping model.
        motor: drives each wheel through a PID sampled each `motor.WHEEL_PERIOD`; for the slipping
            model. None: the proportional law (2.14) with the vehicle's `speed_gain`.
        gains: of that PID; None for `motor.tune_wheel` on the vehicle's own load.
        driven: wheels with a drive, "all" or "front"; for the slipping model.
        every: samples from one entry of the result to the next, a divisor of n.
        tolerance: of the slipping model's integrator: error of a step in m, rad, m/s and rad/s,
            relative to 1 plus the value.

    Returns:
        The runs at times 0, every dt, 2 every dt ... n dt.

    Raises:
        ValueError: commands of different shape or not finite; dt not positive; a model that there
            is not, or wheels asked of one that has none; vehicles or starts that do not fit.
    """
    control = WheelControl(half_track, motor, gains, driven)
    check_control(model, control)
    v_ref, omega_ref = numbers(v_ref, "v_ref"), numbers(omega_ref, "omega_ref")
    alike(v_ref=v_ref, omega_ref=omega_ref)
    if v_ref.ndim not in (1, 2) or not v_ref.size:
        raise ValueError(f"v_ref must have the shape (n,) or (runs, n), got {v_ref.shape}")
    commands = np.stack([np.atleast_2d(v_ref), np.atleast_2d(omega_ref)])
    _, runs, n = commands.shape
    dt, tolerance = positive(dt, "dt", "s"), positive(tolerance, "tolerance")
    every = whole(every, "every", least=1)
    if n % every:
        raise ValueError(f"every must divide the {n} samples, got {every}")
    vehicles, first = _one_a_run(vehicle, runs), _starts(start, runs)
    log = np.zeros((runs, n // every + 1, 10 if motor is None else 14))

    def work(tile: slice) -> None:
        u, fleet = commands[:, tile], vehicles[tile]
        if model == "slipping":
            wheels = controlled_wheels(fleet, control, dt, tolerance)
            _slip(log[tile], wheels, _references(u, fleet, half_track), first[tile], every)
        else:
            log[tile] = no_slip.states(u, fleet, first[tile], dt, model)[:, ::every]

    for_each_tile(work, runs, _BLOCK)
    log = log[0] if v_ref.ndim == 1 else log
    voltage = None if motor is None else log[..., 10:]
    time = dt * np.arange(0, n + 1, every)
    return Runs(time, log[..., :3], log[..., 3:6], log[..., 6:10], voltage)


def _slip(
    log: NDArray,
    wheels: ProportionalWheels | WheelMotors,
    reference: NDArray,
    first: NDArray,
    every: int,
) -> None:
    """Fill log (runs, n // every + 1, 10 or 14) with states, and with voltages if there are any."""
    states = np.zeros((len(log), 10))
    states[:, :3] = log[:, 0, :3] = first
    for k in range(reference.shape[1]):
        wheels.advance(states, reference[:, k])
        if (k + 1) % every == 0:
            row = log[:, (k + 1) // every]
            row[:, :10], row[:, 10:] = states, wheels.voltage


def _references(
    commands: NDArray, vehicles: Sequence[Vehicle], half_track: float | None
) -> NDArray:
    """Wheel speeds (runs, n, 4) that commands (2, runs, n) ask for, by (2.2)."""
    pairs = zip(np.moveaxis(commands, 0, -1), vehicles, strict=True)
    sides = np.stack([wheel_speeds(u, p, half_track=half_track) for u, p in pairs])
    return np.tile(sides, 2)


def _one_a_run(vehicle: Vehicle | Sequence[Vehicle], runs: int) -> list[Vehicle]:
    if isinstance(vehicle, Vehicle):
        return [vehicle] * runs
    vehicles = list(vehicle) if isinstance(vehicle, Iterable) else [vehicle]
    if len(vehicles) != runs or not all(isinstance(p, Vehicle) for p in vehicles):
        kinds = ", ".join(sorted({type(p).__name__ for p in vehicles}))
        raise ValueError(
            f"vehicle must be one Vehicle, or one for each of the {runs} runs, got {len(vehicles)} "
            f"({kinds})"
        )
    return vehicles


def _starts(start: ArrayLike, runs: int) -> NDArray:
    first = numbers(start, "start", (..., 3), meaning="values (X, Y, theta)")
    if first.shape not in ((3,), (runs, 3)):
        raise ValueError(f"start must be one pose (3,) or ({runs}, 3), got shape {first.shape}")
    return np.broadcast_to(first, (runs, 3))
