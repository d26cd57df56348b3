"""From the heap to the truck with a full bucket: what is in the way, and what is lost on it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.kinematics import forward_kinematics, inverse_kinematics, pose
from backhoe.basics.inputs import function, instance, number, numbers, times, whole
from backhoe.machine import BACKHOE, JOINTS, Machine
from backhoe.mission.loading import Run
from backhoe.mission.parts import WayPoint, hand_made_plan
from backhoe.perception.distance_field import covering_spheres
from backhoe.planning.search import (
    ArmWorld,
    LevelWorld,
    Relief,
    few_spheres,
    in_time,
    pitch,
    rrt_connect,
    shortcut,
)
from backhoe.simulation import forces
from backhoe.simulation.clock import STEP, TICKS_PER_DIG
from backhoe.simulation.scene import LOADING, Scene, untouched_ground
from backhoe.simulation.soil import SANDY_LOAM, SoilParameters
from backhoe.view.appearance import truck_boxes, visuals

FINE = 0.15
"""Edge of the cubes in which a mesh gets one sphere, before these become few [m]."""

FEW = {"boom": 6, "stick": 4, "bucket": 6}
"""Spheres a link for planners: 16 in all, up to 0.72 m large."""

ABOVE = 0.5
"""A way begins where the teeth are so far above the highest ground [m]."""

STRIDE, RESOLUTION = 0.4, 0.04
"""Longest edge of a search, and between two looks on it [rad]."""

SLACK = 0.05
"""What a way may come nearer between two looks and where its corners are rounded [m]."""

SAME = 1e-6
"""Joint angles closer than this are one posture [rad]."""

SET_OFF, BETWEEN = 2.0, 0.5
"""From rest to full speed, and from one way-point of a planned swing to the next [s]."""

DEEP = 1e3
"""Depth of a ground that is not asked for [m]."""


def arm_world(
    scene: Scene = LOADING,
    heights: ArrayLike | None = None,
    *,
    margin: float = 0.0,
    machine: Machine = BACKHOE,
    fine: bool = False,
) -> ArmWorld:
    """The arm's world in a scene: truck, ground, and the machine's own body.

    Args:
        scene: what stands around; the machine stands at its origin.
        heights: of the ground, shape of the scene's grid [m]; None for the untouched ground.
        margin: that `is_free` keeps [m].
        machine: whose arm it is.
        fine: hundreds of small spheres to measure with, in place of `FEW` to plan with.

    Raises:
        ValueError: heights of another shape or unknown, a negative margin.
        TypeError: scene is no Scene, machine is no Machine.
    """
    scene = instance(scene, "scene", Scene)
    shape = (scene.rows, scene.columns)
    heights = scene.heights() if heights is None else numbers(heights, "heights", shape)
    body = visuals(instance(machine, "machine", Machine))
    own = {link: [_box(body[link])] for link in ("undercarriage", "swing")}
    return ArmWorld(
        _spheres(machine, bool(fine)),
        truck_boxes(scene.truck),
        relief=Relief(heights, scene.corner, scene.cell),
        own=own,
        margin=margin,
        machine=machine,
    )


def level_way(
    start: ArrayLike, goal: ArrayLike, world: ArmWorld, *, seed: int = 0, time_limit: float = 10.0
) -> NDArray:
    """A way of the loaded bucket: over the heap it turns to the goal's pitch, and keeps that.

    What it cannot hold at that pitch falls where it came from. RRT-Connect and shortcuts.

    Args:
        start, goal: joint angles, shape (4,) [rad].
        world: what must not be touched, and its margin.
        seed: of the samples.
        time_limit: of the search [s].

    Returns:
        Joint angles from start to goal, shape (n, 4) [rad].

    Raises:
        ValueError: start, also with the goal's pitch, or goal is not free.
        NoPath: none was found in this time (a RuntimeError).
    """
    start = numbers(start, "start", (4,), meaning="joint angles [rad]")
    goal = numbers(goal, "goal", (4,), meaning="joint angles [rad]")
    level = LevelWorld(world, float(pitch(goal, instance(world, "world", ArmWorld).machine)))
    limits = {"resolution": RESOLUTION, "seed": seed, "time_limit": time_limit}
    path = rrt_connect(
        start[:3], goal[:3], level.is_free, level.lower, level.upper, step=STRIDE, **limits
    )
    path = level.joints(shortcut(path, level.is_free, **limits))
    path[-1] = goal
    if np.abs(path[0] - start).max() <= SAME:
        path[0] = start
        return path
    if not world.is_free(np.linspace(start, path[0], 20)).all():
        raise ValueError("start must be free, also while the bucket turns to the goal's pitch")
    path = np.vstack([start, path])
    return path


def planned_swing(
    way: Callable[..., NDArray] | None = None,
    scene: Scene = LOADING,
    *,
    margin: float = 0.4,
    pace: float = 0.5,
) -> Callable[[int], list[WayPoint]]:
    """The hand-made plan with another way from the heap to the truck, for `mission.run(plan=...)`.

    Args:
        way: way(start, goal, world) -> joint angles from start to goal, shape (n, 4) [rad];
            default `level_way`.
        scene: where the run will be.
        margin: that the movement keeps [m]; the world's `is_free` keeps 5 cm more.
        pace: share of the joints' speed limits that is used, above 0 to 1 [1].

    Returns:
        plan(cycle) -> list of WayPoint. It raises what `way` does, and a ValueError for a way of
        another shape or between other postures.

    Raises:
        ValueError: a negative margin, pace out of range.
        TypeError: way cannot be called, scene is no Scene.
    """
    way = level_way if way is None else way
    function(way, "way", "way(start, goal, world) -> joint angles (n, 4)")
    rounded, world = (arm_world(scene, margin=margin + more) for more in (0.0, SLACK))
    speed = number(pace, "pace", above=0.0, most=1.0) * BACKHOE.speed_limit

    def plan(cycle: int) -> list[WayPoint]:
        points = hand_made_plan(cycle)
        at = [point.name for point in points].index("swing to the truck")
        start, goal = (inverse_kinematics(point.target) for point in points[at - 1 : at + 1])
        path = numbers(way(start.copy(), goal.copy(), world), "way", ("n", 4))
        if np.abs(path[[0, -1]] - [start, goal]).max() > 1e-6:
            raise ValueError("way must begin at start and end at goal")
        moved = in_time(path, speed, speed / SET_OFF, is_free=rounded.is_free)
        stops = np.linspace(0, len(moved.times) - 1, max(round(moved.times[-1] / BETWEEN), 1) + 1)
        stops = stops.round().astype(int)[1:]
        lasts = np.diff(moved.times[stops], prepend=0.0)
        swing = [
            WayPoint(points[at].name, float(last), tuple(pose(moved.q[stop]).tolist()))
            for stop, last in zip(stops, lasts, strict=True)
        ]
        return [*points[:at], *swing, *points[at + 1 :]]

    return plan


class Carried(NamedTuple):
    """What became of a bucket's load on a way.

    `kept` is in the bucket at each time, shape (n,), `loaded` fell into the truck in all, `spilled`
    beside it [m^3].
    """

    kept: NDArray
    loaded: float
    spilled: float


def carry(
    time: ArrayLike,
    q: ArrayLike,
    volume: float | None = None,
    *,
    scene: Scene = LOADING,
    soil: SoilParameters = SANDY_LOAM,
    machine: Machine = BACKHOE,
) -> Carried:
    """Lead a loaded bucket along a movement of the joints, in the simulation's soil.

    Soil falls as it does there: what the bucket does not hold at its pitch runs out over the lower
    lip, within a fraction of a second. Accelerations shake nothing out in this model.

    Args:
        time: rising, shape (n,) [s].
        q: joint angles, shape (n, 4) [rad]; straight in between.
        volume: in the bucket at the start [m^3]; None for all that it holds there.
        scene: with its truck.
        soil: in the bucket.
        machine: whose arm it is.

    Raises:
        ValueError: shapes, times that do not rise, a volume below 0 or more than the bucket holds.
    """
    time = times(time, "time")
    q = numbers(q, "q", (len(time), 4), meaning="joints (swing, boom, stick, bucket)")
    from backhoe.simulation import engine

    ground = untouched_ground(scene, machine, 0, STEP, soil)
    reach, still = forces.numbers_of(machine, True).reach, np.zeros(3)
    full = ground.fill.retained(float(pitch(q[0], machine)))
    most = ground.fill.heaped
    ground.bucket_volume = (
        full if volume is None else number(volume, "volume", "m^3", least=0.0, most=most)
    )
    tick = STEP * TICKS_PER_DIG
    count = max(round((time[-1] - time[0]) / tick), 1)
    at = np.linspace(time[0], time[-1], count + 1)
    way = np.stack([np.interp(at, time, joint) for joint in q.T], axis=1)
    before, kept = ground.terrain.volume, [ground.bucket_volume]
    for here, dq in zip(way[1:], np.diff(way, axis=0) / tick, strict=True):
        T, velocity = engine.tip_motion(reach, np.r_[still, here], np.r_[still, dq])
        ground.advance(T, velocity, tick, float(dq[1:].sum()))
        kept.append(ground.bucket_volume)
    beside = ground.terrain.volume - before + ground.off_map_volume
    return Carried(np.interp(time, at, kept), float(ground.truck_volume), float(beside))


@dataclass(frozen=True)
class Haul:
    """A run's ways with soil: `spilled` beside the truck from above the ground [m^3], and the least
    `clearance` of boom, stick and bucket from the truck [m], at `time` [s]."""

    spilled: float
    clearance: float
    time: float

    def __str__(self) -> str:
        return (
            f"spilled on the way {1e3 * self.spilled:.0f} l, least clearance from the truck "
            f"{self.clearance:.2f} m at {self.time:.1f} s"
        )


def hauled(run: Run, every: int = 5) -> Haul:
    """What a run spilled on its ways, and how near it came to the truck.

    Args:
        run: of `mission.run`, in a scene with a truck.
        every: how many samples of its log, 10 ms each, from one look at the clearance to the next.

    Raises:
        ValueError: no truck in the run's scene, every below 1.
        TypeError: run is no Run.
    """
    run = instance(run, "run", Run)
    if run.scene.truck is None:
        raise ValueError("run must be in a scene with a truck")
    every = whole(every, "every", least=1)
    deep = Relief(np.full((2, 2), -DEEP), (0.0, 0.0), 1.0)
    boxes = truck_boxes(run.scene.truck)
    world = ArmWorld(_spheres(run.machine, True), boxes, relief=deep, machine=run.machine)
    gaps = world.clearance(run.q[::every])
    nearest = int(gaps.argmin())
    height = forward_kinematics(run.q, machine=run.machine)[:, 2, 3]
    high = height > run.scene.heights().max() + ABOVE
    lost = -np.diff(run.bucket_volume) - np.diff(run.truck_volume)
    spilled = float(lost[high[1:] & (lost > 0)].sum())
    return Haul(spilled, float(gaps[nearest]), float(run.time[nearest * every]))


@lru_cache(maxsize=8)
def _spheres(machine: Machine, fine: bool) -> dict[str, NDArray]:
    body = visuals(machine)
    found = {}
    for link in JOINTS[1:]:
        small = [covering_spheres(part.vertices, part.faces, FINE) for part in body[link]]
        found[link] = np.concatenate(small)
        if not fine:
            found[link] = few_spheres(found[link], FEW[link])
    return found


def _box(parts: tuple) -> tuple[NDArray, NDArray]:
    corners = np.concatenate([part.vertices for part in parts])
    return corners.min(axis=0), corners.max(axis=0)
