"""The terms of the arm's equation of motion, each written once, for numbers and for arrays alike.

Boom, stick and bucket move in one vertical plane with coordinates (r, z), r outwards from the swing
axis. Five vectors in that plane hold all that a posture changes: l2 and l3 run along boom and stick
from joint to joint, c2, c3 and c4 from a link's joint to its centre of mass.

Every function takes floats (one posture), arrays (many) or is compiled for long batches
(`engine`): there is arithmetic here and nothing else.
"""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

from backhoe.machine import Machine


class Arm(NamedTuple):
    """The machine's numbers in the letters of Tables A.1 and A.2.

    `z1` is the height of the boom's joint, `o2` to `o4` are the angle offsets; (along, across) is
    where a centre of mass lies in the frame of its link; `I_yaw` is the part of M11 that no posture
    changes. The bucket's mass stands last: a load only adds to that.
    """

    g: float
    b1: float
    z1: float
    L2: float
    L3: float
    o2: float
    o3: float
    o4: float
    along2: float
    across2: float
    along3: float
    across3: float
    along4: float
    across4: float
    m_bo: float
    m_s: float
    I_yaw: float
    I_bo: float
    I_s: float
    I_bu: float
    m_bu: float


class Vectors(NamedTuple):
    """The five vectors of a posture in the plane (r, z) [m]."""

    l2r: float
    l2z: float
    l3r: float
    l3z: float
    c2r: float
    c2z: float
    c3r: float
    c3z: float
    c4r: float
    c4z: float


def arm_of(machine: Machine) -> Arm:
    """What the equation of motion needs of a machine."""
    swing, boom, stick, bucket = machine.swing, machine.boom, machine.stick, machine.bucket
    bend2 = boom.com_angle - boom.angle_offset
    bend3 = stick.com_angle - stick.angle_offset
    bend4 = bucket.com_angle - bucket.angle_offset
    return Arm(
        machine.gravity,
        swing.offset,
        machine.base.height + swing.height,
        boom.length,
        stick.length,
        boom.angle_offset,
        stick.angle_offset,
        bucket.angle_offset,
        boom.com_radius * cos(bend2),
        boom.com_radius * sin(bend2),
        stick.com_radius * cos(bend3),
        stick.com_radius * sin(bend3),
        bucket.com_radius * cos(bend4),
        bucket.com_radius * sin(bend4),
        boom.mass,
        stick.mass,
        swing.inertia
        + boom.inertia
        + stick.inertia
        + bucket.inertia
        + swing.mass * swing.com_radius**2,
        boom.inertia,
        stick.inertia,
        bucket.inertia,
        bucket.mass,
    )


def vectors(arm, cos2, sin2, cos3, sin3, cos4, sin4) -> Vectors:
    """The five vectors from the cosines and sines of the links' pitch angles."""
    return Vectors(
        arm.L2 * cos2,
        arm.L2 * sin2,
        arm.L3 * cos3,
        arm.L3 * sin3,
        arm.along2 * cos2 - arm.across2 * sin2,
        arm.along2 * sin2 + arm.across2 * cos2,
        arm.along3 * cos3 - arm.across3 * sin3,
        arm.along3 * sin3 + arm.across3 * cos3,
        arm.along4 * cos4 - arm.across4 * sin4,
        arm.along4 * sin4 + arm.across4 * cos4,
    )


def inertias(arm, v):
    """M11, M22, M23, M24, M33, M34, M44: all entries of M that are not zero.

    An entry of M is the sum over the masses of m dp/dq_i . dp/dq_j, and what turns. Source:
    Mastalli 2013, eqs. (2.14) and (A.22), corrected.
    """
    r2 = arm.b1 + v.c2r
    r3 = arm.b1 + v.l2r + v.c3r
    r4 = arm.b1 + v.l2r + v.l3r + v.c4r
    M11 = arm.I_yaw + arm.m_bo * r2 * r2 + arm.m_s * r3 * r3 + arm.m_bu * r4 * r4

    l2_c4 = arm.m_bu * (v.l2r * v.c4r + v.l2z * v.c4z)
    l3_c4 = arm.m_bu * (v.l3r * v.c4r + v.l3z * v.c4z)
    l2_l3 = arm.m_s * (v.l2r * v.c3r + v.l2z * v.c3z) + arm.m_bu * (v.l2r * v.l3r + v.l2z * v.l3z)
    J2 = arm.m_bo * (arm.along2**2 + arm.across2**2) + (arm.m_s + arm.m_bu) * arm.L2**2 + arm.I_bo
    J3 = arm.m_s * (arm.along3**2 + arm.across3**2) + arm.m_bu * arm.L3**2 + arm.I_s
    M44 = arm.m_bu * (arm.along4**2 + arm.across4**2) + arm.I_bu
    M34 = M44 + l3_c4
    M24 = M34 + l2_c4
    M33 = J3 + M34 + l3_c4
    M23 = M33 + l2_l3 + l2_c4
    M22 = J2 + M23 + l2_l3 + l2_c4
    return M11, M22, M23, M24, M33, M34, M44


def inertia_slopes(arm, v):
    """Derivatives of M11 by q2, q3, q4, and of the three mixed terms of `inertias` by their bend.

    Returns:
        dM11/dq2, dM11/dq3, dM11/dq4, then l2_l3 by q3, l2_c4 by q3 or q4, l3_c4 by q4.
    """
    r2 = arm.b1 + v.c2r
    r3 = arm.b1 + v.l2r + v.c3r
    r4 = arm.b1 + v.l2r + v.l3r + v.c4r
    by_q4 = -2 * arm.m_bu * r4 * v.c4z
    by_q3 = by_q4 - 2 * (arm.m_bu * r4 * v.l3z + arm.m_s * r3 * v.c3z)
    by_q2 = by_q3 - 2 * ((arm.m_bu * r4 + arm.m_s * r3) * v.l2z + arm.m_bo * r2 * v.c2z)
    l2_l3 = arm.m_s * (v.l2z * v.c3r - v.l2r * v.c3z) + arm.m_bu * (v.l2z * v.l3r - v.l2r * v.l3z)
    l2_c4 = arm.m_bu * (v.l2z * v.c4r - v.l2r * v.c4z)
    l3_c4 = arm.m_bu * (v.l3z * v.c4r - v.l3r * v.c4z)
    return by_q2, by_q3, by_q4, l2_l3, l2_c4, l3_c4


def mass_height(arm, v):
    """Sum of mass times height above the ground over boom, stick and bucket [kg m]."""
    return (
        (arm.m_bo + arm.m_s + arm.m_bu) * arm.z1
        + arm.m_bo * v.c2z
        + arm.m_s * (v.l2z + v.c3z)
        + arm.m_bu * (v.l2z + v.l3z + v.c4z)
    )


def gravity_torques(arm, v):
    """g2, g3, g4: the weights times their horizontal lever arms (2.21, corrected)."""
    g4 = arm.g * arm.m_bu * v.c4r
    g3 = g4 + arm.g * (arm.m_s * v.c3r + arm.m_bu * v.l3r)
    g2 = g3 + arm.g * (arm.m_bo * v.c2r + (arm.m_s + arm.m_bu) * v.l2r)
    return g2, g3, g4


def newton_euler(arm, v, dq1, dq2, dq3, dq4, ddq1, ddq2, ddq3, ddq4):
    """The four joint torques of a motion: accelerations outwards, then forces inwards.

    Gravity enters as an upward acceleration g of the base; a link that turns at w and dw gives a
    vector (r, z) in it the acceleration (-dw z - w w r, dw r - w w z).
    """
    w2, dw2 = dq2, ddq2
    w3, dw3 = w2 + dq3, dw2 + ddq3
    w4, dw4 = w3 + dq4, dw3 + ddq4
    w2w2, w3w3, w4w4, w1w1 = w2 * w2, w3 * w3, w4 * w4, dq1 * dq1

    stick_r, stick_z = -dw2 * v.l2z - w2w2 * v.l2r, arm.g + dw2 * v.l2r - w2w2 * v.l2z
    bucket_r, bucket_z = stick_r - dw3 * v.l3z - w3w3 * v.l3r, stick_z + dw3 * v.l3r - w3w3 * v.l3z
    r2 = arm.b1 + v.c2r
    r3 = arm.b1 + v.l2r + v.c3r
    r4 = arm.b1 + v.l2r + v.l3r + v.c4r
    F2r = arm.m_bo * (-dw2 * v.c2z - w2w2 * v.c2r - w1w1 * r2)
    F2z = arm.m_bo * (arm.g + dw2 * v.c2r - w2w2 * v.c2z)
    F3r = arm.m_s * (stick_r - dw3 * v.c3z - w3w3 * v.c3r - w1w1 * r3)
    F3z = arm.m_s * (stick_z + dw3 * v.c3r - w3w3 * v.c3z)
    F4r = arm.m_bu * (bucket_r - dw4 * v.c4z - w4w4 * v.c4r - w1w1 * r4)
    F4z = arm.m_bu * (bucket_z + dw4 * v.c4r - w4w4 * v.c4z)

    tau4 = arm.I_bu * dw4 + v.c4r * F4z - v.c4z * F4r
    tau3 = tau4 + arm.I_s * dw3 + v.c3r * F3z - v.c3z * F3r + v.l3r * F4z - v.l3z * F4r
    tau2 = tau3 + arm.I_bo * dw2 + v.c2r * F2z - v.c2z * F2r
    tau2 = tau2 + v.l2r * (F3z + F4z) - v.l2z * (F3r + F4r)

    dr2, dr3 = -w2 * v.c2z, -w2 * v.l2z - w3 * v.c3z
    dr4 = -w2 * v.l2z - w3 * v.l3z - w4 * v.c4z
    mr2, mr3, mr4 = arm.m_bo * r2, arm.m_s * r3, arm.m_bu * r4
    M11 = arm.I_yaw + mr2 * r2 + mr3 * r3 + mr4 * r4
    tau1 = M11 * ddq1 + 2 * dq1 * (mr2 * dr2 + mr3 * dr3 + mr4 * dr4)
    return tau1, tau2, tau3, tau4


def solve_inertias(M, b1, b2, b3, b4):
    """Solve M a = b: the swing by itself, the rest by elimination from the bucket inwards."""
    M11, M22, M23, M24, M33, M34, M44 = M
    by_M44_2, by_M44_3 = M24 / M44, M34 / M44
    S22, S23, s2 = M22 - by_M44_2 * M24, M23 - by_M44_2 * M34, b2 - by_M44_2 * b4
    S33, s3 = M33 - by_M44_3 * M34, b3 - by_M44_3 * b4
    by_S33 = S23 / S33
    a2 = (s2 - by_S33 * s3) / (S22 - by_S33 * S23)
    a3 = (s3 - S23 * a2) / S33
    a4 = (b4 - M24 * a2 - M34 * a3) / M44
    return b1 / M11, a2, a3, a4
