"""The operator's dig, learnt once as a primitive and bent to any strip: a stroke for `run`.

The demonstration swings out from low beside the heap. Learnt is what comes after, from where the
edge is farthest out: down into the soil, along, curled and lifted. It is learnt seen from the swing
axis, as reach, height and slope of the bucket, so that a strip in another direction is the same
movement, and one farther out has the bucket at the same slope to the ground.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.kinematics import forward_kinematics, inverse_kinematics
from backhoe.basics import inputs
from backhoe.machine import BACKHOE
from backhoe.mission.autonomy.choice import LEVEL, Strip, edge_height
from backhoe.planning.dmp import DMP, demonstration
from backhoe.planning.foresight import foresee, nearest_reachable

ENTRY = 0.4
"""Height at which the demonstrated edge, on its way down, is at its strip's start [m]."""

ABOVE, DOWN = 1.3, 1.8
"""So far above the primitive's start it comes from [m], in this time [s]."""

CURLED = np.radians(-8.0)
"""Slope of the bucket in the end, as of the hand-made stroke [rad]."""

STEP, TRIES = 0.1, 5
"""Between two samples of the path [s]; how often the start is raised."""

OFF = 0.02
"""What a stroke may be beyond the arm's reach, and is then drawn in [m]."""

SHY = 0.01
"""Angle by which the bucket keeps off the ends of its joint [rad]."""

_OFFSET = BACKHOE.base.offset


class Learnt(NamedTuple):
    """The primitive of reach [m], height [m] and slope [rad], and its edge's `entry`: reach and
    height where it comes to its strip's start, shape (2,) [m]."""

    primitive: DMP
    entry: NDArray


@lru_cache(maxsize=1)
def learnt() -> Learnt:
    """What was learnt from `planning.dmp.demonstration`."""
    times, positions = demonstration("dig")
    q = inverse_kinematics(positions)
    edge = _seen(forward_kinematics(q)[:, :3, 3])
    first = int(edge[:, 0].argmax())
    shape = np.c_[_seen(positions[:, :3]), q[:, 1:].sum(axis=1)]
    down = first + int(np.argmax(edge[first:, 1] < ENTRY))
    return Learnt(DMP().learn(shape[first:], times[first:] - times[first]), edge[down])


def learnt_stroke(
    strip: Strip,
    heights: NDArray,
    directions: NDArray,
    reaches: NDArray,
    remedy: str = "minimum_jerk",
) -> tuple[NDArray, NDArray]:
    """The way of a strip as the operator digs it; arguments and result as `choice.stroke`.

    The primitive starts and ends as much farther out and higher as the strip begins, and its bucket
    ends as level as it is carried. Where that would bring the edge under `LEVEL`, it is higher.

    Args:
        strip, heights, directions, reaches: as for `choice.stroke`.
        remedy: how the primitive goes to the new start and goal, a name in `dmp.REMEDIES`. The
            default keeps the entry where the strip has it: there its shift is hardly less yet.

    Returns:
        Times from 0 on, (n,) [s]; x, y, z of the stick's tip [m] and the bucket joint's angle
        [rad] then, (n, 4).

    Raises:
        ValueError: a strip of other numbers, one out of the arm's reach, or an unknown remedy.
    """
    strip = Strip(*inputs.numbers(strip, "strip", (3,), meaning="direction, start, depth").tolist())
    primitive, entry = learnt()
    height = edge_height(strip, heights, directions, reaches)
    shift = np.array([strip.start - entry[0], height - entry[1], 0.0])
    for _ in range(TRIES):
        start = primitive.start + shift
        goal = primitive.goal + shift
        goal[2] = CURLED
        t, shape, _ = primitive.rollout(start, goal, remedy=remedy, dt=STEP)
        shape = np.vstack([shape[0] + (0.0, ABOVE, 0.0), shape])
        seen = foresee(_path(shape), np.r_[0.0, t + DOWN])
        low = LEVEL - forward_kinematics(seen.q)[:, 2, 3].min()
        if low <= 0 or seen.out_by.max() > OFF:
            break
        shift[1] += 1.2 * low
    if seen.out_by.max() > OFF:
        raise ValueError(f"the learnt stroke of {strip} cannot be dug: {seen}")
    times = seen.times * max(1.0, float(seen.use.max()))
    path, (c, s) = seen.nearest, (np.cos(strip.direction), np.sin(strip.direction))
    reach = path[:, 0] - _OFFSET
    return times, np.c_[_OFFSET + reach * c, reach * s, path[:, 2:]]


def _path(shape: NDArray) -> NDArray:
    """Reach, height and slope (n, 3) as x, y, z and the bucket's angle straight ahead, (n, 4)."""
    ahead = np.c_[_OFFSET + shape[:, 0], np.zeros(len(shape)), shape[:, 1], np.zeros(len(shape))]
    _, q = nearest_reachable(ahead)
    bucket = shape[:, 2] - q[:, 1:3].sum(axis=1)
    ahead[:, 3] = np.clip(bucket, BACKHOE.lower[3] + SHY, BACKHOE.upper[3] - SHY)
    return ahead


def _seen(points: NDArray) -> NDArray:
    """Reach from the swing axis and height of points (n, 3), shape (n, 2) [m]."""
    return np.c_[np.hypot(points[:, 0] - _OFFSET, points[:, 1]), points[:, 2]]
