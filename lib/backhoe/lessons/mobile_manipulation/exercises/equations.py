"""Exercises of lesson 12a: the Jacobian, least velocities, the null space, W."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.whole_body import (
    BACKHOE,
    Robot,
    SlidesRobot,
    hand,
    jacobian,
    minimum_norm,
    null_projector,
    wanted_velocity,
)

__all__ = ["EXERCISES"]


def _robots(rng: np.random.Generator) -> list[tuple]:
    """Postures far from the origin, of arms of several sizes and of the backhoe."""
    robots = [SlidesRobot(*rng.uniform(0.1, 0.9, 4)) for _ in range(12)] + [BACKHOE] * 8
    return [
        (np.r_[rng.uniform(-5, 5, 2), rng.uniform(-3, 3, 1 + robot.joints)], robot)
        for robot in robots
    ]


def _pieces(q: NDArray, robot: Robot) -> tuple[NDArray, NDArray, NDArray]:
    """The turn of the platform, and its own view of the hand and of the arm's columns."""
    c, s = np.cos(q[2]), np.sin(q[2])
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return turn, robot.reach(q[3:]), robot.reach_jacobian(q[3:])


def _joined(heading: NDArray, lever: NDArray, arm: NDArray) -> NDArray:
    return np.c_[heading, np.cross([0.0, 0.0, 1.0], lever), arm]


def _arm_not_turned(q: NDArray, robot: Robot) -> NDArray:
    turn, reach, arm = _pieces(q, robot)
    return _joined(turn[:, 0], turn @ reach, arm)


def _lever_not_turned(q: NDArray, robot: Robot) -> NDArray:
    turn, reach, arm = _pieces(q, robot)
    return _joined(turn[:, 0], reach, turn @ arm)


def _heading_only(q: NDArray, robot: Robot) -> NDArray:
    turn, reach, arm = _pieces(q, robot)
    return _joined(turn[:, 0], reach, arm)


def _turned_back(q: NDArray, robot: Robot) -> NDArray:
    turn, reach, arm = _pieces(q, robot)
    return _joined(turn[:, 0], turn @ reach, turn.T @ arm)


def _about_the_origin(q: NDArray, robot: Robot) -> NDArray:
    turn, _, arm = _pieces(q, robot)
    return _joined(turn[:, 0], hand(q, robot), turn @ arm)


def _seen_from_the_platform(q: NDArray, robot: Robot) -> NDArray:
    return _joined(np.eye(3)[0], *_pieces(q, robot)[1:])


def _turned_the_other_way(q: NDArray, robot: Robot) -> NDArray:
    return jacobian(q, robot) * np.r_[1.0, -1.0, np.ones(robot.joints)]


JACOBIAN = Exercise(
    number="12.1",
    title="Six columns",
    reference=jacobian,
    cases=_robots,
    oracle="hands_moved_a_little",
    mistakes={
        "the arm's columns are the platform's view: turn them by theta, as the heading": (
            _arm_not_turned
        ),
        "the lever of omega is the platform's view: turn the reach by theta before the cross": (
            _lever_not_turned
        ),
        "only the heading is turned by theta: the lever of omega and the arm's columns turn, too": (
            _heading_only
        ),
        "the arm's columns are turned by -theta: from the platform to the world it is +theta": (
            _turned_back
        ),
        "omega turns the hand about the platform and not about the world's origin: no x, y": (
            _about_the_origin
        ),
        "all of it is seen from the platform: turn all columns by theta": _seen_from_the_platform,
        "the column of omega points the other way: up cross lever, in this order": (
            _turned_the_other_way
        ),
    },
    hints=(
        "R = [[c, -s, 0], [s, c, 0], [0, 0, 1]] turns from the platform's view to the world's.",
        "The columns: R[:, 0]; then up x (R @ reach); then R @ reach_jacobian. np.c_ joins them.",
    ),
    tested_on="12 arms of the slides' kind and 8 postures of the backhoe",
)


def _equations(rng: np.random.Generator) -> list[tuple]:
    """J, b and weights: of both robots, and of none."""
    cases = []
    for q, robot in _robots(rng):
        J = jacobian(q, robot)
        cases.append((J, rng.normal(size=3), rng.uniform(0.2, 9.0, J.shape[1])))
    for m, n in ((1, 2), (2, 6), (4, 6)):
        cases.append((rng.normal(size=(m, n)), rng.normal(size=m), rng.uniform(0.2, 9.0, n)))
    return [case for case in cases if np.linalg.cond(case[0]) < 50]


def least_velocities(J: NDArray, b: NDArray, weights: NDArray) -> NDArray:
    """Of all v with J v = b the one whose sum of weights v^2 is least, shape (n,)."""
    return minimum_norm(J, b, weights=weights)


def _plain(J: NDArray, b: NDArray, weights: NDArray) -> NDArray:
    return minimum_norm(J, b)


def _times_weights(J: NDArray, b: NDArray, weights: NDArray) -> NDArray:
    return minimum_norm(J, b, weights=1 / weights)


def _weights_squared(J: NDArray, b: NDArray, weights: NDArray) -> NDArray:
    return minimum_norm(J, b, weights=weights**2)


def _not_scaled_back(J: NDArray, b: NDArray, weights: NDArray) -> NDArray:
    return minimum_norm(J, b, weights=weights) * np.sqrt(weights)


def _transposed(J: NDArray, b: NDArray, weights: NDArray) -> NDArray:
    return J.T @ b


def _weighted_outside(J: NDArray, b: NDArray, weights: NDArray) -> NDArray:
    return minimum_norm(J, b) / weights


def _some_solution(J: NDArray, b: NDArray, weights: NDArray) -> NDArray:
    v = np.zeros(J.shape[1])
    v[-len(J) :] = np.linalg.solve(J[:, -len(J) :], b)
    return v


LEAST = Exercise(
    number="12.2",
    title="The cheapest velocities",
    reference=least_velocities,
    cases=_equations,
    oracle="no_way_along_the_solutions_is_cheaper",
    rtol=1e-5,
    atol=1e-7,
    mistakes={
        "the weights are left out: that is the least sum of v^2 itself": _plain,
        "the weights are upside down: a dear velocity must become small": _times_weights,
        "the weights are used twice: w v^2 and not (w v)^2 is to be least": _weights_squared,
        "that is sqrt(w) v, in the scaled velocities: divide once more to come back": (
            _not_scaled_back
        ),
        "J.T @ b alone is no solution: J.T @ y with J J.T y = b": _transposed,
        "scaled after solving, it no longer moves the hand by b: the weights belong in both Js": (
            _weighted_outside
        ),
        "the last velocities do all of it: a solution, and not the cheapest": _some_solution,
    },
    hints=(
        "Put v = z / sqrt(w): the sum of w v^2 is the sum of z^2, and J v = (J / sqrt(w)) z.",
        "K = J / w (each column by its weight); then v = K.T @ np.linalg.solve(J @ K.T, b).",
    ),
    tested_on="both robots in random postures, and matrices of other shapes",
)


def _matrices(rng: np.random.Generator) -> list[tuple]:
    return [(J,) for J, _, _ in _equations(rng)]


def _the_other_part(J: NDArray) -> NDArray:
    return np.linalg.pinv(J) @ J


def _turned_sign(J: NDArray) -> NDArray:
    return -null_projector(J)


def _transpose_for_inverse(J: NDArray) -> NDArray:
    return np.eye(J.shape[1]) - J.T @ J


def _basis(J: NDArray) -> NDArray:
    return np.linalg.svd(J)[2][len(J) :].T


def _in_the_hand(J: NDArray) -> NDArray:
    return np.eye(len(J)) - J @ np.linalg.pinv(J)


PROJECTOR = Exercise(
    number="12.3",
    title="What the hand does not notice",
    reference=null_projector,
    cases=_matrices,
    oracle="from_a_basis_of_the_null_space",
    atol=1e-8,
    mistakes={
        "J^+ J keeps what moves the hand: take it away from the identity": _the_other_part,
        "the sign is turned: I - J^+ J leaves a v0 without effect on the hand as it is": (
            _turned_sign
        ),
        "the transpose is no inverse: (J J^T)^-1 is missing between J^T and J": (
            _transpose_for_inverse
        ),
        "these are directions that the hand does not notice, a basis: their N is Z @ Z.T": _basis,
        "J J^+ is in the hand's space, and just 1 there: it is J^+ J, one row a velocity": (
            _in_the_hand
        ),
    },
    hints=(
        "J^+ = J.T @ np.linalg.inv(J @ J.T); np.linalg.pinv(J) is the same.",
        "np.eye(J.shape[1]) - J^+ @ J. Then J @ N must be zero, and N @ N = N.",
    ),
    tested_on="both robots in random postures, and matrices of other shapes",
)


def _steps(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(24):
        h, goal, next_goal = rng.uniform(-2, 2, (3, 3))
        W = rng.uniform(0.05, 0.95, 3) if k % 2 else float(rng.uniform(0.05, 0.95))
        cases.append((h, goal, next_goal, W, float(rng.uniform(0.02, 0.4))))
    return cases


def _changed(**factors: float) -> object:
    """(next_goal - w W e - g e - h) / T for other factors w and g."""
    w, g, ahead = factors.get("w", 1.0), factors.get("g", 0.0), factors.get("ahead", 1.0)

    def wrong(h: NDArray, goal: NDArray, next_goal: NDArray, W: NDArray, T: float) -> NDArray:
        start = ahead * next_goal + (1 - ahead) * goal
        return (start - (w * np.asarray(W) + g) * (goal - h) - h) / T

    return wrong


def _only_the_way_in_t(
    h: NDArray, goal: NDArray, next_goal: NDArray, W: NDArray, T: float
) -> NDArray:
    return (next_goal - goal) / T + (1 - np.asarray(W)) * (goal - h)


def _where_and_not_how_far(
    h: NDArray, goal: NDArray, next_goal: NDArray, W: NDArray, T: float
) -> NDArray:
    return (next_goal - W * (goal - h)) / T


def _with_the_next_error(
    h: NDArray, goal: NDArray, next_goal: NDArray, W: NDArray, T: float
) -> NDArray:
    return (next_goal - W * (next_goal - h) - h) / T


WANTED = Exercise(
    number="12.4",
    title="Leave W of the error",
    reference=wanted_velocity,
    cases=_steps,
    oracle="after_the_step_w_of_the_error_is_left",
    mistakes={
        "that is where the hand should be: take away where it is, then divide by T": (
            _where_and_not_how_far
        ),
        "the goal's way is divided by T, the error is not: both are to be gone in T": (
            _only_the_way_in_t
        ),
        "the error's sign is turned: e = goal - h, where it should be less where it is": (
            _changed(w=-1.0)
        ),
        "that leaves 1 - W of the error: W is what is left, not what is taken away": (
            _changed(w=-1.0, g=1.0)
        ),
        "the next goal is forgotten: the hand would be a step late all the way": (
            _changed(ahead=0.0)
        ),
        "the way is right, but it is to be gone in T: divide by it": (
            lambda h, goal, next_goal, W, T: wanted_velocity(h, goal, next_goal, W, 1.0)
        ),
        "multiplied by T: a short step needs a high velocity": (
            lambda h, goal, next_goal, W, T: wanted_velocity(h, goal, next_goal, W, 1 / T)
        ),
        "the goal's own velocity alone: the error of now is never mended": _changed(w=0.0, g=1.0),
        "the error is left out, W = 0: all of it would be mended in one step": _changed(w=0.0),
        "W times the error of now, to this step's goal, not to the next one": _with_the_next_error,
    },
    hints=(
        "Write down where the hand should be after the step: next_goal - W (goal - h).",
        "It is at h now and has the time T: (where it should be - h) / T.",
    ),
    tested_on="24 steps, with one W and with a W for each direction",
)

EXERCISES = (JACOBIAN, LEAST, PROJECTOR, WANTED)
