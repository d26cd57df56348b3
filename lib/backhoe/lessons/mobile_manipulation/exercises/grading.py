"""Exercises of lesson 12b: manipulability, priorities, limits, the slope."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.whole_body import (
    limited_velocity,
    manipulability,
    minimum_norm,
    strict_priorities,
)

__all__ = ["EXERCISES"]


def two_manipulabilities(J: NDArray, length: float) -> tuple[float, float]:
    """Of the arm alone and of the whole robot, a turn counted as the way at that length."""
    J = J / [1.0, *np.full(J.shape[1] - 1, length)]
    return float(manipulability(J[:, 2:])), float(manipulability(J))


def _jacobians(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(30):
        J = rng.normal(size=(3, 5 + k % 2))
        J[:, 0] = [np.cos(k), np.sin(k), 0.0]
        J[2, 1] = 0.0
        if k % 5 == 4:  # the arm stretched, but for a little
            J[:, 4] = 1.3 * J[:, 3] + 0.02 * rng.normal(size=3)
        cases.append((J, rng.uniform(0.3, 4.0)))
    return cases


def _root_of(gram: Callable[[NDArray], NDArray]) -> Callable[[NDArray], float]:
    return lambda J: float(np.sqrt(np.abs(np.linalg.det(gram(J)))))


_w = _root_of(lambda J: J @ J.T)


def _turns(J: NDArray, length: float) -> NDArray:
    return J / [1.0, *np.full(J.shape[1] - 1, length)]


def _both(w: Callable[[NDArray], float]) -> Callable[[NDArray, float], tuple[float, float]]:
    return lambda J, length: (w(_turns(J, length)[:, 2:]), w(_turns(J, length)))


MANIPULABILITY = Exercise(
    number="12.5",
    title="Two manipulabilities",
    reference=two_manipulabilities,
    cases=_jacobians,
    oracle="areas_of_all_triples_of_columns",
    mistakes={
        "the first is the whole robot's too, which is blind to the arm: take the arm's columns": (
            lambda J, length: (_w(_turns(J, length)),) * 2
        ),
        "omega is the platform's: the arm's columns begin with the third": (
            lambda J, length: (_w(_turns(J, length)[:, 1:]), _w(_turns(J, length)))
        ),
        "that is the determinant of J J^T: w is its root": _both(lambda J: _w(J) ** 2),
        "J^T J has as many rows as velocities and rank 3: its determinant is 0, take J J^T": _both(
            _root_of(lambda J: J.T @ J)
        ),
        "metres and radians are mixed: divide each column of a turn by the length": (
            lambda J, length: (_w(J[:, 2:]), _w(J))
        ),
        "a column is in metres a radian: divide by the length, do not multiply": (
            lambda J, length: two_manipulabilities(J, 1 / length)
        ),
        "u has no radian in it: its column is left as it is": (
            lambda J, length: (_w(J[:, 2:] / length), _w(J / length))
        ),
        "the length belongs to each column of a turn, not once to w": (
            lambda J, length: (_w(J[:, 2:]) / length, _w(J) / length)
        ),
        "the order is turned over: the arm's first, then the whole robot's": (
            lambda J, length: two_manipulabilities(J, length)[::-1]
        ),
    },
    hints=(
        "Columns: u, omega, then the arm's joints. All but the first are divided by the length.",
        "w = np.sqrt(np.linalg.det(J @ J.T)), once with J[:, 2:] and once with all columns.",
    ),
    atol=1e-6,
    tested_on="30 Jacobians of robots with 3 and 4 joints, six nearly stretched",
)


def two_tasks(J1: NDArray, b1: NDArray, J2: NDArray, b2: NDArray) -> NDArray:
    """The first task exactly, the second as well as the null space of the first allows."""
    return strict_priorities([(J1, b1), (J2, b2)])


def _tasks(rng: np.random.Generator) -> list[tuple]:
    sizes = [(3, 1), (4, 1), (3, 2), (4, 2), (4, 3), (2, 5)] * 4
    return [
        tuple(rng.normal(size=shape) for m in pair for shape in ((m, 6), (m,))) for pair in sizes
    ]


def _projector(J: NDArray) -> NDArray:
    return np.eye(J.shape[1]) - np.linalg.pinv(J) @ J


_plus = np.linalg.pinv

PRIORITY = Exercise(
    number="12.6",
    title="First things first",
    reference=two_tasks,
    cases=_tasks,
    oracle="conditions_of_the_least_second_error",
    mistakes={
        "the order is swapped: the first task gives way to the second": (
            lambda J1, b1, J2, b2: two_tasks(J2, b2, J1, b1)
        ),
        "summed: the second task pushes the first aside where they meet": (
            lambda J1, b1, J2, b2: _plus(J1) @ b1 + _plus(J2) @ b2
        ),
        "N2 is the freedom that the second task leaves: take that of the first, N1": (
            lambda J1, b1, J2, b2: (
                _plus(J1) @ b1 + _plus(J2 @ _projector(J2), 1e-9) @ (b2 - J2 @ _plus(J1) @ b1)
            )
        ),
        "J2^+ in place of (J2 N1)^+: its answer also moves the first task": (
            lambda J1, b1, J2, b2: _plus(J1) @ b1 + _plus(J2) @ (b2 - J2 @ _plus(J1) @ b1)
        ),
        "projected afterwards: N1 J2^+ spares the first task but misses the second": (
            lambda J1, b1, J2, b2: (
                _plus(J1) @ b1 + _projector(J1) @ _plus(J2) @ (b2 - J2 @ _plus(J1) @ b1)
            )
        ),
        "projected afterwards, and v1 not counted: what v1 does to the second task is still to "
        "be taken off": (lambda J1, b1, J2, b2: _plus(J1) @ b1 + _projector(J1) @ _plus(J2) @ b2),
        "v1 moves the second task already: only b2 - J2 v1 is left to do": (
            lambda J1, b1, J2, b2: _plus(J1) @ b1 + _plus(J2 @ _projector(J1), 1e-9) @ b2
        ),
        "one system for both: where it has no solution the first task errs as well": (
            lambda J1, b1, J2, b2: _plus(np.vstack([J1, J2])) @ np.r_[b1, b2]
        ),
        "only the first task: its null space is still free for the second": (
            lambda J1, b1, J2, b2: _plus(J1) @ b1
        ),
    },
    hints=(
        "v = v1 + (what is left of the second task, through the null space of the first).",
        "v1 = J1^+ b1, N1 = I - J1^+ J1; then solve (J2 N1) w = b2 - J2 v1 by the pseudo-inverse.",
    ),
    rtol=1e-5,
    atol=1e-7,
    tested_on="24 pairs of tasks for six velocities, twelve of them that do not fit together",
)


def scaled(v: NDArray, lower: NDArray, upper: NDArray) -> NDArray:
    """v times the largest factor, at most 1, that all bounds allow."""
    bound = np.where(v > 0, upper, lower)
    moving = v != 0
    return v * min(1.0, np.min(bound[moving] / v[moving], initial=1.0))


def _speeds(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(40):
        n = 4 + k % 4
        lower, upper = -rng.uniform(0.1, 1.0, n), rng.uniform(0.1, 1.0, n)
        v = rng.uniform((0.3, 2.0, 4.0)[k % 3] * lower, (0.3, 2.0, 4.0)[k % 3] * upper)
        v[k % n] *= k % 4 != 0
        if k % 8 == 5:  # at the end of its range, moving away from it, or into it
            j = int(np.argmax(np.abs(v)))
            (upper if (v[j] > 0) == (k % 16 == 5) else lower)[j] = 0.0
        cases.append((v, lower, upper))
    return cases


def _by(factor: Callable[[NDArray], float]) -> Callable[[NDArray, NDArray, NDArray], NDArray]:
    """v times a factor that is made of the shares v / bound."""

    def answer(v, lower, upper):
        bound = np.where(v > 0, upper, lower)
        use = np.divide(v, bound, out=np.where(v == 0, 0.0, np.inf), where=bound != 0)
        return v * np.nan_to_num(factor(use))

    return answer


SCALING = Exercise(
    number="12.7",
    title="Slower, not bent",
    reference=scaled,
    cases=_speeds,
    oracle="halved_until_it_fits",
    mistakes={
        "each axis is clipped by itself: the hand leaves its way; one factor for all": np.clip,
        "the mean factor: some limit is still broken; the least factor counts": _by(
            lambda use: 1 / max(1.0, np.mean(use))
        ),
        "bounds differ by side: for a negative v the lower one counts": (
            lambda v, lower, upper: scaled(v, -upper, upper)
        ),
        "the other side's bound: upper for a positive v, lower for a negative one": (
            lambda v, lower, upper: scaled(v, -upper, -lower)
        ),
        "a factor above 1 makes a slow task faster than it was asked to be: at most 1": _by(
            lambda use: 1 / np.max(use)
        ),
        "the first limit decides only if it is the tightest: take the least factor": _by(
            lambda use: 1 / max(1.0, use[0])
        ),
        "the loosest limit decides: take the least of all factors, not the largest": _by(
            lambda use: 1 / max(1.0, np.min(use))
        ),
        "all or nothing: the task may go on at a share of its speed": _by(
            lambda use: float(np.max(use) <= 1)
        ),
        "limits are not used: v may not pass them": lambda v, lower, upper: v,
    },
    hints=(
        "A positive v[i] allows the factor upper[i] / v[i], a negative one lower[i] / v[i].",
        "The least of these and 1 is the factor; where v[i] is 0 there is no limit from it.",
    ),
    tested_on="40 sets of 4 to 7 velocities, slow and fast, five with an axis at its end",
)


def whole_body(
    J: NDArray, b: NDArray, preferred: NDArray, lower: NDArray, upper: NDArray
) -> NDArray:
    """The mission's part, made of the library's quadratic programme."""
    return limited_velocity(J, b, lower, upper, preferred=preferred).v


def _steps(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(24):
        J, preferred = rng.normal(size=(4, 6)), 0.2 * rng.normal(size=6)
        J[2:, :2] = 0.0
        lower, upper = -rng.uniform(0.3, 1.5, 6), rng.uniform(0.3, 1.5, 6)
        b = (0.1, 1.0, 3.0)[k % 3] * rng.normal(size=4)
        cases.append((J, b, preferred, lower, upper))
    return cases


def _follows(
    answer: NDArray,
    reference: NDArray,
    J: NDArray,
    b: NDArray,
    preferred: NDArray,
    *bounds: NDArray,
) -> str | None:
    lower, upper = bounds
    if np.shape(answer) != (6,) or not np.isfinite(answer).all():
        return "give six finite velocities: u, omega and the four joints"
    over = np.maximum(answer - upper, lower - answer)
    if over.max() > 1e-6:
        return f"velocity {int(over.argmax())} is outside its bounds"
    s = float(b @ J @ answer / (b @ b))
    if np.abs(J @ answer - s * b).max() > 1e-4 * np.abs(b).max():
        return "J v has another direction than b: the edge leaves its way"
    if not -1e-6 <= s <= 1 + 1e-3:
        return "J v is longer than b, or against it: the share s is from 0 to 1"
    v = preferred + _plus(J) @ (b - J @ preferred)
    plain = scaled(v, lower, upper)
    least = float(b @ J @ plain / (b @ b))
    if s < least - 1e-2:
        return "slower than the limits ask for: scale no more than they need"
    if least == 1.0 and np.abs(answer - v).max() > 2e-2:
        return "right for the edge, but not the v nearest to the preferred one"
    return None


WHOLE_BODY = Exercise(
    number="12.8",
    title="Your whole body in the machine",
    reference=whole_body,
    cases=_steps,
    oracle="a_linear_programme_and_multipliers",
    mistakes={
        "each axis is clipped after the solution: the edge leaves its way": (
            lambda J, b, preferred, lower, upper: np.clip(
                minimum_norm(J, b, preferred), lower, upper
            )
        ),
        "limits are not used: the drives will cut what is too fast, each axis by itself": (
            lambda J, b, preferred, lower, upper: minimum_norm(J, b, preferred)
        ),
        "the preferred velocities are forgotten: the tracks do not creep": (
            lambda J, b, preferred, lower, upper: scaled(minimum_norm(J, b), lower, upper)
        ),
        "the preferred velocities are added as they are: they move the edge; through N first": (
            lambda J, b, preferred, lower, upper: scaled(
                minimum_norm(J, b) + preferred, lower, upper
            )
        ),
        "scaled first, preferred velocities added afterwards: the sum can pass the limits": (
            lambda J, b, preferred, lower, upper: (
                scaled(minimum_norm(J, b), lower, upper) + _projector(J) @ preferred
            )
        ),
        "that is the preferred v alone: the edge's task is forgotten": (
            lambda J, b, preferred, lower, upper: scaled(preferred, lower, upper)
        ),
    },
    hints=(
        "Minimum norm with the preferred velocities, J^+ b + N v0, then your factor of 12.7.",
        "Or hand in the quadratic programme of section 3: it is faster where a limit is near.",
    ),
    compare=_follows,
    timeout=20.0,
    tested_on="24 random tasks, slow, quick and far too quick",
)

EXERCISES = (MANIPULABILITY, PRIORITY, SCALING, WHOLE_BODY)
