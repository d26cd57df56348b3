"""Digging and loading along way-points with the library's parts, or with a student's."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from math import ceil

import numpy as np
from numpy.typing import NDArray

from backhoe import simulation
from backhoe.arm import dynamics, kinematics, pid
from backhoe.basics.inputs import numbers, positive, whole
from backhoe.machine import BACKHOE, JOINTS, Machine
from backhoe.mission.calls import call_part, given_parts, reset
from backhoe.mission.parts import PARTS, WayPoint, hand_made_plan, smooth_trajectory
from backhoe.mission.records import Record, recorder_of
from backhoe.simulation.soil import SoilParameters, soil_of
from backhoe.simulation.standing import lesser

LOG_EVERY = 10
LIMIT_ROUNDING = 1e-9
"""What a joint may pass its limit by [rad]."""

_DEGREES = "are these degrees? Angles are in radians, np.radians(angles)"

_WANTED_PLAN = f"your plan must return a list of WayPoint. It is {PARTS['plan'].call}"


@dataclass(frozen=True, eq=False, kw_only=True)
class Run(Record):
    """What happened: the log at 100 Hz, the way-points, and what became of the soil.

    `time` (n,) [s]; `q`, `q_ref` (n, 4) [rad]; `torque` (n, 4) [N m]; `bucket_volume`,
    `truck_volume` (n,) [m^3]; `in_the_air` (n,) whether the bucket is empty and touches no soil;
    `margin` (n,) of the balance [m], and `least` of all its steps;
    `reached` (k, 4) against `wanted` (k, 4), stick's tip [m] and bucket
    angle [rad] at each way-point; `soil_lost` is the largest change of the sum of all soil [m^3];
    `scene` and `soil` are those of its world.
    """

    cycles: int
    scene: simulation.Scene
    soil: SoilParameters
    waypoints: tuple[WayPoint, ...]
    time: NDArray
    q: NDArray
    q_ref: NDArray
    torque: NDArray
    bucket_volume: NDArray
    truck_volume: NDArray
    in_the_air: NDArray
    margin: NDArray
    least: simulation.Least
    soil_lost: float
    wanted: NDArray
    reached: NDArray
    SHOWN = ("mission.run", "Dig and load", "3D replay of the backhoe digging and loading a truck")


def _plan(plan: Callable, cycles: int) -> list[WayPoint]:
    waypoints = []
    for cycle in range(cycles):
        of_cycle = call_part("plan", plan, cycle)
        if not isinstance(of_cycle, Iterable):
            raise ValueError(f"{_WANTED_PLAN}, got {of_cycle!r}")
        waypoints += of_cycle
    if not waypoints or not all(isinstance(waypoint, WayPoint) for waypoint in waypoints):
        raise ValueError(_WANTED_PLAN)
    for point in waypoints:
        positive(point.time, f"the time of way-point {point.name!r}", "s")
        meaning = "x, y, z and the bucket's angle"
        numbers(point.target, f"the target of way-point {point.name!r}", (4,), meaning=meaning)
    return waypoints


def _postures(waypoints: Sequence[WayPoint], inverse: Callable) -> list[NDArray]:
    """Joint angles at the way-points."""
    postures = []
    for waypoint in waypoints:
        try:
            postures.append(inverse(np.array(waypoint.target, dtype=float)))
        except ValueError as error:
            raise ValueError(f"at way-point {waypoint.name!r}: {error}") from error
    return postures


def _within_limits(q: NDArray, where: Callable[[int], str], machine: Machine) -> None:
    """Stop at the first of the postures (n, 4) that a joint cannot take; `where` says which it is.

    What is far outside is likely in degrees.
    """
    excess = np.maximum(machine.lower - q, q - machine.upper)
    if excess.max() <= LIMIT_ROUNDING:
        return
    first = int(np.argmax(excess.max(axis=1) > LIMIT_ROUNDING))
    joint = int(excess[first].argmax())
    low, high = machine.lower[joint], machine.upper[joint]
    if np.abs(q).max() > 3 * np.pi:
        advice = _DEGREES
    elif joint == 0:
        advice = "bring it back by a whole turn, 2 pi"
    else:
        advice = "choose another posture, or another way-point"
    raise ValueError(
        f"{where(first)} the {JOINTS[joint]} would be at {q[first, joint]:.3f} rad, its limits are "
        f"{low:.3f} and {high:.3f} rad: {advice}"
    )


def _within_speed(
    waypoints: Sequence[WayPoint],
    times: NDArray,
    t: NDArray,
    q: NDArray,
    dq: NDArray,
    machine: Machine,
) -> None:
    excess = np.abs(dq) / machine.speed_limit
    if excess.max() > 1.0:
        shares = np.abs(np.gradient(q, t, axis=0)) / machine.speed_limit
        if shares.max() < excess.max() / 10:
            raise ValueError(f"your trajectory's speeds are not those of its angles: {_DEGREES}")
        sample, joint = np.unravel_index(excess.argmax(), excess.shape)
        late = waypoints[min(np.searchsorted(times, t[sample]), len(times) - 1) - 1]
        needed = ceil(10 * late.time * excess.max()) / 10
        raise ValueError(
            f"on the way to {late.name!r} the {JOINTS[joint]} would turn at "
            f"{abs(dq[sample, joint]):.2f} rad/s, its limit is {machine.speed_limit[joint]:.2f}: "
            f"give this way-point at least {needed:.1f} s"
        )


def run(
    *,
    plan: Callable | None = None,
    inverse_kinematics: Callable | None = None,
    gravity_torque: Callable | None = None,
    controller: Callable | None = None,
    trajectory: Callable | None = None,
    cycles: int = 3,
    world: simulation.World | None = None,
    machine: Machine = BACKHOE,
    backend: str = "auto",
    soil: str | SoilParameters | None = None,
    record: bool = False,
    **unknown: object,
) -> Run:
    """Dig and load with the library's parts, or with yours in their place.

    Args:
        plan, inverse_kinematics, gravity_torque, controller, trajectory: your parts; `PARTS` gives
            the call of each. What is left out is the library's.
        cycles: how many buckets.
        world: a simulation to run in; without it one is opened and closed here.
        machine: the machine, if no world is given.
        backend: as in `simulation.open_world`, if no world is given.
        soil: likewise; in one too hard for the plan the bucket holds fast, and the machine tips.
        record: keep what the 3D replay needs.

    Returns:
        The run, with its log.

    Raises:
        ValueError: no cycles, a world without soil or one beside `soil`, an unknown soil, a part
            that returns the wrong shape or values that are not finite, a way-point that a joint
            cannot reach in its time.
        TypeError: a part of an unknown name, or one that cannot be called.
        Tipped: the machine tips over (a RuntimeError); its `run` is the run until then, with NaN
            where it did not get.
    """
    given = given_parts(
        PARTS,
        unknown,
        plan=plan,
        inverse_kinematics=inverse_kinematics,
        gravity_torque=gravity_torque,
        controller=controller,
        trajectory=trajectory,
    )
    cycles = whole(cycles, "cycles", least=1)
    if world is not None:
        if soil is not None:
            raise ValueError("soil is that of the given world: leave it out")
        return _load(world, cycles, given, record)
    soil = True if soil is None else soil_of(soil)
    with simulation.open_world(machine, backend=backend, soil=soil) as opened:
        return _load(opened, cycles, given, record)


def _load(world: simulation.World, cycles: int, given: dict[str, Callable], record: bool) -> Run:
    if world.ground is None:
        raise ValueError("the mission needs soil: open the world with soil=True")
    machine, dt = world.machine, world.dt
    inverse, gravity, controller = _followers(given, machine)
    waypoints = _plan(given.get("plan", hand_made_plan), cycles)
    wanted = np.array([waypoint.target for waypoint in waypoints], dtype=float)
    q_way = np.array([world.q.copy(), *_postures(waypoints, inverse)])
    times = np.cumsum([0.0, *(waypoint.time for waypoint in waypoints)])
    t = np.arange(round(times[-1] / dt) + 1) * dt
    trajectory = given.get("trajectory", smooth_trajectory)
    _within_limits(q_way[1:], lambda at: f"at way-point {waypoints[at].name!r}", machine)
    q_ref, dq_ref = call_part("trajectory", trajectory, times, q_way, t, shape=(2, len(t), 4))
    _within_limits(q_ref, lambda at: f"your trajectory: at {t[at]:.2f} s", machine)
    _within_speed(waypoints, times, t, q_ref, dq_ref, machine)

    recorder = recorder_of(world) if record else None
    departures = {round(time / dt): index for index, time in enumerate(times[:-1])}
    arrivals = {round(time / dt): index for index, time in enumerate(times[1:])}
    reached = np.full_like(wanted, np.nan)
    log, least = [], simulation.Least(world.margin, 0.0, world.edge)

    def made() -> Run:
        """The run so far."""
        columns = map(np.array, zip(*log, strict=True))
        q_log, torque_log, bucket, truck, total, touching, margin = columns
        return Run(
            swapped=tuple(given),
            cycles=cycles,
            machine=machine,
            scene=world.scene,
            soil=world.ground.parameters,
            backend=world.backend,
            waypoints=tuple(waypoints),
            time=t[::LOG_EVERY][: len(log)],
            q=q_log,
            q_ref=q_ref[::LOG_EVERY][: len(log)],
            torque=torque_log,
            bucket_volume=bucket,
            truck_volume=truck,
            in_the_air=~touching & (bucket < 1e-6),
            margin=margin,
            least=least,
            soil_lost=float(np.abs(total - total[0]).max()),
            wanted=wanted,
            reached=reached,
            recorder=recorder,
        )

    for step in range(len(t)):
        q, dq = world.q, world.dq
        if step in arrivals:
            reached[arrivals[step]] = kinematics.pose(q, machine=machine)
        if recorder is not None and step in departures:
            recorder.label(waypoints[departures[step]].name)
        if step % LOG_EVERY == 0:
            ground = world.ground
            volumes = ground.bucket_volume, ground.truck_volume, ground.total_volume
            felt = world.soil_force.any(), world.margin
            log.append((q.copy(), world.torque.copy(), *volumes, *felt))
            if recorder is not None:
                recorder.capture()
        torque = controller(q_ref[step], dq_ref[step], q, dq, dt) + gravity(q)
        try:
            world.step(torque)
        except simulation.Tipped as error:
            late = waypoints[min(np.searchsorted(times, t[step], "right"), len(waypoints)) - 1]
            error.run = made()
            error.add_note(
                f"This happened on the way to {late.name!r}. The run until then is kept: "
                "import sys; run = sys.last_value.run"
            )
            raise
        finally:
            least = lesser(least, world.margin, float(t[step]) + dt, world.edge)
    return made()


def _followers(given: dict[str, Callable], machine: Machine) -> list[Callable]:
    """Inverse kinematics, gravity torque and controller; a student's is checked at every call."""
    own = {
        "inverse_kinematics": partial(kinematics.inverse_kinematics, machine=machine),
        "gravity_torque": partial(dynamics.gravity_torque, machine=machine),
        "controller": pid.PID(*pid.ARM_GAINS, machine.torque_limit),
    }
    for part in given.values():
        reset(part)
    return [
        partial(call_part, name, given[name], shape=(4,)) if name in given else own[name]
        for name in own
    ]
