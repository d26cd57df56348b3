"""The closed loop of arm and PID, Kelly's function V of its state, and how V changes.

State: w = alpha z + q~ [rad], the error q~ = goal - q [rad] and the joint speeds dq [rad/s], with z
the integral of q~ less its value at rest and alpha > 0 [1/s] a number of the analysis alone: the
controller does not know it. The goal stands still; no friction, no torque limit.

Source: Mastalli 2013, section 3.1, after Kelly 1995. Printed (3.5) and (3.7) have + K_d dq, which
drives the arm; here it is - K_d dq, which follows from dq~/dt = -dq and is what (3.18) needs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.dynamics import (
    coriolis_matrix,
    energy,
    forward_dynamics,
    gravity_torque,
    mass_matrix,
)
from backhoe.arm.kinematics import joint_vector
from backhoe.arm.kinematics.forward import leading_shape
from backhoe.arm.lyapunov.gains import gain_matrices
from backhoe.arm.pid import Gains
from backhoe.basics.inputs import instance, positive
from backhoe.machine import BACKHOE, Machine


class State(NamedTuple):
    """A state of the analysis and its goal, shape (..., 4) each.

    `w` [rad], the `error` q~ [rad], the joint speeds `dq` [rad/s], and the `goal` [rad].
    """

    w: NDArray
    error: NDArray
    dq: NDArray
    goal: NDArray


def closed_loop_state(
    q: ArrayLike,
    dq: ArrayLike,
    integral: ArrayLike,
    goal: ArrayLike,
    gains: Gains,
    alpha: float,
    *,
    machine: Machine = BACKHOE,
) -> State:
    """The state of the analysis from what the controller knows; zero at rest in the goal.

    Source: Mastalli 2013, (3.3) and (3.6), with z = integral - K_i^-1 g(goal).

    Args:
        q, dq: joint angles and speeds, shape (..., 4) [rad, rad/s].
        integral: the controller's integral of the error, shape (..., 4) [rad s].
        goal: where the joints should be, shape (..., 4) [rad].
        gains: each (4,) or symmetric (4, 4) [N m/rad, N m/(rad s), N m s/rad].
        alpha: number of the analysis [1/s].

    Raises:
        ValueError: shapes do not fit, a value is not finite, a gain is not positive definite.
    """
    q, integral, goal = (
        joint_vector(q),
        joint_vector(integral, "integral"),
        joint_vector(goal, "goal"),
    )
    alpha, Ki = positive(alpha, "alpha", "1/s"), gain_matrices(gains).ki
    leading_shape(q, integral, goal)
    z = integral - np.linalg.solve(Ki, gravity_torque(goal, machine)[..., None])[..., 0]
    return State(*map(np.array, checked_state(State(alpha * z + goal - q, goal - q, dq, goal))))


def closed_loop_rate(
    state: State, gains: Gains, alpha: float, *, machine: Machine = BACKHOE
) -> tuple[NDArray, NDArray, NDArray]:
    """Time derivatives of w, q~ and dq under the PID.

    Source: Mastalli 2013, (3.7) with - K_d dq.

    Args:
        state: w, error, dq and goal, shape (..., 4) each [rad, rad, rad/s, rad].
        gains: each (4,) or symmetric (4, 4) [N m/rad, N m/(rad s), N m s/rad].
        alpha: number of the analysis [1/s].

    Returns:
        dw/dt [rad/s], dq~/dt [rad/s] and ddq [rad/s^2], shape (..., 4) each.

    Raises:
        ValueError: shapes do not fit, a value is not finite, a gain is not positive definite.
        TypeError: state is no State, or gains are no Gains.
    """
    (w, error, dq, goal), (Kp, Ki, Kd) = checked_state(state), gain_matrices(gains)
    alpha = positive(alpha, "alpha", "1/s")
    tau = error @ (Kp - Ki / alpha) - dq @ Kd + w @ Ki / alpha + gravity_torque(goal, machine)
    return alpha * error - dq, -dq, forward_dynamics(goal - error, dq, tau, machine=machine)


def function(state: State, gains: Gains, alpha: float, *, machine: Machine = BACKHOE) -> NDArray:
    """Kelly's Lyapunov function V of the closed loop.

    Source: Mastalli 2013, (3.8).

    Args:
        state, gains, alpha: as for `closed_loop_rate`.

    Returns:
        V, shape (...) [J]; zero at rest in the goal.

    Raises:
        ValueError, TypeError: as for `closed_loop_rate`.
    """
    state, (Kp, Ki, Kd) = checked_state(state), gain_matrices(gains)
    alpha = positive(alpha, "alpha", "1/s")
    _, error, _, goal = state
    M = mass_matrix(goal - error, machine)
    return quadratic(state, M, Kd, Ki, alpha) + potential_term(
        error, goal, Kp - Ki / alpha, machine
    )


def derivative(state: State, gains: Gains, alpha: float, *, machine: Machine = BACKHOE) -> NDArray:
    """How fast V changes along the motion of the closed loop.

    Source: Mastalli 2013, (3.18). The integral does not appear in it: w has no part in the decay.

    Args:
        state, gains, alpha: as for `closed_loop_rate`.

    Returns:
        dV/dt, shape (...) [W].

    Raises:
        ValueError, TypeError: as for `closed_loop_rate`.
    """
    return derivative_terms(state, gains, alpha, machine=machine).sum(axis=-1)


def derivative_terms(
    state: State, gains: Gains, alpha: float, *, machine: Machine = BACKHOE
) -> NDArray:
    """The four terms of dV/dt: damping, stiffness, Coriolis and gravity.

    Source: Mastalli 2013, (3.18), in the order printed; (3.19) bounds each.

    Args:
        state, gains, alpha: as for `closed_loop_rate`.

    Returns:
        Terms whose sum is dV/dt, shape (..., 4) [W].

    Raises:
        ValueError, TypeError: as for `closed_loop_rate`.
    """
    (_, error, dq, goal), (Kp, Ki, Kd) = checked_state(state), gain_matrices(gains)
    alpha, q = positive(alpha, "alpha", "1/s"), goal - error
    C_T = np.swapaxes(coriolis_matrix(q, dq, machine), -1, -2)
    gravity = gravity_torque(goal, machine) - gravity_torque(q, machine)
    return np.stack(
        [
            -form(dq, Kd - alpha * mass_matrix(q, machine), dq),
            -form(error, alpha * Kp - Ki, error),
            -alpha * form(error, C_T, dq),
            -alpha * (error * gravity).sum(axis=-1),
        ],
        axis=-1,
    )


def checked_state(state: State) -> State:
    """The state as arrays with common leading axes, shape (..., 4) each [its own units].

    Raises:
        ValueError: a part does not end in 4 joints or is not finite; leading axes do not fit.
        TypeError: it is no State.
    """
    instance(state, "state", State, "give lyapunov.State(w, error, dq, goal)")
    parts = [joint_vector(part, name) for name, part in state._asdict().items()]
    lead = leading_shape(*parts)
    return State(*(np.broadcast_to(part, (*lead, 4)) for part in parts))


def quadratic(state: State, M: NDArray, Kd: NDArray, Ki: NDArray, alpha: float) -> NDArray:
    """The quadratic form of (3.8), half its matrix times the state twice [J]."""
    w, error, dq, _ = state
    return (
        form(w, Ki, w) / alpha
        + alpha * form(error, Kd, error)
        - 2 * alpha * form(error, M, dq)
        + form(dq, M, dq)
    ) / 2


def potential_term(error: NDArray, goal: NDArray, stiffness: NDArray, machine: Machine) -> NDArray:
    """The part (3.9) of V, with stiffness = K_p - K_i/alpha [J]."""
    still = np.zeros(4)
    _, here = energy(goal - error, still, machine)
    _, there = energy(goal, still, machine)
    lever = (error * gravity_torque(goal, machine)).sum(axis=-1)
    return form(error, stiffness, error) / 2 + here - there + lever


def form(x: NDArray, A: NDArray, y: NDArray) -> NDArray:
    """x^T A y over leading axes."""
    return (x * (A @ y[..., None])[..., 0]).sum(axis=-1)
