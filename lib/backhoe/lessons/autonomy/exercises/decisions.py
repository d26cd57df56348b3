"""Exercises of sitting 14a: what a strip brings, which one pays, a queue of movements, a choice."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE
from backhoe.mission import autonomy
from backhoe.mission.autonomy import DIRECTIONS, REACHES, Strip, choice

__all__ = ["EXERCISES"]

WIDTH = BACKHOE.shell.width


def strip_fill(surface: NDArray, bottom: NDArray, reaches: NDArray, start: float) -> float:
    """Soil in the bucket, from heights of the ground and of the edge along a strip."""
    depth = np.clip(surface - bottom, 0.0, None)
    return float(autonomy.bucket_fill(depth, reaches, start))


def _profiles(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(24):
        reaches = np.arange(35 - k % 4, 71) / 10 + 0.1 * (k % 5)
        start, height = reaches[rng.integers(17, 29)], (0.15, 0.4, 1.2)[k % 3]
        surface = height * np.exp(
            -(((reaches - rng.uniform(4.5, 6.5)) / rng.uniform(0.5, 1.2)) ** 2)
        )
        bottom = rng.uniform(0.0, 0.4) + 0.15 * (reaches - start)
        bottom[reaches > start] += 2 * (reaches - start)[reaches > start]
        cases.append((surface, bottom, reaches, start))
    return cases


def _filled(
    depth: Callable, lost: float = 0.3, most: float = 0.7, width: float = WIDTH
) -> Callable:
    def answer(surface, bottom, reaches, start):
        kept = reaches <= start - lost + 1e-9
        step = reaches[1] - reaches[0]
        return min(width * step * float(np.sum(depth(surface - bottom)[kept])), most)

    return answer


_cut = partial(np.clip, a_min=0.0, a_max=None)

STRIP = Exercise(
    number="14.1",
    title="What a strip brings",
    reference=strip_fill,
    cases=_profiles,
    oracle="slices_of_the_cut_one_by_one",
    mistakes={
        "where the edge is above the ground it cuts nothing: no depth is negative": _filled(
            lambda depth: depth
        ),
        "the first 0.3 m count too: that soil is pushed aside": _filled(_cut, lost=0.0),
        "a bucket holds 0.7 m^3: what is more does not count": _filled(_cut, most=np.inf),
        "that is the area of the cut: times the bucket's width, 1.2 m": _filled(_cut, width=1.0),
        "the sum of the depths is no volume yet: times the step between two reaches": (
            lambda surface, bottom, reaches, start: min(
                WIDTH * float(np.sum(_cut(surface - bottom)[reaches <= start - 0.3 + 1e-9])), 0.7
            )
        ),
        "the edge comes nearer: count what lies nearer than the start, not beyond it": (
            lambda surface, bottom, reaches, start: min(
                WIDTH * 0.1 * float(np.sum(_cut(surface - bottom)[reaches >= start + 0.3])), 0.7
            )
        ),
        "all of the ground is counted: only what is above the edge is cut": (
            lambda surface, bottom, reaches, start: _filled(lambda depth: depth)(
                surface, 0 * bottom, reaches, start
            )
        ),
    },
    hints=(
        "Depth of the cut: surface - bottom, where that is positive. Sum it, times step and width.",
        "Keep the reaches up to start - 0.3 (add 1e-9 for rounding), and at most 0.7 at the end.",
    ),
    tested_on="24 strips through low, middling and high heaps, eight of which fill the bucket",
)


def which_strip(fill: NDArray, side: NDArray, directions: NDArray, truck: float) -> tuple[int, int]:
    """Row and column of the strip that pays best; -1, -1 where none may be dug."""
    return autonomy.best_of(fill, side, directions, truck) or (-1, -1)


def _tables(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(30):
        directions = np.radians(np.arange(-75, 61, 15) + 10 * (k % 3 - 1))
        fill = rng.uniform(0.35, 0.7, (len(directions), 4))
        side = rng.uniform(-30e3, 30e3, fill.shape)
        if k % 6 == 4:
            fill *= 0.14
        if k % 6 == 5:
            side = np.sign(side) * rng.uniform(20.5e3, 40e3, fill.shape)
        cases.append((fill, side, directions, (np.pi / 2, -1.2, -2.6)[k % 3]))
    return cases


def _by_rate(
    may: Callable, time: Callable = lambda swing: 13.2 + 2 * swing / (np.pi / 8)
) -> Callable:
    def answer(fill, side, directions, truck):
        allowed = may(fill, side)
        rate = np.where(allowed, fill / time(np.abs(truck - directions))[:, None], 0.0)
        i, k = np.unravel_index(rate.argmax(), rate.shape)
        return (int(i), int(k)) if allowed[i, k] else (-1, -1)

    return answer


def _both(fill: NDArray, side: NDArray) -> NDArray:
    return (np.abs(side) <= 20e3) & (fill >= 0.1)


def _signed(fill: NDArray, side: NDArray, directions: NDArray, truck: float) -> tuple:
    allowed = _both(fill, side)
    time = 13.2 + 2 * (truck - directions) / (np.pi / 8)
    rate = np.where(allowed, fill / time[:, None], -np.inf)
    i, k = np.unravel_index(rate.argmax(), rate.shape)
    return (int(i), int(k)) if allowed[i, k] else (-1, -1)


CHOICE = Exercise(
    number="14.2",
    title="Which strip pays",
    reference=which_strip,
    cases=_tables,
    oracle="no_strip_that_may_be_dug_pays_more",
    mistakes={
        "that is the fullest bucket: a second counts too, divide by the cycle's time": _by_rate(
            _both, lambda swing: 13.2 + 0 * swing
        ),
        "side loads are not looked at: the swing holds 20 kN m": _by_rate(
            lambda fill, side: fill >= 0.1
        ),
        "a side load of -30 kN m is as bad as one of +30: take its magnitude": _by_rate(
            lambda fill, side: (side <= 20e3) & (fill >= 0.1)
        ),
        "nothing is worth digging below 0.1 m^3: then the answer is -1, -1": _by_rate(
            lambda fill, side: np.abs(side) <= 20e3
        ),
        "the bucket swings twice a cycle, there and back": _by_rate(
            _both, lambda swing: 13.2 + swing / (np.pi / 8)
        ),
        "digging and emptying take 13.2 s beside the swings": _by_rate(
            _both, lambda swing: 2 * swing / (np.pi / 8)
        ),
        "the truck may stand on the right: a swing takes its magnitude's time": _signed,
    },
    hints=(
        "time = 13.2 + 2 * abs(truck - directions) / (pi / 8); rate = fill / time[:, None].",
        "Set the rate to 0 where abs(side) > 20e3 or fill < 0.1; np.unravel_index(rate.argmax(), "
        "rate.shape) gives row and column.",
    ),
    tested_on="30 tables of 40 strips, ten with none to dig, the truck left, right and behind",
)


BRAKING = 0.5


def queue(durations: list[float], cancels: dict[int, float]) -> NDArray:
    """How each movement ends: 1 if it succeeded, else 0, when, and which share was done."""
    now, ends = 0.0, []
    for number, duration in enumerate(durations):
        cancelled = cancels.get(number, np.inf)
        if cancelled <= now:
            ends.append((0.0, cancelled, 0.0))
        elif cancelled < now + duration:
            ends.append((0.0, cancelled + BRAKING, (cancelled - now) / duration))
            now = cancelled + BRAKING
        else:
            now += duration
            ends.append((1.0, now, 1.0))
    return np.array(ends)


def _queues(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(24):
        durations = [float(d) for d in rng.integers(4, 17, 2 + k % 3)]
        number = int(rng.integers(len(durations)))
        at = float(np.round(rng.uniform(0.5, sum(durations) + 3), 1)) + 0.05
        cases.append((durations, {number: at} if k % 6 else {}))
    return cases


def _queue_with(
    waits: bool = True,
    brakes: bool = True,
    status: float = 0.0,
    share: bool = True,
    stops: bool = True,
    late: bool = False,
) -> Callable:
    def answer(durations, cancels):
        now, ends = 0.0, []
        for number, duration in enumerate(durations):
            at = cancels.get(number, np.inf)
            if waits and at <= now:
                ends.append((status, at, 0.0))
            elif at < now + duration:
                at = max(at, now)
                if not stops:
                    now += duration
                    ends.append((status, now, 1.0))
                    continue
                done = (at - now) / duration if share else 1.0
                ends.append((status, at + BRAKING * brakes, done))
                now = at + BRAKING * brakes
            else:
                now += duration
                ends.append((0.0 if late and at < np.inf else 1.0, now, 1.0))
        return np.array(ends)

    return answer


QUEUE = Exercise(
    number="14.3",
    title="Repair the queue",
    reference=queue,
    cases=_queues,
    oracle="a_clock_that_ticks_through_the_queue",
    mistakes={
        "a movement that was cancelled while it waited never begins: it takes no time": _queue_with(
            waits=False
        ),
        "the machine needs 0.5 s to come to rest before the next may begin": _queue_with(
            brakes=False
        ),
        "whoever cancels is told so: what was cancelled has not succeeded": _queue_with(status=1.0),
        "the last feedback is the share that was done, not 1": _queue_with(share=False),
        "a cancelled movement goes on to its end: the machine has to stop": _queue_with(
            stops=False
        ),
        "what is over cannot be cancelled: it has succeeded": _queue_with(late=True),
    },
    hints=(
        "Three cases: cancelled before it begins, while it moves, and after its end.",
        "Only the second takes time: from its begin to the cancel, and 0.5 s to come to rest.",
    ),
    tested_on="24 queues of two to four movements, cancelled early, in motion and late",
)


def my_own_choice(
    heights: NDArray, deviation: NDArray, directions: NDArray, reaches: NDArray
) -> Strip | None:
    """The library's choice; yours may well be a better one."""
    return autonomy.best_strip(heights, deviation, directions, reaches)


def _views(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(4):
        heights = np.zeros((len(DIRECTIONS), len(REACHES)))
        for _ in range(1 + k % 3):
            at, r = rng.uniform(-0.9, 0.6), rng.uniform(5.0, 6.2)
            away = (DIRECTIONS[:, None] - at) * REACHES, REACHES - r
            heights += rng.uniform(0.7, 1.3) * np.exp(-(away[0] ** 2 + away[1] ** 2) / 1.2)
        heights = autonomy.seen(heights) + 0.01 * rng.normal(size=heights.shape)
        deviation = np.where(np.isnan(heights), np.nan, 0.02)
        cases.append((heights, deviation, DIRECTIONS.copy(), REACHES.copy()))
    return cases


def _rate(strip: Strip, heights: NDArray) -> float:
    """Expected soil a second [m^3/s]."""
    fill = autonomy.expected_fill(strip, heights, DIRECTIONS, REACHES)
    return float(fill) / autonomy.cycle_time(strip.direction)


def _pays(answer: object, reference: Strip, heights: NDArray, *view: NDArray) -> str | None:
    if np.shape(answer) != (3,) or not np.isfinite(np.array(answer, float)).all():
        return "give a Strip: direction [rad], start [m], depth [m], three finite numbers"
    strip = Strip(*(float(value) for value in answer))
    if not DIRECTIONS[0] - 0.1 <= strip.direction <= DIRECTIONS[-1] + 0.1:
        return "the direction is outside the map: radians from straight ahead, to the left"
    if not choice.STARTS[0] - 0.11 <= strip.start <= choice.STARTS[-1] + 0.11:
        return "the start is out of the arm's reach: 5.1 to 6.4 m from the swing axis"
    if not 0 < strip.depth <= 1.0:
        return "the depth is that of the cut below the surface: above 0, at most 1 m"
    if abs(autonomy.side_load(strip, heights, DIRECTIONS, REACHES)) > choice.MOST_SIDE_LOAD:
        return "the strip lies on a flank: its side load is above 20 kN m"
    share = _rate(strip, heights) / _rate(reference, heights)
    if share < 0.85:
        return f"it may be dug, but brings {share:.0%} of the library's soil a second"
    return None


def _nearest(heights, deviation, directions, reaches):
    for direction in directions[::-1]:
        strips = Strip(float(direction), choice.STARTS, np.full(len(choice.STARTS), 0.6))
        fill = autonomy.expected_fill(strips, heights, directions, reaches)
        if fill.max() > choice.LEAST:
            return strips._replace(start=float(choice.STARTS[fill.argmax()]), depth=0.6)


OWN = Exercise(
    number="14.4",
    title="Your own choice",
    reference=my_own_choice,
    cases=_views,
    oracle="best_of_strips_tried_at_random",
    mistakes={
        "that is the highest place: soil a second is what counts": autonomy.highest_strip,
        "the direction is in degrees: radians": (
            lambda *view: (s := my_own_choice(*view))._replace(direction=57.3 * s.direction)
        ),
        "that is a row's number, not a direction: directions[i]": (
            lambda *view: (s := my_own_choice(*view))._replace(
                direction=float(np.abs(DIRECTIONS - s.direction).argmin())
            )
        ),
        "the shortest swing first: what the strip brings counts as much": _nearest,
        "the start is the distance from the swing axis, not from where the heap begins": (
            lambda *view: (s := my_own_choice(*view))._replace(start=s.start - 4.0)
        ),
    },
    hints=(
        "Begin with expected_fill of every strip, as in section 3, and your choice of 14.2.",
        "expected_fill and side_load of mission.autonomy take a Strip and the map.",
    ),
    compare=_pays,
    timeout=30.0,
    tested_on="four maps of one to three heaps, parts of them hidden",
)

EXERCISES = (STRIP, CHOICE, QUEUE, OWN)
