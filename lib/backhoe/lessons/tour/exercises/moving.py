"""Exercises on movement: what a joint does to the teeth, how many buckets, how much time."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.tour.exercises.reading import random_postures
from backhoe.machine import BACKHOE


def tip_travel(q: ArrayLike) -> NDArray:
    """How far the bucket's teeth move when one joint turns by one degree.

    Args:
        q: joint angles, shape (4,) [rad].

    Returns:
        The distance for each joint turned alone, shape (4,) [m].
    """
    before = kinematics.forward_kinematics(q)[:3, 3]
    travel = np.empty(4)
    for joint in range(4):
        turned = np.array(q)
        turned[joint] += np.radians(1.0)
        after = kinematics.forward_kinematics(turned)[:3, 3]
        travel[joint] = np.linalg.norm(after - before)
    return travel


def loads(truck_volume: float, bucket_volume: float, fill: float) -> int:
    """How many buckets fill the truck.

    Args:
        truck_volume: what the truck holds [m^3].
        bucket_volume: what the bucket holds when it is level full [m^3].
        fill: the part of that which one dig brings in, about 0.6 to 1.1.
    """
    return math.ceil(truck_volume / (bucket_volume * fill))


def segment_times(q_way: ArrayLike, share: float) -> NDArray:
    """Shortest time from each posture to the next, within a share of the joints' speeds.

    Args:
        q_way: postures in order, shape (n, 4) [rad].
        share: how much of its largest speed a joint may use on average, above 0 up to 1.

    Returns:
        One time for each of the n - 1 segments, that of the joint which needs longest [s].
    """
    turns = np.abs(np.diff(q_way, axis=0))
    return np.max(turns / (share * BACKHOE.speed_limit), axis=1)


def _load_cases(rng: np.random.Generator) -> list[tuple[float, float, float]]:
    low, high = (4.0, 0.3, 0.6), (12.0, 0.9, 1.1)
    return [(6.0, 0.5, 1.0), *(tuple(map(float, rng.uniform(low, high))) for _ in range(20))]


def _travel(q: ArrayLike, measure, turn: float = math.radians(1.0), frame: str = "tip") -> NDArray:
    """`measure` of the displacement that each joint's `turn` gives the origin of `frame`."""
    before = kinematics.forward_kinematics(q, frame)[:3, 3]
    turned = np.asarray(q) + turn * np.eye(4)
    return np.array(
        [measure(p - before) for p in kinematics.forward_kinematics(turned, frame)[:, :3, 3]]
    )


def _all_turned(q: ArrayLike) -> NDArray:
    turned = np.asarray(q) + math.radians(1.0) * np.tri(5, 4, -1)
    points = kinematics.forward_kinematics(turned)[:, :3, 3]
    return np.linalg.norm(points[1:] - points[0], axis=1)


def _times(q_way: ArrayLike, share: float, over_joints=np.max, size=np.abs) -> NDArray:
    return over_joints(size(np.diff(q_way, axis=0)) / (share * BACKHOE.speed_limit), axis=1)


MOVING = (
    Exercise(
        number="0.4",
        title="Which joint moves the teeth most?",
        reference=tip_travel,
        cases=lambda rng: [(q,) for q in random_postures(rng, 20)],
        rtol=1e-3,
        atol=1e-5,
        tested_on="20 random postures",
        mistakes={
            "you turn each joint by one radian: one degree is np.radians(1.0)": (
                lambda q: _travel(q, np.linalg.norm, turn=1.0)
            ),
            "that is the change of height alone: the distance has x and y in it as well": (
                lambda q: _travel(q, lambda d: abs(d[2]))
            ),
            "that is what one sees from above: the height z belongs to the distance as well": (
                lambda q: _travel(q, lambda d: np.linalg.norm(d[:2]))
            ),
            "that is the stick's tip, where the bucket hangs: the teeth are the frame 'tip'": (
                lambda q: _travel(q, np.linalg.norm, frame="stick")
            ),
            "the joints before are still turned: start from q again for each joint": _all_turned,
            "that is the square of the distance: take the root, or np.linalg.norm": (
                lambda q: _travel(q, lambda d: d @ d)
            ),
            "distances along x, y and z do not just add up: take np.linalg.norm": (
                lambda q: _travel(q, lambda d: np.abs(d).sum())
            ),
            "those are the displacements: one distance for each joint is asked, four numbers": (
                lambda q: _travel(q, lambda d: d)
            ),
        },
        hints=(
            "where are the teeth before and after? kinematics.forward_kinematics(q)[:3, 3] tells",
            "for each joint: copy q, add np.radians(1.0) to that joint alone, and measure the "
            "distance between the two places with np.linalg.norm",
        ),
    ),
    Exercise(
        number="0.5",
        title="How many buckets fill the truck?",
        reference=loads,
        cases=_load_cases,
        tested_on="21 trucks and buckets",
        mistakes={
            "the truck is not quite full: round up, the last bucket may be a small one": (
                lambda truck_volume, bucket_volume, fill: int(truck_volume / (bucket_volume * fill))
            ),
            "a machine cannot dig part of a time: a whole number is asked, rounded up": (
                lambda truck_volume, bucket_volume, fill: truck_volume / (bucket_volume * fill)
            ),
            "rounding to the nearest leaves some trucks not full: always round up": (
                lambda truck_volume, bucket_volume, fill: round(
                    truck_volume / (bucket_volume * fill)
                )
            ),
            "you count on full buckets: a dig brings in bucket_volume * fill": (
                lambda truck_volume, bucket_volume, fill: math.ceil(truck_volume / bucket_volume)
            ),
            "fill is on the wrong side: emptier buckets mean more of them, not fewer": (
                lambda truck_volume, bucket_volume, fill: math.ceil(
                    truck_volume / bucket_volume * fill
                )
            ),
            "one too many when it comes out even: 6 m^3 are 12 buckets of 0.5 m^3": (
                lambda truck_volume, bucket_volume, fill: (
                    int(truck_volume / (bucket_volume * fill)) + 1
                )
            ),
        },
        hints=(
            "how much soil does one bucket bring? how often does that go into the truck?",
            "math.ceil rounds up to the next whole number",
        ),
    ),
    Exercise(
        number="0.6",
        title="How fast may the machine be?",
        reference=segment_times,
        cases=lambda rng: [
            (random_postures(rng, 6), float(share)) for share in rng.uniform(0.2, 0.9, 20)
        ],
        tested_on="20 random movements of six postures",
        mistakes={
            "the joints move together, not one after the other: the slowest counts, no sum": (
                lambda q_way, share: _times(q_way, share, over_joints=np.sum)
            ),
            "that is the mean over the joints: the slowest decides, so the longest time counts": (
                lambda q_way, share: _times(q_way, share, over_joints=np.mean)
            ),
            "joints that move together are no triangle: the longest time counts": (
                lambda q_way, share: _times(q_way, share, over_joints=np.linalg.norm)
            ),
            "the slowest joint is not always the one that turns most: divide joint by joint": (
                lambda q_way, share: (
                    np.max(np.abs(np.diff(q_way, axis=0)), axis=1)
                    / (share * np.min(BACKHOE.speed_limit))
                )
            ),
            "the sign goes too late: first np.abs of the turns, then the largest": (
                lambda q_way, share: np.abs(_times(q_way, share, size=np.asarray))
            ),
            "those times count from the start: each segment has its own, from one way-point on": (
                lambda q_way, share: np.cumsum(_times(q_way, share))
            ),
            "that is one time too many: n way-points have n - 1 segments, without a leading 0": (
                lambda q_way, share: np.append(0.0, _times(q_way, share))
            ),
            "that is the joint which is ready first: all must be, so the longest time counts": (
                lambda q_way, share: _times(q_way, share, over_joints=np.min)
            ),
            "a joint that turns back needs time too: take np.abs of the turns": (
                lambda q_way, share: _times(q_way, share, size=np.asarray)
            ),
            "share is not used: a joint may use share * BACKHOE.speed_limit only": (
                lambda q_way, share: _times(q_way, 1.0)
            ),
            "share is on the wrong side: a smaller share of the speed needs more time": (
                lambda q_way, share: _times(q_way, 1 / share)
            ),
            (
                "each joint has its own largest speed: divide joint by joint, then look for the "
                "longest time"
            ): (
                lambda q_way, share: (
                    np.max(np.abs(np.diff(q_way, axis=0)), axis=1)
                    / (share * np.max(BACKHOE.speed_limit))
                )
            ),
            "that is the time of the whole way: one time for each segment is asked": (
                lambda q_way, share: np.sum(_times(q_way, share))
            ),
            "that is a time for each joint: take the largest along axis 1": (
                lambda q_way, share: np.abs(np.diff(q_way, axis=0)) / (share * BACKHOE.speed_limit)
            ),
        },
        hints=(
            "np.diff(q_way, axis=0) is how far each joint turns in each segment, with its sign",
            "time = turn / speed, joint by joint; np.max(..., axis=1) picks the slowest joint",
        ),
    ),
)
