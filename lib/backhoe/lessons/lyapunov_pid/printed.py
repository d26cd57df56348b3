"""The thesis's stability analysis where its print is wrong: (3.5) to (3.34), (A.8). Not for use.

The appendix of lesson 03 tries each on random states; `backhoe.arm.lyapunov` has what holds.
`constants` are those of `lyapunov.constants`, or the printed numbers put in their place.

Reference: Mastalli 2013, sections 3.1, 3.2, 3.4.1 and Appendix A.1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.dynamics import coriolis_matrix, gravity_torque, mass_matrix
from backhoe.arm.kinematics import joint_vector
from backhoe.arm.lyapunov import Constants, State, function
from backhoe.arm.lyapunov.candidate import checked_state
from backhoe.arm.lyapunov.conditions import highest, lowest
from backhoe.arm.lyapunov.gains import gain_matrices, gain_matrix
from backhoe.arm.pid import Gains
from backhoe.basics.inputs import positive
from backhoe.machine import BACKHOE, Machine

__all__ = [
    "alpha_high_317",
    "alpha_limits_323",
    "bound_324",
    "closed_loop_rate_35",
    "closed_loop_rate_37",
    "coriolis_bound_a8",
    "function_38",
    "kd_bound_334",
    "kp_condition_312",
    "term_310",
    "weight_322",
    "within_324",
]


def closed_loop_rate_35(
    z: ArrayLike,
    error: ArrayLike,
    dq: ArrayLike,
    goal: ArrayLike,
    gains: Gains,
    *,
    machine: Machine = BACKHOE,
) -> tuple[NDArray, NDArray, NDArray]:
    """Rate of (z, q~, dq) as printed in (3.5), with + K_d dq: the derivative action pushes.

    Args:
        z, error, dq: state, shape (..., 4) each [rad s, rad, rad/s].
        goal: where the joints should be, shape (..., 4) [rad].
        gains: each (4,) or symmetric (4, 4) [N m/rad, N m/(rad s), N m s/rad].

    Returns:
        dz/dt [rad], dq~/dt [rad/s], ddq [rad/s^2], shape (..., 4) each.

    Raises:
        ValueError: the last axis is not 4, a value is not finite, a gain is not positive definite.
        TypeError: gains are no Gains.
    """
    Kp, Ki, Kd = gain_matrices(gains)
    z, error, dq, goal = checked_state(State(z, error, dq, goal))
    torque = error @ Kp + dq @ Kd + z @ Ki
    return error, -dq, _acceleration(torque, error, dq, goal, machine)


def closed_loop_rate_37(
    state: State, gains: Gains, alpha: float, *, machine: Machine = BACKHOE
) -> tuple[NDArray, NDArray, NDArray]:
    """Rate of (w, q~, dq) as printed in (3.7), with + K_d dq.

    Args:
        state: w, error, dq and goal, shape (..., 4) each [rad, rad, rad/s, rad].
        gains: as for `closed_loop_rate_35`.
        alpha: number of the analysis [1/s].

    Returns:
        dw/dt [rad/s], dq~/dt [rad/s], ddq [rad/s^2], shape (..., 4) each.

    Raises:
        ValueError, TypeError: as for `lyapunov.closed_loop_rate`.
    """
    (w, error, dq, goal), (Kp, Ki, Kd) = checked_state(state), gain_matrices(gains)
    alpha = positive(alpha, "alpha", "1/s")
    torque = error @ (Kp - Ki / alpha) + dq @ Kd + w @ Ki / alpha
    return alpha * error - dq, -dq, _acceleration(torque, error, dq, goal, machine)


def function_38(state: State, gains: Gains, alpha: float, *, machine: Machine = BACKHOE) -> NDArray:
    """V with the state vector printed in (3.8), which ends in dq~/dt = -dq; (3.14) has dq.

    Args:
        state, gains, alpha: as for `closed_loop_rate_37`.

    Returns:
        Shape (...) [J].

    Raises:
        ValueError, TypeError: as for `lyapunov.function`.
    """
    state = checked_state(state)
    return function(state._replace(dq=-state.dq), gains, alpha, machine=machine)


def term_310(
    error: ArrayLike, goal: ArrayLike, gains: Gains, alpha: float, *, machine: Machine = BACKHOE
) -> NDArray:
    """(3.10): said to be (3.9), it adds two vectors of torques to an energy.

    Args:
        error, goal: shape (..., 4) each [rad].
        gains, alpha: as for `closed_loop_rate_37`.

    Returns:
        The sum taken as written, the energy added to every component, shape (..., 4) [J and N m].

    Raises:
        ValueError, TypeError: as for `closed_loop_rate_35`.
    """
    error, goal = joint_vector(error, "error"), joint_vector(goal, "goal")
    Kp, Ki, _ = gain_matrices(gains)
    stiffness = Kp - Ki / positive(alpha, "alpha", "1/s")
    energy = (error * (error @ stiffness)).sum(axis=-1, keepdims=True) / 2
    return energy + gravity_torque(goal - error, machine) + gravity_torque(goal, machine)


def kp_condition_312(kp: ArrayLike, ki: ArrayLike, constants: Constants) -> bool:
    """The rewriting of (3.12), lambda_min(K_p) - lambda_max(K_i) > k_g: 1/alpha is lost.

    Args:
        kp, ki: gains, shape (4,) or (4, 4) [N m/rad, N m/(rad s)]; the printed difference mixes
            their units.

    Raises:
        ValueError: a gain is not positive definite.
    """
    return _lowest(kp, "K_p") - _highest(ki, "K_i") > constants.kg


def alpha_high_317(kd: ArrayLike, constants: Constants) -> float:
    """(3.17): alpha < lambda_min(M) lambda_min(K_d) / lambda_max(M)^2. Sufficient for V > 0.

    Args:
        kd: gain, shape (4,) or (4, 4) [N m s/rad].

    Returns:
        The bound [1/s].

    Raises:
        ValueError: the gain is not positive definite.
    """
    return constants.lambda_min * _lowest(kd, "K_d") / constants.lambda_max**2


def weight_322(state: State, gains: Gains, alpha: float, constants: Constants) -> NDArray:
    """W22 as printed in (3.22), with ||dq||: it adds kg m^2/s to kg m^2.

    Args:
        state, gains, alpha: as for `closed_loop_rate_37`.

    Returns:
        Shape (...).

    Raises:
        ValueError, TypeError: as for `closed_loop_rate_35`.
    """
    inertia = constants.lambda_max + constants.kc1 * _speed(state)
    return lowest(gain_matrices(gains).kd) - positive(alpha, "alpha", "1/s") * inertia


def alpha_limits_323(state: State, gains: Gains, constants: Constants) -> tuple[float, NDArray]:
    """(3.23): the second line with K_p, which (3.22) has as K_d, and with ||dq||.

    Args:
        state, gains: as for `closed_loop_rate_37`.

    Returns:
        What alpha must be above [1/s] and, shape (...), below [1/s^2 by its units].

    Raises:
        ValueError, TypeError: as for `closed_loop_rate_35`.
    """
    Kp, Ki, _ = gain_matrices(gains)
    low = highest(Ki) / (lowest(Kp) - constants.kg)
    return low, lowest(Kp) / (constants.lambda_max + constants.kc1 * _speed(state))


def bound_324(gains: Gains, constants: Constants) -> float:
    """Right side of (3.24) = (3.29): kg m^2 over kg m^2, so [rad], printed as a bound in rad/s.

    Args:
        gains: as for `closed_loop_rate_35`.

    Raises:
        ValueError, TypeError: as for `closed_loop_rate_35`.
    """
    Kp, Ki, Kd = gain_matrices(gains)
    stiff = lowest(Kp) - constants.kg
    return (lowest(Kd) * stiff / highest(Ki) - constants.lambda_max) / constants.kc1


def within_324(state: State, gains: Gains, constants: Constants) -> NDArray:
    """Whether ||dq|| obeys (3.24), which holds of ||q~||.

    Args:
        state, gains: as for `closed_loop_rate_37`.

    Returns:
        Truth values, shape (...).

    Raises:
        ValueError, TypeError: as for `closed_loop_rate_35`.
    """
    return _speed(state) < bound_324(gains, constants)


def kd_bound_334(kp: ArrayLike, ki: ArrayLike, constants: Constants) -> float:
    """Third line of (3.30), which gave the 280007 of (3.34): lambda_min(K_d) must be above this.

    Right as a formula; the constants that the thesis puts in are not those of its arm.

    Args:
        kp, ki: gains, shape (4,) or (4, 4) [N m/rad, N m/(rad s)].

    Returns:
        Bound on lambda_min(K_d) [N m s/rad].

    Raises:
        ValueError: a gain is not positive definite.
    """
    left = _lowest(kp, "K_p") - constants.kg
    return _highest(ki, "K_i") / left * constants.ratio


def coriolis_bound_a8(
    q: ArrayLike, x: ArrayLike, y: ArrayLike, constants: Constants, *, machine: Machine = BACKHOE
) -> NDArray:
    """(A.8) as printed: ||C(q, x) y|| >= k_C1 ||x|| ||y||.

    Args:
        q: postures, x, y: vectors, shape (..., 4) each.

    Returns:
        Where the printed relation holds, shape (...).

    Raises:
        ValueError: as for `closed_loop_rate_35`.
    """
    x, y = joint_vector(x, "x"), joint_vector(y, "y")
    turned = (coriolis_matrix(q, x, machine) @ y[..., None])[..., 0]
    sizes = np.linalg.norm(x, axis=-1) * np.linalg.norm(y, axis=-1)
    return np.linalg.norm(turned, axis=-1) >= constants.kc1 * sizes


def _speed(state: State) -> NDArray:
    return np.linalg.norm(checked_state(state).dq, axis=-1)


def _acceleration(
    torque: NDArray, error: NDArray, dq: NDArray, goal: NDArray, machine: Machine
) -> NDArray:
    q = goal - error
    turned = (coriolis_matrix(q, dq, machine) @ dq[..., None])[..., 0]
    force = torque + gravity_torque(goal, machine) - turned - gravity_torque(q, machine)
    return np.linalg.solve(mass_matrix(q, machine), force[..., None])[..., 0]


def _lowest(gain: ArrayLike, name: str) -> float:
    return lowest(gain_matrix(gain, name))


def _highest(gain: ArrayLike, name: str) -> float:
    return highest(gain_matrix(gain, name))
