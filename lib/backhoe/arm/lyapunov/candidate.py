"""The closed loop of arm and PID, Kelly's function V of its state, and how V changes.

State: w = alpha z + q~ [rad], the error q~ = q_desired - q [rad] and the joint speeds dq [rad/s],
with z the integral of q~ less its value at rest and alpha > 0 [1/s] a number of the analysis alone:
the controller does not know it. The goal q_desired stands still; no friction, no torque limit.

Source: Mastalli 2013, section 3.1, after Kelly 1995. Printed (3.5) and (3.7) have + K_d dq, which
drives the arm; here it is - K_d dq, which follows from dq~/dt = -dq and is what (3.18) needs.
"""

from __future__ import annotations

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
from backhoe.arm.lyapunov.gains import gain_matrix, positive
from backhoe.machine import BACKHOE, Machine


def closed_loop_state(
    q: ArrayLike,
    dq: ArrayLike,
    integral: ArrayLike,
    q_desired: ArrayLike,
    ki: ArrayLike,
    alpha: float,
    *,
    machine: Machine = BACKHOE,
) -> tuple[NDArray, NDArray, NDArray]:
    """The state (w, q~, dq) of the analysis from what the controller knows.

    Source: Mastalli 2013, (3.3) and (3.6), with z = integral - K_i^-1 g(q_desired).

    Args:
        q, dq: joint angles and speeds, shape (..., 4) [rad, rad/s].
        integral: the controller's integral of the error, shape (..., 4) [rad s].
        q_desired: the goal, shape (..., 4) [rad].
        ki: integral gain, (4,) or symmetric (4, 4) [N m/(rad s)].
        alpha: number of the analysis [1/s].

    Returns:
        w [rad], error [rad] and dq [rad/s], shape (..., 4) each; all are zero at rest in the goal.

    Raises:
        ValueError: shapes do not fit, a value is not finite, K_i is not positive definite.
    """
    q, dq, q_desired = joint_vector(q), joint_vector(dq, "dq"), joint_vector(q_desired, "q_desired")
    integral = joint_vector(integral, "integral")
    lead = leading_shape(q, dq, integral, q_desired)
    alpha, Ki = positive(alpha, "alpha", "1/s"), gain_matrix(ki, "K_i")
    error = q_desired - q
    z = integral - np.linalg.solve(Ki, gravity_torque(q_desired, machine)[..., None])[..., 0]
    return tuple(np.broadcast_to(x, (*lead, 4)).copy() for x in (alpha * z + error, error, dq))


def closed_loop_rate(
    w: ArrayLike,
    error: ArrayLike,
    dq: ArrayLike,
    q_desired: ArrayLike,
    kp: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike,
    alpha: float,
    *,
    machine: Machine = BACKHOE,
) -> tuple[NDArray, NDArray, NDArray]:
    """Time derivatives of w, q~ and dq under the PID.

    Source: Mastalli 2013, (3.7) with - K_d dq.

    Args:
        w, error, dq: state, shape (..., 4) each [rad, rad, rad/s].
        q_desired: the goal, shape (..., 4) [rad].
        kp, kd, ki: gains, (4,) or symmetric (4, 4) [N m/rad, N m s/rad, N m/(rad s)].
        alpha: number of the analysis [1/s].

    Returns:
        dw/dt [rad/s], dq~/dt [rad/s] and ddq [rad/s^2], shape (..., 4) each.

    Raises:
        ValueError: shapes do not fit, a value is not finite, a gain is not positive definite.
    """
    w, error, dq, q_desired = _state(w, error, dq, q_desired)
    Kp, Kd, Ki = gain_matrix(kp, "K_p"), gain_matrix(kd, "K_d"), gain_matrix(ki, "K_i")
    alpha = positive(alpha, "alpha", "1/s")
    goal = gravity_torque(q_desired, machine)
    tau = error @ (Kp - Ki / alpha) - dq @ Kd + w @ Ki / alpha + goal
    ddq = forward_dynamics(q_desired - error, dq, tau, machine=machine)
    return alpha * error - dq, -dq, ddq


def function(
    w: ArrayLike,
    error: ArrayLike,
    dq: ArrayLike,
    q_desired: ArrayLike,
    kp: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike,
    alpha: float,
    *,
    machine: Machine = BACKHOE,
) -> NDArray:
    """Kelly's Lyapunov function V of the closed loop.

    Source: Mastalli 2013, (3.8).

    Args:
        w, error, dq: state, shape (..., 4) each [rad, rad, rad/s].
        q_desired: the goal, shape (..., 4) [rad].
        kp, kd, ki: gains, (4,) or symmetric (4, 4) [N m/rad, N m s/rad, N m/(rad s)].
        alpha: number of the analysis [1/s].

    Returns:
        V, shape (...) [J]; zero at rest in the goal.

    Raises:
        ValueError: shapes do not fit, a value is not finite, a gain is not positive definite.
    """
    w, error, dq, q_desired = _state(w, error, dq, q_desired)
    Kp, Kd, Ki = gain_matrix(kp, "K_p"), gain_matrix(kd, "K_d"), gain_matrix(ki, "K_i")
    alpha = positive(alpha, "alpha", "1/s")
    moving = quadratic(w, error, dq, mass_matrix(q_desired - error, machine), Kd, Ki, alpha)
    return moving + potential_term(error, q_desired, Kp - Ki / alpha, machine)


def derivative(
    error: ArrayLike,
    dq: ArrayLike,
    q_desired: ArrayLike,
    kp: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike,
    alpha: float,
    *,
    machine: Machine = BACKHOE,
) -> NDArray:
    """How fast V changes along the motion of the closed loop.

    Source: Mastalli 2013, (3.18). The integral does not appear in it: w has no part in the decay.

    Args:
        error, dq: state, shape (..., 4) each [rad, rad/s].
        q_desired: the goal, shape (..., 4) [rad].
        kp, kd, ki, alpha: as for `function`.

    Returns:
        dV/dt, shape (...) [W].

    Raises:
        ValueError: as for `function`.
    """
    terms = derivative_terms(error, dq, q_desired, kp, kd, ki, alpha, machine=machine)
    return terms.sum(axis=-1)


def derivative_terms(
    error: ArrayLike,
    dq: ArrayLike,
    q_desired: ArrayLike,
    kp: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike,
    alpha: float,
    *,
    machine: Machine = BACKHOE,
) -> NDArray:
    """The four terms of dV/dt: damping, stiffness, Coriolis and gravity.

    Source: Mastalli 2013, (3.18), in the order printed; `inequalities` bounds each (3.19).

    Args:
        error, dq, q_desired, kp, kd, ki, alpha: as for `derivative`.

    Returns:
        Terms whose sum is dV/dt, shape (..., 4) [W].

    Raises:
        ValueError: as for `function`.
    """
    _, error, dq, q_desired = _state(error, error, dq, q_desired)
    Kp, Kd, Ki = gain_matrix(kp, "K_p"), gain_matrix(kd, "K_d"), gain_matrix(ki, "K_i")
    alpha, q = positive(alpha, "alpha", "1/s"), q_desired - error
    C_T = np.swapaxes(coriolis_matrix(q, dq, machine), -1, -2)
    gravity = gravity_torque(q_desired, machine) - gravity_torque(q, machine)
    return np.stack(
        [
            -form(dq, Kd - alpha * mass_matrix(q, machine), dq),
            -form(error, alpha * Kp - Ki, error),
            -alpha * form(error, C_T, dq),
            -alpha * (error * gravity).sum(axis=-1),
        ],
        axis=-1,
    )


def quadratic(
    w: NDArray, error: NDArray, dq: NDArray, M: NDArray, Kd: NDArray, Ki: NDArray, alpha: float
) -> NDArray:
    """The quadratic form of (3.8), half its matrix times the state twice [J]."""
    return (
        form(w, Ki, w) / alpha
        + alpha * form(error, Kd, error)
        - 2 * alpha * form(error, M, dq)
        + form(dq, M, dq)
    ) / 2


def potential_term(
    error: NDArray, q_desired: NDArray, stiffness: NDArray, machine: Machine
) -> NDArray:
    """The part (3.9) of V, with stiffness = K_p - K_i/alpha [J]."""
    still = np.zeros(4)
    _, here = energy(q_desired - error, still, machine)
    _, goal = energy(q_desired, still, machine)
    lever = (error * gravity_torque(q_desired, machine)).sum(axis=-1)
    return form(error, stiffness, error) / 2 + here - goal + lever


def form(x: NDArray, A: NDArray, y: NDArray) -> NDArray:
    """x^T A y over leading axes."""
    return (x * (A @ y[..., None])[..., 0]).sum(axis=-1)


def _state(
    w: ArrayLike, error: ArrayLike, dq: ArrayLike, q_desired: ArrayLike
) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """The four vectors with common leading axes."""
    vectors = (
        joint_vector(w, "w"),
        joint_vector(error, "error"),
        joint_vector(dq, "dq"),
        joint_vector(q_desired, "q_desired"),
    )
    lead = leading_shape(*vectors)
    return tuple(np.broadcast_to(vector, (*lead, 4)) for vector in vectors)
