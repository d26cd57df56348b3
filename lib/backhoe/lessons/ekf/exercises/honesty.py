"""Exercises 7.5 and 7.8: how honest a filter is, and how far off."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise


def wrapped(angle: NDArray) -> NDArray:
    """The same direction from -pi to pi [rad]."""
    return np.arctan2(np.sin(angle), np.cos(angle))


def nees(truth: NDArray, estimate: NDArray, P: NDArray) -> float:
    """Error of a pose in the filter's own measure, e^T P^-1 e; the heading is wrapped."""
    e = truth - estimate
    e[2] = np.arctan2(np.sin(e[2]), np.cos(e[2]))
    return float(e @ np.linalg.solve(P, e))


def _poses(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for turns in rng.integers(-2, 3, 30):
        A = rng.normal(size=(3, 3)) * (0.3, 0.3, 0.1) * rng.choice((1.0, 8.0))
        P = A.T @ A + np.diag((0.02, 0.02, 0.002))
        truth = rng.uniform((-9, -9, -6), (9, 9, 6))
        truth[2] = rng.choice((truth[2], np.pi * rng.choice((-1, 1))))
        estimate = rng.multivariate_normal(truth + np.array([0, 0, 2 * np.pi * turns]), P)
        cases.append((truth, estimate, P))
    return cases


def _error(truth: NDArray, estimate: NDArray) -> NDArray:
    e = truth - estimate
    return np.append(e[:2], wrapped(e[2]))


def _squared(e: NDArray, P: NDArray) -> float:
    return float(e @ np.linalg.solve(P, e))


NEES = Exercise(
    number="7.5",
    title="Does the filter know?",
    reference=nees,
    cases=_poses,
    mistakes={
        "the heading is not wrapped: a whole turn is no error": (
            lambda truth, estimate, P: (truth - estimate) @ np.linalg.inv(P) @ (truth - estimate)
        ),
        (
            "each heading is wrapped by itself: 179 and -179 deg still differ by 358, wrap after "
            "the subtraction"
        ): (
            lambda truth, estimate, P: _squared(
                np.append(
                    (truth - estimate)[:2], np.subtract(*wrapped(np.array([truth, estimate]))[:, 2])
                ),
                P,
            )
        ),
        "wrapped to 0 ... 2 pi, a small error to the right becomes nearly a turn: -pi ... pi": (
            lambda truth, estimate, P: _squared(
                np.append((truth - estimate)[:2], (truth - estimate)[2] % (2 * np.pi)), P
            )
        ),
        "x and y are wrapped as well: they are metres, only the heading is an angle": (
            lambda truth, estimate, P: _squared(wrapped(truth - estimate), P)
        ),
        "that multiplies by P: e^T P^-1 e has the inverse": (
            lambda truth, estimate, P: _error(truth, estimate) @ P @ _error(truth, estimate)
        ),
        "that is its root, a distance: NEES is squared": (
            lambda truth, estimate, P: np.sqrt(nees(truth, estimate, P))
        ),
        "it is divided by 3: NEES itself is 3 on average, not 1": (
            lambda truth, estimate, P: nees(truth, estimate, P) / 3
        ),
        "only the variances are used: errors of x, y and heading go together, use all of P": (
            lambda truth, estimate, P: np.sum(_error(truth, estimate) ** 2 / np.diag(P))
        ),
        "it divides squares by standard deviations: P holds variances": (
            lambda truth, estimate, P: np.sum(_error(truth, estimate) ** 2 / np.sqrt(np.diag(P)))
        ),
        "P has no effect: an error counts by how much the filter expects": (
            lambda truth, estimate, P: np.sum(_error(truth, estimate) ** 2)
        ),
        "1 / P inverts each element: np.linalg.inv(P) or solve inverts the matrix": (
            lambda truth, estimate, P: _error(truth, estimate) @ (1 / P) @ _error(truth, estimate)
        ),
    },
    hints=(
        "The error first, with its third component brought back to between -pi and pi.",
        "e @ np.linalg.solve(P, e) is e^T P^-1 e.",
    ),
    tested_on="30 random poses, some of them whole turns apart",
)


def rmse(t: NDArray, psi: NDArray, t_e: NDArray, psi_e: NDArray, period: float) -> float:
    """RMSE of a heading whose truth and estimate have different times: Algorithm 2 repaired."""
    grid = np.arange(0.0, min(t[-1], t_e[-1]) + 1e-9, period)
    squares = []
    for instant in grid:
        true = psi[np.argmin(np.abs(t - instant))]
        estimated = psi_e[np.argmin(np.abs(t_e - instant))]
        e = np.arctan2(np.sin(estimated - true), np.cos(estimated - true))
        squares.append(e**2)
    return float(np.sqrt(np.mean(squares)))


def _headings(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(10):
        end = float(rng.integers(5, 9))
        t, t_e = np.linspace(0, end, int(20 * end) + 1), np.linspace(0, end, int(32 * end) + 1)
        rate = rng.uniform(0.5, 0.9)
        true, estimated = rate * t, (rate + 0.03) * t_e + 0.05 * rng.normal(size=len(t_e))
        cases.append((t, wrapped(true), t_e, wrapped(estimated), float(rng.choice((0.1, 0.25)))))
    return cases


def _errors(t: NDArray, psi: NDArray, t_e: NDArray, psi_e: NDArray, period: float) -> NDArray:
    grid = np.arange(0.0, min(t[-1], t_e[-1]) + 1e-9, period)
    near = (
        [np.argmin(np.abs(t - one)) for one in grid],
        [np.argmin(np.abs(t_e - one)) for one in grid],
    )
    return psi_e[near[1]] - psi[near[0]]


def _by_place(t: NDArray, psi: NDArray, t_e: NDArray, psi_e: NDArray, period: float) -> float:
    shared = min(len(psi), len(psi_e))
    return np.sqrt(np.mean(wrapped(psi_e[:shared] - psi[:shared]) ** 2))


def _count_printed(t: NDArray, psi: NDArray, t_e: NDArray, psi_e: NDArray, period: float) -> float:
    errors = wrapped(_errors(t, psi, t_e, psi_e, period))
    return np.sqrt(np.sum(errors**2) / (len(errors) - 1))


def _without_the_end(*drive: NDArray | float) -> float:
    return np.sqrt(np.mean(wrapped(_errors(*drive)[:-1]) ** 2))


RMSE = Exercise(
    number="7.8",
    title="Repair Algorithm 2",
    reference=rmse,
    cases=_headings,
    mistakes={
        "differences of headings are not wrapped: a jump of 2 pi counts as an error": (
            lambda *drive: np.sqrt(np.mean(_errors(*drive) ** 2))
        ),
        "it pairs sample i with sample i: they were not taken at the same time": _by_place,
        "the sum has one term more than it is divided by, as in Algorithm 2: take the mean": (
            _count_printed
        ),
        "the last instant is left out: the grid includes the end, but np.arange stops before": (
            _without_the_end
        ),
        "that is the mean square error: the root is missing": (
            lambda *drive: np.mean(wrapped(_errors(*drive)) ** 2)
        ),
        "that is the mean of the absolute error: square, mean, root": (
            lambda *drive: np.mean(np.abs(wrapped(_errors(*drive))))
        ),
        "the mean error is taken off: a standard deviation hides a constant error": (
            lambda *drive: np.std(wrapped(_errors(*drive)))
        ),
        "that is the error at the end: all instants count": (
            lambda *drive: np.abs(wrapped(_errors(*drive))[-1])
        ),
        "these are degrees: the headings are in radians": lambda *drive: np.degrees(rmse(*drive)),
    },
    hints=(
        "For each instant of a grid 0, period, 2 period, ... the nearest sample of either signal.",
        "np.argmin(np.abs(t - instant)) finds it; wrap each difference, then square, mean, root.",
    ),
    tested_on="10 drives whose truth comes at 20 Hz and whose estimate at 32 Hz",
)
