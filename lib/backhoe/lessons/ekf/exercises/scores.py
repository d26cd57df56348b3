"""Exercises 7.5, 7.8 and 7.9: whether a filter knows how wrong it is, and how far off it is."""

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


def _root(P: NDArray) -> NDArray:
    return np.linalg.inv(np.linalg.cholesky(P))


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
        "the root of P is inverted: P holds variances already": (partial(_squared, weight=_root)),
        "the heading's error has lost its sign: wrap it, and keep the sign": (
            lambda e, P: _squared(np.append(e[:2], abs(wrap(e[2]))), P)
        ),
        "P is inverted twice: e^T P^-1 e": (
            partial(_squared, weight=lambda P: np.linalg.inv(P @ P))
        ),
        "that counts e^T e by the mean variance: use all of P": (
            partial(_squared, weight=lambda P: np.eye(3) / np.trace(P))
        ),
        "the determinant belongs to the density, not to NEES": (
            lambda e, P: _squared(e, P) + np.log(np.linalg.det(P))
        ),
        "it is halved: the half belongs to the density": lambda e, P: _squared(e, P) / 2,
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
    """Drives with even clocks and with uneven ones; truth and estimate end first by turns."""
    cases = []
    for k in range(12):
        end, more = float(rng.integers(3, 6)), rng.uniform(0.3, 1.2)
        t, t_e = _clock(end, 20, k > 5, rng), _clock(end + (-1) ** k * more, 32, k > 3, rng)
        speed = np.add(rng.uniform((-1.0, -1.0, -0.9), 1.0), (0, 0, 0.6 * (-1) ** (k // 2)))
        drift = t_e[:, None] * (0.8, -0.6, 0.03) + 0.05 * rng.normal(size=(len(t_e), 3))
        start = 5.0 * (-1) ** (k // 3)
        pose, pose_e = start + t[:, None] * speed, start + t_e[:, None] * speed + drift
        pose[:, 2], pose_e[:, 2] = wrap(pose[:, 2]), wrap(pose_e[:, 2])
        cases.append((t, pose, t_e, pose_e))
    return cases


def _clock(end: float, rate: float, uneven: bool, rng: np.random.Generator) -> NDArray:
    """Times from 0 on at about a rate [Hz]."""
    steps = rng.uniform(0.2, 1.8, int(rate * end)) if uneven else np.ones(int(rate * end))
    return np.append(0.0, np.cumsum(steps / rate))


def _errors(
    t: NDArray,
    pose: NDArray,
    t_e: NDArray,
    pose_e: NDArray,
    angles: Sequence[int] = (2,),
    end: Callable = min,
    read: Callable = lambda wanted, t, pose: pose[np.abs(t - wanted[:, None]).argmin(axis=1)],
) -> NDArray:
    grid = np.arange(0.0, end(t[-1], t_e[-1]) + 1e-9, _PERIOD)
    return residual(read(grid, t_e, pose_e), read(grid, t, pose), angles)


def _before(wanted: NDArray, t: NDArray, pose: NDArray) -> NDArray:
    return pose[np.searchsorted(t, wanted + 1e-9, side="right") - 1]


def _after(wanted: NDArray, t: NDArray, pose: NDArray) -> NDArray:
    return pose[np.minimum(np.searchsorted(t, wanted - 1e-9), len(t) - 1)]


def _between(wanted: NDArray, t: NDArray, pose: NDArray) -> NDArray:
    return np.stack([np.interp(wanted, t, one) for one in pose.T], axis=1)


def _rms(e: NDArray) -> NDArray:
    return np.sqrt(np.mean(e**2, axis=0))


def _scored(score: Callable, angles: Sequence[int] = (2,), **settings: object) -> Callable:
    return lambda *drive: score(_errors(*drive, angles, **settings))


def _by_place(
    t: NDArray, pose: NDArray, t_e: NDArray, pose_e: NDArray, angles: Sequence[int] = (2,)
) -> NDArray:
    n = min(len(t), len(t_e))
    return _rms(residual(pose_e[:n], pose[:n], angles))


def _at_the_truths(t: NDArray, pose: NDArray, t_e: NDArray, pose_e: NDArray) -> NDArray:
    kept = t <= t_e[-1]
    at = np.abs(t_e - t[kept, None]).argmin(axis=1)
    return _rms(residual(pose_e[at], pose[kept], (2,)))


RMSE = Exercise(
    number="7.8",
    title="How far off?",
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
        "it goes on to the end of the longer signal: stop where the shorter one ends": (
            _scored(_rms, end=max)
        ),
        "it goes to the end of the signal, though the estimate may end before": (
            _scored(_rms, end=lambda end, end_e: end)
        ),
        "it goes to the end of the estimate, though the signal may end before": (
            _scored(_rms, end=lambda end, end_e: end_e)
        ),
        "it takes the sample before each instant: the nearest may come after": (
            _scored(_rms, read=_before)
        ),
        "it takes the sample after each instant: the nearest may come before": (
            _scored(_rms, read=_after)
        ),
        "it draws straight lines between samples: a heading that jumps by 2 pi has none": (
            _scored(_rms, read=_between)
        ),
        "it asks at the signal's own instants: the grid has one each 0.1 s": _at_the_truths,
        "it adds x and y into one distance: one error for each component": (
            _scored(lambda e: np.array([*[np.hypot(*_rms(e)[:2])] * 2, _rms(e)[2]]))
        ),
        "the sum is not divided: the mean of the squares": (
            _scored(lambda e: np.sqrt(np.sum(e**2, axis=0)))
        ),
        "that is the largest error: the root of the mean square": (
            _scored(lambda e: np.abs(e).max(axis=0))
        ),
        "a heading's error counts without its sign before it is wrapped: wrap the difference": (
            _scored(lambda e: _rms(np.column_stack([e[:, :2], np.abs(e[:, 2]) % np.pi])), angles=())
        ),
        "the first instant is left out: the grid begins at 0": _scored(lambda e: _rms(e[1:])),
        "that is the mean error, and both signs cancel: square first": (
            _scored(lambda e: e.mean(axis=0))
        ),
        "that is the median of the error: square, mean, root": (
            _scored(lambda e: np.median(np.abs(e), axis=0))
        ),
        "one number for all three: one error for each component": (
            _scored(lambda e: np.full(3, np.sqrt(np.mean(e**2))))
        ),
        "it pairs sample i with sample i, and headings are not wrapped": (
            partial(_by_place, angles=())
        ),
        "it draws straight lines to the signal's own instants: take the nearest, each 0.1 s": (
            lambda t, pose, t_e, pose_e: _rms(residual(_between(t, t_e, pose_e), pose, (2,)))
        ),
        "it pairs sample i with sample i: they were not taken at the same time": _by_place,
        "the sum has one term more than it is divided by: take the mean": (
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
    tested_on="12 drives of two clocks, even and uneven, of which one ends first",
)


def _measured(rng: np.random.Generator) -> list[tuple]:
    """Measurements of one, two and three numbers, as surprising as they should be and more."""
    cases = []
    for k in range(30):
        m, n = 1 + k % 3, int(rng.integers(3, 5))
        A, B, H = rng.normal(size=(n, n)), rng.normal(size=(m, m)), rng.normal(size=(m, n))
        x, P, R = rng.normal(size=n), A @ A.T + 0.1 * np.eye(n), B @ B.T + 0.2 * np.eye(m)
        z = H @ x + rng.multivariate_normal(np.zeros(m), H @ P @ H.T + R) * rng.choice((1, 5))
        cases.append((x, P, z, H, R))
    still = np.zeros(3), np.diag([0.04, 0.09, 0.01]), np.array([-0.3, 0.6])
    return [*cases, (*still, np.eye(3)[:2], 0.04 * np.eye(2))]


def innovation_squared(x: NDArray, P: NDArray, z: NDArray, H: NDArray, R: NDArray) -> float:
    """NIS of a measurement by what is believed before it [1]."""
    return float(kalman.nis(z - H @ x, H @ P @ H.T + R))


def _by(S: Callable, y: Callable = lambda x, z, H: z - H @ x) -> Callable:
    """NIS with another covariance or another innovation."""

    def answer(x: NDArray, P: NDArray, z: NDArray, H: NDArray, R: NDArray) -> float:
        seen = y(x, z, H)
        return seen @ np.linalg.solve(S(P, H, R), seen)

    return answer


def _S(P: NDArray, H: NDArray, R: NDArray) -> NDArray:
    return H @ P @ H.T + R


def _afterwards(x: NDArray, P: NDArray, z: NDArray, H: NDArray, R: NDArray) -> float:
    return innovation_squared(*kalman.update(x, P, z, H, R), z, H, R)


def _of_nis(change: Callable) -> Callable:
    return lambda x, P, z, H, R: change(innovation_squared(x, P, z, H, R), len(z))


NIS = Exercise(
    number="7.9",
    title="How surprised should it be?",
    reference=innovation_squared,
    cases=_measured,
    oracle="the_joint_determinant_with_the_innovation_in_it",
    mistakes={
        "R is not in S: the sensor has noise of its own, S = H P H^T + R": (
            _by(lambda P, H, R: H @ P @ H.T + 1e-12 * np.eye(len(R)))
        ),
        "P is not in S: what is expected is uncertain too, S = H P H^T + R": _by(lambda P, H, R: R),
        "S has no effect: an innovation counts by how much is expected": (
            _by(lambda P, H, R: np.eye(len(R)))
        ),
        "that multiplies by S: y^T S^-1 y has the inverse": (
            _by(lambda P, H, R: np.linalg.inv(_S(P, H, R)))
        ),
        "only the variances of S are used: what errs together is in the others": (
            _by(lambda P, H, R: np.diag(np.diag(_S(P, H, R))))
        ),
        "R is squared: it is a covariance already": _by(lambda P, H, R: H @ P @ H.T + R @ R),
        "the innovation is z - H x: yours leaves out what was expected": (
            _by(_S, lambda x, z, H: z)
        ),
        "the innovation is z - H x, with a minus": _by(_S, lambda x, z, H: z + H @ x),
        "it is asked after the update, when the filter has heard already: before": _afterwards,
        "that is its root: NIS is squared": _of_nis(lambda nis, m: np.sqrt(nis)),
        "it is divided by how many numbers were measured: NIS is that many on average": (
            _of_nis(lambda nis, m: nis / m if m > 1 else nis)
        ),
        "it is halved: the half belongs to the density": _of_nis(lambda nis, m: nis / 2),
        "S is inverted twice: y^T S^-1 y": (_by(lambda P, H, R: _S(P, H, R) @ _S(P, H, R))),
        "that counts y^T y by the sum of the variances: use all of S": (
            _by(lambda P, H, R: np.trace(_S(P, H, R)) * np.eye(len(R)))
        ),
        "the determinant belongs to the density, not to NIS": (
            lambda x, P, z, H, R: (
                innovation_squared(x, P, z, H, R) + np.log(np.linalg.det(_S(P, H, R)))
            )
        ),
        "the innovation has lost its signs: numbers that err together need them": (
            _by(_S, lambda x, z, H: np.abs(z - H @ x))
        ),
        "the innovations are added before they are squared: y^T S^-1 y": (
            lambda x, P, z, H, R: float(np.sum((z - H @ x) / np.sqrt(np.diag(_S(P, H, R)))))
        ),
        "P is subtracted: the uncertainties of filter and sensor add": (
            _by(lambda P, H, R: H @ P @ H.T - R)
        ),
    },
    hints=(
        "The innovation y = z - H x, and its covariance S = H P H^T + R, as in exercise 7.2.",
        "y @ np.linalg.solve(S, y) is y^T S^-1 y.",
    ),
    tested_on="31 measurements of one to three numbers",
)
