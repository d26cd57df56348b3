"""Exercises 3.1 to 3.3: the integral at rest, the closed loop and its Lyapunov function."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics, lyapunov
from backhoe.arm.lyapunov import State
from backhoe.arm.pid import Gains
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.lyapunov_pid import printed
from backhoe.machine import BACKHOE

RADIANS = "the angles come in radians already: do not convert them again"

Term = Callable[[State, Gains, float], ArrayLike]


def integral_at_rest(q_goal: ArrayLike, ki: ArrayLike) -> NDArray:
    """What the integral of the error must have grown to [rad s], shape (4,), at rest in q_goal."""
    return dynamics.gravity_torque(q_goal) / ki


def _goals(rng: np.random.Generator) -> list[tuple]:
    """Within the joints' limits, and beyond them, where the boom's weight pulls the other way."""
    goals = rng.uniform(BACKHOE.lower, BACKHOE.upper, (50, 4))
    goals[25:] = rng.uniform(-np.pi, np.pi, (25, 4))
    return list(zip(goals, rng.uniform(1e4, 1e6, (50, 4)), strict=True))


INTEGRAL = Exercise(
    number="3.1",
    title="what the integral has learnt",
    reference=integral_at_rest,
    oracle="rest_by_newton_and_euler",
    cases=_goals,
    tested_on="50 goals and gains",
    hints=(
        "at rest in the goal, error and speed are zero: which of the three terms is left?",
        "what is left must hold the weight: K_i times the integral = g(q_goal)",
    ),
    mistakes={
        "check the units: N m times N m/(rad s) is no rad s": (
            lambda q_goal, ki: dynamics.gravity_torque(q_goal) * ki
        ),
        "that is upside down, 1/(rad s), and infinite where nothing pulls": (
            lambda q_goal, ki: ki / dynamics.gravity_torque(q_goal)
        ),
        "the sign: g(q) is the torque that holds the arm up, and the integral must give it": (
            lambda q_goal, ki: -integral_at_rest(q_goal, ki)
        ),
        "that is the torque which the integral term must give; the integral itself is asked": (
            lambda q_goal, ki: dynamics.gravity_torque(q_goal)
        ),
        "each joint has its own integral gain: divide joint by joint": (
            lambda q_goal, ki: dynamics.gravity_torque(q_goal) / np.mean(ki)
        ),
        "right, but in degrees times seconds: leave it in rad s": (
            lambda q_goal, ki: np.degrees(integral_at_rest(q_goal, ki))
        ),
        RADIANS: lambda q_goal, ki: integral_at_rest(np.radians(q_goal), ki),
    },
)


def _states(rng: np.random.Generator) -> list[tuple]:
    """Random states, gains and alpha, 40 times."""
    return [
        (
            State(
                *rng.uniform(-0.3, 0.3, (2, 4)),
                rng.uniform(-0.6, 0.6, 4),
                rng.uniform(BACKHOE.lower, BACKHOE.upper),
            ),
            Gains(*rng.uniform((5e5, 5e4, 1e5), (3e6, 5e5, 1e6), (4, 3)).T),
            float(rng.uniform(0.5, 5.0)),
        )
        for _ in range(40)
    ]


def _pushed(torque: Term) -> Callable:
    """The closed loop with an extra torque, shape (4,) [N m]."""

    def rate(state: State, gains: Gains, alpha: float) -> tuple:
        dw, derror, ddq = lyapunov.closed_loop_rate(state, gains, alpha)
        M = dynamics.mass_matrix(state.goal - state.error)
        return dw, derror, ddq + np.linalg.solve(M, torque(state, gains, alpha))

    return rate


def _centrifugal(state: State, gains: Gains, alpha: float) -> NDArray:
    return dynamics.coriolis_matrix(state.goal - state.error, state.dq) @ state.dq


def _beyond_the_goal(state: State, gains: Gains, alpha: float) -> tuple:
    there = state.goal + 2 * state.error
    lost = dynamics.gravity_torque(state.goal) - dynamics.gravity_torque(there)
    return _pushed(lambda *_: lost)(state._replace(goal=there), gains, alpha)


def _no_inertia(state: State, gains: Gains, alpha: float) -> tuple:
    dw, derror, ddq = lyapunov.closed_loop_rate(state, gains, alpha)
    return dw, derror, dynamics.mass_matrix(state.goal - state.error) @ ddq


RATE = Exercise(
    number="3.2",
    title="repair the closed loop",
    reference=lyapunov.closed_loop_rate,
    oracle="torque_of_the_controller",
    cases=_states,
    tested_on="40 random states and gains",
    hints=(
        "the posture is q = goal - error, and the goal stands still: what is the error's rate?",
        "K_d acts on the error's rate, which is -dq; the other terms are right as they stand",
    ),
    mistakes={
        "the sign of the damping: + K_d dq pushes the arm the way it is moving already": (
            printed.closed_loop_rate_37
        ),
        (
            "the term with w lacks its 1/alpha: w = alpha z + error, so K_i z = K_i (w - error)/"
            "alpha"
        ): _pushed(lambda s, gains, alpha: (1 - 1 / alpha) * gains.ki * s.w),
        "the bracket is K_p - K_i/alpha: without 1/alpha the units do not even fit": (
            _pushed(lambda s, gains, alpha: (1 / alpha - 1) * gains.ki * s.error)
        ),
        "1/alpha is missing in both places where K_i stands": (
            _pushed(lambda s, gains, alpha: (1 - 1 / alpha) * gains.ki * (s.w - s.error))
        ),
        "w has part of the error in it: K_p alone counts that part twice, take K_p - K_i/alpha": (
            _pushed(lambda s, gains, alpha: gains.ki / alpha * s.error)
        ),
        "g(goal) is missing: z counts the integral from its value at rest, which holds it": (
            _pushed(lambda s, gains, alpha: -dynamics.gravity_torque(s.goal))
        ),
        "the Coriolis torques C dq are missing: subtract them before you divide by M": (
            _pushed(_centrifugal)
        ),
        "the posture: error = goal - q, so q = goal - error": _beyond_the_goal,
        "that is the torque that is left over: solve with M(q) for the acceleration": _no_inertia,
    },
)


def _plus(term: Term) -> Callable:
    """V with an extra term [J]."""
    return lambda *inputs: lyapunov.function(*inputs) + term(*inputs)


def _cross(state: State, alpha: float) -> float:
    """alpha error^T M dq."""
    return alpha * state.error @ dynamics.mass_matrix(state.goal - state.error) @ state.dq


def _potential(q: NDArray) -> float:
    return dynamics.energy(q, np.zeros(4))[1]


def _lifted(state: State) -> float:
    return _potential(state.goal - state.error) - _potential(state.goal)


def _lever(state: State) -> float:
    return state.error @ dynamics.gravity_torque(state.goal)


FUNCTION = Exercise(
    number="3.3",
    title="a function that must fall",
    reference=lyapunov.function,
    oracle="blocks_and_the_work_of_gravity",
    cases=_states,
    rtol=1e-7,
    atol=1e-3,
    tested_on="40 random states and gains",
    hints=(
        "multiply the block matrix out: one term for w, one with two errors, two with M",
        "the cross term stands twice in the matrix: with the 1/2 in front it is - alpha e^T M dq",
    ),
    mistakes={
        "the sign of the cross term: with dq, not the error's rate, it is - alpha e^T M dq": (
            printed.function_38
        ),
        "the cross term stands twice in the matrix, above and below the diagonal": (
            _plus(lambda s, gains, alpha: _cross(s, alpha) / 2)
        ),
        "the cross term - alpha e^T M dq is missing: the rest is hardly more than an energy": (
            _plus(lambda s, gains, alpha: _cross(s, alpha))
        ),
        "the cross term has a factor alpha": (
            _plus(lambda s, gains, alpha: _cross(s, alpha) - _cross(s, 1.0))
        ),
        "the sign of e^T g(goal): it takes the slope of U away, so it is added": (
            _plus(lambda s, gains, alpha: -2 * _lever(s))
        ),
        "e^T g(goal) is missing: without it V slopes at the goal and has no minimum there": (
            _plus(lambda s, gains, alpha: -_lever(s))
        ),
        "the potential energy U(q) - U(goal) is missing": (
            _plus(lambda s, gains, alpha: -_lifted(s))
        ),
        "the potential energy is U at the arm's posture less U at the goal, not the reverse": (
            _plus(lambda s, gains, alpha: -2 * _lifted(s))
        ),
        "subtract U(goal): at the goal, V must be zero": (
            _plus(lambda s, gains, alpha: _potential(s.goal))
        ),
        "the last bracket is K_p - K_i/alpha: the integral's share is in the term of w already": (
            _plus(lambda s, gains, alpha: s.error @ (gains.ki / alpha * s.error) / 2)
        ),
        "alpha e^T K_d e is missing: it pays for the cross term": (
            _plus(lambda s, gains, alpha: -alpha * s.error @ (gains.kd * s.error) / 2)
        ),
        "the term of w has K_i / alpha, not alpha K_i": (
            _plus(lambda s, gains, alpha: (alpha - 1 / alpha) * s.w @ (gains.ki * s.w) / 2)
        ),
        "a factor 2: the quadratic forms have a 1/2 in front": (
            lambda s, *inputs: 2 * lyapunov.function(s, *inputs) - _lifted(s) - _lever(s)
        ),
    },
)
