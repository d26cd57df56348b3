"""Exercise 6.9: the effective gauge that a log with a measured heading asks for."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.angles import wrap
from backhoe.lessons.exercise import Exercise


def gauge_from_log(left: NDArray, right: NDArray, heading: NDArray, radius: float) -> float:
    """Gauge [m] with which turns of the belts explain those of the heading by least squares."""
    belts = radius * (right - right[0] - left + left[0])
    return float(belts @ belts / (belts @ (heading - heading[0])))


def _ratio(belts: NDArray, turn: NDArray) -> float:
    return float(belts @ belts / (belts @ turn))


def _raw_heading(left: NDArray, right: NDArray, heading: NDArray, radius: float) -> float:
    return _ratio(radius * (right - right[0] - left + left[0]), heading)


def _logs(rng: np.random.Generator) -> list[tuple]:
    """Turns to the left, to the right, both ways and in reverse; ends at all sides of the start."""
    cases = []
    for turning in (0.3, -0.3, 0.05, -0.05) * 4:
        n, gauge = int(rng.integers(30, 90)), float(rng.uniform(1.5, 3.5))
        radius, dt = float(rng.uniform(0.2, 0.5)), rng.uniform(0.05, 0.8, n)
        omega = turning + np.cumsum(rng.normal(0, 0.08, n))
        way, turn = np.cumsum([rng.uniform(-1, 1.5, n) * dt, omega * dt], axis=1)
        way, turn = way - way[0], turn - turn[0]
        start = rng.uniform(-9, 9, (3, 1))
        left, right = (way + np.outer((-1, 1), turn) * gauge / 2) / radius + start[:2]
        heading = start[2] + turn + rng.normal(0, 0.02, n)
        cases.append((left, right, heading, radius))
    return cases


def _of(change: Callable) -> Callable[..., float]:
    """`change` of the way of the belts against each other and of the turn, since the first row."""

    def answer(left: NDArray, right: NDArray, heading: NDArray, radius: float) -> float:
        belts = radius * (right - right[0] - left + left[0])
        with np.errstate(all="ignore"):
            return float(change(belts, heading - heading[0]))

    return answer


LOG = Exercise(
    number="6.9",
    title="The gauge from a log",
    reference=gauge_from_log,
    oracle="heading_is_explained_no_better_beside_it",
    cases=_logs,
    mistakes={
        "upside down: that is 1 / l, which multiplies the belts' difference": (
            _of(lambda belts, turn: belts @ turn / (belts @ belts))
        ),
        "that fits the belts to the heading: the headings' misses are asked for, with 1 / l": (
            _of(lambda belts, turn: belts @ turn / (turn @ turn))
        ),
        "the last row alone: its noise counts fully, and a drive may have turned back by then": (
            _of(lambda belts, turn: belts[-1] / turn[-1])
        ),
        "a mean of quotients: rows with little turn are nearly 0 / 0 and outweigh the others": (
            _of(lambda belts, turn: np.mean(belts[1:] / turn[1:]))
        ),
        "quotient of two sums: left and right cancel in them, squares do not": (
            _of(lambda belts, turn: np.sum(belts) / np.sum(turn))
        ),
        "quotient of two means of sizes: the least sum of squares has another l": (
            _of(lambda belts, turn: np.sum(np.abs(belts)) / np.sum(np.abs(turn)))
        ),
        "from row to row the noise of the heading outweighs the turn: count from the first row": (
            _of(lambda b, turn: np.diff(b) @ np.diff(b) / (np.diff(b) @ np.diff(turn)))
        ),
        "the line is free to miss the first row: both changes are 0 there, so fit no offset": (
            _of(lambda belts, turn: 1 / np.polyfit(belts, turn, 1)[0])
        ),
        "the line through the belts has a free offset, and is that of the belts over the turn": (
            _of(lambda belts, turn: np.polyfit(turn, belts, 1)[0])
        ),
        "heading and angles count from their own zeros: take the first row off each": (
            lambda left, right, heading, radius: _ratio(radius * (right - left), heading)
        ),
        "the heading counts from its own zero: take its first row off": _raw_heading,
        "left and right are swapped: a faster right track turns the machine to the left": (
            lambda left, right, *given: gauge_from_log(right, left, *given)
        ),
        "belts run at r times the sprockets' angles: the radius is missing": (
            lambda left, right, heading, radius: gauge_from_log(left, right, heading, 1.0)
        ),
        "half of it: the whole difference of the belts is l times the turn": (
            lambda *given: gauge_from_log(*given) / 2
        ),
        "twice as much: the difference of the belts is l times the turn, without a half": (
            lambda *given: gauge_from_log(*given) * 2
        ),
        "the headings are in radians already": (
            lambda left, right, heading, radius: gauge_from_log(
                left, right, np.degrees(heading), radius
            )
        ),
        "the heading is wrapped: what you are given counts on through full turns": (
            lambda left, right, heading, radius: gauge_from_log(
                left, right, heading[0] + wrap(heading - heading[0]), radius
            )
        ),
    },
    hints=(
        "With m = 1 / l the misses are turn - m b, a straight line through 0: m = b.turn / b.b.",
        "b = radius * (right - right[0] - left + left[0]); b @ b / (b @ (heading - heading[0])).",
    ),
    tested_on="16 logs with uneven rows, to the left, to the right and both ways",
)
