"""Digging and loading along way-points with the library's parts, or with a student's."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import ceil, inf
from numbers import Real
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from backhoe import simulation
from backhoe.arm import dynamics, kinematics, pid
from backhoe.basics.inputs import real_array
from backhoe.machine import BACKHOE, JOINTS, Machine
from backhoe.mission.asking import asked, checked_part, numbers
from backhoe.mission.parts import PARTS, WayPoint, hand_made_plan, smooth_trajectory

if TYPE_CHECKING:
    from backhoe.view.replay import Recorder, Replay

LOG_EVERY = 10

_WANTED_PLAN = f"plan must return a list of WayPoint. It is {PARTS['plan'].call}"


@dataclass
class Run:
    """What happened: the log at 100 Hz, the way-points, and what became of the soil.

    `time` (n,) [s]; `q`, `q_ref` (n, 4) [rad]; `torque` (n, 4) [N m]; `bucket_volume`,
    `truck_volume` (n,) [m^3]; `in_the_air` (n,) whether the bucket is empty and touches no soil;
    `reached` (k, 4) against `wanted` (k, 4), stick's tip [m] and bucket
    angle [rad] at each way-point; `soil_lost` is the largest change of the sum of all soil [m^3];
    `swapped` names the student's parts; `machine`, `scene` and `backend` are those of its world.
    """

    swapped: tuple[str, ...]
    cycles: int
    machine: Machine
    scene: simulation.Scene
    backend: str
    waypoints: tuple[WayPoint, ...]
    time: NDArray
    q: NDArray
    q_ref: NDArray
    torque: NDArray
    bucket_volume: NDArray
    truck_volume: NDArray
    in_the_air: NDArray
    soil_lost: float
    wanted: NDArray
    reached: NDArray
    recorder: Recorder | None = field(default=None, repr=False)

    def replay(
        self,
        title: str = "Dig and load",
        alt: str = "3D replay of the backhoe digging and loading a truck",
    ) -> Replay:
        """The run as a 3D replay for the notebook.

        Args:
            title: what stands above it.
            alt: what it shows, for readers who do not see it.

        Raises:
            ValueError: the run was not recorded, or title or alt is empty.
        """
        if self.recorder is None:
            raise ValueError("this run was not recorded: call mission.run(record=True)")
        return self.recorder.replay(title=title, alt=alt)


def _checked(name: str, part: Callable) -> Callable:
    def call(*arguments: object) -> NDArray:
        return numbers(name, f"your {name}", asked(name, part, *arguments), (4,))

    return call


def _plan(plan: Callable, cycles: int) -> list[WayPoint]:
    waypoints = []
    for cycle in range(cycles):
        of_cycle = asked("plan", plan, cycle)
        if not isinstance(of_cycle, Iterable):
            raise ValueError(f"{_WANTED_PLAN}, got {of_cycle!r}")
        waypoints += of_cycle
    if not waypoints or not all(isinstance(waypoint, WayPoint) for waypoint in waypoints):
        raise ValueError(_WANTED_PLAN)
    for name, seconds, target in ((point.name, point.time, point.target) for point in waypoints):
        if not (isinstance(seconds, Real) and 0 < seconds < inf):
            raise ValueError(f"way-point {name!r} needs a time above 0 s, got {seconds!r}")
        wanted = real_array(target, f"the target of way-point {name!r} must be numbers")
        if wanted.shape != (4,) or not np.isfinite(wanted).all():
            raise ValueError(
                f"the target of way-point {name!r} must be x, y, z and the bucket's angle, all "
                f"finite, got {target!r}"
            )
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


def _within_speed(
    waypoints: Sequence[WayPoint], times: NDArray, t: NDArray, dq: NDArray, machine: Machine
) -> None:
    excess = np.abs(dq) / machine.speed_limit
    if excess.max() > 1.0:
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
    world: simulation.Simulation | None = None,
    machine: Machine = BACKHOE,
    backend: str = "auto",
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
        record: keep what the 3D replay needs.

    Returns:
        The run, with its log.

    Raises:
        ValueError: no cycles, a world without soil, a part that returns the wrong shape or values
            that are not finite, a way-point that a joint cannot reach in its time.
        TypeError: a part of an unknown name, or one that cannot be called.
    """
    if unknown:
        raise TypeError(f"unknown part {next(iter(unknown))!r}: the parts are {', '.join(PARTS)}")
    if isinstance(cycles, bool) or not isinstance(cycles, int) or cycles < 1:
        raise ValueError(f"cycles must be a whole number, 1 or more, got {cycles!r}")
    offered = {
        "plan": plan,
        "inverse_kinematics": inverse_kinematics,
        "gravity_torque": gravity_torque,
        "controller": controller,
        "trajectory": trajectory,
    }
    given = {name: part for name, part in offered.items() if part is not None}
    for name, part in given.items():
        checked_part(name, part)
    if world is not None:
        return _drive(world, cycles, given, record)
    with simulation.open_world(machine, backend=backend) as opened:
        return _drive(opened, cycles, given, record)


def _drive(
    world: simulation.Simulation, cycles: int, given: dict[str, Callable], record: bool
) -> Run:
    if world.ground is None:
        raise ValueError("the mission needs soil: open the world with soil=True")
    machine, dt = world.machine, world.dt
    inverse, gravity, controller = _followers(given, machine)
    waypoints = _plan(given.get("plan", hand_made_plan), cycles)
    wanted = np.array([waypoint.target for waypoint in waypoints], dtype=float)
    q_way = np.array([world.q.copy(), *_postures(waypoints, inverse)])
    times = np.cumsum([0.0, *(waypoint.time for waypoint in waypoints)])
    t = np.arange(round(times[-1] / dt) + 1) * dt
    q_ref, dq_ref = _reference(given.get("trajectory", smooth_trajectory), times, q_way, t)
    _within_speed(waypoints, times, t, dq_ref, machine)

    recorder = _recorder(world) if record else None
    departures = {round(time / dt): index for index, time in enumerate(times[:-1])}
    arrivals = {round(time / dt): index for index, time in enumerate(times[1:])}
    reached = np.zeros_like(wanted)
    log = []
    for step in range(len(t)):
        q, dq = world.q, world.dq
        if step in arrivals:
            reached[arrivals[step]] = kinematics.pose(q, machine=machine)
        if recorder is not None and step in departures:
            recorder.label(waypoints[departures[step]].name)
        if step % LOG_EVERY == 0:
            ground = world.ground
            volumes = ground.bucket_volume, ground.truck_volume, ground.total_volume
            log.append((q.copy(), world.torque.copy(), *volumes, world.soil_force.any()))
            if recorder is not None:
                recorder.capture()
        world.step(controller(q_ref[step], dq_ref[step], q, dq, dt) + gravity(q))
    q_log, torque_log, bucket, truck, total, touching = map(np.array, zip(*log, strict=True))
    return Run(
        swapped=tuple(given),
        cycles=cycles,
        machine=machine,
        scene=world.scene,
        backend=world.backend,
        waypoints=tuple(waypoints),
        time=t[::LOG_EVERY],
        q=q_log,
        q_ref=q_ref[::LOG_EVERY],
        torque=torque_log,
        bucket_volume=bucket,
        truck_volume=truck,
        in_the_air=~touching & (bucket < 1e-6),
        soil_lost=float(np.abs(total - total[0]).max()),
        wanted=wanted,
        reached=reached,
        recorder=recorder,
    )


def _followers(given: dict[str, Callable], machine: Machine) -> list[Callable]:
    """Inverse kinematics, gravity torque and controller; a student's is checked at every call."""
    own = {
        "inverse_kinematics": partial(kinematics.inverse_kinematics, machine=machine),
        "gravity_torque": partial(dynamics.gravity_torque, machine=machine),
        "controller": pid.PID(*pid.ARM_GAINS, machine.torque_limit),
    }
    for part in given.values():
        if callable(getattr(part, "reset", None)):
            part.reset()
    return [_checked(name, given[name]) if name in given else own[name] for name in own]


def _reference(
    trajectory: Callable, times: NDArray, q_way: NDArray, t: NDArray
) -> tuple[NDArray, NDArray]:
    pair = asked("trajectory", trajectory, times, q_way, t)
    if not (isinstance(pair, tuple | list) and len(pair) == 2):
        call = PARTS["trajectory"].call
        raise ValueError(f"your trajectory must return two arrays. It is {call}")
    angles, speeds = (
        numbers("trajectory", f"your trajectory ({name})", value, (len(t), 4))
        for name, value in zip(("angles", "speeds"), pair, strict=True)
    )
    return angles, speeds


def _recorder(world: simulation.Simulation) -> Recorder:
    from backhoe.view import replay

    return replay.Recorder(world)
