"""Exercises 6.4 and 6.5: the guide's Algorithm 4 with a predictor, and the exact arc."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.angles import wrap
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.odometry import printed
from backhoe.localisation import odometry

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
) -> bool | str:
    """Any predictor of order 1 will do, and so will x_k solved for."""
    if np.shape(answer) != np.shape(reference):
        return "it must have the shape of x"
    start = odometry.streaming.State(0.0, x, u_old)
    solved = odometry.streaming.bilinear(start, dt, u_new, f).x
    other = x + dt / 2 * (f(x, u_old) + f(x + dt * f(x, u_new), u_new))
    return any(np.allclose(answer, one, rtol=1e-9) for one in (reference, other, solved))


def _starts(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(20):
        x = rng.uniform((-5, -5, -7), (5, 5, 7))
        speeds = rng.uniform(1, 8, (2, 2))
        robot = odometry.differential(rng.uniform(0.05, 0.3), rng.uniform(0.4, 1.5))
        cases.append((x, *speeds, float(rng.uniform(0.05, 0.3)), robot.rate))
    return cases


TRAPEZOID = Exercise(
    number="6.4",
    title="Repair Algorithm 4",
    reference=heun,
    oracle="turn_at_the_old_rate_then_average",
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


_STRAIGHT = ((0.8, 0.0), (0.8, 1e-12), (-0.6, -1e-12), (0.9, 2e-4), (0.9, -2e-4))


def _turns(rng: np.random.Generator) -> list[tuple]:
    poses = rng.uniform((-4, -4, -9), (4, 4, 9), (30, 3))
    bends = rng.uniform((-1.5, 0.1), (1.5, 1.2), (25, 2))
    bends[:, 1] *= rng.choice((-1.0, 1.0), 25)
    speeds = [*_STRAIGHT, *bends.tolist()]
    return [
        (pose, *one, float(rng.uniform(0.2, 1.5))) for pose, one in zip(poses, speeds, strict=True)
    ]


def by_differences(pose: NDArray, v: float, omega: float, dt: float) -> NDArray:
    """The arc by differences of sines and cosines, as everybody writes it first."""
    x, y, old = pose
    psi = old + omega * dt
    with np.errstate(all="ignore"):
        radius = np.float64(v) / omega
        dx, dy = radius * (np.sin(psi) - np.sin(old)), radius * (np.cos(old) - np.cos(psi))
    return np.array([x + dx, y + dy, psi])


def advanced_by(method: str) -> Callable[..., NDArray]:
    """A step by one of the library's methods, shape (3,) [m, m, rad]."""
    return lambda pose, v, omega, dt: odometry.advance(pose, v * dt, omega * dt, method)


def _move_times(*factors: float) -> Callable[..., NDArray]:
    return lambda pose, *given: pose + factors * (arc(pose, *given) - pose)


ARC = Exercise(
    number="6.5",
    title="Repair (4.3)",
    reference=arc,
    oracle="exponential_of_the_twist",
    cases=_turns,
    mistakes={
        "that is (4.3) as printed: integrate cos psi over psi, and you get its sine": (
            lambda pose, v, omega, dt: (arc if abs(omega) < 1e-8 else printed.step_43)(
                pose, v, omega, dt
            )
        ),
        "a turn to the left goes to the right: the integral of the sine is minus the cosine": (
            _move_times(1, -1, 1)
        ),
        "it divides by omega = 0: straight ahead needs its own branch, or the sinc form": (
            by_differences
        ),
        "right for omega = 0, but at 1e-12 the difference of two sines is only rounding error": (
            lambda pose, v, omega, dt: (by_differences if omega else arc)(pose, v, omega, dt)
        ),
        "right turns take the straight branch: omega < 0.001 needs an absolute value": (
            lambda pose, v, omega, dt: (advanced_by("midpoint") if omega < 0.001 else arc)(
                pose, v, omega, dt
            )
        ),
        "that is (4.1) corrected, Euler: a straight line along the old heading": (
            advanced_by("euler")
        ),
        "that is (4.1) as printed: a straight line along the new heading": printed.step_41,
        "that is (4.2) corrected: the right direction, but the chord is shorter than the arc": (
            advanced_by("midpoint")
        ),
        "(4.2) as printed, beyond the end: the middle is psi_{k-1} + omega T / 2": printed.step_42,
        "np.sinc(z) is sin(pi z) / (pi z): give it h / pi": (
            lambda pose, v, omega, dt: advanced_by("midpoint")(
                pose, v * np.sinc(omega * dt / 2), omega, dt
            )
        ),
        "that is how far it moved: add it to the pose": (
            lambda pose, *given: arc(pose, *given) - pose
        ),
        "the place is right, but the heading did not turn": _move_times(1, 1, 0),
        "the heading is wrapped: let it count on through full turns": (
            lambda *given: np.append(arc(*given)[:2], wrap(arc(*given)[2]))
        ),
    },
    hints=(
        "Integrate v cos(psi_0 + omega t) over the step; then look at omega -> 0.",
        "A chord of v dt sin(h) / h along psi_0 + h, h = omega dt / 2; np.sinc(h / pi) is safe.",
    ),
    tested_on="30 random steps, forwards and backwards, left, right and straight ahead",
)
