"""From the heap to the truck and back without touching it, and without spilling."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.kinematics import inverse_kinematics, pose
from backhoe.machine import BACKHOE, Machine
from backhoe.mission.autonomy.eyes import at, filled
from backhoe.mission.hauling import arm_world
from backhoe.planning.search import ArmWorld, in_time, pitch, rrt_connect, shortcut
from backhoe.simulation.scene import Scene, Truck
from backhoe.view.appearance.truck import CAB_GAP, CAB_LENGTH

MARGINS = (0.4, 0.2, 0.05, 0.0)
"""Distances from the truck that are tried, one after another [m]."""

LEVEL = np.radians(-175.0)
"""Pitch of a bucket that is carried full [rad]."""

FULL = np.radians(30.0)
"""A bucket whose pitch is no further from `LEVEL` may be full [rad]."""

FAST = np.array([0.5, 0.5, 0.7, 1.3])
"""Speeds at which the joints move from place to place [rad/s]."""

SOFT = np.array([0.4, 0.5, 0.9, 2.0])
"""How fast they speed up and slow down then [rad/s^2]."""

RAISED = 4.2
"""A way that would begin in what is around begins by raising the stick's tip to this [m]."""

DETOURS = ((4.6, 4.2), (4.2, 4.6), (5.0, 4.6))
"""Reach and height of the stick's tip [m] half way, of the simple ways that are tried first."""

SIDE, CELLS = 9.0, 91
"""Half side of the ground that is looked at [m], and cells along it."""

OWN = 2.2
"""So far around it the ground is that on which the machine stands [m]."""

STEEP = 0.8
"""Single cells of the map may be wrong: around each the ground is taken to fall no faster [1]."""

_AROUND = np.mgrid[-6:7, -6:7]

DENSE = 0.02
"""Between two postures of a way that are looked at [rad]."""


def world_seen(
    truck: Truck, terrain: object, belief: NDArray, margin: float, machine: Machine
) -> ArmWorld:
    """What the arm must not touch, as the machine sees it, in its base frame.

    The truck is taken to stand along the machine's nose, and for as much wider as it does not.

    Args:
        truck: where it was seen, in the world.
        terrain: the map; unknown ground is taken for level.
        belief: x, y, heading of the machine, shape (3,) [m, m, rad].
        margin: to keep [m].
        machine: whose arm.
    """
    from scipy.ndimage import grey_dilation, median_filter

    c, s = np.cos(belief[2]), np.sin(belief[2])
    dx, dy = truck.x - belief[0], truck.y - belief[1]
    nose = truck.bed_length / 2 + CAB_GAP + CAB_LENGTH
    near = replace(
        truck,
        x=float(dx * c + dy * s),
        y=float(dy * c - dx * s),
        bed_width=float(truck.bed_width + 2 * nose * abs(s)),
    )
    scene = Scene((-SIDE, -SIDE), CELLS, CELLS, 2 * SIDE / (CELLS - 1), truck=near)
    x, y = scene.grid()
    wx, wy = belief[0] + x * c - y * s, belief[1] + x * s + y * c
    heights = np.nan_to_num(at(filled(np.asarray(terrain.heights)), wx, wy), nan=0.0)
    heights = np.where(np.hypot(x, y) < OWN, 0.0, median_filter(heights, 3))
    heights = grey_dilation(heights, structure=-STEEP * np.hypot(*_AROUND) * scene.cell)
    return arm_world(scene, heights, margin=margin, machine=machine)


def around(start: NDArray, goal: NDArray, is_free: Callable) -> NDArray:
    """A way of the joints (n, 4) [rad] from start (4,) to goal (4,): simple if that is free.

    First straight, then by a posture half way that is higher and nearer; else RRT-Connect searches.
    A bucket that is level enough to be full at both ends stays so: it is then searched in three
    joints, and the fourth follows.
    """
    level = bool((np.abs(pitch(np.stack([start, goal])) - LEVEL) < FULL).all())
    for way in _simple(start, goal, level):
        if is_free(dense(way)).all():
            return way
    lower, upper = BACKHOE.lower, BACKHOE.upper
    if not level:
        path = rrt_connect(start, goal, is_free, lower, upper)
        return shortcut(path, is_free, DENSE)
    ends = pitch(np.stack([start, goal]))

    def joints(p: NDArray) -> NDArray:
        share = np.clip((p[..., :1] - start[0]) / (goal[0] - start[0] + 1e-9), 0.0, 1.0)
        wanted = ends[0] + share * (ends[1] - ends[0])
        bucket = wanted - pitch(np.concatenate([p, np.zeros_like(share)], axis=-1))[..., None]
        return np.concatenate([p, bucket.clip(lower[3], upper[3])], axis=-1)

    def free(p: NDArray) -> NDArray:
        return is_free(joints(p))

    path = rrt_connect(start[:3], goal[:3], free, lower[:3], upper[:3])
    return joints(dense(shortcut(path, free, DENSE)))


def raised(q: NDArray, machine: Machine = BACKHOE) -> NDArray:
    """A posture (4,) [rad] above another, in the same direction, its bucket at the same pitch."""
    x, y, z, _ = pose(q, machine=machine)
    up = inverse_kinematics([x, y, max(z, RAISED), 0.0], machine=machine)
    up[3] = np.clip(q[1:].sum() - up[1:3].sum(), machine.lower[3], machine.upper[3])
    return up


def carrying(q: NDArray, machine: Machine = BACKHOE) -> float:
    """Angle of the bucket's joint that keeps a full bucket level, for boom and stick of q [rad]."""
    angle = LEVEL - float(pitch(np.array([*q[:3], 0.0]), machine))
    return float(np.clip(angle, machine.lower[3], machine.upper[3]))


def moved(path: NDArray) -> tuple[NDArray, NDArray]:
    """Times (m,) [s] and joint angles (m, 4) [rad] of a way (n, 4) from rest to rest."""
    timed = in_time(path, FAST, SOFT, dt=0.02)
    if len(timed.times) < 2:
        return np.array([0.0, 0.02]), np.repeat(timed.q, 2, axis=0)
    return timed.times, timed.q


def dense(path: NDArray) -> NDArray:
    """A way (n, 4) [rad] with postures no further from each other than `DENSE`, (m, 4)."""
    pieces = [
        np.linspace(a, b, max(int(np.abs(b - a).max() / DENSE), 1), endpoint=False)
        for a, b in pairwise(path)
    ]
    return np.concatenate([*pieces, path[-1:]])


def _simple(start: NDArray, goal: NDArray, level: bool) -> list[NDArray]:
    swing = (start[0] + goal[0]) / 2 + np.pi / 2
    ways = [np.stack([start, goal])]
    top = pose(np.stack([start, goal]))[:, 2].max()
    for reach, height in DETOURS:
        x, y = BACKHOE.base.offset + reach * np.cos(swing), reach * np.sin(swing)
        q = inverse_kinematics([x, y, max(height, top), 0.0], on_failure="nan")
        if np.isfinite(q).all():
            q[3] = carrying(q) if level else (start[3] + goal[3]) / 2
            ways.append(np.stack([start, q, goal]))
    if level:
        return [_levelled(way) for way in ways]
    return ways


def _levelled(way: NDArray) -> NDArray:
    """A way whose bucket turns evenly from its first to its last pitch."""
    ends, way = pitch(way[[0, -1]]), dense(way)
    share = np.linspace(0.0, 1.0, len(way))
    now = pitch(np.c_[way[:, :3], np.zeros(len(way))])
    bucket = ends[0] + share * (ends[1] - ends[0]) - now
    way[:, 3] = bucket.clip(BACKHOE.lower[3], BACKHOE.upper[3])
    return way
