"""Exercises of lesson 10b: where a new goal leads, a better way there, a truck elsewhere."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.planning.dmp import DMP, demonstration, minimum_jerk, sequence

__all__ = ["EXERCISES"]


def stiff_path(x: NDArray, s: NDArray, new_goal: NDArray) -> NDArray:
    """x + (g' - g)(1 - s): where a stiff primitive goes when only its goal is new."""
    return x + (new_goal - x[-1]) * (1 - s[:, None])


def _stiff_cases(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(12):
        s = np.exp(-rng.uniform(3, 7) * np.linspace(0, 1, 20 + k))
        x = np.cumsum(rng.normal(size=(20 + k, 1 + k % 4)), axis=0)
        cases.append((x, s, x[-1] + rng.normal(size=1 + k % 4)))
    return cases


STIFF = Exercise(
    number="10.5",
    title="Where a new goal leads",
    reference=stiff_path,
    cases=_stiff_cases,
    oracle="a_very_stiff_spring_is_followed",
    mistakes={
        "the shift grows as the phase falls: 1 - s, which is 0 at the start": (
            lambda x, s, new_goal: x + (new_goal - x[-1]) * s[:, None]
        ),
        "the whole path is moved: the start stands where it stood": (
            lambda x, s, new_goal: x + (new_goal - x[-1])
        ),
        "the sign is turned: from the old goal to the new one": (
            lambda x, s, new_goal: x - (new_goal - x[-1]) * (1 - s[:, None])
        ),
        "the shift is from the old goal, x[-1], not from the start": (
            lambda x, s, new_goal: x + (new_goal - x[0]) * (1 - s[:, None])
        ),
        "the phase does not reach 0: the shift is 1 - s as it is, and misses the goal a little": (
            lambda x, s, new_goal: x + (new_goal - x[-1]) * ((1 - s) / (1 - s[-1]))[:, None]
        ),
        "the shift grows with the phase, not evenly with time": (
            lambda x, s, new_goal: x + (new_goal - x[-1]) * np.linspace(0, 1, len(x))[:, None]
        ),
    },
    hints=(
        "Take the demonstrated path x; add the shift of the goal, times a number for each sample.",
        "x[-1] is the old goal; s has one value a sample, so s[:, None] goes with rows of x.",
    ),
    tested_on="12 random paths in 1 to 4 dimensions",
)


def minimum_jerk_shift(x: NDArray, t: NDArray, new_start: NDArray, new_goal: NDArray) -> NDArray:
    """The path with its start and its goal moved, from one shift to the other by minimum jerk."""
    m = minimum_jerk((t - t[0]) / (t[-1] - t[0]))[0][:, None]
    return x + (1 - m) * (new_start - x[0]) + m * (new_goal - x[-1])


def _shift_cases(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(12):
        n, d = 20 + k, 1 + k % 4
        t = (k % 3 - 1) * 2.0 + np.cumsum(rng.uniform(0.016, 0.151, n))
        x = np.cumsum(rng.normal(size=(n, d)), axis=0)
        cases.append((x, t, x[0] + rng.normal(size=d), x[-1] + rng.normal(size=d)))
    return cases


def _by(weight: Callable[[NDArray], NDArray]) -> Callable[..., NDArray]:
    """The shift with another m(u)."""

    def answer(x, t, new_start, new_goal):
        m = weight((t - t[0]) / (t[-1] - t[0]))[:, None]
        return x + (1 - m) * (new_start - x[0]) + m * (new_goal - x[-1])

    return answer


def _timed(share: Callable[[NDArray], NDArray]) -> Callable[..., NDArray]:
    """The shift with another u(t)."""

    def answer(x, t, new_start, new_goal):
        m = minimum_jerk(share(t))[0][:, None]
        return x + (1 - m) * (new_start - x[0]) + m * (new_goal - x[-1])

    return answer


SHIFT = Exercise(
    number="10.6",
    title="A better way to a new goal",
    reference=minimum_jerk_shift,
    cases=_shift_cases,
    oracle="ends_hold_and_the_shift_is_the_smoothest",
    mistakes={
        "u rises evenly: the shift would set off and stop with a jerk": _by(lambda u: u),
        "that is the phase's way, which (6.4) takes already: m(u) by minimum jerk": _by(
            lambda u: 1 - np.exp(-5.25 * u)
        ),
        "m(u) is 3 u^2 - 2 u^3: at rest at the ends, but its acceleration jumps there": _by(
            lambda u: u**2 * (3 - 2 * u)
        ),
        "that is the slope of m(u), not m(u)": _by(lambda u: 30 * u**2 * (1 - u) ** 2),
        "m and 1 - m are changed over: the start moves by its shift, the goal by its own": _by(
            lambda u: 1 - minimum_jerk(u)[0]
        ),
        "times need not begin at 0: u is (t - t[0]) / (t[-1] - t[0])": _timed(lambda t: t / t[-1]),
        "samples are not evenly spaced: u comes from the times": _timed(
            lambda t: np.linspace(0, 1, len(t))
        ),
        "the start's shift is forgotten: it fades as the goal's grows": (
            lambda x, t, new_start, new_goal: minimum_jerk_shift(x, t, x[0], new_goal)
        ),
        "the goal's shift is from the old goal, x[-1], not from the start": (
            lambda x, t, new_start, new_goal: minimum_jerk_shift(
                x, t, new_start, new_goal + x[-1] - x[0]
            )
        ),
    },
    hints=(
        "u is the share of the time that has passed; m(u) = 10 u^3 - 15 u^4 + 6 u^5.",
        "Two shifts: of the start, times 1 - m, and of the goal, times m; added to the path.",
    ),
    tested_on="12 random paths at uneven times in 1 to 4 dimensions",
)


def moved_cycle(dig: tuple, load: tuple, shift: NDArray) -> tuple[NDArray, NDArray]:
    """Dig as shown, then load a truck that stands elsewhere: times (n,) [s], path (n, 4)."""
    parts = [DMP().learn(positions, times) for times, positions in (dig, load)]
    goal = parts[1].goal + np.r_[shift, 0.0, 0.0]
    t, x, _ = sequence(parts, [None, goal], dt=0.02, remedy="minimum_jerk", exact_end=True)
    return t, x


def _cycles(rng: np.random.Generator) -> list[tuple]:
    dig, load = (tuple(demonstration(name, 0.02)) for name in ("dig", "load"))
    shifts = [[-3.2, 0.2], [1.0, -0.3], *rng.uniform([-2.0, -0.4], [1.5, 0.2], (4, 2))]
    return [(dig, load, np.array(shift)) for shift in shifts]


def _loads(answer, reference, dig, load, shift) -> str | None:
    """Whether a path digs as shown, is continuous and ends over the truck."""
    if not (isinstance(answer, (tuple, list)) and len(answer) == 2):
        return "give two things: times (n,) and the path (n, 4)"
    t, x = (np.asarray(one, dtype=float) for one in answer)
    if t.ndim != 1 or x.shape != (len(t), 4) or not (np.isfinite(t).all() and np.isfinite(x).all()):
        return "give times (n,) and the path (n, 4), all finite"
    if len(t) < 50 or (np.diff(t) <= 0).any():
        return "times must rise: leave out the sample that dig and load share"
    if np.diff(t).max() > 0.3:
        return "give a sample at least each 0.3 s"
    rows = np.column_stack([np.interp(dig[0], t - t[0], column) for column in x.T])
    if np.abs(rows - dig[1]).max() > 0.1:
        return "the dig itself is moved: only the truck stands elsewhere"
    goal = load[1][-1] + [*shift, 0.0, 0.0]
    if np.abs(x[-1] - load[1][-1]).max() < 1e-6 < np.abs(shift).max():
        return "it ends where the truck used to be"
    if np.abs(x[-1] - goal).max() > 0.02:
        return "it ends elsewhere than over the truck: the goal of the load, moved by the shift"
    if np.abs(np.diff(x, axis=0) / np.diff(t)[:, None]).max() > 3.0:
        return "the path jumps, or is faster than 3 m/s: where dig and load meet, or at the end"
    if abs(t[-1] - t[0] - dig[0][-1] - load[0][-1]) > 2.0:
        return "it should last about as long as dig and load together"
    return None


def _glued(moved: Callable[[NDArray, NDArray, NDArray], NDArray]) -> Callable[..., tuple]:
    """Dig and load one after the other, the load changed by a function of its path and times."""

    def answer(dig, load, shift):
        t, x = dig[0][-1] + load[0][1:], moved(load[1], load[0], np.r_[shift, 0, 0])[1:]
        return np.r_[dig[0], t], np.vstack([dig[1], x])

    return answer


CYCLE = Exercise(
    number="10.7",
    title="The truck stands elsewhere",
    reference=moved_cycle,
    cases=_cycles,
    oracle="digs_as_shown_and_ends_over_the_truck",
    mistakes={
        "it ends where the truck used to be": _glued(lambda x, t, shift: x),
        "the path jumps, or is faster than 3 m/s: where dig and load meet, or at the end": _glued(
            lambda x, t, shift: x + shift
        ),
        "it ends elsewhere than over the truck: the goal of the load, moved by the shift": _glued(
            lambda x, t, shift: minimum_jerk_shift(x, t, x[0], x[-1] - shift)
        ),
        "the dig itself is moved: only the truck stands elsewhere": (
            lambda dig, load, shift: (
                np.r_[dig[0], dig[0][-1] + load[0][1:]],
                np.vstack([dig[1], load[1][1:]]) + np.r_[shift, 0, 0],
            )
        ),
        "times must rise: leave out the sample that dig and load share": (
            lambda dig, load, shift: (
                np.r_[dig[0], dig[0][-1] + load[0]],
                np.vstack(
                    [
                        dig[1],
                        minimum_jerk_shift(
                            load[1], load[0], load[1][0], load[1][-1] + np.r_[shift, 0, 0]
                        ),
                    ]
                ),
            )
        ),
    },
    hints=(
        "The dig as it is; then the load with its goal moved by your exercise 10.6.",
        "np.r_[t1, t1[-1] + t2[1:]] and np.vstack([x1, x2[1:]]): the shared sample only once.",
    ),
    compare=_loads,
    timeout=20.0,
    tested_on="six places of the truck",
)

EXERCISES = (STIFF, SHIFT, CYCLE)
