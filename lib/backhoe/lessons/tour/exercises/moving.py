"""Exercises on movement: what a joint does to the teeth, how much time it needs."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.lessons.exercise import Exercise
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


def _way_cases(rng: np.random.Generator) -> list[tuple[NDArray, float]]:
    shares = rng.uniform(0.2, 0.9, 20)
    return [(rng.uniform(BACKHOE.lower, BACKHOE.upper, (6, 4)), float(share)) for share in shares]


def _travel(
    measure: Callable = np.linalg.norm,
    turn: float = math.radians(1.0),
    frame: str = "tip",
    joints: Callable[[int], NDArray] = np.eye,
) -> Callable[[NDArray], NDArray]:
    """`measure` of how the origin of `frame` moves, for each row of joints that turn."""

    def travel(q: NDArray) -> NDArray:
        postures = [q, *(q + turn * joints(4))]
        before, *after = kinematics.forward_kinematics(postures, frame)[:, :3, 3]
        return np.array([measure(place - before) for place in after])

    return travel


def _times(
    longest: Callable = np.max,
    size: Callable = np.abs,
    speed: Callable = lambda share: share * BACKHOE.speed_limit,
) -> Callable[[NDArray, float], NDArray]:
    return lambda q_way, share: longest(size(np.diff(q_way, axis=0)) / speed(share), axis=1)


MOVING = (
    Exercise(
        number="0.4",
        title="Which joint moves the teeth most?",
        reference=tip_travel,
        oracle="chord_about_each_joint",
        cases=lambda rng: [(q,) for q in rng.uniform(BACKHOE.lower, BACKHOE.upper, (20, 4))],
        rtol=1e-3,
        atol=1e-5,
        tested_on="20 random postures",
        mistakes={
            "you turn each joint by one radian: one degree is np.radians(1.0)": _travel(turn=1.0),
            "that is the change of height alone: the distance has x and y in it as well": (
                _travel(lambda d: abs(d[2]))
            ),
            "that is what one sees from above: the height z belongs to the distance as well": (
                _travel(lambda d: np.linalg.norm(d[:2]))
            ),
            "that is the stick's tip, where the bucket hangs: the teeth are the frame 'tip'": (
                _travel(frame="stick")
            ),
            "the joints before are still turned: start from q again for each joint": (
                _travel(joints=np.tri)
            ),
            "that is the square of the distance: take the root, or np.linalg.norm": (
                _travel(lambda d: d @ d)
            ),
            "distances along x, y and z do not just add up: take np.linalg.norm": (
                _travel(lambda d: np.abs(d).sum())
            ),
            "those are the displacements: one distance for each joint is asked, four numbers": (
                _travel(lambda d: d)
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
        title="How fast may the machine be?",
        reference=segment_times,
        oracle="busiest_joint_at_its_share",
        cases=_way_cases,
        tested_on="20 random movements of six postures",
        mistakes={
            "the joints move together, not one after the other: the slowest counts, no sum": (
                _times(np.sum)
            ),
            "that is the mean over the joints: the slowest decides, so the longest time counts": (
                _times(np.mean)
            ),
            "joints that move together are no triangle: the longest time counts": (
                _times(np.linalg.norm)
            ),
            "the slowest joint is not always the one that turns most: divide joint by joint": (
                _times(speed=lambda share: share * np.min(BACKHOE.speed_limit))
            ),
            "the sign goes too late: first np.abs of the turns, then the largest": (
                lambda *given: np.abs(_times(size=np.asarray)(*given))
            ),
            "those times count from the start: each segment has its own, from one way-point on": (
                lambda *given: np.cumsum(segment_times(*given))
            ),
            "that is one time too many: n way-points have n - 1 segments, without a leading 0": (
                lambda *given: np.append(0.0, segment_times(*given))
            ),
            "that is the joint which is ready first: all must be, so the longest time counts": (
                _times(np.min)
            ),
            "a joint that turns back needs time too: take np.abs of the turns": (
                _times(size=np.asarray)
            ),
            "share is not used: a joint may use share * BACKHOE.speed_limit only": (
                lambda q_way, share: segment_times(q_way, 1.0)
            ),
            "share is on the wrong side: a smaller share of the speed needs more time": (
                lambda q_way, share: segment_times(q_way, 1 / share)
            ),
            "each joint has its own largest speed: divide joint by joint, then take the longest": (
                _times(speed=lambda share: share * np.max(BACKHOE.speed_limit))
            ),
            "that is the time of the whole way: one time for each segment is asked": (
                lambda *given: np.sum(segment_times(*given))
            ),
            "that is a time for each joint: take the largest along axis 1": (
                _times(lambda times, axis: times)
            ),
        },
        hints=(
            "np.diff(q_way, axis=0) is how far each joint turns in each segment, with its sign",
            "time = turn / speed, joint by joint; np.max(..., axis=1) picks the slowest joint",
        ),
    ),
)
