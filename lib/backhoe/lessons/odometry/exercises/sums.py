"""Exercises 6.1 and 6.2: the way from samples of a speed, and the order of a rule."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise


def way(t: NDArray, v: NDArray) -> NDArray:
    """Trapezoids (4): positions at the instants t [s], from zero, for speeds v, shape (n,) [m]."""
    areas = (v[1:] + v[:-1]) / 2 * np.diff(t)
    return np.concatenate([[0.0], np.cumsum(areas)])


def _logs(rng: np.random.Generator) -> list[tuple]:
    logs = []
    for _ in range(12):
        t = rng.uniform(0, 5) + np.cumsum(rng.uniform(0.02, 0.3, int(rng.integers(8, 60))))
        logs.append((t, 0.6 + rng.normal(0, 0.4, len(t))))
    return logs


def _rectangles(t: NDArray, heights: NDArray) -> NDArray:
    return np.concatenate([[0.0], np.cumsum(heights * np.diff(t))])


def _stopped_at_first(t: NDArray, v: NDArray) -> NDArray:
    return way(t, np.concatenate([[0.0], v[1:]]))


WAY = Exercise(
    number="6.1",
    title="The way from samples",
    reference=way,
    cases=_logs,
    mistakes={
        "that is Euler's (2), rectangles as high as the newer sample: take trapezoids": (
            lambda t, v: _rectangles(t, v[1:])
        ),
        "these are rectangles as high as the older sample: take trapezoids": (
            lambda t, v: _rectangles(t, v[:-1])
        ),
        "the steps are not equal: each pair of samples has its own delta_k = t_k - t_{k-1}": (
            lambda t, v: way(np.linspace(t[0], t[-1], len(t)), v)
        ),
        "twice too far: the height of a trapezoid is the mean of its two sides": (
            lambda t, v: 2 * way(t, v)
        ),
        "a sum of speeds is no way: every sample counts for its time step": (
            lambda t, v: way(np.arange(len(t)), v)
        ),
        "the first trapezoid starts at zero speed: v[0] was measured, so use it": (
            _stopped_at_first
        ),
        "n instants have n positions: the first of them, 0 at t[0], is missing": (
            lambda t, v: way(t, v)[1:]
        ),
        "that is the position at the end: return it at every instant": lambda t, v: way(t, v)[-1],
    },
    hints=(
        "np.diff(t) are the lengths of the steps; (v[1:] + v[:-1]) / 2 the mean heights.",
        "np.cumsum adds up the areas; put a 0 in front with np.concatenate.",
    ),
    tested_on="12 logs with unequal steps, none of which starts at t = 0",
)


def order(steps: NDArray, errors: NDArray) -> float:
    """Slope of log error over log step, by least squares [1]."""
    x, y = np.log(steps), np.log(errors)
    return _fit(x, y)


def _families(rng: np.random.Generator) -> list[tuple]:
    families = []
    for _ in range(20):
        steps = rng.uniform(0.5, 2.0) / 2.0 ** np.arange(6)
        spread = np.exp(rng.normal(0, 0.05, 6))
        families.append((steps, rng.uniform(0.01, 3.0) * steps ** rng.uniform(0.7, 4.2) * spread))
    return families


def _fit(x: NDArray, y: NDArray, place: int = 0) -> float:
    finite = np.isfinite(x).all() and np.isfinite(y).all()
    return float(np.polyfit(x, y, 1)[place]) if finite else np.nan


ORDER = Exercise(
    number="6.2",
    title="The order of a rule",
    reference=order,
    cases=_families,
    mistakes={
        "negative: take the logarithm of the step's length, not of how many there are": (
            lambda steps, errors: -order(steps, errors)
        ),
        "upside down: how does the error follow the step, not the step the error?": (
            lambda steps, errors: _fit(np.log(errors), np.log(steps))
        ),
        "that is the slope of the curve itself: take logarithms of both axes first": (
            lambda steps, errors: _fit(steps, errors)
        ),
        "a power is straight only when both axes are logarithmic: the steps are not": (
            lambda steps, errors: _fit(steps, np.log(errors))
        ),
        "that is where the line cuts the axis: the order is its slope, polyfit's first number": (
            lambda steps, errors: _fit(np.log(steps), np.log(errors), 1)
        ),
        "two different logarithms: take the same one for steps and for errors": (
            lambda steps, errors: _fit(np.log10(steps), np.log(errors))
        ),
        "only the first and the last point are used: fit the line through all of them": (
            lambda steps, errors: order(steps[[0, -1]], errors[[0, -1]])
        ),
    },
    hints=(
        "error = C step^p is a straight line once you take logarithms: log e = log C + p log step.",
        "np.polyfit(x, y, 1) returns the slope and the intercept of the best line.",
    ),
    tested_on="20 families of errors with orders from 0.7 to 4.2",
)
