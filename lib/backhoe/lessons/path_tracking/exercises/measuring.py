"""Exercises 5.1 and 5.2: what a printed ratio of lengths says; the four measures of a run."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.lessons import published
from backhoe.lessons.exercise import Exercise

RADIUS = 1.5  # m, section 5.3.1 of the source


def missing_length() -> float:
    """How much shorter the printed run is than the shortest one that covers the circle [m]."""
    table = published.load("dangelo_2022_table_51")
    radius, ratio = table["circle_radius"], table["P"]["circle"]["d_ratio"]
    circle = 2 * pi * radius
    shortest = radius + circle
    return shortest - ratio * circle


def _printed_ratio() -> float:
    return published.load("dangelo_2022_table_51")["P"]["circle"]["d_ratio"]


MISSING = Exercise(
    number="5.1",
    title="What 1.084 says",
    reference=missing_length,
    mistakes={
        "that is the length of the printed run: how much is missing from the shortest one?": (
            lambda: _printed_ratio() * 2 * pi * RADIUS
        ),
        "that is a difference of ratios: times the length of the circle it is metres": (
            lambda: 1 + 1 / (2 * pi) - _printed_ratio()
        ),
        "that compares with the circle alone: the way from the centre to it is 1.5 m more": (
            lambda: (_printed_ratio() - 1) * 2 * pi * RADIUS
        ),
        "a circle is 2 pi r long, with r = 1.5 m": (
            lambda: RADIUS + pi * RADIUS - _printed_ratio() * pi * RADIUS
        ),
        "the sign: the printed run is shorter than the shortest one that covers the circle": (
            lambda: -missing_length()
        ),
    },
    hints=(
        "Three lengths: the circle, the straight way from its centre to it, and the printed run.",
        "The printed run is 1.084 times the circle; the shortest covering one is 1.5 m + circle.",
    ),
    rtol=0.0,
    atol=0.01,
)


def metrics(actual: ArrayLike, reference: ArrayLike) -> NDArray:
    """d_mean, d_std, d_max [m] and d_ratio [1] of a run (K, 2) against a path (N, 2) [m]."""
    distances = _distances(actual, reference)
    ratio = _length(actual) / _length(reference)
    return np.array([distances.mean(), distances.std(), distances.max(), ratio])


def _distances(points: ArrayLike, path: ArrayLike, low: float = 0.0, high: float = 1.0) -> NDArray:
    """Distance of each point to the nearest segment of the path [m]."""
    start, way = path[:-1], np.diff(path, axis=0)
    to_point = points[:, None] - start
    share = np.clip((to_point * way).sum(axis=-1) / (way**2).sum(axis=-1), low, high)
    return np.linalg.norm(to_point - share[..., None] * way, axis=-1).min(axis=1)


def _length(points: ArrayLike) -> float:
    return np.linalg.norm(np.diff(points, axis=0), axis=1).sum()


def _cases(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(12):
        corners = np.cumsum(rng.uniform(-2.0, 2.0, (rng.integers(4, 8), 2)), axis=0)
        places = np.linspace(0, len(corners) - 1, 30)
        along = [np.interp(places, range(len(corners)), axis) for axis in corners.T]
        run = np.column_stack(along) + rng.normal(0.0, 0.2, (30, 2))
        cases.append((np.vstack((corners[0] + rng.uniform(-3, 3, 2), run)), corners))
    return cases


def _with(index: int, value: object) -> object:
    """The measures with the one at `index` worked out by `value(actual, reference)`."""

    def wrong(actual: ArrayLike, reference: ArrayLike) -> NDArray:
        measured = metrics(actual, reference)
        measured[index] = value(actual, reference)
        return measured

    return wrong


def _from(distance: object) -> object:
    """The measures with the distances worked out by `distance(actual, reference)`."""

    def wrong(actual: ArrayLike, reference: ArrayLike) -> NDArray:
        d = distance(actual, reference)
        ratio = _length(actual) / _length(reference)
        return np.array([d.mean(), d.std(), d.max(), ratio])

    return wrong


def _to_vertices(actual: NDArray, reference: NDArray) -> NDArray:
    return np.linalg.norm(actual[:, None] - reference, axis=-1).min(axis=1)


def _to_resampled(actual: NDArray, reference: NDArray, count: int = 100) -> NDArray:
    places = np.linspace(0, len(reference) - 1, count)
    finer = [np.interp(places, range(len(reference)), axis) for axis in reference.T]
    return _to_vertices(actual, np.column_stack(finer))


def _closed(reference: NDArray) -> NDArray:
    return np.vstack((reference, reference[:1]))


METRICS = Exercise(
    number="5.2",
    title="The four measures of a run",
    reference=metrics,
    cases=_cases,
    mistakes={
        "that is the distance to the nearest way-point: the path also runs between them": (
            _from(_to_vertices)
        ),
        "your segments go on for ever: keep the share along each between 0 and 1": (
            _from(lambda actual, path: _distances(actual, path, -np.inf, np.inf))
        ),
        "your segments have a start but no end: the share along each is at most 1": (
            _from(lambda actual, path: _distances(actual, path, 0.0, np.inf))
        ),
        "that is from each way-point to the run: ask from each point of the run to the path": (
            _from(lambda actual, path: _distances(path, actual))
        ),
        "you lead the path back to its first point: it ends at its last": (
            lambda actual, path: metrics(actual, _closed(path))
        ),
        "d_std is the square root of that: the standard deviation, not the variance": (
            _with(1, lambda actual, path: _distances(actual, path).var())
        ),
        "d_std is over all points of the run: divide by their number K, not by K - 1": (
            _with(1, lambda actual, path: _distances(actual, path).std(ddof=1))
        ),
        "d_ratio is upside down: the length of the run over that of the path": (
            _with(3, lambda actual, path: _length(path) / _length(actual))
        ),
        "d_ratio itself is asked, 1 for a perfect run; the charts take |d_ratio - 1|": (
            _with(3, lambda actual, path: _length(actual) / _length(path) - 1)
        ),
        "a length is the sum of all small steps, not the distance from first to last point": (
            _with(
                3,
                lambda actual, path: (
                    np.linalg.norm(actual[-1] - actual[0]) / np.linalg.norm(path[-1] - path[0])
                ),
            )
        ),
        "nearly: that samples the path finely; the distance to a segment needs no sampling": (
            _from(_to_resampled)
        ),
    },
    hints=(
        "Point p, segment from a to b: the foot of p lies the share (p - a).(b - a)/|b - a|^2 "
        "along it.",
        "Clip the share to 0..1, take the distance to a + share (b - a), then the least of all.",
    ),
    tested_on="12 random paths, with runs that miss them",
)
