"""Exercises 7.5 and 7.8: whether a filter knows how wrong it is, and how far off it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.angles import residual, wrap
from backhoe.lessons.exercise import Exercise
from backhoe.localisation import fusion, kalman

_PERIOD = 0.1  # of the grid of exercise 7.8 [s]


def _claims(rng: np.random.Generator) -> list[tuple]:
    """Errors that are as their covariances say, but for whole turns."""
    cases = []
    for turns in rng.integers(-2, 3, 30):
        A = rng.normal(size=(3, 3)) * (0.3, 0.3, 0.1) * rng.choice((1.0, 8.0))
        P = A.T @ A + np.diag((0.02, 0.02, 0.002))
        cases.append((rng.multivariate_normal((0.0, 0.0, 2 * np.pi * turns), P), P))
    return cases


def _squared(
    e: NDArray, P: NDArray, angles: Sequence[int] = (2,), weight: Callable = np.linalg.inv
) -> float:
    e = residual(e, 0.0, angles)
    return e @ weight(P) @ e


NEES = Exercise(
    number="7.5",
    title="Does the filter know?",
    reference=partial(kalman.nees, angles=(2,)),
    cases=_claims,
    oracle="the_determinant_with_the_error_in_it",
    mistakes={
        "the heading is not wrapped: a whole turn is no error": partial(_squared, angles=()),
        "wrapped to 0 ... 2 pi, a small error to the right becomes nearly a turn: -pi ... pi": (
            lambda e, P: _squared(np.append(e[:2], e[2] % (2 * np.pi)), P, angles=())
        ),
        "x and y are wrapped as well: they are metres, only the heading is an angle": (
            partial(_squared, angles=(0, 1, 2))
        ),
        "the heading is left out: the filter claims to know it, too": (
            lambda e, P: _squared(e[:2], P[:2, :2], angles=())
        ),
        "that multiplies by P: e^T P^-1 e has the inverse": partial(_squared, weight=np.array),
        "that is its root, a distance: NEES is squared": lambda e, P: np.sqrt(_squared(e, P)),
        "it is divided by 3: NEES itself is 3 on average, not 1": lambda e, P: _squared(e, P) / 3,
        "only the variances are used: errors of x, y and heading go together, use all of P": (
            partial(_squared, weight=lambda P: np.diag(1 / np.diag(P)))
        ),
        "it divides squares by standard deviations: P holds variances": (
            partial(_squared, weight=lambda P: np.diag(np.diag(P) ** -0.5))
        ),
        "P has no effect: an error counts by how much the filter expects": (
            partial(_squared, weight=lambda P: np.eye(3))
        ),
        "1 / P inverts each element: np.linalg.inv(P) or solve inverts the matrix": (
            partial(_squared, weight=lambda P: 1 / P)
        ),
    },
    hints=(
        "First a copy of the error, its third component brought back to between -pi and pi.",
        "e @ np.linalg.solve(P, e) is e^T P^-1 e.",
    ),
    tested_on="30 random errors, some of them with whole turns",
)


def _drives(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(10):
        end = float(rng.integers(5, 9))
        t, t_e = np.linspace(0, end, int(20 * end) + 1), np.linspace(0, end, int(32 * end) + 1)
        speed = rng.uniform((-1.0, -1.0, 0.5), (1.0, 1.0, 0.9))
        drift = t_e[:, None] * (0.8, -0.6, 0.03) + 0.05 * rng.normal(size=(len(t_e), 3))
        pose, pose_e = t[:, None] * speed, t_e[:, None] * speed + drift
        pose[:, 2], pose_e[:, 2] = wrap(pose[:, 2]), wrap(pose_e[:, 2])
        cases.append((t, pose, t_e, pose_e))
    return cases


def _errors(
    t: NDArray, pose: NDArray, t_e: NDArray, pose_e: NDArray, angles: Sequence[int] = (2,)
) -> NDArray:
    grid = np.arange(0.0, min(t[-1], t_e[-1]) + 1e-9, _PERIOD)
    at, at_e = (np.argmin(np.abs(one - grid[:, None]), axis=1) for one in (t, t_e))
    return residual(pose_e[at_e], pose[at], angles)


def _rms(e: NDArray) -> NDArray:
    return np.sqrt(np.mean(e**2, axis=0))


def _scored(score: Callable, angles: Sequence[int] = (2,)) -> Callable:
    return lambda *drive: score(_errors(*drive, angles))


def _by_place(t: NDArray, pose: NDArray, t_e: NDArray, pose_e: NDArray) -> NDArray:
    return _rms(residual(pose_e[: len(t)], pose, (2,)))


RMSE = Exercise(
    number="7.8",
    title="Repair Algorithm 2",
    reference=partial(fusion.rmse, period=_PERIOD, angles=(2,)),
    cases=_drives,
    oracle="the_nearest_samples_one_by_one",
    mistakes={
        "differences of headings are not wrapped: a jump of 2 pi counts as an error": (
            _scored(_rms, angles=())
        ),
        "x and y are wrapped as well: they are metres, only the heading is an angle": (
            _scored(_rms, angles=(0, 1, 2))
        ),
        "it pairs sample i with sample i: they were not taken at the same time": _by_place,
        "the sum has one term more than it is divided by, as in Algorithm 2: take the mean": (
            _scored(lambda e: np.sqrt(np.sum(e**2, axis=0) / (len(e) - 1)))
        ),
        "the last instant is left out: the grid includes the end, but np.arange stops before": (
            _scored(lambda e: _rms(e[:-1]))
        ),
        "that is the mean square error: the root is missing": _scored(lambda e: _rms(e) ** 2),
        "that is the mean of the absolute error: square, mean, root": (
            _scored(lambda e: np.mean(np.abs(e), axis=0))
        ),
        "the mean error is taken off: a standard deviation hides a constant error": (
            _scored(lambda e: np.std(e, axis=0))
        ),
        "that is the error at the end: all instants count": _scored(lambda e: np.abs(e[-1])),
        "the heading is in degrees: it comes in radians and stays in them": (
            _scored(lambda e: _rms(e) * (1, 1, 180 / np.pi))
        ),
    },
    hints=(
        "For each instant of a grid 0, 0.1 s, 0.2 s, ... the nearest sample of either signal.",
        "np.argmin(np.abs(t - instant)) finds it; wrap headings' differences; square, mean, root.",
    ),
    tested_on="10 drives whose truth comes at 20 Hz and whose estimate at 32 Hz",
)
