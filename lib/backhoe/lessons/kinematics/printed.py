"""The thesis's kinematics exactly as printed: A.15, A.17, A.18, (2.3) to (2.5), (2.8), (2.10), and
the angles of Table A.1. Not for use.

Lesson 01 tests these formulas and finds which entries are wrong; `backhoe.arm.kinematics` has the
right ones. Lengths and the signs of the angle offsets come from the machine. What the print leaves
open is read so:

- theta_cm1 (in q1^cm of J_L1) is not in Table A.2; q1^cm is taken as q1*;
- q23^cm3 is taken as q2* + q3^cm, the direction of the stick's centre of mass;
- ^nT_0 in (2.3) is what the indices of (2.2) make of it: frame 0 seen from frame n;
- theta in (2.8) is an angle of its own that nothing changes, in (2.10) the heading psi.

Reference: Mastalli 2013, sections 2.1, 2.2 and Appendix A.2.1.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.kinematics import forward_kinematics, joint_vector
from backhoe.lessons import published
from backhoe.machine import BACKHOE, Machine

__all__ = [
    "angle_offsets",
    "angular_jacobians",
    "inverse_24",
    "inverse_25",
    "linear_jacobians",
    "link_transforms",
    "pose_23",
    "rates_28",
    "track_matrix",
]


def angle_offsets() -> tuple[NDArray, NDArray]:
    """What boom, stick and bucket add to q2, q3, q4: Table A.1, and q_i^cm below (A.22).

    Returns:
        q* - q of the links and q^cm - q of their centres of mass, shape (3,) each [rad].
    """
    rows = published.load("mastalli_2013_table_a1")["rows"]
    angles = published.load("mastalli_2013_table_a2")["angles_deg"]
    links = [rows[i]["constant_deg"] + angles[f"theta_{i}"] for i in (2, 3, 4)]
    return np.radians(links), np.radians([angles[f"theta_cm{i}"] for i in (2, 3, 4)])


def link_transforms(q: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """T_0^1 to T_0^4 as printed in (A.15).

    Args:
        q: joint angles swing, boom, stick, bucket, shape (..., 4) [rad].
        machine: lengths [m] and angle offsets [rad].

    Returns:
        Shape (..., 4, 4, 4): matrix, row, column; the last column in m.

    Raises:
        ValueError: last axis of q is not 4, or a value is not finite.
    """
    s = _symbols(q, machine)
    o, one = np.zeros_like(s.c1), np.ones_like(s.c1)
    x1, y1, z1 = s.b1 * s.c1 + s.b0, s.b1 * s.s1, o + s.L1 + s.L0
    r2 = s.L2 * s.c2 + s.b1
    x2, y2, z2 = s.c1 * r2 + s.b0, s.s1 * r2, s.L2 * s.s2 + s.L1 + s.L0
    r3 = s.L3 * s.c23 + r2
    x3, y3 = s.c1 * r3 + s.b0, s.s1 * r3
    z3 = s.L3 * s.s23 + s.L2 * s.s2 + s.L1 + s.L0
    x4, y4 = s.L4 * s.c1 * s.c234 + x3, s.L4 * s.s1 * s.c234 + y3
    z4 = s.L4 * s.s234 + z3
    last = [o, o, o, one]
    return _matrices(
        [[s.c1, o, s.s1, x1], [s.s1, o, -s.c1, y1], [o, one, o, z1], last],
        [
            [s.c1 * s.c2, -s.c1 * s.s2, s.s1, x2],
            [s.s1 * s.c2, -s.s1 * s.s2, -s.c1, y2],
            [s.s2, s.c2, o, z2],
            last,
        ],
        [
            [s.c1 * s.c23, s.c1 * s.s23, s.sin_q1, x3],
            [s.s1 * s.c23, -s.s1 * s.s23, -s.cos_q1, y3],
            [s.s23, s.s23, o, z3],
            last,
        ],
        [
            [s.c1 * s.c234, -s.c1 * s.s234, s.sin_q1, x4],
            [s.s1 * s.c234, -s.s1 * s.s234, -s.cos_q1, y4],
            [s.s234, s.c234, o, z4],
            last,
        ],
    )


def linear_jacobians(q: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """J_L1 to J_L4 as printed in (A.17), with its footnotes 2 to 4.

    Arguments and errors: as for `link_transforms`.

    Returns:
        Shape (..., 4, 3, 4): matrix, row, column; meant as [m/rad].
    """
    s = _symbols(q, machine)
    o = np.zeros_like(s.c1)
    c2, s2, c3, s3 = s.cos_q2_cm, s.sin_q2_cm, s.cos_q23_cm, s.sin_q23_cm
    reach = s.L3 * c3 + s.L2 * s.c2 + s.b1
    rise = s.L3 * s3 + s.L2 * s.s2
    J3 = [
        [-s.s1 * reach, -s.c1 * rise, -s.L3 * s.c1 * s3, o],
        [s.c1 * reach, -s.s1 * rise, -s.L3 * s.s1 * s3, o],
        [o, s.L3 * c3 + s.L2 * s.c2, s.L3 * c3, o],
    ]
    x, y, z = s.L4 * s.c1 * s.s234, s.L4 * s.s1 * s.s234, s.L4 * s.c234
    return _matrices(
        [[-s.b1 * s.s1, o, o, o], [s.b1 * s.c1, o, o, o], [o, o, o, o]],
        [
            [-s.s1 * (s.L2 * c2 + s.b1) + s.b0, -s.L2 * s.c1 * s2, o, o],
            [s.c1 * (s.L2 * c2 + s.b1), -s.L2 * s.s1 * s2, o, o],
            [o, s.L2 * c2, o, o],
        ],
        J3,
        [
            [-s.L4 * s.s1 * s.c234 + J3[0][0], -x + J3[0][1], -x + J3[0][2], -x],
            [s.L4 * s.c1 * s.c234 + J3[1][0], -y + J3[1][1], -y + J3[1][2], -y],
            [o, z + J3[2][1], z + J3[2][2], z],
        ],
    )


def angular_jacobians(q: ArrayLike) -> NDArray:
    """J_w1 to J_w4 as printed in (A.18).

    Arguments and errors: as for `link_transforms`.

    Returns:
        Shape (..., 4, 3, 4): matrix, row, column [1].
    """
    s = _symbols(q, BACKHOE)
    o, one = np.zeros_like(s.c1), np.ones_like(s.c1)
    return _matrices(
        [[o, o, o, o], [o, o, o, o], [one, o, o, o]],
        [[o, s.s1, o, o], [o, -s.c1, o, o], [one, o, o, o]],
        [[o, s.s1, o, o], [o, -s.c1, o, o], [one, o, one, o]],
        [[o, s.s1, o, o], [o, -s.c1, o, o], [one, o, one, one]],
    )


def pose_23(q: ArrayLike) -> NDArray:
    """^nT_0 of (2.3), which the thesis calls the pose with respect to the base.

    Arguments and errors: as for `link_transforms`.

    Returns:
        Transform from the base frame to that of the teeth, shape (..., 4, 4); lengths in m.
    """
    return np.linalg.inv(forward_kinematics(q))


def inverse_24(J: ArrayLike, damping: float) -> NDArray:
    """(J + lambda^2 I)^-1, the inverse of (2.4).

    Args:
        J: square Jacobian, shape (..., n, n) [m/rad].
        damping: lambda, whose square is printed as if it were a J.

    Returns:
        Shape (..., n, n) [rad/m].

    Raises:
        ValueError: J is not square, so that the printed sum is not defined.
        numpy.linalg.LinAlgError: the sum is singular, which its damping was meant to prevent.
    """
    J = _square(J)
    return np.linalg.inv(J + damping**2 * np.eye(J.shape[-1]))


def inverse_25(J: ArrayLike, damping: float) -> NDArray:
    """V (D + lambda^2 I)^-1 U^T, the middle of (2.5).

    Arguments, returns and ValueError: as for `inverse_24`.
    """
    U, sigma, Vt = np.linalg.svd(_square(J))
    V, Ut = np.swapaxes(Vt, -1, -2), np.swapaxes(U, -1, -2)
    return (V / (sigma + damping**2)[..., None, :]) @ Ut


def rates_28(twist: ArrayLike, heading: ArrayLike, theta: ArrayLike = 0.0) -> NDArray:
    """(2.8), whose matrix turns by theta what turns psi.

    Args:
        twist: v and omega, shape (..., 2) [m/s, rad/s].
        heading: psi [rad], which (2.8) does not use.
        theta: shape (...) [rad].

    Returns:
        dx, dy, dpsi, shape (..., 3) [m/s, m/s, rad/s].
    """
    v, omega = np.moveaxis(np.asarray(twist, dtype=float), -1, 0)
    return np.stack((v * np.cos(theta), v * np.sin(theta), omega), axis=-1)


def track_matrix(heading: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """The matrix of (2.10), from sprocket speeds (right, left) to (dx, dy, dpsi).

    Args:
        heading: psi, shape (...) [rad].
        machine: sprocket radius r and gauge l of the tracks [m].

    Returns:
        Shape (..., 3, 2).
    """
    heading = np.asarray(heading, dtype=float)
    r, gauge = machine.tracks.sprocket_radius, machine.tracks.gauge
    x, y = np.cos(heading) / (2 * r), np.sin(heading) / (2 * r)
    turn = np.full_like(x, 1 / (r * gauge))
    return _matrix([[x, -x], [y, -y], [turn, -turn]])


def _symbols(q: ArrayLike, machine: Machine) -> SimpleNamespace:
    """The thesis's symbols at q: c1 = cos q1*, s23 = sin q23*, and so on."""
    q1, *rest = np.moveaxis(joint_vector(q), -1, 0)
    boom, stick, bucket = machine.links
    offsets = [link.angle_offset for link in machine.links]
    q2, q3, q4 = (angle + offset for angle, offset in zip(rest, offsets, strict=True))
    q1_star, q23, q234 = q1 + np.pi / 2, q2 + q3, q2 + q3 + q4
    q2_cm, q23_cm = rest[0] + boom.com_angle, q2 + rest[1] + stick.com_angle
    s = SimpleNamespace(b0=machine.base.offset, b1=machine.swing.offset)
    s.L0, s.L1 = machine.base.height, machine.swing.height
    s.L2, s.L3, s.L4 = boom.length, stick.length, bucket.length
    s.c1, s.s1 = np.cos(q1_star), np.sin(q1_star)
    s.c2, s.s2 = np.cos(q2), np.sin(q2)
    s.c23, s.s23 = np.cos(q23), np.sin(q23)
    s.c234, s.s234 = np.cos(q234), np.sin(q234)
    s.cos_q1, s.sin_q1 = np.cos(q1), np.sin(q1)
    s.cos_q2_cm, s.sin_q2_cm = np.cos(q2_cm), np.sin(q2_cm)
    s.cos_q23_cm, s.sin_q23_cm = np.cos(q23_cm), np.sin(q23_cm)
    return s


def _matrix(rows: list) -> NDArray:
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _matrices(*matrices: list) -> NDArray:
    return np.stack([_matrix(rows) for rows in matrices], axis=-3)


def _square(J: ArrayLike) -> NDArray:
    J = np.asarray(J, dtype=float)
    if J.ndim < 2 or J.shape[-1] != J.shape[-2]:
        raise ValueError(
            f"J must be square, got shape {J.shape}: J + lambda^2 I is not defined otherwise"
        )
    return J
