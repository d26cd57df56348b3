"""Exercises 6.4 and 6.5: a trapezoid with a predictor, and the exact arc."""

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
    """A trapezoid with x_k predicted by a step of Euler's, shape (n,)."""
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
        speeds = rng.uniform(1, 8, (2, 2)) * rng.choice((-1.0, 1.0), (2, 2))
        robot = odometry.differential(rng.uniform(0.05, 0.3), rng.uniform(0.4, 1.5))
        cases.append((x, *speeds, float(rng.uniform(0.05, 0.3)), robot.rate))
    x, _, u_new, dt, f = cases[0]
    return [*cases, (x, np.zeros(2), u_new, dt, f), (x, u_new, np.zeros(2), dt, f)]


TRAPEZOID = Exercise(
    number="6.4",
    title="Repair a turn",
    reference=heun,
    oracle="turn_at_the_old_rate_then_average",
    cases=_starts,
    compare=right_trapezoid,
    mistakes={
        "the old x in both halves, order 1: predict x_k first, and put it into the second rate": (
            lambda x, u_old, u_new, dt, f: x + dt / 2 * (f(x, u_old) + f(x, u_new))
        ),
        "one rate for the whole step, that of the new sample at the old x: average two": (
            lambda x, u_old, u_new, dt, f: x + dt * f(x, u_new)
        ),
        "that is the predictor, Euler's step: go on, and average the rates at both ends": (
            lambda x, u_old, u_new, dt, f: x + dt * f(x, u_old)
        ),
        "the rate at the end alone has order 1: average it with the one at the start": (
            lambda x, u_old, u_new, dt, f: x + dt * f(x + dt * f(x, u_old), u_new)
        ),
        "solved for the rate at the end alone, order 1: average it with the one at the start": (
            lambda x, u_old, u_new, dt, f: (
                odometry.streaming.implicit_euler(
                    odometry.streaming.State(0.0, x, u_old), dt, u_new, f
                ).x
            )
        ),
        "the old sample in both rates: the one at the end goes with u_new": (
            lambda x, u_old, u_new, dt, f: heun(x, u_old, u_old, dt, f)
        ),
        "the new sample in both rates: the one at the start goes with u_old": (
            lambda x, u_old, u_new, dt, f: heun(x, u_new, u_new, dt, f)
        ),
        "that is the mean rate: times dt, plus x": (
            lambda x, u_old, u_new, dt, f: (heun(x, u_old, u_new, dt, f) - x) / dt
        ),
        "it starts from the predicted x: the mean rate leads on from x": (
            lambda x, u_old, u_new, dt, f: dt * f(x, u_old) + heun(x, u_old, u_new, dt, f)
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
        "the midpoint rule, order 2 as well; but asked for are the rates at both ends, averaged": (
            lambda x, u_old, u_new, dt, f: x + dt * f(x + dt / 2 * f(x, u_old), (u_old + u_new) / 2)
        ),
    },
    hints=(
        "f(x_k, u_k) needs x_k. Guess it by a step of Euler's: x + dt f(x, u_old).",
        "before = f(x, u_old); after = f(x + dt * before, u_new); their mean, times dt, plus x.",
    ),
    tested_on="22 random steps of random robots, forwards, in reverse, from rest and to rest",
)


def arc(pose: NDArray, v: float, omega: float, dt: float) -> NDArray:
    """The exact arc for held speeds, straight ahead included, shape (3,) [m, m, rad]."""
    half = omega * dt / 2
    chord = v * dt * np.sinc(half / np.pi)
    middle = pose[2] + half
    return pose + np.array([chord * np.cos(middle), chord * np.sin(middle), omega * dt])


_STRAIGHT = ((0.8, 0.0), (-0.8, 0.0), (0.8, 1e-12), (-0.6, -1e-12), (0.9, 2e-4), (0.9, -2e-4))
_SPOT = ((0.0, 0.7), (0.0, -0.7))


def _turns(rng: np.random.Generator) -> list[tuple]:
    poses = rng.uniform((-4, -4, -9), (4, 4, 9), (33, 3))
    bends = rng.uniform((-1.5, 0.1), (1.5, 1.2), (25, 2))
    bends[:, 1] *= rng.choice((-1.0, 1.0), 25)
    speeds = [*_STRAIGHT, *_SPOT, *bends.tolist()]
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


def _straight_below(
    below: bool, pose: NDArray, v: float, omega: float, dt: float, turns: float = 1
) -> NDArray:
    """A straight line along the old heading in one branch, the arc in the other."""
    if not below:
        return arc(pose, v, omega, dt)
    return advanced_by("euler")(pose, v, omega, dt) - [0.0, 0.0, (1 - turns) * omega * dt]


def _move_times(*factors: float) -> Callable[..., NDArray]:
    return lambda pose, *given: pose + factors * (arc(pose, *given) - pose)


ARC = Exercise(
    number="6.5",
    title="Repair an arc",
    reference=arc,
    oracle="exponential_of_the_twist",
    cases=_turns,
    mistakes={
        "sine and cosine are swapped: integrate cos psi over psi, and you get its sine": (
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
        "right turns go straight on: omega < 0.001 needs an absolute value": (
            lambda *given: _straight_below(given[2] < 0.001, *given)
        ),
        "right turns go straight on: a threshold below them needs an absolute value": (
            lambda *given: _straight_below(given[2] < 1e-6, *given)
        ),
        "right turns go straight on and do not turn: omega < 0.001 needs an absolute value": (
            lambda *given: _straight_below(given[2] < 0.001, *given, turns=0)
        ),
        "right turns go straight on and do not turn: such a threshold needs an absolute value": (
            lambda *given: _straight_below(given[2] < 1e-6, *given, turns=0)
        ),
        "left turns take the straight branch: omega > 0.001 is what turns": (
            lambda *given: (advanced_by("midpoint") if given[2] > -0.001 else arc)(*given)
        ),
        "nearly straight, it goes along the old heading: a smaller threshold, or the middle": (
            lambda *given: _straight_below(abs(given[2]) < 0.001, *given)
        ),
        "nearly straight, the heading does not turn: add omega dt there, too": (
            lambda *given: _straight_below(abs(given[2]) < 0.001, *given, turns=0)
        ),
        "that is Euler: a straight line along the old heading": advanced_by("euler"),
        "a straight line along the new heading: the chord points to the middle of the turn": (
            printed.step_41
        ),
        "that is the midpoint: the right direction, but the chord is shorter than the arc": (
            advanced_by("midpoint")
        ),
        "beyond the end: the middle of the turn is psi_{k-1} + omega T / 2": printed.step_42,
        "in reverse it goes ahead: v has a sign": (
            lambda pose, v, omega, dt: arc(pose, abs(v), omega, dt)
        ),
        "it turns to one side only: omega has a sign": (
            lambda pose, v, omega, dt: arc(pose, v, abs(omega), dt)
        ),
        "the step goes on for a whole second: dt is missing": (
            lambda pose, v, omega, dt: arc(pose, v, omega, 1.0)
        ),
        "h is half the turn: omega dt / 2": (
            lambda pose, v, omega, dt: np.append(
                arc(pose, v, 2 * omega, dt)[:2], pose[2] + omega * dt
            )
        ),
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
    tested_on="33 random steps, forwards and in reverse, left, right, straight and on the spot",
)
