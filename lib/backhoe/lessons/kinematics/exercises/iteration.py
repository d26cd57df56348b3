"""Exercises 1.7 and 1.9: the damped inverse, and a solver that steps along it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.arm import kinematics
from backhoe.arm.kinematics import damped_inverse
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.kinematics import printed
from backhoe.machine import BACKHOE


def _damped_cases(rng: np.random.Generator) -> list[tuple[NDArray, float]]:
    cases = []
    for index, q in enumerate(rng.uniform(BACKHOE.lower, BACKHOE.upper, (40, 4))):
        if index % 2:
            q[2] = -BACKHOE.stick.angle_offset - rng.uniform(0.02, 0.2)
        rows = 3 if index % 4 == 3 else 4
        cases.append((kinematics.task_jacobian(q)[:rows], rng.uniform(0.05, 0.4)))
    return cases


def _from_svd(
    V: Callable = np.transpose, sign: float = 1.0, full: bool = True
) -> Callable[[NDArray, float], NDArray]:
    def inverse(J: NDArray, damping: float) -> NDArray:
        U, sigma, V_T = np.linalg.svd(J, full_matrices=full)
        return V(V_T) @ np.diag(sigma / (sigma**2 + sign * damping**2)) @ U.T

    return inverse


DAMPED = Exercise(
    number="1.7",
    title="The damped inverse",
    reference=damped_inverse,
    oracle="gradient_of_damped_least_squares_is_zero",
    cases=_damped_cases,
    mistakes={
        "J + lambda^2 I can be singular itself, and needs a square J": printed.inverse_24,
        "1/(sigma + lambda^2) never gets small near sigma = 0: sigma/(sigma^2 + lambda^2)": (
            printed.inverse_25
        ),
        "there is no damping in it: near the stretched arm it asks for enormous steps": (
            lambda J, damping: np.linalg.inv(J)
        ),
        "that is the pseudoinverse, which has no damping: near the stretched arm it explodes": (
            lambda J, damping: np.linalg.pinv(J)
        ),
        (
            "right while J is square: with three rows svd(J, full_matrices=False) makes the "
            "shapes fit"
        ): _from_svd(),
        "np.linalg.svd returns U, sigma and V^T, transposed already: V is V_T.T": (
            _from_svd(np.asarray)
        ),
        "the damping enters squared: lambda^2 I": (
            lambda J, damping: damped_inverse(J, np.sqrt(damping))
        ),
        "a J^T is missing: J^T (J J^T + lambda^2 I)^-1": (
            lambda J, damping: np.linalg.inv(J @ J.T + damping**2 * np.eye(len(J)))
        ),
        "J^T (J J^T + ...)^-1 or (J^T J + ...)^-1 J^T: you have mixed the two forms": (
            lambda J, damping: J.T @ np.linalg.inv(J.T @ J + damping**2 * np.eye(4))
        ),
        "the damping is added to sigma^2, not taken off": _from_svd(sign=-1.0, full=False),
    },
    hints=(
        "Minimise |J dq - e|^2 + lambda^2 |dq|^2: set its gradient to zero, and take e out of dq.",
        "(J^T J + lambda^2 I)^-1 J^T; or the SVD with a gain sigma/(sigma^2 + lambda^2) each.",
    ),
    tested_on="40 random Jacobians, half near the stretched arm, some with three wishes only",
)


def solver(target: NDArray) -> NDArray:
    """Posture at x, y, z of the pin [m] and the bucket joint's angle [rad], by damped steps.

    Raises:
        ValueError: it is not there after 200 steps.
    """
    q = (BACKHOE.lower + BACKHOE.upper) / 2
    q[0] = np.arctan2(BACKHOE.base.offset - target[0], target[1])
    for _ in range(200):
        error = target - kinematics.pose(q)
        if np.abs(error).max() < 1e-6:
            return q
        q = q + damped_inverse(kinematics.task_jacobian(q), 0.1) @ error
        q = np.clip(q, BACKHOE.lower, BACKHOE.upper)
    raise ValueError(f"target {target} is not reached in 200 steps")


def _solved(
    steps: int = 200, enough: float = 1e-6, clip: bool = True, rows: int = 4
) -> Callable[[NDArray], NDArray]:
    """`solver` with other settings, which never raises."""

    def solve(target: NDArray) -> NDArray:
        q = (BACKHOE.lower + BACKHOE.upper) / 2
        q[0] = np.arctan2(BACKHOE.base.offset - target[0], target[1])
        for _ in range(steps):
            error = (target - kinematics.pose(q))[:rows]
            if np.abs(error).max() < enough:
                break
            q = q + damped_inverse(kinematics.task_jacobian(q)[:rows], 0.1) @ error
            q = np.clip(q, BACKHOE.lower, BACKHOE.upper) if clip else q
        return q

    return solve


def _in_reach(solve: Callable) -> Callable[[NDArray], NDArray]:
    """`solve` that raises where `solver` does."""

    def solved(target: NDArray) -> NDArray:
        solver(target)
        return solve(target)

    return solved


_FAR = "it stops away from the target: repeat the step until all of the error is small"
_OUTSIDE = "it ends outside the joints' limits: np.clip(q, lower, upper) after each step"


def arrives(answer: NDArray, reference: NDArray, target: NDArray) -> bool | str:
    """Whether a posture is at the target, to 0.01 mm, and within the limits."""
    if np.shape(answer) != (4,):
        return "a posture is asked, four joint angles"
    if np.abs(kinematics.pose(answer) - target).max() > 1e-5:
        return _FAR
    inside = (BACKHOE.lower - 1e-9 <= answer) & (answer <= BACKHOE.upper + 1e-9)
    return bool(inside.all()) or _OUTSIDE


def _solver_cases(rng: np.random.Generator) -> list[tuple[NDArray]]:
    postures = rng.uniform(BACKHOE.lower, BACKHOE.upper, (40, 4))
    far = np.column_stack((rng.uniform(8.5, 12, 3), rng.uniform(-3, 3, (3, 3))))
    near = np.array([(1.5, 0.5, 1.2, 0.0), (0.2, -1.5, 2.0, 0.5)])
    return [(target,) for target in (*kinematics.pose(postures), *far, *near)]


SOLVER = Exercise(
    number="1.9",
    title="A solver without a formula",
    reference=solver,
    oracle="there_within_the_limits_or_out_of_reach",
    cases=_solver_cases,
    compare=arrives,
    mistakes={
        _OUTSIDE: _in_reach(_solved(clip=False)),
        _FAR: _in_reach(_solved(enough=0.05)),
        "one step is not enough: the Jacobian is right for small steps only, so repeat": (
            _in_reach(_solved(steps=1))
        ),
        "out of reach it must not return: raise ValueError after 200 steps": _solved(),
        "the bucket's angle is not brought along: the error has four rows": (
            _in_reach(_solved(rows=3))
        ),
        "that is the way from the start, not the posture: return q": (
            _in_reach(lambda target: _solved()(target) - _solved(steps=0)(target))
        ),
    },
    hints=(
        "error = target - kinematics.pose(q); a step is my_damped_inverse(J, 0.1) @ error.",
        "for _ in range(200): return q if the error is small, else step and clip; then raise.",
    ),
    tested_on="40 random targets, and five out of reach",
)
