"""The arm's equation of motion, forwards and backwards, and its terms.

    M(q) ddq + C(q, dq) dq + F_v dq + F_s sgn(dq) + g(q) = tau - J^T h_e        (2.11)

Source: Mastalli 2013, section 2.3 and Appendix A.2, whose printed M, C and g are wrong in most
entries: what stands here is derived anew, from the Lagrangian for M, C and g, by Newton and Euler
for the inverse dynamics. Frames and the meaning of q as in `kinematics`; SI units.

Boom, stick and bucket turn about parallel axes, so the swing does not couple with them through M.
Every link's inertia is the same about every axis through its centre of mass (see `machine`). The
closed forms are in `terms`; here inputs are checked and postures arranged.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.dynamics.postures import (
    evaluate,
    write_forward_dynamics,
    write_gravity_torque,
    write_inverse_dynamics,
    write_mass_height,
    write_mass_matrix,
    write_mass_matrix_derivative,
)
from backhoe.arm.kinematics import jacobian, joint_vector
from backhoe.arm.kinematics.forward import leading_shape
from backhoe.basics.inputs import numbers, positive
from backhoe.machine import BACKHOE, Machine

Friction = Callable[[NDArray], ArrayLike] | bool | None


def mass_matrix(q: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """Inertia matrix M of the arm.

    Source: Mastalli 2013, eqs. (2.13), (2.14) and (A.21), (A.22), corrected.

    Args:
        q: joint angles swing, boom, stick, bucket, shape (..., 4) [rad].

    Returns:
        M with kinetic energy dq @ M @ dq / 2, symmetric and positive definite, shape (..., 4, 4)
        [kg m^2].

    Raises:
        ValueError: the last axis is not 4, or a value is not finite.
    """
    return evaluate(write_mass_matrix, (4, 4), machine, joint_vector(q))


def mass_matrix_derivative(q: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """Derivatives of the inertia matrix by each joint angle.

    Args:
        q: joint angles swing, boom, stick, bucket, shape (..., 4) [rad].

    Returns:
        dM with dM[..., k, :, :] the derivative of M by q_k, shape (..., 4, 4, 4) [kg m^2/rad].

    Raises:
        ValueError: the last axis is not 4, or a value is not finite.
    """
    return evaluate(write_mass_matrix_derivative, (4, 4, 4), machine, joint_vector(q))


def coriolis_matrix(q: ArrayLike, dq: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """Matrix C of the centrifugal and Coriolis torques C @ dq, from the Christoffel symbols.

    C_kj is the sum over i of c_kij dq_i, with c_kij = (dM_kj/dq_i + dM_ki/dq_j - dM_ij/dq_k) / 2:
    the choice for which Mdot - 2 C is skew.

    Source: Mastalli 2013, eqs. (2.15) and (A.7); the entries (2.16) to (2.20) are wrong as printed.

    Args:
        q: joint angles, shape (..., 4) [rad].
        dq: joint speeds, shape (..., 4) [rad/s].

    Returns:
        C, shape (..., 4, 4) [kg m^2/s].

    Raises:
        ValueError: a last axis is not 4, a value is not finite, or shapes do not broadcast.
    """
    q, dq = joint_vector(q), joint_vector(dq, "dq")
    leading_shape(q, dq)
    dM = mass_matrix_derivative(q, machine)
    dM_dt = np.einsum("...ikj,...i->...kj", dM, dq)
    turned = np.einsum("...jki,...i->...kj", dM, dq)
    return (dM_dt + turned - np.swapaxes(turned, -1, -2)) / 2


def gravity_torque(q: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """Torques g that hold the arm still: the gradient of its potential energy.

    Source: Mastalli 2013, eqs. (2.21) and (A.29), corrected.

    Args:
        q: joint angles swing, boom, stick, bucket, shape (..., 4) [rad].

    Returns:
        g, shape (..., 4) [N m].

    Raises:
        ValueError: the last axis is not 4, or a value is not finite.
    """
    return evaluate(write_gravity_torque, (4,), machine, joint_vector(q))


def friction_torque(
    dq: ArrayLike, machine: Machine = BACKHOE, smoothing: float | None = None
) -> NDArray:
    """Torque that joint friction takes: F_v dq + F_s sgn(dq), which is zero at rest.

    Source: Mastalli 2013, eq. (2.11), whose "static" coefficients are Coulomb friction.

    Args:
        dq: joint speeds, shape (..., 4) [rad/s].
        smoothing: a speed [rad/s]; tanh(dq / smoothing) then replaces the jump of sgn, so that an
            integrator does not chatter. None keeps the jump.

    Returns:
        Friction torque on the left side of (2.11): it has the sign of dq, shape (..., 4) [N m].

    Raises:
        ValueError: the last axis is not 4, a value is not finite, or smoothing is not positive.
    """
    dq = joint_vector(dq, "dq")
    if smoothing is None:
        return machine.viscous * dq + machine.coulomb * np.sign(dq)
    smoothing = positive(smoothing, "smoothing", "rad/s")
    return machine.viscous * dq + machine.coulomb * np.tanh(dq / smoothing)


def inverse_dynamics(
    q: ArrayLike,
    dq: ArrayLike,
    ddq: ArrayLike,
    friction: Friction = None,
    tip_force: ArrayLike | None = None,
    machine: Machine = BACKHOE,
) -> NDArray:
    """Torques that give the arm an acceleration.

    By Newton and Euler: accelerations outwards along the arm, then forces and torques inwards. The
    same numbers as M @ ddq + C @ dq + g, without forming the matrices.

    Source: Mastalli 2013, eqs. (2.11) and (2.12).

    Args:
        q: joint angles, shape (..., 4) [rad].
        dq: joint speeds, shape (..., 4) [rad/s].
        ddq: joint accelerations, shape (..., 4) [rad/s^2].
        friction: None for none, True for the machine's (`friction_torque`), or a function from dq
            to friction torques.
        tip_force: h_e of (2.11), the force that the bucket's tip exerts on its surroundings, in the
            base frame, shape (..., 3) [N]. Soil that pushes the tip with F gives h_e = -F.

    Returns:
        tau, shape (..., 4) [N m].

    Raises:
        ValueError: a last axis does not fit, a value is not finite, or shapes do not broadcast.
        TypeError: friction is something else.
    """
    q, dq, ddq = joint_vector(q), joint_vector(dq, "dq"), joint_vector(ddq, "ddq")
    tau = evaluate(write_inverse_dynamics, (4,), machine, q, dq, ddq)
    resistance = _resistance(q, dq, friction, tip_force, machine)
    return tau if resistance is None else tau + resistance


def forward_dynamics(
    q: ArrayLike,
    dq: ArrayLike,
    tau: ArrayLike,
    friction: Friction = None,
    tip_force: ArrayLike | None = None,
    machine: Machine = BACKHOE,
) -> NDArray:
    """Accelerations that torques give the arm.

    Source: Mastalli 2013, eq. (2.22), with the further terms of (2.11).

    Args:
        q: joint angles, shape (..., 4) [rad].
        dq: joint speeds, shape (..., 4) [rad/s].
        tau: joint torques, shape (..., 4) [N m].
        friction, tip_force: as for `inverse_dynamics`.

    Returns:
        ddq, shape (..., 4) [rad/s^2].

    Raises:
        ValueError: a last axis does not fit, a value is not finite, or shapes do not broadcast.
        TypeError: friction is something else.
    """
    q, dq, tau = joint_vector(q), joint_vector(dq, "dq"), joint_vector(tau, "tau")
    resistance = _resistance(q, dq, friction, tip_force, machine)
    if resistance is not None:
        tau = tau - resistance
    return evaluate(write_forward_dynamics, (4,), machine, q, dq, tau)


def energy(q: ArrayLike, dq: ArrayLike, machine: Machine = BACKHOE) -> tuple[NDArray, NDArray]:
    """Kinetic and potential energy of house and arm.

    Args:
        q: joint angles, shape (..., 4) [rad].
        dq: joint speeds, shape (..., 4) [rad/s].

    Returns:
        Kinetic energy dq @ M @ dq / 2 and potential energy, zero at ground level, each of shape
        (...) [J].

    Raises:
        ValueError: a last axis is not 4, a value is not finite, or shapes do not broadcast.
    """
    q, dq = joint_vector(q), joint_vector(dq, "dq")
    leading_shape(q, dq)
    house = machine.swing.mass * (machine.base.height + machine.swing.com_height)
    momentum = (mass_matrix(q, machine) @ dq[..., None])[..., 0]
    kinetic = (dq * momentum).sum(axis=-1) / 2
    potential = machine.gravity * (evaluate(write_mass_height, (), machine, q) + house)
    return kinetic, potential + np.zeros_like(kinetic)


def _resistance(
    q: NDArray,
    dq: NDArray,
    friction: Friction,
    tip_force: ArrayLike | None,
    machine: Machine,
) -> NDArray | None:
    """Friction and the tip's load, J^T h_e: what the drives must give beyond (2.12)."""
    resistance = None
    if friction is True:
        resistance = friction_torque(dq, machine)
    elif callable(friction):
        resistance = joint_vector(friction(dq), "friction(dq)")
    elif friction is not None and friction is not False:
        raise TypeError(
            f"friction must be None, True or a function from dq to torques, got {friction!r}"
        )
    if tip_force is None:
        return resistance
    force = numbers(tip_force, "tip_force", (..., 3), meaning="components (x, y, z) [N]")
    leading_shape(q, dq, force)
    J_T = np.swapaxes(jacobian(q, machine=machine)[..., :3, :], -1, -2)
    load = (J_T @ force[..., None])[..., 0]
    return load if resistance is None else resistance + load
