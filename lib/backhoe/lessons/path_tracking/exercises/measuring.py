"""Exercises 5.1 and 5.2: what a ratio of lengths says; the four measures of a run."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import pi

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons import published
from backhoe.lessons.exercise import Exercise
from backhoe.vehicle.tracking import Metrics, distances, distances_to_samples, length, metrics

RADIUS = 1.5  # m, section 5.3.1 of D'Angelo 2022


def missing_length() -> float:
    """How much shorter a run of 1.084 circles is than the shortest that covers the circle [m]."""
    table = published.load("dangelo_2022_table_51")
    radius, ratio = table["circle_radius"], table["P"]["circle"]["d_ratio"]
    circle = 2 * pi * radius
    shortest = radius + circle
    return shortest - ratio * circle


MISSING = Exercise(
    number="5.1",
    title="What 1.084 says",
    reference=missing_length,
    oracle="a_run_out_and_once_round",
    mistakes={
        "that is the length of that drive: how much is missing from the shortest one?": (
            lambda: RADIUS + 2 * pi * RADIUS - missing_length()
        ),
        "that is a difference of ratios: times the length of the circle it is metres": (
            lambda: missing_length() / (2 * pi * RADIUS)
        ),
        "that compares with the circle alone: the way from the centre to it is 1.5 m more": (
            lambda: RADIUS - missing_length()
        ),
        "a circle is 2 pi r long, with r = 1.5 m": lambda: (RADIUS + missing_length()) / 2,
        "the sign: that drive is shorter than the shortest one that covers the circle": (
            lambda: -missing_length()
        ),
    },
    hints=(
        "Three lengths: the circle, the straight way from its centre to it, and that drive.",
        "That drive is 1.084 times the circle; the shortest covering one is 1.5 m + circle.",
    ),
    rtol=0.0,
    atol=0.01,
)


def _cases(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(12):
        corners = np.cumsum(rng.uniform(-2.0, 2.0, (rng.integers(4, 8), 2)), axis=0)
        places = np.linspace(0, len(corners) - 1, 30)
        along = [np.interp(places, range(len(corners)), axis) for axis in corners.T]
        run = np.column_stack(along) + rng.normal(0.0, 0.2, (30, 2))
        cases.append((np.vstack((corners[0] + rng.uniform(-3, 3, 2), run)), corners))
    return cases


def _with(
    ratio: Callable[[NDArray, NDArray], float] | None = None,
    spread: Callable[[NDArray], float] = np.std,
    distances: Callable[[NDArray, NDArray], NDArray] = distances,
) -> Callable[[NDArray, NDArray], Metrics]:
    """The measures with one of them, or the distances below all, worked out in another way."""

    def wrong(actual: NDArray, path: NDArray) -> Metrics:
        d = distances(actual, path)
        d_ratio = ratio(actual, path) if ratio else length(actual) / length(path)
        return Metrics(d.mean(), spread(d), d.max(), d_ratio)

    return wrong


def _to_lines(actual: NDArray, path: NDArray, least: float = 0.0) -> NDArray:
    """Distances to segments without an end, and with least = -inf without a start [m]."""
    way, to_point = np.diff(path, axis=0), actual[:, None] - path[:-1]
    share = np.maximum((to_point * way).sum(axis=-1) / (way**2).sum(axis=-1), least)
    return np.linalg.norm(to_point - share[..., None] * way, axis=-1).min(axis=1)


METRICS = Exercise(
    number="5.2",
    title="The four measures of a run",
    reference=metrics,
    oracle="distances_in_the_frames_of_the_segments",
    cases=_cases,
    mistakes={
        "that is the distance to the nearest way-point: the path also runs between them": (
            _with(
                distances=lambda actual, path: np.linalg.norm(actual[:, None] - path, axis=-1).min(
                    axis=1
                )
            )
        ),
        "your segments go on for ever: keep the share along each between 0 and 1": (
            _with(distances=partial(_to_lines, least=-np.inf))
        ),
        "your segments have a start but no end: the share along each is at most 1": (
            _with(distances=_to_lines)
        ),
        "that is from each way-point to the run: ask from each point of the run to the path": (
            _with(distances=lambda actual, path: distances(path, actual))
        ),
        "you lead the path back to its first point: it ends at its last": (
            lambda actual, path: metrics(actual, np.vstack((path, path[:1])))
        ),
        "d_std is the square root of that: the standard deviation, not the variance": (
            _with(spread=np.var)
        ),
        "d_std is over all points of the run: divide by their number K, not by K - 1": (
            _with(spread=partial(np.std, ddof=1))
        ),
        "d_ratio is upside down: the length of the run over that of the path": (
            _with(lambda actual, path: length(path) / length(actual))
        ),
        "d_ratio itself is asked, 1 for a perfect run; the charts take |d_ratio - 1|": (
            _with(lambda actual, path: length(actual) / length(path) - 1)
        ),
        "a length is the sum of all small steps, not the distance from first to last point": (
            _with(lambda actual, path: length(actual[[0, -1]]) / length(path[[0, -1]]))
        ),
        "nearly: that samples the path finely; the distance to a segment needs no sampling": (
            _with(distances=partial(distances_to_samples, samples=100))
        ),
    },
    hints=(
        "Point p, segment from a to b: the foot of p lies the share (p - a).(b - a)/|b - a|^2 "
        "along it.",
        "Clip the share to 0..1, take the distance to a + share (b - a), then the least of all.",
    ),
    tested_on="12 random paths, with runs that miss them",
)
