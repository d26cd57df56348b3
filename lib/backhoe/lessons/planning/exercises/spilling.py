"""Exercises of lesson 11b: a gap, the time of a way, and a way that spills nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.kinematics import inverse_kinematics
from backhoe.lessons.exercise import Exercise
from backhoe.mission.hauling import arm_world, level_way
from backhoe.planning.search import ArmWorld, pitch, rrt_connect, segment_times
from backhoe.simulation.scene import LOADING

__all__ = ["EXERCISES"]


def gap_to_box(spheres: NDArray, low: NDArray, high: NDArray) -> float:
    """Least gap between spheres (n, 4) and a box with these corners (3,) [m]."""
    out = np.maximum(np.maximum(low - spheres[:, :3], spheres[:, :3] - high), 0.0)
    return float((np.linalg.norm(out, axis=1) - spheres[:, 3]).min())


def _spheres(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(30):
        low = rng.uniform(-3, 3, 3)
        high = low + rng.uniform(0.3, 3.0, 3)
        away = rng.normal(size=(1 + k % 6, 3)) * (1.0, 2.0, 4.0)[k % 3]
        middles = (low + high) / 2 + away
        if k % 4 == 1:  # beside a face
            middles[:, k % 2] = rng.uniform(low[k % 2], high[k % 2], len(middles))
        cases.append((np.c_[middles, rng.uniform(0.1, 0.7, len(middles))], low, high))
    return cases


def _gap(of: Callable[[NDArray], NDArray], least: Callable = np.min) -> Callable[..., float]:
    """The gap, with another way to make a distance of how far out each axis is."""

    def answer(spheres, low, high):
        out = np.maximum(np.maximum(low - spheres[:, :3], spheres[:, :3] - high), 0.0)
        return float(least(of(out) - spheres[:, 3]))

    return answer


def _norm(out: NDArray) -> NDArray:
    return np.linalg.norm(out, axis=1)


GAP = Exercise(
    number="11.5",
    title="How near is the cab?",
    reference=gap_to_box,
    cases=_spheres,
    oracle="the_nearest_point_of_a_box_by_least_squares",
    mistakes={
        "the radius is forgotten: a sphere begins before its middle": (
            lambda spheres, low, high: gap_to_box(spheres * [1, 1, 1, 0], low, high)
        ),
        "that is the distance to the middle of the box: its faces are nearer": (
            lambda spheres, low, high: float(
                (_norm(spheres[:, :3] - (low + high) / 2) - spheres[:, 3]).min()
            )
        ),
        "that is the nearest corner: where a middle is within the box's length the axis counts 0": (
            lambda spheres, low, high: float(
                (
                    _norm(np.where(spheres[:, :3] < (low + high) / 2, low, high) - spheres[:, :3])
                    - spheres[:, 3]
                ).min()
            )
        ),
        "only the worst axis: near an edge two axes are out, take the length of all three": _gap(
            lambda out: out.max(axis=1)
        ),
        "the three axes are summed: the way is slanting, take the root of their squares": _gap(
            lambda out: out.sum(axis=1)
        ),
        "the square root is missing": _gap(lambda out: (out**2).sum(axis=1)),
        "the mean over the spheres: the nearest one hits": _gap(_norm, np.mean),
        "the largest gap: the nearest sphere hits, take the least": _gap(_norm, np.max),
        "a middle below the lower corner is out too: look at both sides": (
            lambda spheres, low, high: float(
                (_norm(np.maximum(spheres[:, :3] - high, 0.0)) - spheres[:, 3]).min()
            )
        ),
    },
    hints=(
        "How far is each middle out along each axis: low - m on one side, m - high on the other.",
        "np.maximum(np.maximum(low - m, m - high), 0), its norm, less the radius; then the least.",
    ),
    tested_on="30 boxes with one to six spheres before faces, edges and corners",
)


def _ways(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(30):
        joints = 4 if k % 3 else 3
        path = np.cumsum(rng.normal(size=(2 + k % 7, joints)), axis=0)
        if k % 5 == 4:  # a point twice
            path = np.insert(path, 1, path[0], axis=0)
        cases.append((path, rng.uniform(0.4, 2.0, joints)))
    return cases


def _steps(path: NDArray, limit: NDArray) -> NDArray:
    return np.abs(np.diff(path, axis=0)) / limit


TIMES = Exercise(
    number="11.6",
    title="The busiest joint",
    reference=segment_times,
    cases=_ways,
    oracle="one_joint_is_at_its_limit_and_none_beyond",
    mistakes={
        "one joint after the other: they move at the same time, the slowest decides": (
            lambda path, limit: _steps(path, limit).sum(axis=1)
        ),
        "the mean of the joints: the slowest would be too fast": (
            lambda path, limit: _steps(path, limit).mean(axis=1)
        ),
        "the quickest joint decides: take the largest time, not the least": (
            lambda path, limit: _steps(path, limit).min(axis=1)
        ),
        "a norm over the joints: each joint has a limit of its own": (
            lambda path, limit: np.linalg.norm(_steps(path, limit), axis=1)
        ),
        "only the swing is looked at": lambda path, limit: _steps(path, limit)[:, 0],
        "a joint that turns backwards takes time too: take the absolute value": (
            lambda path, limit: (np.diff(path, axis=0) / limit).max(axis=1)
        ),
        "an angle times a speed is no time: divide": (
            lambda path, limit: (np.abs(np.diff(path, axis=0)) * limit).max(axis=1)
        ),
        "one limit for all: each joint has its own": (
            lambda path, limit: (np.abs(np.diff(path, axis=0)) / limit.max()).max(axis=1)
        ),
        "that is when each point is reached: the times of the pieces are asked for": (
            lambda path, limit: np.cumsum(segment_times(path, limit))
        ),
    },
    hints=(
        "np.diff(path, axis=0) has one row a piece; how long would each joint need for its part?",
        "np.abs(...) / speed_limit, and of each row the largest.",
    ),
    tested_on="30 ways of three and four joints, six with a point twice",
)

_PITCH = np.radians(-172.0)


def _hauls(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(2):
        truck = replace(
            LOADING.truck, x=rng.uniform(0.4, 1.4), y=rng.uniform(5.0, 5.2), floor=1.25, wall=2.05
        )
        world = arm_world(replace(LOADING, truck=truck), margin=0.3)
        start = _level((0.4 + rng.uniform(5.3, 5.7), rng.uniform(-1.0, 0.5), (2.9, 3.3)[k]))
        cases.append((start, _level((truck.x - 0.4, truck.y + 0.3, 3.85)), world))
    return cases


def _level(place: tuple[float, float, float]) -> NDArray:
    q = inverse_kinematics((*place, 0.0))
    q[3] = _PITCH - pitch(q)
    return q


def _is_a_way(
    answer: NDArray, reference: NDArray, start: NDArray, goal: NDArray, world: ArmWorld
) -> str | None:
    path = np.asarray(answer, dtype=float)
    if path.ndim != 2 or path.shape[1] != 4 or len(path) < 2 or not np.isfinite(path).all():
        return "give finite angles of four joints, one posture a row, two rows or more"
    if np.abs(path[0] - start).max() > 1e-6 or np.abs(path[-1] - goal).max() > 1e-6:
        return "the way must begin at start and end at goal"
    parts = [np.linspace(a, b, int(np.abs(b - a).max() / 0.01) + 2) for a, b in pairwise(path)]
    dense = np.concatenate(parts)
    if np.maximum(world.lower - dense, dense - world.upper).max() > 1e-9:
        return "a joint leaves its range"
    if world.clearance(dense).min() < world.margin - 0.05:
        return "the way comes nearer to something than the world's margin"
    tilt = np.degrees(np.abs(pitch(dense) - pitch(start)).max())
    return f"the bucket tilts by {tilt:.0f} degrees on the way" if tilt > 8.0 else None


def _search(start: NDArray, goal: NDArray, world: ArmWorld) -> NDArray:
    ends = world.lower, world.upper
    return rrt_connect(start, goal, world.is_free, *ends, step=0.4, resolution=0.04)


def _held(start: NDArray, goal: NDArray, world: ArmWorld) -> NDArray:
    path = level_way(start, goal, world)
    path[:, 3] = start[3]
    return path


WAY = Exercise(
    number="11.7",
    title="Your way to the truck",
    reference=level_way,
    cases=_hauls,
    oracle="level_all_the_way_and_no_mesh_in_a_box",
    mistakes={
        "straight in the joints: level, but through the truck; search a way": (
            lambda start, goal, world: np.array([start, goal])
        ),
        "the way is free, but the bucket tilts on it: plan swing, boom and stick, and let the "
        "bucket follow": _search,
        "the bucket's joint is held: hold its pitch, and the joint follows boom and stick": _held,
        "these are three joints: LevelWorld.joints gives all four": (
            lambda start, goal, world: level_way(start, goal, world)[:, :3]
        ),
        "the way runs from the goal to the start": (
            lambda start, goal, world: level_way(start, goal, world)[::-1]
        ),
        "the goal itself is missing at the end": (
            lambda start, goal, world: level_way(start, goal, world)[:-1]
        ),
    },
    hints=(
        "level = LevelWorld(world, pitch(start)); search from start[:3] to goal[:3] in it.",
        "rrt_connect(..., level.is_free, level.lower, level.upper); return level.joints(path).",
    ),
    compare=_is_a_way,
    timeout=60.0,
    tested_on="two trucks and starts: clearance, joints and the bucket's tilt every 0.6 deg",
)

EXERCISES = (GAP, TIMES, WAY)
