"""Exercises on movement: what a joint does to the teeth, how many buckets, how much time."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.lessons.exercise import Exercise, Mistake
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
        mistakes=(
            Mistake(
                "a radian",
                lambda q: _travel(q, np.linalg.norm, turn=1.0),
                "you turn each joint by one radian: one degree is np.radians(1.0)",
            ),
            Mistake(
                "height",
                lambda q: _travel(q, lambda d: abs(d[2])),
                "that is the change of height alone: the distance has x and y in it as well",
            ),
            Mistake(
                "from above",
                lambda q: _travel(q, lambda d: np.linalg.norm(d[:2])),
                "that is what one sees from above: the height z belongs to the distance as well",
            ),
            Mistake(
                "stick",
                lambda q: _travel(q, np.linalg.norm, frame="stick"),
                "that is the stick's tip, where the bucket hangs: the teeth are the frame 'tip'",
            ),
            Mistake(
                "added up",
                _all_turned,
                "the joints before are still turned: start from q again for each joint",
            ),
            Mistake(
                "square",
                lambda q: _travel(q, lambda d: d @ d),
                "that is the square of the distance: take the root, or np.linalg.norm",
            ),
            Mistake(
                "sum",
                lambda q: _travel(q, lambda d: np.abs(d).sum()),
                "distances along x, y and z do not just add up: take np.linalg.norm",
            ),
            Mistake(
                "vectors",
                lambda q: _travel(q, lambda d: d),
                "those are the displacements: one distance for each joint is asked, four numbers",
            ),
        ),
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
        mistakes=(
            Mistake(
                "rounded down",
                lambda truck_volume, bucket_volume, fill: int(
                    truck_volume / (bucket_volume * fill)
                ),
                "the truck is not quite full: round up, the last bucket may be a small one",
            ),
            Mistake(
                "not rounded",
                lambda truck_volume, bucket_volume, fill: truck_volume / (bucket_volume * fill),
                "a machine cannot dig part of a time: a whole number is asked, rounded up",
            ),
            Mistake(
                "rounded to the nearest",
                lambda truck_volume, bucket_volume, fill: round(
                    truck_volume / (bucket_volume * fill)
                ),
                "rounding to the nearest leaves some trucks not full: always round up",
            ),
            Mistake(
                "full buckets",
                lambda truck_volume, bucket_volume, fill: math.ceil(truck_volume / bucket_volume),
                "you count on full buckets: a dig brings in bucket_volume * fill",
            ),
            Mistake(
                "fill the other way",
                lambda truck_volume, bucket_volume, fill: math.ceil(
                    truck_volume / bucket_volume * fill
                ),
                "fill is on the wrong side: emptier buckets mean more of them, not fewer",
            ),
            Mistake(
                "one more",
                lambda truck_volume, bucket_volume, fill: (
                    int(truck_volume / (bucket_volume * fill)) + 1
                ),
                "one too many when it comes out even: 6 m^3 are 12 buckets of 0.5 m^3",
            ),
        ),
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
        mistakes=(
            Mistake(
                "sum",
                lambda q_way, share: _times(q_way, share, over_joints=np.sum),
                "the joints move together, not one after the other: the slowest counts, no sum",
            ),
            Mistake(
                "mean",
                lambda q_way, share: _times(q_way, share, over_joints=np.mean),
                "that is the mean over the joints: the slowest decides, so the longest time counts",
            ),
            Mistake(
                "norm",
                lambda q_way, share: _times(q_way, share, over_joints=np.linalg.norm),
                "joints that move together are no triangle: the longest time counts",
            ),
            Mistake(
                "slowest limit",
                lambda q_way, share: (
                    np.max(np.abs(np.diff(q_way, axis=0)), axis=1)
                    / (share * np.min(BACKHOE.speed_limit))
                ),
                "the slowest joint is not always the one that turns most: divide joint by joint",
            ),
            Mistake(
                "sign taken off too late",
                lambda q_way, share: np.abs(_times(q_way, share, size=np.asarray)),
                "the sign goes too late: first np.abs of the turns, then the largest",
            ),
            Mistake(
                "since the start",
                lambda q_way, share: np.cumsum(_times(q_way, share)),
                "those times count from the start: each segment has its own, from one way-point on",
            ),
            Mistake(
                "one for each way-point",
                lambda q_way, share: np.append(0.0, _times(q_way, share)),
                "that is one time too many: n way-points have n - 1 segments, without a leading 0",
            ),
            Mistake(
                "quickest joint",
                lambda q_way, share: _times(q_way, share, over_joints=np.min),
                "that is the joint which is ready first: all must be, so the longest time counts",
            ),
            Mistake(
                "no size",
                lambda q_way, share: _times(q_way, share, size=np.asarray),
                "a joint that turns back needs time too: take np.abs of the turns",
            ),
            Mistake(
                "full speed",
                lambda q_way, share: _times(q_way, 1.0),
                "share is not used: a joint may use share * BACKHOE.speed_limit only",
            ),
            Mistake(
                "share the other way",
                lambda q_way, share: _times(q_way, 1 / share),
                "share is on the wrong side: a smaller share of the speed needs more time",
            ),
            Mistake(
                "one limit for all",
                lambda q_way, share: (
                    np.max(np.abs(np.diff(q_way, axis=0)), axis=1)
                    / (share * np.max(BACKHOE.speed_limit))
                ),
                "each joint has its own largest speed: divide joint by joint, then look for the "
                "longest time",
            ),
            Mistake(
                "whole way",
                lambda q_way, share: np.sum(_times(q_way, share)),
                "that is the time of the whole way: one time for each segment is asked",
            ),
            Mistake(
                "joint by joint",
                lambda q_way, share: np.abs(np.diff(q_way, axis=0)) / (share * BACKHOE.speed_limit),
                "that is a time for each joint: take the largest along axis 1",
            ),
        ),
        hints=(
            "np.diff(q_way, axis=0) is how far each joint turns in each segment, with its sign",
            "time = turn / speed, joint by joint; np.max(..., axis=1) picks the slowest joint",
        ),
    ),
)
