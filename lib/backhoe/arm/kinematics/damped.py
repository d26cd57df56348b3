"""Inverse kinematics by damped least squares, step by step along the Jacobian.

Near a singularity the inverse of the Jacobian asks for enormous joint speeds. Damping bounds them:
each singular value sigma is inverted as sigma / (sigma^2 + damping^2), at most 1 / (2 damping).

Source: Mastalli 2013, eqs. (2.4) to (2.7). Equation (2.6) stands; what (2.4), (2.5) and (2.7)
invert is printed as J + lambda^2 I and must be J^T J + lambda^2 I, with J^T behind it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.kinematics.forward import jacobian, joint_vector, leading_shape, pose
from backhoe.arm.kinematics.inverse import TARGET
from backhoe.basics.inputs import not_negative, numbers, positive, whole
from backhoe.machine import BACKHOE, Machine

_AT_REST = 1e-6
_DOUBLINGS = 30
_SMALL_DAMPING = 0.05


@dataclass(frozen=True)
class DampedSolution:
    """Where the iteration ended and how it went there.

    `q` (..., 4) [rad]; `converged` (...) bool; `iterations` made in all; `residual` (..., 4), the
    target less the pose reached [m, m, m, rad]; `path` (iterations + 1, ..., 4), each q on the way.
    """

    q: NDArray
    converged: NDArray
    iterations: int
    residual: NDArray
    path: NDArray


def task_jacobian(q: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """Jacobian of `pose`: x, y, z of the stick's tip and the bucket's joint angle.

    Args:
        q: joint angles swing, boom, stick, bucket, shape (..., 4) [rad].

    Returns:
        J with the rate of pose(q) equal to J @ dq, shape (..., 4, 4) [m/rad; the last row 1].

    Raises:
        ValueError: the last axis is not 4, or a value is not finite.
    """
    linear = jacobian(q, "stick", machine)[..., :3, :]
    J = np.zeros((*linear.shape[:-2], 4, 4))
    J[..., :3, :] = linear
    J[..., 3, 3] = 1.0
    return J


def damped_inverse(J: ArrayLike, damping: ArrayLike) -> NDArray:
    """Damped least-squares inverse V E U^T of a matrix, from its singular values.

    Equals (J^T J + damping^2 I)^-1 J^T; at damping 0 the pseudo-inverse.

    Source: Mastalli 2013, eq. (2.6) and the right-hand side of (2.7).

    Args:
        J: matrices, shape (..., m, n).
        damping: lambda in the units of J, not negative, shape (...).

    Returns:
        The damped inverse, shape (..., n, m).

    Raises:
        ValueError: J is not a matrix, a value is not finite, or damping is negative.
    """
    J, damping = _matrices(J), numbers(damping, "damping")
    if (damping < 0).any():
        raise ValueError(f"damping must not be negative, got {damping}")
    U, sigma, V_T = np.linalg.svd(J, full_matrices=False)
    gain = _damped_reciprocal(sigma, damping[..., None])
    return np.einsum("...ki,...k,...jk->...ij", V_T, gain, U)


def adaptive_damping(J: ArrayLike, largest: float = 0.1, threshold: float = 0.2) -> NDArray:
    """Damping that is zero in the open and grows as a singularity nears.

    damping^2 = largest^2 (1 - (sigma_min / threshold)^2) where the smallest singular value is below
    the threshold. The idea is Nakamura and Hanafusa's (1986), who watch the manipulability.

    Args:
        J: matrices, shape (..., m, n).
        largest: damping at the singularity, in the units of J.
        threshold: smallest singular value at which the damping sets in, in the units of J.

    Returns:
        Damping for `damped_inverse`, shape (...).

    Raises:
        ValueError: J is not a matrix, a value is not finite, largest is negative, or threshold is
            not positive.
    """
    largest, threshold = not_negative(largest, "largest"), positive(threshold, "threshold")
    sigma_min = np.linalg.svd(_matrices(J), compute_uv=False)[..., -1]
    return largest * np.sqrt(np.clip(1 - (sigma_min / threshold) ** 2, 0.0, None))


def solve_damped(
    target: ArrayLike,
    q0: ArrayLike,
    damping: float | None = None,
    tolerance: float = 1e-9,
    max_iterations: int = 200,
    max_step: float = 0.3,
    machine: Machine = BACKHOE,
) -> DampedSolution:
    """Joint angles for a pose of the stick's tip and bucket, by iteration.

    Repeats q <- q + J^# (target - pose(q)) with the damped inverse J^#; where a step would lead
    away from the target, its damping is doubled until it does not. Ignores joint limits. Out of
    reach, it comes to rest at the closest pose; from the far side of the machine it can come to
    rest elsewhere: look at `converged`.

    Source: Mastalli 2013, eqs. (2.4) to (2.7), corrected.

    Args:
        target: x, y, z of the stick's tip [m] and bucket joint angle [rad], shape (..., 4).
        q0: joint angles to start from, shape (..., 4) [rad].
        damping: lambda of every first try; None for `adaptive_damping` with its defaults.
        tolerance: converged when no component of the residual is larger [m, rad].
        max_iterations: when to give up.
        max_step: no joint turns further in one iteration [rad].

    Returns:
        The result with its report.

    Raises:
        ValueError: a last axis is not 4, leading axes do not fit each other, a value is not finite,
            damping is negative, or tolerance, max_iterations or max_step is not positive.
    """
    tolerance, max_step = positive(tolerance, "tolerance"), positive(max_step, "max_step", "rad")
    whole(max_iterations, "max_iterations", least=1)
    if damping is not None:
        not_negative(damping, "damping")
    target, q0 = numbers(target, "target", (..., 4), meaning=TARGET), joint_vector(q0, "q0")
    q = np.array(np.broadcast_to(q0, (*leading_shape(target, q0), 4)))
    path = [q]
    residual = target - pose(q, machine)
    converged = (np.abs(residual) <= tolerance).all(axis=-1)
    resting = converged
    while not resting.all() and len(path) <= max_iterations:
        step = _step_nearer(q, target, damping, max_step, machine)
        step = np.where(resting[..., None], 0.0, step)
        q = q + step
        path.append(q)
        residual = target - pose(q, machine)
        converged = (np.abs(residual) <= tolerance).all(axis=-1)
        distance = np.linalg.norm(residual, axis=-1)
        resting = converged | (np.abs(step).max(axis=-1) <= _AT_REST * distance)
    return DampedSolution(q, converged, len(path) - 1, residual, np.array(path))


def _step_nearer(
    q: NDArray, target: NDArray, damping: float | None, max_step: float, machine: Machine
) -> NDArray:
    """One damped step, its damping doubled until it leads nearer to the target; 0 if none does."""
    J = task_jacobian(q, machine)
    residual = target - pose(q, machine)
    distance = np.linalg.norm(residual, axis=-1)
    strength = adaptive_damping(J) if damping is None else np.full(distance.shape, damping)
    for _ in range(_DOUBLINGS):
        step = (damped_inverse(J, strength) @ residual[..., None])[..., 0]
        longest = np.abs(step).max(axis=-1, keepdims=True)
        step *= max_step / np.maximum(longest, max_step)
        away = np.linalg.norm(target - pose(q + step, machine), axis=-1) >= distance
        if not away.any():
            break
        strength = np.where(away, np.maximum(2 * strength, _SMALL_DAMPING), strength)
    return np.where(away[..., None], 0.0, step)


def _matrices(J: ArrayLike) -> NDArray:
    return numbers(J, "J", (..., "m", "n"), meaning="matrices")


def _damped_reciprocal(sigma: NDArray, damping: NDArray) -> NDArray:
    """sigma / (sigma^2 + damping^2), and 0 where sigma is 0."""
    sigma, damping = np.broadcast_arrays(sigma, damping)
    return np.divide(sigma, sigma**2 + damping**2, out=np.zeros_like(sigma), where=sigma > 0)
