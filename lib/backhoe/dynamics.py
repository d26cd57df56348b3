"""Dynamics of the arm: the equation of motion and its terms, in closed form.

    M(q) ddq + C(q, dq) dq + F_v dq + F_s sgn(dq) + g(q) = tau - J^T h_e        (2.11)

Source: Mastalli 2013, section 2.3 and Appendix A.2, whose printed M, C and g are wrong in most
entries: what stands here is derived anew, from the Lagrangian for M, C and g, by Newton and Euler
for the inverse dynamics. Frames and the meaning of q as in `kinematics`; SI units.

Boom, stick and bucket turn about parallel axes, so the swing does not couple with them through M.
Every link's inertia is the same about every axis through its centre of mass (see `machine`).
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.kinematics import jacobian, joint_vector
from backhoe.machine import BACKHOE, Machine

__all__ = [
    "coriolis_matrix",
    "energy",
    "forward_dynamics",
    "friction_torque",
    "gravity_torque",
    "inverse_dynamics",
    "mass_matrix",
    "mass_matrix_derivative",
]

Friction = Callable[[NDArray], ArrayLike] | bool | None

_TILE = 4096


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
    return _evaluate(_write_mass_matrix, (4, 4), machine, joint_vector(q))


def mass_matrix_derivative(q: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """Derivatives of the inertia matrix by each joint angle.

    Args:
        q: joint angles swing, boom, stick, bucket, shape (..., 4) [rad].

    Returns:
        dM with dM[..., k, :, :] the derivative of M by q_k, shape (..., 4, 4, 4) [kg m^2/rad].

    Raises:
        ValueError: the last axis is not 4, or a value is not finite.
    """
    return _evaluate(_write_mass_matrix_derivative, (4, 4, 4), machine, joint_vector(q))


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
        ValueError: a last axis is not 4, or a value is not finite.
    """
    dq = joint_vector(dq, "dq")
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
    return _evaluate(_write_gravity_torque, (4,), machine, joint_vector(q))


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
    if not smoothing > 0:
        raise ValueError(f"smoothing must be a positive speed in rad/s or None, got {smoothing!r}")
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
    tau = _evaluate(_write_inverse_dynamics, (4,), machine, q, dq, ddq)
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
    return _evaluate(_write_forward_dynamics, (4,), machine, q, dq, tau)


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
    kinetic = np.einsum("...i,...ij,...j->...", dq, mass_matrix(q, machine), dq) / 2
    potential = np.asarray(_potential_energy(q, machine))
    kinetic, potential = np.broadcast_arrays(kinetic, potential)
    return kinetic[()], potential[()]


def _evaluate(
    write: Callable, tail: tuple[int, ...], machine: Machine, *vectors: NDArray
) -> NDArray:
    """Call `write(out, machine, *vectors)` for one posture in floats, for many in arrays.

    Many postures go in tiles that fit the processor's cache.
    """
    if all(vector.ndim == 1 for vector in vectors):
        out = np.zeros(tail)
        write(out, machine, *(vector.tolist() for vector in vectors))
        return out
    vectors = np.broadcast_arrays(*vectors)
    flat = [vector.reshape(-1, 4) for vector in vectors]
    out = np.zeros((len(flat[0]), *tail))
    for start in range(0, len(out), _TILE):
        tile = slice(start, start + _TILE)
        write(out[tile], machine, *(np.ascontiguousarray(vector[tile].T) for vector in flat))
    return out.reshape(vectors[0].shape[:-1] + tail)


def _trigonometry(q: list[float] | NDArray) -> tuple[Callable, Callable]:
    return (cos, sin) if isinstance(q, list) else (np.cos, np.sin)


def _write_mass_matrix(M: NDArray, machine: Machine, q: list[float] | NDArray) -> None:
    M11, M22, M23, M24, M33, M34, M44 = _inertias(q, machine)
    M[..., 0, 0] = M11
    M[..., 1, 1] = M22
    M[..., 1, 2] = M[..., 2, 1] = M23
    M[..., 1, 3] = M[..., 3, 1] = M24
    M[..., 2, 2] = M33
    M[..., 2, 3] = M[..., 3, 2] = M34
    M[..., 3, 3] = M44


def _inertias(q: list[float] | NDArray, machine: Machine) -> tuple:
    """M11, M22, M23, M24, M33, M34, M44: all of M that is not zero."""
    cos, _ = _trigonometry(q)
    _, q2, q3, q4 = q
    swing, boom, stick, bucket = machine.swing, *machine.links
    L2, L3 = boom.length, stick.length
    Lc2, Lc3, Lc4 = boom.com_radius, stick.com_radius, bucket.com_radius
    m_bo, m_s, m_bu = boom.mass, stick.mass, bucket.mass

    p2 = q2 + boom.angle_offset
    p3 = p2 + (q3 + stick.angle_offset)
    r_elbow = swing.offset + L2 * cos(p2)
    r2 = swing.offset + Lc2 * cos(q2 + boom.com_angle)
    r3 = r_elbow + Lc3 * cos(p2 + (q3 + stick.com_angle))
    r4 = r_elbow + L3 * cos(p3) + Lc4 * cos(p3 + (q4 + bucket.com_angle))
    M11 = _swing_inertia(machine) + m_bo * r2 * r2 + m_s * r3 * r3 + m_bu * r4 * r4

    q3_star = q3 + stick.angle_offset
    q4_cm = q4 + bucket.com_angle
    boom_stick = L2 * (m_s * Lc3 * cos(q3 + stick.com_angle) + m_bu * L3 * cos(q3_star))
    boom_bucket = m_bu * L2 * Lc4 * cos(q3_star + q4_cm)
    stick_bucket = m_bu * L3 * Lc4 * cos(q4_cm)
    J2 = m_bo * Lc2 * Lc2 + (m_s + m_bu) * L2 * L2 + boom.inertia
    J3 = m_s * Lc3 * Lc3 + m_bu * L3 * L3 + stick.inertia
    M44 = m_bu * Lc4 * Lc4 + bucket.inertia
    M34 = M44 + stick_bucket
    M24 = M34 + boom_bucket
    M33 = J3 + M34 + stick_bucket
    M23 = M33 + boom_stick + boom_bucket
    M22 = J2 + M23 + boom_stick + boom_bucket
    return M11, M22, M23, M24, M33, M34, M44


def _write_mass_matrix_derivative(dM: NDArray, machine: Machine, q: list[float] | NDArray) -> None:
    cos, sin = _trigonometry(q)
    _, q2, q3, q4 = q
    swing, boom, stick, bucket = machine.swing, *machine.links
    L2, L3 = boom.length, stick.length
    Lc2, Lc3, Lc4 = boom.com_radius, stick.com_radius, bucket.com_radius
    m_bo, m_s, m_bu = boom.mass, stick.mass, bucket.mass

    p2 = q2 + boom.angle_offset
    p3 = p2 + (q3 + stick.angle_offset)
    p2_cm = q2 + boom.com_angle
    p3_cm = p2 + (q3 + stick.com_angle)
    p4_cm = p3 + (q4 + bucket.com_angle)
    r2 = swing.offset + Lc2 * cos(p2_cm)
    r3 = swing.offset + L2 * cos(p2) + Lc3 * cos(p3_cm)
    r4 = swing.offset + L2 * cos(p2) + L3 * cos(p3) + Lc4 * cos(p4_cm)
    lever4 = m_bu * r4 * Lc4 * sin(p4_cm)
    lever3 = lever4 + m_bu * r4 * L3 * sin(p3) + m_s * r3 * Lc3 * sin(p3_cm)
    lever2 = lever3 + (m_bu * r4 + m_s * r3) * L2 * sin(p2) + m_bo * r2 * Lc2 * sin(p2_cm)
    dM[..., 1, 0, 0] = -2 * lever2
    dM[..., 2, 0, 0] = -2 * lever3
    dM[..., 3, 0, 0] = -2 * lever4

    q3_star = q3 + stick.angle_offset
    q4_cm = q4 + bucket.com_angle
    boom_stick = -L2 * (m_s * Lc3 * sin(q3 + stick.com_angle) + m_bu * L3 * sin(q3_star))
    boom_bucket = -m_bu * L2 * Lc4 * sin(q3_star + q4_cm)
    stick_bucket = -m_bu * L3 * Lc4 * sin(q4_cm)
    dM[..., 2, 1, 1] = 2 * (boom_stick + boom_bucket)
    dM[..., 2, 1, 2] = dM[..., 2, 2, 1] = boom_stick + boom_bucket
    dM[..., 2, 1, 3] = dM[..., 2, 3, 1] = boom_bucket
    dM[..., 3, 1, 1] = 2 * (boom_bucket + stick_bucket)
    dM[..., 3, 1, 2] = dM[..., 3, 2, 1] = boom_bucket + 2 * stick_bucket
    dM[..., 3, 1, 3] = dM[..., 3, 3, 1] = boom_bucket + stick_bucket
    dM[..., 3, 2, 2] = 2 * stick_bucket
    dM[..., 3, 2, 3] = dM[..., 3, 3, 2] = stick_bucket


def _write_gravity_torque(g: NDArray, machine: Machine, q: list[float] | NDArray) -> None:
    cos, _ = _trigonometry(q)
    _, q2, q3, q4 = q
    boom, stick, bucket = machine.links
    m_bo, m_s, m_bu = boom.mass, stick.mass, bucket.mass
    p2 = q2 + boom.angle_offset
    p3 = p2 + (q3 + stick.angle_offset)
    lever4 = m_bu * bucket.com_radius * cos(p3 + (q4 + bucket.com_angle))
    lever3 = (
        lever4
        + m_bu * stick.length * cos(p3)
        + m_s * stick.com_radius * cos(p2 + (q3 + stick.com_angle))
    )
    lever2 = (
        lever3
        + (m_s + m_bu) * boom.length * cos(p2)
        + m_bo * boom.com_radius * cos(q2 + boom.com_angle)
    )
    g[..., 1] = machine.gravity * lever2
    g[..., 2] = machine.gravity * lever3
    g[..., 3] = machine.gravity * lever4


def _write_inverse_dynamics(
    tau: NDArray,
    machine: Machine,
    q: list[float] | NDArray,
    dq: list[float] | NDArray,
    ddq: list[float] | NDArray,
) -> None:
    tau[..., 0], tau[..., 1], tau[..., 2], tau[..., 3] = _newton_euler(q, dq, ddq, machine)


def _newton_euler(q: list, dq: list, ddq: list, machine: Machine) -> tuple:
    """The four joint torques: accelerations outwards, then forces inwards, in the arm's plane."""
    cos, sin = _trigonometry(q)
    links = machine.links
    pitch = w = dw = 0.0
    r, dr, ar, az = machine.swing.offset, 0.0, 0.0, machine.gravity
    tau1 = _swing_inertia(machine) * ddq[0]
    forces = []
    for link, angle, speed, acceleration in zip(links, q[1:], dq[1:], ddq[1:], strict=True):
        w, dw = w + speed, dw + acceleration
        direction = pitch + (angle + link.com_angle)
        x, y = link.com_radius * cos(direction), link.com_radius * sin(direction)
        r_cm = r + x
        F_r = link.mass * (ar - dw * y - w * w * x - dq[0] * dq[0] * r_cm)
        F_z = link.mass * (az + dw * x - w * w * y)
        tau1 = tau1 + link.mass * r_cm * (ddq[0] * r_cm + 2 * dq[0] * (dr - w * y))
        moment = link.inertia * dw + x * F_z - y * F_r
        pitch = pitch + (angle + link.angle_offset)
        x, y = link.length * cos(pitch), link.length * sin(pitch)
        forces.append((F_r, F_z, moment, x, y))
        r, dr = r + x, dr - w * y
        ar, az = ar - dw * y - w * w * x, az + dw * x - w * w * y

    taus = []
    F_r = F_z = tau = 0.0
    for f_r, f_z, moment, x, y in reversed(forces):
        tau = tau + moment + x * F_z - y * F_r
        F_r, F_z = F_r + f_r, F_z + f_z
        taus.append(tau)
    return tau1, taus[2], taus[1], taus[0]


def _write_forward_dynamics(
    ddq: NDArray,
    machine: Machine,
    q: list[float] | NDArray,
    dq: list[float] | NDArray,
    tau: list[float] | NDArray,
) -> None:
    """Solve M ddq = tau - h: the swing by itself, the rest by Gaussian elimination from below."""
    h1, h2, h3, h4 = _newton_euler(q, dq, (0.0, 0.0, 0.0, 0.0), machine)
    M11, M22, M23, M24, M33, M34, M44 = _inertias(q, machine)
    b1, b2, b3, b4 = tau[0] - h1, tau[1] - h2, tau[2] - h3, tau[3] - h4
    l2, l3 = M24 / M44, M34 / M44
    M22, M23, b2 = M22 - l2 * M24, M23 - l2 * M34, b2 - l2 * b4
    M33, b3 = M33 - l3 * M34, b3 - l3 * b4
    l2 = M23 / M33
    a2 = (b2 - l2 * b3) / (M22 - l2 * M23)
    a3 = (b3 - M23 * a2) / M33
    ddq[..., 0] = b1 / M11
    ddq[..., 1] = a2
    ddq[..., 2] = a3
    ddq[..., 3] = (b4 - M24 * a2 - M34 * a3) / M44


def _swing_inertia(machine: Machine) -> float:
    """What the arm's posture does not change of M11."""
    swing = machine.swing
    links = sum(link.inertia for link in machine.links)
    return swing.inertia + links + swing.mass * swing.com_radius**2


def _potential_energy(q: NDArray, machine: Machine) -> NDArray:
    base, swing = machine.base, machine.swing
    z = base.height + swing.height
    moment = swing.mass * (base.height + swing.com_height)
    pitch = 0.0
    for link, angle in zip(machine.links, np.moveaxis(q, -1, 0)[1:], strict=True):
        moment = moment + link.mass * (
            z + link.com_radius * np.sin(pitch + (angle + link.com_angle))
        )
        pitch = pitch + (angle + link.angle_offset)
        z = z + link.length * np.sin(pitch)
    return machine.gravity * moment


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
    force = np.asarray(tip_force, dtype=float)
    if force.ndim == 0 or force.shape[-1] != 3 or not np.isfinite(force).all():
        raise ValueError(
            f"tip_force must end in 3 finite components (x, y, z) in N, got {tip_force!r}"
        )
    J_T = np.swapaxes(jacobian(q, machine=machine)[..., :3, :], -1, -2)
    load = (J_T @ force[..., None])[..., 0]
    return load if resistance is None else resistance + load
