"""Exercises 6.4 and 6.5: the guide's Algorithm 4 with a predictor, and the exact arc."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise

Rate = Callable[[NDArray, NDArray], NDArray]


def heun(x: NDArray, u_old: NDArray, u_new: NDArray, dt: float, f: Rate) -> NDArray:
    """(11) with x_k predicted by a step of Euler's, shape (n,)."""
    before = f(x, u_old)
    predicted = x + dt * before
    return x + dt / 2 * (before + f(predicted, u_new))


def right_trapezoid(
    answer: NDArray,
    reference: NDArray,
    x: NDArray,
    u_old: NDArray,
    u_new: NDArray,
    dt: float,
    f: Rate,
) -> bool:
    """Any predictor of order 1 will do, and so will x_k solved for."""
    before = f(x, u_old)
    solved = x
    for _ in range(60):
        solved = x + dt / 2 * (before + f(solved, u_new))
    other = x + dt / 2 * (before + f(x + dt * f(x, u_new), u_new))
    if np.shape(answer) != np.shape(reference):
        return "it must have the shape of x"
    return any(np.allclose(answer, one, rtol=1e-9) for one in (reference, other, solved))


def _robot(radius: float, gauge: float) -> Rate:
    def f(x: NDArray, u: NDArray) -> NDArray:
        v, omega = radius * (u[0] + u[1]) / 2, radius * (u[1] - u[0]) / gauge
        return np.array([v * np.cos(x[2]), v * np.sin(x[2]), omega])

    return f


def _starts(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(20):
        x = rng.uniform((-5, -5, -7), (5, 5, 7))
        speeds = rng.uniform(1, 8, (2, 2))
        robot = _robot(rng.uniform(0.05, 0.3), rng.uniform(0.4, 1.5))
        cases.append((x, *speeds, float(rng.uniform(0.05, 0.3)), robot))
    return cases


TRAPEZOID = Exercise(
    number="6.4",
    title="Repair Algorithm 4",
    reference=heun,
    cases=_starts,
    compare=right_trapezoid,
    mistakes={
        "that is Algorithm 4 as it runs, the old x in both halves: predict x_k first": (
            lambda x, u_old, u_new, dt, f: x + dt / 2 * (f(x, u_old) + f(x, u_new))
        ),
        "that is Algorithm 3 as it runs, one rate for the whole step: average two": (
            lambda x, u_old, u_new, dt, f: x + dt * f(x, u_new)
        ),
        "that is the predictor, Euler's step: go on, and average the rates at both ends": (
            lambda x, u_old, u_new, dt, f: x + dt * f(x, u_old)
        ),
        "the rate at the end alone is (10), order 1: average it with the one at the start": (
            lambda x, u_old, u_new, dt, f: x + dt * f(x + dt * f(x, u_old), u_new)
        ),
        "twice too far: the average of two rates needs a half": (
            lambda x, u_old, u_new, dt, f: 2 * heun(x, u_old, u_new, dt, f) - x
        ),
        "the step goes on for a whole second: dt is missing": (
            lambda x, u_old, u_new, dt, f: x + (f(x, u_old) + f(x + dt * f(x, u_old), u_new)) / 2
        ),
        "the predictor goes on for a whole second: dt is missing there": (
            lambda x, u_old, u_new, dt, f: x + dt / 2 * (f(x, u_old) + f(x + f(x, u_old), u_new))
        ),
        "that is how far it moved: add it to x": (
            lambda x, u_old, u_new, dt, f: heun(x, u_old, u_new, dt, f) - x
        ),
        "the samples are swapped: the old one belongs to the start of the step": (
            lambda x, u_old, u_new, dt, f: heun(x, u_new, u_old, dt, f)
        ),
        "the old sample counts as zero: use u_old": (
            lambda x, u_old, u_new, dt, f: heun(x, np.zeros(2), u_new, dt, f)
        ),
        "the midpoint rule, order 2 as well; but (11) averages the rates at both ends": (
            lambda x, u_old, u_new, dt, f: x + dt * f(x + dt / 2 * f(x, u_old), (u_old + u_new) / 2)
        ),
    },
    hints=(
        "f(x_k, u_k) needs x_k. Guess it by a step of Euler's: x + dt f(x, u_old).",
        "before = f(x, u_old); after = f(x + dt * before, u_new); their mean, times dt, plus x.",
    ),
    tested_on="20 random steps of random robots",
)


def arc(pose: NDArray, v: float, omega: float, dt: float) -> NDArray:
    """(4.3) corrected: exact for held speeds, straight ahead included, shape (3,) [m, m, rad]."""
    half = omega * dt / 2
    chord = v * dt * np.sinc(half / np.pi)
    middle = pose[2] + half
    return pose + np.array([chord * np.cos(middle), chord * np.sin(middle), omega * dt])


def _turns(rng: np.random.Generator) -> list[tuple]:
    cases = [(*rng.uniform((-4, -4, -9), (4, 4, 9), (1, 3)), *rest) for rest in _EDGES]
    for _ in range(25):
        v, omega, dt = rng.uniform((-1.5, 0.1, 0.2), (1.5, 1.2, 1.5))
        sign = rng.choice([-1.0, 1.0])
        cases.append(
            (rng.uniform((-4, -4, -9), (4, 4, 9)), float(v), float(sign * omega), float(dt))
        )
    return cases


_EDGES = (
    (0.8, 0.0, 0.5),
    (0.8, 1e-12, 0.5),
    (-0.6, -1e-12, 0.5),
    (0.9, 2e-4, 0.5),
    (0.9, -2e-4, 1),
)


def _ends(pose: NDArray, v: float, omega: float, dt: float) -> NDArray:
    """The arc by differences of sines and cosines, as everybody writes it first."""
    if abs(omega) < 1e-8:
        return arc(pose, v, omega, dt)
    return _by_differences(pose, v, omega, dt)


def _by_differences(pose: NDArray, v: float, omega: float, dt: float) -> NDArray:
    psi = pose[2] + omega * dt
    with np.errstate(all="ignore"):
        radius = np.float64(v) / omega
        dx = radius * (np.sin(psi) - np.sin(pose[2]))
        dy = -radius * (np.cos(psi) - np.cos(pose[2]))
    return np.array([pose[0] + dx, pose[1] + dy, psi])


def _as_printed(pose: NDArray, v: float, omega: float, dt: float) -> NDArray:
    psi = pose[2] + omega * dt
    if abs(omega) < 1e-8:
        return arc(pose, v, omega, dt)
    dx = v / omega * (np.cos(psi) - np.cos(pose[2]))
    dy = -v / omega * (np.sin(psi) - np.sin(pose[2]))
    return np.array([pose[0] + dx, pose[1] + dy, psi])


def _mirrored(pose: NDArray, v: float, omega: float, dt: float) -> NDArray:
    end = arc(pose, v, omega, dt)
    return np.array([end[0], 2 * pose[1] - end[1], end[2]])


def _zero_only(pose: NDArray, v: float, omega: float, dt: float) -> NDArray:
    return arc(pose, v, omega, dt) if omega == 0 else _by_differences(pose, v, omega, dt)


def _no_absolute(pose: NDArray, v: float, omega: float, dt: float) -> NDArray:
    if omega < 0.001:
        return _straight(pose, v, omega, dt, 0.5)
    return arc(pose, v, omega, dt)


def _straight(pose: NDArray, v: float, omega: float, dt: float, share: float) -> NDArray:
    heading = pose[2] + share * omega * dt
    way = v * dt * np.array([np.cos(heading), np.sin(heading)])
    return np.array([*(pose[:2] + way), pose[2] + omega * dt])


def _sinc_without_pi(pose: NDArray, v: float, omega: float, dt: float) -> NDArray:
    return _straight(pose, v * np.sinc(omega * dt / 2), omega, dt, 0.5)


def _wrapped(pose: NDArray, v: float, omega: float, dt: float) -> NDArray:
    end = arc(pose, v, omega, dt)
    return np.array([end[0], end[1], (end[2] + np.pi) % (2 * np.pi) - np.pi])


ARC = Exercise(
    number="6.5",
    title="Repair (4.3)",
    reference=arc,
    cases=_turns,
    mistakes={
        "that is (4.3) as printed: integrate cos psi over psi, and you get its sine": _as_printed,
        "a turn to the left goes to the right: the integral of the sine is minus the cosine": (
            _mirrored
        ),
        "it divides by omega = 0: straight ahead needs its own branch, or the sinc form": (
            _by_differences
        ),
        "right for omega = 0, but at 1e-12 the difference of two sines is only rounding error": (
            _zero_only
        ),
        "right turns take the straight branch: omega < 0.001 needs an absolute value": (
            _no_absolute
        ),
        "that is (4.1) corrected, Euler: a straight line along the old heading": (
            lambda pose, v, omega, dt: _straight(pose, v, omega, dt, 0.0)
        ),
        "that is (4.1) as printed: a straight line along the new heading": (
            lambda pose, v, omega, dt: _straight(pose, v, omega, dt, 1.0)
        ),
        "that is (4.2) corrected: the right direction, but the chord is shorter than the arc": (
            lambda pose, v, omega, dt: _straight(pose, v, omega, dt, 0.5)
        ),
        "(4.2) as printed, beyond the end: the middle is psi_{k-1} + omega T / 2": (
            lambda pose, v, omega, dt: _straight(pose, v, omega, dt, 1.5)
        ),
        "np.sinc(z) is sin(pi z) / (pi z): give it h / pi": _sinc_without_pi,
        "that is how far it moved: add it to the pose": (
            lambda pose, v, omega, dt: arc(pose, v, omega, dt) - pose
        ),
        "the place is right, but the heading did not turn": (
            lambda pose, v, omega, dt: np.array([*arc(pose, v, omega, dt)[:2], pose[2]])
        ),
        "the heading is wrapped: let it count on through full turns": _wrapped,
    },
    hints=(
        "Integrate v cos(psi_0 + omega t) over the step; then look at omega -> 0.",
        "A chord of v dt sin(h) / h along psi_0 + h, h = omega dt / 2; np.sinc(h / pi) is safe.",
    ),
    tested_on="30 random steps, forwards and backwards, left, right and straight ahead",
)
