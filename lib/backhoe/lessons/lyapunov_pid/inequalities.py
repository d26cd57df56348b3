"""The bounds on V and on dV/dt, to be tried on states: each right side beside its left side.

Source: Mastalli 2013, (3.14) to (3.16) and (3.19) to (3.22). Printed (3.22) has ||dq|| where the
Coriolis term of (3.19) gives ||q~||; here it is ||q~||.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.dynamics import mass_matrix
from backhoe.arm.kinematics import joint_vector
from backhoe.arm.kinematics.forward import leading_shape
from backhoe.arm.lyapunov.candidate import form, quadratic
from backhoe.arm.lyapunov.extremes import Constants
from backhoe.arm.lyapunov.gains import gain_matrix, positive
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
    w: ArrayLike,
    error: ArrayLike,
    dq: ArrayLike,
    q_desired: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike,
    alpha: float,
    *,
    machine: Machine = BACKHOE,
) -> NDArray:
    """What V is at least when K_p - K_i/alpha outweighs k_g: V without its part (3.9).

    Source: Mastalli 2013, right side of (3.14).

    Args:
        w, error, dq: state, shape (..., 4) each [rad, rad, rad/s].
        q_desired: the goal, shape (..., 4) [rad].
        kd, ki: gains, (4,) or symmetric (4, 4) [N m s/rad, N m/(rad s)].
        alpha: number of the analysis [1/s].

    Returns:
        Shape (...) [J].

    Raises:
        ValueError: shapes do not fit, a value is not finite, a gain is not positive definite.
    """
    w, error, dq = joint_vector(w, "w"), joint_vector(error, "error"), joint_vector(dq, "dq")
    q_desired = joint_vector(q_desired, "q_desired")
    leading_shape(w, error, dq, q_desired)
    M = mass_matrix(q_desired - error, machine)
    Kd, Ki = gain_matrix(kd, "K_d"), gain_matrix(ki, "K_i")
    return quadratic(w, error, dq, M, Kd, Ki, positive(alpha, "alpha", "1/s"))


def quadratic_terms(
    w: ArrayLike,
    error: ArrayLike,
    dq: ArrayLike,
    q_desired: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike,
    alpha: float,
    *,
    machine: Machine = BACKHOE,
) -> NDArray:
    """The four terms of the quadratic form: of w, of q~, of dq, and the mixed one.

    Source: Mastalli 2013, left sides of (3.15); `quadratic_part` is half of their sum, the mixed
    term counted twice.

    Args:
        w, error, dq, q_desired, kd, ki, alpha: as for `quadratic_part`.

    Returns:
        Shape (..., 4) [J].

    Raises:
        ValueError: as for `quadratic_part`.
    """
    w, error, dq = joint_vector(w, "w"), joint_vector(error, "error"), joint_vector(dq, "dq")
    q_desired = joint_vector(q_desired, "q_desired")
    lead = leading_shape(w, error, dq, q_desired)
    M = mass_matrix(q_desired - error, machine)
    Kd, Ki = gain_matrix(kd, "K_d"), gain_matrix(ki, "K_i")
    alpha = positive(alpha, "alpha", "1/s")
    terms = (
        form(w, Ki, w) / alpha,
        alpha * form(error, Kd, error),
        form(dq, M, dq),
        -alpha * form(error, M, dq),
    )
    return np.stack([np.broadcast_to(term, lead) for term in terms], axis=-1)


def quadratic_term_bounds(
    w: ArrayLike,
    error: ArrayLike,
    dq: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike,
    alpha: float,
    constants: Constants,
) -> NDArray:
    """What the four terms of `quadratic_terms` are at least.

    Source: Mastalli 2013, right sides of (3.15).

    Args:
        w, error, dq: state, shape (..., 4) each [rad, rad, rad/s].
        kd, ki, alpha: as for `quadratic_part`.
        constants: of the arm, over postures that hold q.

    Returns:
        Shape (..., 4) [J].

    Raises:
        ValueError: as for `quadratic_part`.
    """
    sizes = _size(w, "w"), _size(error, "error"), _size(dq, "dq")
    w_size, error_size, speed = np.broadcast_arrays(*sizes)
    alpha = positive(alpha, "alpha", "1/s")
    return np.stack(
        [
            _lowest(ki, "K_i") * w_size**2 / alpha,
            alpha * _lowest(kd, "K_d") * error_size**2,
            constants.lambda_min * speed**2,
            -alpha * constants.lambda_max * error_size * speed,
        ],
        axis=-1,
    )


def lower_bound(
    w: ArrayLike,
    error: ArrayLike,
    dq: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike,
    alpha: float,
    constants: Constants,
) -> NDArray:
    """What V is at least, from the lengths of w, q~ and dq alone.

    Source: Mastalli 2013, (3.16).

    Args:
        w, error, dq, kd, ki, alpha, constants: as for `quadratic_term_bounds`.

    Returns:
        Shape (...) [J].

    Raises:
        ValueError: as for `quadratic_part`.
    """
    bounds = quadratic_term_bounds(w, error, dq, kd, ki, alpha, constants)
    return (bounds.sum(axis=-1) + bounds[..., 3]) / 2


def derivative_term_bounds(
    error: ArrayLike,
    dq: ArrayLike,
    kp: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike,
    alpha: float,
    constants: Constants,
) -> NDArray:
    """What the four terms of dV/dt are at most.

    Source: Mastalli 2013, right sides of (3.19).

    Args:
        error, dq: state, shape (..., 4) each [rad, rad/s].
        kp, kd, ki: gains, (4,) or symmetric (4, 4) [N m/rad, N m s/rad, N m/(rad s)].
        alpha: number of the analysis [1/s].
        constants: of the arm, over postures that hold q, q_desired and what lies between.

    Returns:
        Shape (..., 4) [W], in the order of `derivative_terms`.

    Raises:
        ValueError: as for `quadratic_part`.
    """
    error_size, speed = np.broadcast_arrays(_size(error, "error"), _size(dq, "dq"))
    alpha = positive(alpha, "alpha", "1/s")
    return np.stack(
        [
            -(_lowest(kd, "K_d") - alpha * constants.lambda_max) * speed**2,
            -(alpha * _lowest(kp, "K_p") - _highest(ki, "K_i")) * error_size**2,
            alpha * constants.kc1 * error_size * speed**2,
            alpha * constants.kg * error_size**2,
        ],
        axis=-1,
    )


def rate_weights(
    error: ArrayLike,
    kp: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike,
    alpha: float,
    constants: Constants,
) -> tuple[float, NDArray]:
    """W11 and W22, with dV/dt <= -W11 ||q~||^2 - W22 ||dq||^2.

    Source: Mastalli 2013, (3.21) and (3.22), with ||q~|| for the printed ||dq|| in W22.

    Args:
        error: shape (..., 4) [rad].
        kp, kd, ki, alpha, constants: as for `derivative_term_bounds`.

    Returns:
        W11 [N m/(rad s)] and W22, shape (...) [N m s/rad].

    Raises:
        ValueError: as for `quadratic_part`.
    """
    alpha = positive(alpha, "alpha", "1/s")
    W11 = alpha * (_lowest(kp, "K_p") - constants.kg) - _highest(ki, "K_i")
    inertia = constants.lambda_max + constants.kc1 * _size(error, "error")
    return W11, _lowest(kd, "K_d") - alpha * inertia


def derivative_bound(
    error: ArrayLike,
    dq: ArrayLike,
    kp: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike,
    alpha: float,
    constants: Constants,
) -> NDArray:
    """What dV/dt is at most.

    Source: Mastalli 2013, (3.20), with W22 corrected.

    Args:
        error, dq, kp, kd, ki, alpha, constants: as for `derivative_term_bounds`.

    Returns:
        Shape (...) [W].

    Raises:
        ValueError: as for `quadratic_part`.
    """
    W11, W22 = rate_weights(error, kp, kd, ki, alpha, constants)
    return -W11 * _size(error, "error") ** 2 - W22 * _size(dq, "dq") ** 2


def _size(vector: ArrayLike, name: str) -> NDArray:
    return np.linalg.norm(joint_vector(vector, name), axis=-1)


def _lowest(gain: ArrayLike, name: str) -> float:
    return float(np.linalg.eigvalsh(gain_matrix(gain, name))[0])


def _highest(gain: ArrayLike, name: str) -> float:
    return float(np.linalg.eigvalsh(gain_matrix(gain, name))[-1])
