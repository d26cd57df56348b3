"""The thesis's M, C and g exactly as printed: eqs. (2.13)-(2.21) = (A.21)-(A.29). Not for use.

Lesson 02 tests these formulas and finds them wrong; `backhoe.arm.dynamics` has the right ones. The
numbers and angle signs come from the machine, so that a variant (all lengths doubled, another sign
reading) goes through the same formulas. What the print leaves undefined is read so:

- theta_cm1 (in q1^cm) is taken as pi/2, so that q1^cm = q1*;
- L_cm1 (in C_1,21) is taken as L_cm2, L*_cm3 (in g) as L_cm3;
- A, A^cm and A' are printed with the swing angle q1. `charitable=True` reads them with the boom's
  angle q2, the only change that makes them the distances they stand for.

In the code q1..q4 are the starred angles of Table A.1.

Reference: Mastalli 2013, section 2.3 and Appendix A.2.2.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.kinematics import joint_vector
from backhoe.machine import BACKHOE, Machine

__all__ = ["coriolis_forms", "coriolis_vector", "gravity_torque", "mass_matrix"]


def mass_matrix(q: ArrayLike, *, charitable: bool = False, machine: Machine = BACKHOE) -> NDArray:
    """M(q) as printed in (2.13), (2.14).

    Args:
        q: joint angles, shape (..., 4) [rad].
        charitable: read A, A^cm, A' with the boom's angle instead of the swing's.
        machine: numbers and angle signs.

    Returns:
        Shape (..., 4, 4); meant as kg m^2, but the terms do not all have that unit.

    Raises:
        ValueError: last axis of q is not 4, or a value is not finite.
    """
    s = _symbols(q, machine, charitable)
    M = np.zeros((*s.q.shape[:-1], 4, 4))
    M[..., 0, 0] = (
        s.m_t * s.b_cm1**2
        + s.m_bo * (s.A_cm**2 + s.b0 * (s.b0 + 2 * s.A_cm * np.sin(s.q1)))
        + s.m_s * (s.L_cm3 * s.B_cm + s.A_prime) ** 2
        + s.m_bu * (s.L_cm4 * s.C + s.L3 * s.B + s.A_prime) ** 2
        + s.I_t
        + s.I_bo
        + s.I_s
    )
    M[..., 0, 1] = s.m_bu * s.b0 * s.L_cm2 * np.cos(s.q1) * np.sin(s.q2)
    M[..., 0, 2] = s.I_s + s.I_bu
    M[..., 0, 3] = s.I_bu
    M[..., 1, 1] = (
        s.m_bo * s.L_cm2**2
        + s.m_s * (s.L_cm3**2 + 2 * s.L_cm3 * s.L2 * np.cos(s.a_stick) + s.L2**2)
        + s.m_bu * (s.height_bar**2 + s.reach_bar)
    )
    M[..., 1, 2] = s.m_s * (s.L_cm3**2 + s.L_cm3 * s.L2 * np.cos(s.a_stick)) + s.m_bu * (
        s.L_cm4**2 + s.L3 * (s.L_cm4 * np.cos(s.a_bucket) + s.L2 * np.cos(s.a_elbow)) + s.L3**2
    )
    M[..., 1, 3] = s.m_bu * s.L_cm4 * (s.L_cm4 + s.L3 * np.cos(s.a_bucket) + s.L2 * np.cos(s.a_far))
    M[..., 2, 2] = (
        s.m_s * s.L_cm3**2
        + s.m_bu * (s.L_cm4**2 + 2 * s.L_cm4 * s.L3 * np.cos(s.a_bucket) + s.L3**2)
        + s.I_s
        + s.I_bu
    )
    M[..., 2, 3] = s.m_bu * (s.L_cm4**2 + s.L_cm4 * s.L3 * np.cos(s.a_bucket)) + s.I_bu
    M[..., 3, 3] = s.m_bu * s.L_cm4**2 + s.I_bu
    return _mirror(M)


def gravity_torque(q: ArrayLike, *, machine: Machine = BACKHOE) -> NDArray:
    """g(q) as printed in (2.21).

    Args:
        q: joint angles, shape (..., 4) [rad].
        machine: numbers and angle signs.

    Returns:
        Shape (..., 4) [N m].

    Raises:
        ValueError: last axis of q is not 4, or a value is not finite.
    """
    s = _symbols(q, machine, charitable=False)
    beyond = s.m_bu * (s.L3 * np.cos(s.q23) + s.L_cm4 * np.cos(s.q234))
    g = np.zeros_like(s.q)
    g[..., 1] = (
        s.m_bo * s.L_cm2 * np.cos(s.q2_cm) + s.m_s * s.L2 + s.m_bu * s.L2 * np.cos(s.q2) + beyond
    )
    g[..., 2] = s.m_s * s.L_cm3 * np.cos(s.q23) + beyond
    g[..., 3] = s.m_bu * s.L_cm4 * np.cos(s.q234)
    return machine.gravity * g


def coriolis_vector(
    q: ArrayLike, dq: ArrayLike, *, charitable: bool = False, machine: Machine = BACKHOE
) -> NDArray:
    """C(q, dq) dq as printed in (2.15): row k is dq^T C_k(q) dq.

    Args:
        q: joint angles, shape (..., 4) [rad].
        dq: joint velocities, shape (..., 4) [rad/s].
        charitable: read A, A^cm, A' with the boom's angle instead of the swing's.
        machine: numbers and angle signs.

    Returns:
        Shape (..., 4), meant as N m.

    Raises:
        ValueError: last axis of q is not 4, or a value is not finite.
    """
    forms = coriolis_forms(q, charitable=charitable, machine=machine)
    return np.einsum("...i,...kij,...j->...k", dq, forms, dq)


def coriolis_forms(
    q: ArrayLike, *, charitable: bool = False, machine: Machine = BACKHOE
) -> NDArray:
    """The four matrices C_1..C_4 as printed in (2.16)-(2.20).

    Args:
        q: joint angles, shape (..., 4) [rad].
        charitable: read A, A^cm, A' with the boom's angle instead of the swing's.
        machine: numbers and angle signs.

    Returns:
        Shape (..., 4, 4, 4): form k, then row and column; meant as kg m^2.

    Raises:
        ValueError: last axis of q is not 4, or a value is not finite.
    """
    s = _symbols(q, machine, charitable)
    printed = {**_c1(s), **_c2(s), **_c34(s)}
    forms = np.zeros((*s.q.shape[:-1], 4, 4, 4))
    for (k, i, j), value in printed.items():
        forms[..., k - 1, i - 1, j - 1] = -value
    return forms


def _c1(s: SimpleNamespace) -> dict:
    half = 0.5 * s.m_bo * s.L_cm2
    c_121 = (
        -s.m_bo * s.L_cm1 * np.sin(s.q2_cm) * (s.A_cm + s.b0 * np.sin(s.q1))
        + s.m_s * (s.L_cm3 * s.B_cm + s.A**2) * (s.L_cm3 * s.B_cm_bar + s.L2 * np.sin(s.q2_cm))
        + s.m_bu
        * (s.L_cm4 * s.C_bar + s.L3 * s.B + s.L2 * np.sin(s.q2))
        * (s.L_cm4 * s.C + s.L3 * s.B + s.A_prime)
    )
    c_131 = s.m_s * s.L_cm3 * s.B_cm_bar * (s.L_cm3 * s.B_cm + s.A_prime) + s.m_bu * (
        s.L_cm4 * s.C_bar + s.L3 * s.B_bar
    ) * (s.L_cm4 * s.C + s.L3 * s.B + s.A_prime)
    return {
        (1, 1, 1): -s.m_bo * s.A_cm * np.cos(s.q1),
        (1, 1, 2): -half * np.sin(s.q1) * np.sin(s.q2_cm),
        (1, 2, 1): c_121,
        (1, 2, 2): -half * np.cos(s.q1) * np.cos(s.q2_cm),
        (1, 3, 1): c_131,
    }


def _c2(s: SimpleNamespace) -> dict:
    half = 0.5 * s.m_bo * s.L_cm2
    stick = s.m_s * s.L_cm3 * s.L2 * np.sin(s.a_stick)
    boom_x, boom_z = s.L2 * np.cos(s.q2), s.L2 * np.sin(s.q2)
    arm_x, arm_z = s.L_cm4 * s.C + s.L3 * s.B, s.L_cm4 * s.C_bar + s.L3 * s.B_bar
    bucket, elbow, far = np.sin(s.a_bucket), np.sin(s.a_elbow), np.sin(s.a_far)
    return {
        (2, 1, 1): -half * np.sin(s.q1) * np.sin(s.q2_cm),
        (2, 2, 1): -half * np.cos(s.q1) * np.cos(s.q2_cm),
        (2, 2, 2): 2 * stick
        + s.m_bu * ((arm_z + boom_z) * (arm_x - boom_x) - (arm_x + boom_x) * (arm_z - boom_z)),
        (2, 2, 3): stick + s.m_bu * s.L3 * (s.L_cm4 * bucket - s.L2 * elbow),
        (2, 2, 4): s.m_bu * s.L_cm3 * (s.L3 * bucket + s.L2 * far),
        (2, 3, 2): stick + s.m_bu * ((arm_z + boom_z) * arm_x - (arm_x + boom_x) * arm_z),
        (2, 3, 3): 0.5 * stick + 0.5 * s.m_bu * s.L3 * (2 * s.L_cm4 * bucket - s.L2 * elbow),
        (2, 3, 4): 0.5 * s.m_bu * s.L_cm3 * (2 * s.L3 * bucket + s.L2 * far),
        (2, 4, 2): s.m_bu * s.L_cm4 * ((arm_z + boom_z) * s.C - (arm_x + boom_x) * s.C_bar),
        (2, 4, 3): 0.5 * s.m_bu * s.L3 * s.L_cm4 * bucket,
        (2, 4, 4): s.m_bu * s.L_cm3 * (s.L3 * bucket + s.L2 * far),
    }


def _c34(s: SimpleNamespace) -> dict:
    c2 = _c2(s)
    c_323 = 2 * s.m_bu * s.L_cm4 * s.L3 * np.sin(s.a_bucket)
    return {
        (3, 2, 2): c2[2, 2, 2],
        (3, 2, 3): c_323,
        (3, 2, 4): c_323 / 2,
        (3, 3, 2): c_323,
        (3, 3, 3): c_323,
        (3, 3, 4): c_323 / 2,
        (3, 4, 2): c2[2, 4, 2],
        (3, 4, 3): c_323 / 2,
        (3, 4, 4): c_323 / 4,
        (4, 2, 2): c2[2, 2, 4],
        (4, 2, 3): c_323,
        (4, 3, 2): c2[2, 3, 4],
        (4, 3, 3): c_323,
        (4, 4, 2): c2[2, 2, 4],
        (4, 4, 3): c_323 / 2,
    }


def _symbols(q: ArrayLike, machine: Machine, charitable: bool) -> SimpleNamespace:
    q = joint_vector(q)
    s = SimpleNamespace(q=q, **_constants(machine))
    _add_angles(s, machine)
    _add_lengths(s, charitable)
    return s


def _constants(machine: Machine) -> dict[str, float]:
    swing, boom, stick, bucket = machine.swing, *machine.links
    return {
        "b0": machine.base.offset,
        "b1": swing.offset,
        "b_cm1": swing.com_radius,
        "L2": boom.length,
        "L3": stick.length,
        "L_cm1": boom.com_radius,
        "L_cm2": boom.com_radius,
        "L_cm3": stick.com_radius,
        "L_cm4": bucket.com_radius,
        "m_t": swing.mass,
        "m_bo": boom.mass,
        "m_s": stick.mass,
        "m_bu": bucket.mass,
        "I_t": swing.inertia,
        "I_bo": boom.inertia,
        "I_s": stick.inertia,
        "I_bu": bucket.inertia,
    }


def _add_angles(s: SimpleNamespace, machine: Machine) -> None:
    boom, stick, bucket = machine.links
    s.q1 = s.q[..., 0] + np.pi / 2
    s.q2, s.q2_cm = s.q[..., 1] + boom.angle_offset, s.q[..., 1] + boom.com_angle
    s.q3, q3_cm = s.q[..., 2] + stick.angle_offset, s.q[..., 2] + stick.com_angle
    s.q4, q4_cm = s.q[..., 3] + bucket.angle_offset, s.q[..., 3] + bucket.com_angle
    s.q23, s.q234 = s.q2 + s.q3, s.q2 + s.q3 + s.q4
    s.q23_cm, s.q234_cm = s.q2 + q3_cm, s.q2 + s.q3 + q4_cm
    s.a_stick = 2 * s.q2 + q3_cm
    s.a_elbow = 2 * s.q2 + s.q3
    s.a_bucket = 2 * s.q2 + 2 * s.q3 + s.q4
    s.a_far = 2 * s.q2 + s.q3 + s.q4


def _add_lengths(s: SimpleNamespace, charitable: bool) -> None:
    star, cm = (s.q2, s.q2_cm) if charitable else (s.q1, s.q1)
    s.A = s.L_cm2 * np.cos(star) + s.b1
    s.A_cm = s.L_cm2 * np.cos(cm) + s.b1
    s.A_prime = s.L2 * np.cos(star) + s.b1
    s.B, s.B_bar = np.cos(s.q23), np.sin(s.q23)
    s.B_cm, s.B_cm_bar = np.cos(s.q23_cm), np.sin(s.q23_cm)
    s.C, s.C_bar = np.cos(s.q234_cm), np.sin(s.q234_cm)
    s.height_bar = s.L_cm4 * s.C_bar + s.L3 * s.B + s.L2 * np.sin(s.q2)
    s.reach_bar = s.L_cm4 * s.C + s.L3 * s.B + s.L2 * np.cos(s.q2)


def _mirror(M: NDArray) -> NDArray:
    upper = np.triu(M, 1)
    return M + np.swapaxes(upper, -1, -2)
