"""Many vehicles driven at once: commands in, poses and velocities out.

Three models, from coarse to fine, behind one function:

- kinematic: the twist is the command (2.6), so the vehicle drives arcs of circles;
- linear: the twist follows with the lags and errors of (2.15), repaired;
- slipping: friction at each wheel (`slipping`), with proportional wheel control (2.14) or with
  motors and wheel PIDs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from os import cpu_count
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array
from backhoe.vehicle.skid_steer import without_slip
from backhoe.vehicle.skid_steer.kinematics import half_track_of
from backhoe.vehicle.skid_steer.vehicle import DRIVEN, HUSKY, Vehicle

if TYPE_CHECKING:
    from backhoe.vehicle.motor import Motor, WheelGains

MODELS = ("kinematic", "linear", "slipping")


NO_OPTIONS = (None, None, None, "all")
"""half_track, motor, gains, driven: what only the slipping model can make use of."""

_BLOCK = 32
"""Runs that one thread takes at a time."""


@dataclass(frozen=True)
class Simulation:
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
) -> Simulation:
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
        tolerance: of the slipping model's integrator, see `slipping.advance`.

    Returns:
        The runs at times 0, every dt, 2 every dt ... n dt.

    Raises:
        ValueError: commands of different shape or not finite; dt not positive; a model that there
            is not, or wheels asked of one that has none; vehicles or starts that do not fit.
    """
    commands = _commands(v_ref, omega_ref)
    single = commands.ndim == 2
    if single:
        commands = commands[:, None]
    _, runs, n = commands.shape
    vehicles, first = _one_a_run(vehicle, runs), _starts(start, runs)
    _check_times(dt, every, n, tolerance)
    block = _block(model, dt, every, tolerance, (half_track, motor, gains, driven))
    log = _in_blocks(block, commands, vehicles, first)
    log = log[0] if single else log
    voltage = log[..., 10:] if log.shape[-1] > 10 else None
    time = dt * np.arange(0, n + 1, every)
    return Simulation(time, log[..., :3], log[..., 3:6], log[..., 6:10], voltage)


Block = Callable[[NDArray, Sequence[Vehicle], NDArray], NDArray]


def _block(model: str, dt: float, every: int, tolerance: float, options: tuple) -> Block:
    """The function that drives a block of runs by a model."""
    if model == "slipping":
        return _slipping_block(dt, every, tolerance, *options)
    if model not in MODELS:
        raise ValueError(f"model must be one of {', '.join(MODELS)}, got {model!r}")
    if options != NO_OPTIONS:
        raise ValueError(
            f"the {model} model has no wheels that slip or take torque: half_track, motor, gains "
            'and driven go with model="slipping"'
        )
    return lambda u, vehicles, first: without_slip.drive(u, dt, vehicles, model, first)[:, ::every]


def _in_blocks(block: Block, commands: NDArray, vehicles: list[Vehicle], first: NDArray) -> NDArray:
    """Blocks of runs, shared out over threads: the loops inside let go of Python's lock."""
    parts = [slice(k, k + _BLOCK) for k in range(0, len(vehicles), _BLOCK)]

    def run(part: slice) -> NDArray:
        return block(commands[:, part], vehicles[part], first[part])

    if len(parts) == 1:
        return run(parts[0])
    with ThreadPoolExecutor(cpu_count()) as pool:
        return np.concatenate(list(pool.map(run, parts)))


def _slipping_block(
    dt: float,
    every: int,
    tolerance: float,
    half_track: float | None,
    motor: Motor | None,
    gains: WheelGains | None,
    driven: str,
) -> Block:
    from backhoe.vehicle.skid_steer import kernels

    if driven not in DRIVEN:
        raise ValueError(f"driven must be one of {', '.join(DRIVEN)}, got {driven!r}")
    if motor is None and gains is not None:
        raise ValueError("gains are those of the motors' PIDs: give a motor as well")
    if motor is not None:
        from backhoe.vehicle.skid_steer.motorised import drive_block

        return drive_block(dt, every, tolerance, half_track, motor, gains, driven)

    def block(u: NDArray, vehicles: Sequence[Vehicle], first: NDArray) -> NDArray:
        gain = np.array([[p.speed_gain] for p in vehicles]) * DRIVEN[driven]
        tracks = np.array([half_track_of(p, half_track) for p in vehicles])
        states = np.zeros((len(vehicles), 10))
        states[:, :3] = first
        log = np.empty((len(vehicles), u.shape[-1] // every + 1, 10))
        p = kernels.record(vehicles, gain)
        kernels.roll_out(states, *u, gain, tracks, p, dt, tolerance, every, log)
        return log

    return block


def _commands(v_ref: ArrayLike, omega_ref: ArrayLike) -> NDArray:
    parts = []
    for values, name in ((v_ref, "v_ref"), (omega_ref, "omega_ref")):
        array = real_array(values, f"{name} must be numbers")
        if array.ndim not in (1, 2) or array.size == 0:
            raise ValueError(f"{name} must have the shape (n,) or (runs, n), got {array.shape}")
        if not np.isfinite(array).all():
            raise ValueError(f"{name} must be finite: it holds nan or inf")
        parts.append(array)
    if parts[0].shape != parts[1].shape:
        raise ValueError(
            "v_ref and omega_ref must be alike, one value a sample, got shapes "
            f"{parts[0].shape} and {parts[1].shape}"
        )
    return np.stack(parts)


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
    first = real_array(start, "start must be numbers")
    if first.shape not in ((3,), (runs, 3)) or not np.isfinite(first).all():
        raise ValueError(
            f"start must be one pose (3,) or ({runs}, 3) of finite numbers, got {start!r}"
        )
    return np.broadcast_to(first, (runs, 3))


def _check_times(dt: float, every: int, n: int, tolerance: float) -> None:
    for name, value in (("dt", dt), ("tolerance", tolerance)):
        if not (np.ndim(value) == 0 and np.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be a positive number, got {value!r}")
    if isinstance(every, bool) or not isinstance(every, int | np.integer) or every < 1 or n % every:
        raise ValueError(f"every must be a whole number that divides the {n} samples, got {every}")
