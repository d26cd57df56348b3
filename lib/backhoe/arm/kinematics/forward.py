"""Forward kinematics of the arm: the pose of every frame, and the geometric Jacobian.

The base frame is the machine's own: origin on the ground between the tracks, x forward, y left,
z up. Every frame follows from Table A.1 of Mastalli 2013 in the reading of `machine`. At q = 0 the
arm points left; the swing at -90 degrees points it forward.

Boom, stick and bucket always stay in one vertical plane, so a pose is found in two steps: the
point (r, z) in the plane of the arm, r outwards from the swing axis, and then the swing that turns
the plane. The pitch of a link is its angle above the horizontal, seen outwards.
"""

from __future__ import annotations

import math
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, numbers
from backhoe.machine import BACKHOE, JOINTS, Machine

FRAMES = ("swing", "boom", "stick", "tip", "swing_com", "boom_com", "stick_com", "bucket_com")

_MEANING = f"joints ({', '.join(JOINTS)})"


class _Point(NamedTuple):
    """A frame in the arm's plane: where it is [m], its pitch and the cosine and sine of that."""

    r: NDArray | float
    z: NDArray | float
    cos: NDArray | float
    sin: NDArray | float


def joint_vector(q: ArrayLike, name: str = "q") -> NDArray:
    """`q` as an array of floats with one value a joint, checked.

    Args:
        q: one value a joint (swing, boom, stick, bucket) of any unit, shape (..., 4).
        name: what the error message calls it.

    Returns:
        The same numbers, shape (..., 4), not copied when they are an array of floats already.

    Raises:
        ValueError: the last axis is not 4, or a value is not a finite number.
    """
    return numbers(q, name, (..., 4), meaning=_MEANING)


def leading_shape(*vectors: NDArray) -> tuple[int, ...]:
    """The leading axes that arrays share once those of length 1 or missing are repeated.

    Raises:
        ValueError: the leading axes do not fit each other.
    """
    try:
        return np.broadcast_shapes(*(vector.shape[:-1] for vector in vectors))
    except ValueError as error:
        shapes = ", ".join(str(vector.shape) for vector in vectors)
        raise ValueError(f"the leading axes must fit each other, got shapes {shapes}") from error


def dh_transform(theta: ArrayLike, d: ArrayLike, a: ArrayLike, alpha: ArrayLike) -> NDArray:
    """Transform of one Denavit-Hartenberg row: turn theta, lift d, go a, twist alpha.

    Source: Mastalli 2013, the convention of Table A.1 and eq. (A.15).

    Args:
        theta: angle about the old z axis, shape (...) [rad].
        d: displacement along the old z axis, shape (...) [m].
        a: displacement along the new x axis, shape (...) [m].
        alpha: angle about the new x axis, shape (...) [rad].

    Returns:
        T = Rot_z(theta) Trans_z(d) Trans_x(a) Rot_x(alpha), shape (..., 4, 4).

    Raises:
        ValueError: a value is not a finite number, or the shapes do not fit each other.
    """
    row = {"theta": theta, "d": d, "a": a, "alpha": alpha}
    checked = [numbers(value, name) for name, value in row.items()]
    theta, d, a, alpha = np.broadcast_arrays(*checked)
    T = np.zeros((*theta.shape, 4, 4))
    T[..., 0, 0] = np.cos(theta)
    T[..., 0, 1] = -np.sin(theta) * np.cos(alpha)
    T[..., 0, 2] = np.sin(theta) * np.sin(alpha)
    T[..., 0, 3] = a * np.cos(theta)
    T[..., 1, 0] = np.sin(theta)
    T[..., 1, 1] = np.cos(theta) * np.cos(alpha)
    T[..., 1, 2] = -np.cos(theta) * np.sin(alpha)
    T[..., 1, 3] = a * np.sin(theta)
    T[..., 2, 1] = np.sin(alpha)
    T[..., 2, 2] = np.cos(alpha)
    T[..., 2, 3] = d
    T[..., 3, 3] = 1.0
    return T


def link_transforms(q: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """Poses T_01, T_02, T_03 and T_04 of the frames "swing", "boom", "stick" and "tip".

    Source: Mastalli 2013, eqs. (2.2) and (A.15), the latter with its misprints corrected.

    Args:
        q: joint angles swing, boom, stick, bucket, shape (..., 4) [rad].

    Returns:
        Transforms from each frame to the base frame, shape (..., 4, 4, 4): the first of the last
        three axes counts the frames.

    Raises:
        ValueError: the last axis is not 4, or a value is not finite.
    """
    q = joint_vector(q)
    cos_swing, sin_swing = _swing_direction(q)
    joints = _joints_in_plane(q, machine)
    T = np.empty((*q.shape[:-1], 4, 4, 4))
    for index, point in enumerate(joints):
        _write_pose(T[..., index, :, :], cos_swing, sin_swing, point, machine)
    return T


def forward_kinematics(q: ArrayLike, frame: str = "tip", machine: Machine = BACKHOE) -> NDArray:
    """Pose of a frame in the base frame.

    Source: Mastalli 2013, eq. (2.2) with Table A.1.

    Args:
        q: joint angles swing, boom, stick, bucket, shape (..., 4) [rad].
        frame: "swing" (at the boom's joint), "boom" (at its tip, the stick's joint), "stick" (at
            its tip, the bucket's joint), "tip" (the bucket's teeth), or a centre of mass with the
            axes of its link: "swing_com", "boom_com", "stick_com", "bucket_com".

    Returns:
        Transform from the frame to the base frame, shape (..., 4, 4); lengths in m.

    Raises:
        ValueError: the last axis is not 4, a value is not finite, or the frame is unknown.
    """
    q = joint_vector(q)
    link = _link_of(frame)
    cos_swing, sin_swing = _swing_direction(q)
    T = np.empty((*q.shape[:-1], 4, 4))
    joints = _joints_in_plane(q, machine)
    _write_pose(T, cos_swing, sin_swing, joints[link], machine)
    if frame.endswith("_com"):
        T[..., :3, 3] = np.stack(_com_position(q, link, joints, machine), axis=-1)
    return T


def jacobian(q: ArrayLike, frame: str = "tip", machine: Machine = BACKHOE) -> NDArray:
    """Geometric Jacobian of a frame's origin, in the base frame.

    Source: Mastalli 2013, eqs. (A.16) to (A.18), with (A.17) and the third and fourth column of
    (A.18) corrected.

    Args:
        q: joint angles swing, boom, stick, bucket, shape (..., 4) [rad].
        frame: as for `forward_kinematics`.

    Returns:
        J with (v, omega) = J @ dq, linear rows first, shape (..., 6, 4) [m/rad and 1].

    Raises:
        ValueError: the last axis is not 4, a value is not finite, or the frame is unknown.
    """
    q = joint_vector(q)
    link = _link_of(frame)
    cos_swing, sin_swing = _swing_direction(q)
    joints = _joints_in_plane(q, machine)
    if frame.endswith("_com"):
        x, y, z = _com_position(q, link, joints, machine)
    else:
        x = machine.base.offset + joints[link].r * cos_swing
        y = joints[link].r * sin_swing
        z = joints[link].z
    J = np.zeros((*q.shape[:-1], 6, 4))
    J[..., 0, 0] = -y
    J[..., 1, 0] = x - machine.base.offset
    J[..., 5, 0] = 1.0
    r = (x - machine.base.offset) * cos_swing + y * sin_swing
    for column in range(1, link + 1):
        hinge = joints[column - 1]
        J[..., 0, column] = -(z - hinge.z) * cos_swing
        J[..., 1, column] = -(z - hinge.z) * sin_swing
        J[..., 2, column] = r - hinge.r
        J[..., 3, column] = sin_swing
        J[..., 4, column] = -cos_swing
    return J


def pose(q: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """Where the stick's tip is, and how far the bucket is turned on it: the x of the thesis.

    Source: Mastalli 2013, section 2.1.1.

    Args:
        q: joint angles swing, boom, stick, bucket, shape (..., 4) [rad].

    Returns:
        x, y, z of the stick's tip in the base frame [m] and the bucket's joint angle [rad], shape
        (..., 4): what `inverse_kinematics` takes.

    Raises:
        ValueError: the last axis is not 4, or a value is not finite.
    """
    q = joint_vector(q)
    cos_swing, sin_swing = _swing_direction(q)
    stick_tip = _joints_in_plane(q, machine)[2]
    x = np.empty(q.shape)
    x[..., 0] = machine.base.offset + stick_tip.r * cos_swing
    x[..., 1] = stick_tip.r * sin_swing
    x[..., 2] = stick_tip.z
    x[..., 3] = q[..., 3]
    return x


def _link_of(frame: str) -> int:
    return FRAMES.index(choice(frame, "frame", FRAMES)) % 4


def _swing_direction(q: NDArray) -> tuple:
    """Cosine and sine of the direction of the arm, q1* = q1 + pi/2."""
    if q.ndim == 1:
        return -math.sin(q[0]), math.cos(q[0])
    return -np.sin(q[..., 0]), np.cos(q[..., 0])


def _joints_in_plane(q: NDArray, machine: Machine) -> list[_Point]:
    """The boom's, stick's and bucket's joint and the bucket's tip in the plane of the arm."""
    if q.ndim == 1:
        angles, cos, sin = q.tolist(), math.cos, math.sin
    else:
        angles, cos, sin = np.moveaxis(q, -1, 0), np.cos, np.sin
    r, z = machine.swing.offset, machine.base.height + machine.swing.height
    pitch = 0.0
    joints = [_Point(r, z, 1.0, 0.0)]
    for link, angle in zip(machine.links, angles[1:], strict=True):
        pitch = pitch + (angle + link.angle_offset)
        c, s = cos(pitch), sin(pitch)
        r, z = r + link.length * c, z + link.length * s
        joints.append(_Point(r, z, c, s))
    return joints


def _com_position(q: NDArray, link: int, joints: list[_Point], machine: Machine) -> tuple:
    """x, y, z of the centre of mass of a link (0 is the house) in the base frame."""
    cos_swing, sin_swing = _swing_direction(q)
    x0 = machine.base.offset
    if link == 0:
        swing = machine.swing
        direction = q[..., 0] + pi / 2 + swing.com_angle
        x = x0 + swing.com_radius * np.cos(direction)
        y = swing.com_radius * np.sin(direction)
        return x, y, np.full_like(x, machine.base.height + swing.com_height)
    hinge, outer, body = joints[link - 1], joints[link], machine.links[link - 1]
    bend = body.com_angle - body.angle_offset
    along, across = body.com_radius * math.cos(bend), body.com_radius * math.sin(bend)
    r = hinge.r + along * outer.cos - across * outer.sin
    z = hinge.z + along * outer.sin + across * outer.cos
    return x0 + r * cos_swing, r * sin_swing, z


def _write_pose(
    T: NDArray, cos_swing: ArrayLike, sin_swing: ArrayLike, point: _Point, machine: Machine
) -> None:
    """Fill T with the pose of a frame of the arm: x along the link, z across the arm's plane."""
    T[..., 0, 0] = cos_swing * point.cos
    T[..., 0, 1] = -cos_swing * point.sin
    T[..., 0, 2] = sin_swing
    T[..., 0, 3] = machine.base.offset + point.r * cos_swing
    T[..., 1, 0] = sin_swing * point.cos
    T[..., 1, 1] = -sin_swing * point.sin
    T[..., 1, 2] = -cos_swing
    T[..., 1, 3] = point.r * sin_swing
    T[..., 2, 0] = point.sin
    T[..., 2, 1] = point.cos
    T[..., 2, 2] = 0.0
    T[..., 2, 3] = point.z
    T[..., 3, :3] = 0.0
    T[..., 3, 3] = 1.0
