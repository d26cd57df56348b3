"""Exercises of sitting 14b: a report, an alarm that can be trusted, a stroke of one's own."""

from __future__ import annotations

from collections.abc import Callable
from math import radians

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.kinematics import forward_kinematics, inverse_kinematics
from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE
from backhoe.mission import autonomy
from backhoe.mission.autonomy import DIRECTIONS, REACHES, Strip

__all__ = ["EXERCISES"]

HEAPED = 0.764


def site_report(
    begins: NDArray, ends: NDArray, dug: NDArray, loaded: NDArray, time: NDArray, power: NDArray
) -> NDArray:
    """Mean cycle [s], fill factor [1], m^3/h in the truck, and kWh, from a log."""
    cycle = (begins[-1] - begins[0]) / (len(begins) - 1)
    hours = (ends[-1] - begins[0]) / 3600
    work = np.maximum(power[1:], 0.0) @ np.diff(time)
    return np.array([cycle, dug.mean() / HEAPED, loaded.sum() / hours, work / 3.6e6])


def _logs(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(12):
        n = 3 + k % 4
        begins = 10.0 + np.cumsum(rng.uniform(24, 32, n))
        ends = begins + rng.uniform(17, 22, n)
        dug = rng.uniform(0.3, 0.75, n)
        time = np.cumsum(rng.uniform(0.3, 0.9, 400))
        power = 1e3 * rng.uniform(-40, 90, 400)
        cases.append((begins, ends, dug, dug * rng.uniform(0.85, 0.98, n), time, power))
    return cases


def _reported(**other: Callable) -> Callable:
    """The report with one of its numbers made in another way."""
    order = ("cycle", "fill", "rate", "energy")

    def answer(*log):
        numbers = site_report(*log)
        for name, make in other.items():
            numbers[order.index(name)] = make(*log)
        return numbers

    return answer


REPORT = Exercise(
    number="14.5",
    title="A report of the site",
    reference=site_report,
    cases=_logs,
    oracle="a_foremans_book",
    mistakes={
        "a cycle goes from begin to begin: the way back to the heap belongs to it": _reported(
            cycle=lambda begins, ends, *_: (ends - begins).mean()
        ),
        "n buckets have n - 1 cycles between their begins": _reported(
            cycle=lambda begins, *_: (begins[-1] - begins[0]) / len(begins)
        ),
        "the fill factor is of what was dug, before any was spilled": _reported(
            fill=lambda b, e, dug, loaded, *_: loaded.mean() / HEAPED
        ),
        "m^3/h is of what is in the truck, not of what was dug": _reported(
            rate=lambda b, e, dug, *_: 3600 * dug.sum() / (e[-1] - b[0])
        ),
        "an hour has 3600 s: that is m^3 a minute": _reported(
            rate=lambda b, e, dug, loaded, *_: 60 * loaded.sum() / (e[-1] - b[0])
        ),
        "what the machine brakes does not come back: power below 0 counts as 0": _reported(
            energy=lambda *log: log[5][1:] @ np.diff(log[4]) / 3.6e6
        ),
        "a kWh is 3.6e6 J": _reported(energy=lambda *log: 3600 * site_report(*log)[3]),
        "the steps of the log are uneven: each power times its own step": _reported(
            energy=lambda *log: np.maximum(log[5], 0).mean() * (log[4][-1] - log[4][0]) / 3.6e6
        ),
    },
    hints=(
        "Cycle: from the first begin to the last, over one less than the buckets.",
        "np.maximum(power[1:], 0) @ np.diff(time) is the work in joules; 3.6e6 J are a kWh.",
    ),
    tested_on="12 logs of three to six buckets, with uneven steps",
)


GAUGE, RADIUS = BACKHOE.tracks.gauge, BACKHOE.tracks.sprocket_radius


def alarm(gyro: NDArray, left: NDArray, right: NDArray, sigma: float, count: int) -> int:
    """Row at which `count` residuals in a row have been beyond 3 sigma; -1 if there is none."""
    residual = gyro - (right - left) * RADIUS / GAUGE
    beyond, run = np.abs(residual) > 3 * sigma, 0
    for row, is_beyond in enumerate(beyond):
        run = run + 1 if is_beyond else 0
        if run == count:
            return row
    return -1


def _drives(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(24):
        n, sigma = 120, 10 ** rng.uniform(-3, -1.3)
        speed = (-1) ** (k // 4) * rng.uniform(1.0, 3.0, n)
        turn = (-1) ** k * rng.uniform(0.15, 0.4) * np.sin(np.arange(n) / rng.uniform(8, 20))
        left, right = (speed - s * turn * GAUGE / 2 / RADIUS for s in (1, -1))
        gyro = turn + sigma * rng.normal(size=n)
        places = rng.choice(n, 8, replace=False)
        gyro[places] += rng.choice([-9, 9], 8) * sigma  # spikes
        start = int(rng.integers(30, 60))
        if k % 4 == 1:
            gyro[start:] *= -1
        elif k % 4 == 2:
            gyro[start:] -= 6 * sigma
        elif k % 4 == 3:
            gyro[start:] += 6 * sigma
        cases.append((gyro, left, right, sigma, int(rng.integers(4, 9))))
    return cases


def _alarmed(
    residual: Callable = lambda gyro, rate: gyro - rate,
    beyond: Callable = lambda r, sigma: np.abs(r) > 3 * sigma,
    row: Callable = lambda runs, count: np.flatnonzero(runs == count),
    shift: Callable = lambda count: 0,
    radius: float = RADIUS,
    gauge: float = GAUGE,
) -> Callable:
    def answer(gyro, left, right, sigma, count):
        flags = beyond(residual(gyro, (right - left) * radius / gauge), sigma)
        runs, run = np.zeros(len(flags)), 0
        for i, flag in enumerate(flags):
            run = run + 1 if flag else 0
            runs[i] = run
        found = row(runs, count)
        return int(found[0]) + shift(count) if len(found) else -1

    return answer


ALARM = Exercise(
    number="14.6",
    title="An alarm that can be trusted",
    reference=alarm,
    cases=_drives,
    oracle="words_of_ones",
    mistakes={
        "one spike is no fault: wait until it has been so count times in a row": _alarmed(
            row=lambda runs, count: np.flatnonzero(runs == 1)
        ),
        "the threshold is 3 sigma: at 1 sigma good noise gives an alarm": _alarmed(
            beyond=lambda r, sigma: np.abs(r) > sigma
        ),
        "a residual may err to both sides: take its magnitude": _alarmed(
            beyond=lambda r, sigma: r > 3 * sigma
        ),
        "turning left the right track is the faster: (right - left)": _alarmed(
            residual=lambda gyro, rate: gyro + rate
        ),
        "that is when it began: the alarm comes when it is sure, count - 1 rows later": _alarmed(
            shift=lambda count: 1 - count
        ),
        "in a row, not in all: a good residual begins the count anew": (
            lambda gyro, left, right, sigma, count: (
                int(found[count - 1])
                if len(
                    found := np.flatnonzero(
                        np.abs(gyro - (right - left) * RADIUS / GAUGE) > 3 * sigma
                    )
                )
                >= count
                else -1
            )
        ),
        "the tracks turn it by the difference over the whole gauge, not half of it": _alarmed(
            gauge=GAUGE / 2
        ),
    },
    hints=(
        "residual = gyro - (right - left) * 0.35 / 2.38; beyond = abs(residual) > 3 * sigma.",
        "Count up while it is beyond, back to 0 when not; at count return the row.",
    ),
    tested_on="24 drives with spikes: sound, reversed, and with a bias to both sides",
)


def own_stroke(
    strip: Strip, heights: NDArray, directions: NDArray, reaches: NDArray
) -> tuple[NDArray, NDArray]:
    """The mission's part, the hand-made stroke moved to the strip."""
    return autonomy.stroke(strip, heights, directions, reaches)


def _strips(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(6):
        away = (DIRECTIONS[:, None] - 0.1 * k) * REACHES, REACHES - 5.5
        heights = (0.8 + 0.1 * k) * np.exp(-(away[0] ** 2 + away[1] ** 2) / 2.0)
        direction = float(DIRECTIONS[np.abs(DIRECTIONS - (-1) ** k * 0.1 * (k + 1)).argmin()])
        strip = Strip(direction, float(rng.uniform(5.4, 6.2)), float(rng.uniform(0.2, 0.4)))
        cases.append((strip, heights, DIRECTIONS.copy(), REACHES.copy()))
    return cases


def _digs(
    answer: object, reference: object, strip: Strip, heights: NDArray, *_: NDArray
) -> str | None:
    try:
        times, path = (np.asarray(part, dtype=float) for part in answer)
    except (TypeError, ValueError):
        return "give two arrays: times (n,) and path (n, 4)"
    if path.ndim != 2 or path.shape[1:] != (4,) or times.shape != path.shape[:1]:
        return "give times (n,) and path (n, 4): x, y, z of the stick's tip, bucket angle"
    if not (np.isfinite(path).all() and (np.diff(times) > 0).all() and times[-1] < 25):
        return "times rise, and a stroke takes less than 25 s; no NaN"
    try:
        q = inverse_kinematics(path)
    except ValueError as error:
        return f"out of the arm's reach: {error}"
    x, y, z = forward_kinematics(q)[:, :3, 3].T
    x = x - BACKHOE.base.offset
    if np.abs(np.arctan2(y, x) - strip.direction).max() > 0.05:
        return "the stroke leaves its strip: keep to its direction, seen from the swing axis"
    surface = np.interp(
        strip.start, REACHES, heights[np.abs(DIRECTIONS - strip.direction).argmin()]
    )
    if z.min() < -0.03:
        return "the edge goes below the ground that the machine stands on"
    near = np.abs(np.hypot(x, y) - strip.start) < 0.2
    wanted = max(surface - strip.depth, 0.3)
    if not near.any() or np.abs(z[near] - wanted).min() > 0.15:
        return "the edge should come down at the strip's start, to its depth below the surface"
    slope = q[-1, 1:].sum() - inverse_kinematics(reference[1])[-1, 1:].sum()
    if z[-1] < 2.0 or abs(slope) > radians(25):
        return "in the end the bucket is curled and lifted clear of the heap"
    return None


def _moved_by(change: Callable) -> Callable:
    def answer(strip, heights, directions, reaches):
        times, path = own_stroke(strip, heights, directions, reaches)
        return change(strip, times, path)

    return answer


def _turned(path: NDArray, angle: float) -> NDArray:
    path, axis = path.copy(), np.array([BACKHOE.base.offset, 0.0])
    c, s = np.cos(angle), np.sin(angle)
    path[:, :2] = axis + (path[:, :2] - axis) @ np.array([[c, s], [-s, c]])
    return path


STROKE = Exercise(
    number="14.7",
    title="Your parts in the machine",
    reference=own_stroke,
    cases=_strips,
    oracle="a_stroke_that_begins_and_ends_right",
    mistakes={
        "the direction is turned the other way: left is positive": _moved_by(
            lambda strip, times, path: (times, _turned(path, -2 * strip.direction))
        ),
        "straight ahead whatever the strip says: turn the path by its direction": _moved_by(
            lambda strip, times, path: (times, _turned(path, -strip.direction))
        ),
        "the depth is below the surface at the start, not below the ground": (
            lambda strip, heights, *view: own_stroke(
                Strip(strip.direction, strip.start, strip.depth + 0.5), heights, *view
            )
        ),
        "the bucket's angle is in degrees: radians": _moved_by(
            lambda strip, times, path: (times, path * [1, 1, 1, 57.3])
        ),
        "the bucket is not lifted: the stroke ends above the heap": _moved_by(
            lambda strip, times, path: (times[:-1], path[:-1])
        ),
        "that is the time of each part: times count from the start on": _moved_by(
            lambda strip, times, path: (np.r_[0.0, np.diff(times)], path)
        ),
        "the path comes first: times, path": _moved_by(lambda strip, times, path: (path, times)),
    },
    hints=(
        "autonomy.stroke gives one; move, stretch or replace it by your primitive of lesson 10.",
        "Put the edge, not the stick's tip, at the strip's start: forward_kinematics tells where.",
    ),
    compare=_digs,
    timeout=20.0,
    tested_on="six strips to both sides, in heaps of 0.8 to 1.3 m",
)

EXERCISES = (REPORT, ALARM, STROKE)
