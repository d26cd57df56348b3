"""Exercises 6.1 and 6.2: the way from samples of a speed, and the order of a rule."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.localisation.odometry import bilinear_sum, euler_sum, order


def _logs(rng: np.random.Generator) -> list[tuple[NDArray, NDArray]]:
    logs = []
    for count in (2, 3, *rng.integers(8, 60, 10)):
        t = rng.uniform(-5, 5) + np.cumsum(rng.uniform(0.02, 0.3, int(count)))
        logs.append((t, rng.choice((-0.6, 0.1, 0.6)) + rng.normal(0, 0.4, len(t))))
    return logs


WAY = Exercise(
    number="6.1",
    title="The way from samples",
    reference=bilinear_sum,
    oracle="area_under_straight_lines",
    cases=_logs,
    mistakes={
        "that is Euler's (2), rectangles as high as the newer sample: take trapezoids": euler_sum,
        "these are rectangles as high as the older sample: take trapezoids": (
            lambda t, v: euler_sum(t, np.append(0.0, v[:-1]))
        ),
        "the steps are not equal: each pair of samples has its own delta_k = t_k - t_{k-1}": (
            lambda t, v: bilinear_sum(np.linspace(t[0], t[-1], len(t)), v)
        ),
        "twice too far: the height of a trapezoid is the mean of its two sides": (
            lambda t, v: 2 * bilinear_sum(t, v)
        ),
        "a sum of speeds is no way: every sample counts for its time step": (
            lambda t, v: bilinear_sum(np.arange(len(t)), v)
        ),
        "the first trapezoid starts at zero speed: v[0] was measured, so use it": (
            lambda t, v: bilinear_sum(t, np.append(0.0, v[1:]))
        ),
        "a negative speed leads back: add it up with its sign": (
            lambda t, v: bilinear_sum(t, np.abs(v))
        ),
        "that is the distance from the start: a position has a sign": (
            lambda t, v: np.abs(bilinear_sum(t, v))
        ),
        "these are the ways of the steps: add them up": (
            lambda t, v: np.append(0.0, np.diff(bilinear_sum(t, v)))
        ),
        "the first position is 0: what came before t[0] is not asked for": (
            lambda t, v: bilinear_sum(t, v) + t[0] * v[0]
        ),
        "n instants have n positions: the first of them, 0 at t[0], is missing": (
            lambda t, v: bilinear_sum(t, v)[1:]
        ),
        "that is the position at the end: return it at every instant": (
            lambda t, v: bilinear_sum(t, v)[-1]
        ),
    },
    hints=(
        "np.diff(t) are the lengths of the steps; (v[1:] + v[:-1]) / 2 the mean heights.",
        "np.cumsum adds up the areas; put a 0 in front with np.concatenate.",
    ),
    tested_on="12 logs with unequal steps, forwards and in reverse, none of which starts at t = 0",
)


def _families(rng: np.random.Generator) -> list[tuple[NDArray, NDArray]]:
    families = []
    for low, high in ((0.7, 4.2),) * 18 + ((-1.5, -0.5),) * 2:
        count = int(rng.integers(3, 9))
        steps = rng.uniform(0.5, 2.0) / np.cumprod(rng.uniform(1.4, 4.0, count))
        steps = steps[:: rng.choice((-1, 1))]
        spread = np.exp(rng.normal(0, 0.05, count))
        families.append((steps, rng.uniform(0.01, 3.0) * steps ** rng.uniform(low, high) * spread))
    return families


def _line(x: Callable = np.log, y: Callable = np.log, place: int = 0) -> Callable:
    return lambda steps, errors: np.polyfit(x(steps), y(errors), 1)[place]


ORDER = Exercise(
    number="6.2",
    title="The order of a rule",
    reference=order,
    oracle="nothing_left_that_follows_the_step",
    cases=_families,
    mistakes={
        "negative: take the logarithm of the step's length, not of how many there are": (
            lambda steps, errors: -order(steps, errors)
        ),
        "upside down: how does the error follow the step, not the step the error?": (
            lambda steps, errors: order(errors, steps)
        ),
        "that is the slope of the curve itself: take logarithms of both axes first": (
            _line(np.asarray, np.asarray)
        ),
        "a power is straight only when both axes are logarithmic: the steps are not": (
            _line(np.asarray)
        ),
        "that is where the line cuts the axis: the order is its slope, polyfit's first number": (
            _line(place=1)
        ),
        "a mean of the slopes between neighbours: fit one line through all points": (
            lambda steps, errors: np.mean(np.diff(np.log(errors)) / np.diff(np.log(steps)))
        ),
        "that takes each step for half of the one before: divide by the logarithm of their ratio": (
            lambda steps, errors: np.mean(np.log2(errors[:-1] / errors[1:]))
        ),
        "that is by what the errors shrink, 2^p or so: the order is the exponent p": (
            lambda steps, errors: np.mean(errors[:-1] / errors[1:])
        ),
        "an order may be negative: then a shorter step makes the error larger": (
            lambda steps, errors: abs(order(steps, errors))
        ),
        "two different logarithms: take the same one for steps and for errors": _line(np.log10),
        "only the first and the last point are used: fit the line through all of them": (
            lambda steps, errors: order(steps[[0, -1]], errors[[0, -1]])
        ),
    },
    hints=(
        "error = C step^p is a straight line once you take logarithms: log e = log C + p log step.",
        "np.polyfit(x, y, 1) returns the slope and the intercept of the best line.",
    ),
    tested_on="20 families of errors with orders from -1.5 to 4.2, the steps not halved",
)
