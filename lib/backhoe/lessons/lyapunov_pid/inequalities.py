"""The bounds on V and on dV/dt, to be tried on states: each right side beside its left side.

States, gains and alpha are those of `lyapunov.function`; the constants are those of the arm, over
postures that hold q, the goal and what lies between.

Source: Mastalli 2013, (3.14) to (3.16) and (3.19) to (3.22). Printed (3.22) has ||dq|| where the
Coriolis term of (3.19) gives ||q~||; here it is ||q~||.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.dynamics import mass_matrix
from backhoe.arm.kinematics import joint_vector
from backhoe.arm.lyapunov import Constants, State
from backhoe.arm.lyapunov.candidate import checked_state, form, quadratic
from backhoe.arm.lyapunov.conditions import highest, lowest
from backhoe.arm.lyapunov.gains import gain_matrices
from backhoe.arm.pid import Gains
from backhoe.basics.inputs import positive
from backhoe.machine import BACKHOE, Machine

__all__ = [
    "derivative_bound",
    "derivative_term_bounds",
    "lower_bound",
    "quadratic_part",
    "quadratic_term_bounds",
    "quadratic_terms",
    "rate_weights",
]


def quadratic_part(
    state: State, gains: Gains, alpha: float, *, machine: Machine = BACKHOE
) -> NDArray:
    """What V is at least when K_p - K_i/alpha outweighs k_g: V without its part (3.9).

    Source: Mastalli 2013, right side of (3.14).

    Args:
        state: w, error, dq and goal, shape (..., 4) each [rad, rad, rad/s, rad].
        gains: each (4,) or symmetric (4, 4) [N m/rad, N m/(rad s), N m s/rad].
        alpha: number of the analysis [1/s].

    Returns:
        Shape (...) [J].

    Raises:
        ValueError: shapes do not fit, a value is not finite, a gain is not positive definite.
        TypeError: state is no State, or gains are no Gains.
    """
    state, (_, Ki, Kd) = checked_state(state), gain_matrices(gains)
    M = mass_matrix(state.goal - state.error, machine)
    return quadratic(state, M, Kd, Ki, positive(alpha, "alpha", "1/s"))


def quadratic_terms(
    state: State, gains: Gains, alpha: float, *, machine: Machine = BACKHOE
) -> NDArray:
    """The four terms of the quadratic form: of w, of q~, of dq, and the mixed one.

    Source: Mastalli 2013, left sides of (3.15); `quadratic_part` is half of their sum, the mixed
    term counted twice.

    Returns:
        Shape (..., 4) [J]; arguments and errors as for `quadratic_part`.
    """
    (w, error, dq, goal), (_, Ki, Kd) = checked_state(state), gain_matrices(gains)
    M, alpha = mass_matrix(goal - error, machine), positive(alpha, "alpha", "1/s")
    terms = (
        form(w, Ki, w) / alpha,
        alpha * form(error, Kd, error),
        form(dq, M, dq),
        -alpha * form(error, M, dq),
    )
    return np.stack(terms, axis=-1)


def quadratic_term_bounds(
    state: State, gains: Gains, alpha: float, constants: Constants
) -> NDArray:
    """What the four terms of `quadratic_terms` are at least.

    Source: Mastalli 2013, right sides of (3.15).

    Returns:
        Shape (..., 4) [J]; arguments and errors as for `quadratic_part`.
    """
    (w, error, speed), gains = _sizes(state), gain_matrices(gains)
    alpha = positive(alpha, "alpha", "1/s")
    return np.stack(
        [
            lowest(gains.ki) * w**2 / alpha,
            alpha * lowest(gains.kd) * error**2,
            constants.lambda_min * speed**2,
            -alpha * constants.lambda_max * error * speed,
        ],
        axis=-1,
    )


def lower_bound(state: State, gains: Gains, alpha: float, constants: Constants) -> NDArray:
    """What V is at least, from the lengths of w, q~ and dq alone.

    Source: Mastalli 2013, (3.16).

    Returns:
        Shape (...) [J]; arguments and errors as for `quadratic_part`.
    """
    bounds = quadratic_term_bounds(state, gains, alpha, constants)
    return (bounds.sum(axis=-1) + bounds[..., 3]) / 2


def derivative_term_bounds(
    state: State, gains: Gains, alpha: float, constants: Constants
) -> NDArray:
    """What the four terms of dV/dt are at most.

    Source: Mastalli 2013, right sides of (3.19).

    Returns:
        Shape (..., 4) [W], in the order of `derivative_terms`; arguments and errors as for
        `quadratic_part`.
    """
    (_, error, speed), gains = _sizes(state), gain_matrices(gains)
    alpha = positive(alpha, "alpha", "1/s")
    return np.stack(
        [
            -(lowest(gains.kd) - alpha * constants.lambda_max) * speed**2,
            -(alpha * lowest(gains.kp) - highest(gains.ki)) * error**2,
            alpha * constants.kc1 * error * speed**2,
            alpha * constants.kg * error**2,
        ],
        axis=-1,
    )


def rate_weights(
    error: ArrayLike, gains: Gains, alpha: float, constants: Constants
) -> tuple[float, NDArray]:
    """W11 and W22, with dV/dt <= -W11 ||q~||^2 - W22 ||dq||^2.

    Source: Mastalli 2013, (3.21) and (3.22), with ||q~|| for the printed ||dq|| in W22.

    Args:
        error: shape (..., 4) [rad]; the others as for `quadratic_part`.

    Returns:
        W11 [N m/(rad s)] and W22, shape (...) [N m s/rad].

    Raises:
        ValueError, TypeError: as for `quadratic_part`.
    """
    gains, alpha = gain_matrices(gains), positive(alpha, "alpha", "1/s")
    W11 = alpha * (lowest(gains.kp) - constants.kg) - highest(gains.ki)
    size = np.linalg.norm(joint_vector(error, "error"), axis=-1)
    return W11, lowest(gains.kd) - alpha * (constants.lambda_max + constants.kc1 * size)


def derivative_bound(state: State, gains: Gains, alpha: float, constants: Constants) -> NDArray:
    """What dV/dt is at most.

    Source: Mastalli 2013, (3.20), with W22 corrected.

    Returns:
        Shape (...) [W]; arguments and errors as for `quadratic_part`.
    """
    _, error, speed = _sizes(state)
    W11, W22 = rate_weights(state.error, gains, alpha, constants)
    return -W11 * error**2 - W22 * speed**2


def _sizes(state: State) -> tuple[NDArray, NDArray, NDArray]:
    """||w||, ||q~|| and ||dq||."""
    w, error, dq, _ = checked_state(state)
    return tuple(np.linalg.norm(part, axis=-1) for part in (w, error, dq))
