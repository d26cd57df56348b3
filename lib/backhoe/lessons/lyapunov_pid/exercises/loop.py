"""Exercises 3.1 to 3.3: the integral at rest, the closed loop and its Lyapunov function."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics
from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE

RADIANS = "the angles come in radians already: do not convert them again"


def integral_at_rest(q_goal: ArrayLike, ki: ArrayLike) -> NDArray:
    """What the integral of the error must have grown to [rad s], shape (4,), at rest in q_goal."""
    return dynamics.gravity_torque(q_goal) / ki


def _goals(rng: np.random.Generator) -> list[tuple]:
    goals = rng.uniform(BACKHOE.lower, BACKHOE.upper, (50, 4))
    return list(zip(goals, rng.uniform(1e4, 1e6, (50, 4)), strict=True))


INTEGRAL = Exercise(
    number="3.1",
    title="what the integral has learnt",
    reference=integral_at_rest,
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
        (RADIANS): (lambda q_goal, ki: integral_at_rest(np.radians(q_goal), ki)),
    },
)


def closed_loop_acceleration(
    w: ArrayLike,
    error: ArrayLike,
    dq: ArrayLike,
    q_goal: ArrayLike,
    kp: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike,
    alpha: float,
) -> NDArray:
    """Third row of (3.7), mended: the joint accelerations [rad/s^2], shape (4,)."""
    q = q_goal - error
    torque = (kp - ki / alpha) * error - kd * dq + ki / alpha * w
    torque = torque + dynamics.gravity_torque(q_goal) - dynamics.gravity_torque(q)
    torque = torque - dynamics.coriolis_matrix(q, dq) @ dq
    return np.linalg.solve(dynamics.mass_matrix(q), torque)


def _states(rng: np.random.Generator) -> list[tuple]:
    """Random w, error, dq, goal, kp, kd, ki and alpha, 40 times."""
    return [
        (
            *rng.uniform(-0.3, 0.3, (2, 4)),
            rng.uniform(-0.6, 0.6, 4),
            rng.uniform(BACKHOE.lower, BACKHOE.upper),
            rng.uniform(5e5, 3e6, 4),
            rng.uniform(1e5, 1e6, 4),
            rng.uniform(5e4, 5e5, 4),
            float(rng.uniform(0.5, 5.0)),
        )
        for _ in range(40)
    ]


def _accelerate(state: tuple, extra: NDArray) -> NDArray:
    """The right acceleration with an extra torque."""
    _, error, _, q_goal, *_ = state
    push = np.linalg.solve(dynamics.mass_matrix(q_goal - error), extra)
    return closed_loop_acceleration(*state) + push


def _loop_as_printed(*state: object) -> NDArray:
    _, _, dq, _, _, kd, _, _ = state
    return _accelerate(state, 2 * kd * dq)


def _integral_without_alpha(*state: object) -> NDArray:
    w, *_, ki, alpha = state
    return _accelerate(state, (ki - ki / alpha) * w)


def _stiffness_without_alpha(*state: object) -> NDArray:
    _, error, *_, ki, alpha = state
    return _accelerate(state, (ki / alpha - ki) * error)


def _no_alpha_at_all(*state: object) -> NDArray:
    w, error, *_, ki, alpha = state
    return _accelerate(state, (ki - ki / alpha) * (w - error))


def _stiffness_not_lowered(*state: object) -> NDArray:
    _, error, *_, ki, alpha = state
    return _accelerate(state, ki / alpha * error)


def _no_goal_gravity(*state: object) -> NDArray:
    return _accelerate(state, -dynamics.gravity_torque(state[3]))


def _no_coriolis(*state: object) -> NDArray:
    _, error, dq, q_goal, *_ = state
    return _accelerate(state, dynamics.coriolis_matrix(q_goal - error, dq) @ dq)


def _posture_beyond_the_goal(*state: object) -> NDArray:
    w, error, dq, q_goal, kp, kd, ki, alpha = state
    q = q_goal + error
    torque = (kp - ki / alpha) * error - kd * dq + ki / alpha * w
    torque = torque + dynamics.gravity_torque(q_goal) - dynamics.gravity_torque(q)
    torque = torque - dynamics.coriolis_matrix(q, dq) @ dq
    return np.linalg.solve(dynamics.mass_matrix(q), torque)


def _no_inertia(*state: object) -> NDArray:
    _, error, _, q_goal, *_ = state
    return dynamics.mass_matrix(q_goal - error) @ closed_loop_acceleration(*state)


ACCELERATION = Exercise(
    number="3.2",
    title="repair the closed loop",
    reference=closed_loop_acceleration,
    cases=_states,
    rtol=1e-6,
    tested_on="40 random states and gains",
    hints=(
        "the posture is q = q_goal - error, and the goal stands still: what is the error's rate?",
        "K_d acts on the error's rate, which is -dq; the other terms are right as printed",
    ),
    mistakes={
        "that is (3.7) as printed: + K_d dq pushes the arm the way it is moving already": (
            _loop_as_printed
        ),
        (
            "the term with w lacks its 1/alpha: w = alpha z + error, so K_i z = K_i (w - error)/"
            "alpha"
        ): _integral_without_alpha,
        "the bracket is K_p - K_i/alpha: without 1/alpha the units do not even fit": (
            _stiffness_without_alpha
        ),
        "1/alpha is missing in both places where K_i stands": _no_alpha_at_all,
        "w has part of the error in it: K_p alone counts that part twice, take K_p - K_i/alpha": (
            _stiffness_not_lowered
        ),
        "g(q_goal) is missing: z counts the integral from its value at rest, which holds it": (
            _no_goal_gravity
        ),
        "the Coriolis torques C dq are missing: subtract them before you divide by M": (
            _no_coriolis
        ),
        "the posture: error = q_goal - q, so q = q_goal - error": _posture_beyond_the_goal,
        "that is the torque that is left over: solve with M(q) for the acceleration": _no_inertia,
    },
)


def lyapunov_function(
    w: ArrayLike,
    error: ArrayLike,
    dq: ArrayLike,
    q_goal: ArrayLike,
    kp: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike,
    alpha: float,
) -> float:
    """V of (3.8), with dq in its state vector [J]."""
    q, still = q_goal - error, np.zeros(4)
    M = dynamics.mass_matrix(q)
    springs = w @ (ki / alpha * w) + error @ ((kp - ki / alpha) * error)
    moving = dq @ M @ dq - 2 * alpha * error @ M @ dq + alpha * error @ (kd * error)
    lifted = dynamics.energy(q, still)[1] - dynamics.energy(q_goal, still)[1]
    return (springs + moving) / 2 + lifted + error @ dynamics.gravity_torque(q_goal)


def _cross(state: tuple) -> float:
    """alpha error^T M dq."""
    _, error, dq, q_goal, *_, alpha = state
    return alpha * error @ dynamics.mass_matrix(q_goal - error) @ dq


def _lifted(state: tuple) -> float:
    """U(q) - U(q_goal)."""
    _, error, _, q_goal, *_ = state
    still = np.zeros(4)
    return dynamics.energy(q_goal - error, still)[1] - dynamics.energy(q_goal, still)[1]


def _lever(state: tuple) -> float:
    return state[1] @ dynamics.gravity_torque(state[3])


def _potential_counted_from_zero(*state: object) -> float:
    goal = dynamics.energy(state[3], np.zeros(4))[1]
    return lyapunov_function(*state) + goal


def _plain_stiffness(*state: object) -> float:
    _, error, *_, ki, alpha = state
    return lyapunov_function(*state) + error @ (ki / alpha * error) / 2


def _no_damping_term(*state: object) -> float:
    _, error, _, _, _, kd, _, alpha = state
    return lyapunov_function(*state) - alpha * error @ (kd * error) / 2


def _integral_times_alpha(*state: object) -> float:
    w, *_, ki, alpha = state
    return lyapunov_function(*state) + w @ ((alpha - 1 / alpha) * ki * w) / 2


FUNCTION = Exercise(
    number="3.3",
    title="a function that must fall",
    reference=lyapunov_function,
    cases=_states,
    rtol=1e-7,
    atol=1e-3,
    tested_on="40 random states and gains",
    hints=(
        "multiply the block matrix out: one term for w, one with two errors, two with M",
        "the cross term stands twice in the matrix: with the 1/2 in front it is - alpha e^T M dq",
    ),
    mistakes={
        "the cross term: with dq (not the error's rate, as printed) it is - alpha e^T M dq": (
            lambda *state: lyapunov_function(*state) + 2 * _cross(state)
        ),
        "the cross term stands twice in the matrix, above and below the diagonal": (
            lambda *state: lyapunov_function(*state) + _cross(state) / 2
        ),
        "the cross term - alpha e^T M dq is missing: the rest is hardly more than an energy": (
            lambda *state: lyapunov_function(*state) + _cross(state)
        ),
        "the cross term has a factor alpha": (
            lambda *state: lyapunov_function(*state) + (1 - 1 / state[-1]) * _cross(state)
        ),
        "the sign of e^T g(q_goal): it takes the slope of U away, so it is added": (
            lambda *state: lyapunov_function(*state) - 2 * _lever(state)
        ),
        "e^T g(q_goal) is missing: without it V slopes at the goal and has no minimum there": (
            lambda *state: lyapunov_function(*state) - _lever(state)
        ),
        "the potential energy U(q) - U(q_goal) is missing": (
            lambda *state: lyapunov_function(*state) - _lifted(state)
        ),
        "the potential energy is U at the arm's posture less U at the goal, not the reverse": (
            lambda *state: lyapunov_function(*state) - 2 * _lifted(state)
        ),
        "subtract U(q_goal): at the goal, V must be zero": _potential_counted_from_zero,
        "the last bracket is K_p - K_i/alpha: the integral's share is in the term of w already": (
            _plain_stiffness
        ),
        "alpha e^T K_d e is missing: it pays for the cross term": _no_damping_term,
        "the term of w has K_i / alpha, not alpha K_i": _integral_times_alpha,
        "a factor 2: the quadratic forms have a 1/2 in front": (
            lambda *state: (
                2 * (lyapunov_function(*state) - _lifted(state) - _lever(state))
                + _lifted(state)
                + _lever(state)
            )
        ),
    },
)
