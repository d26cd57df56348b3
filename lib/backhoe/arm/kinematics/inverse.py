"""Inverse kinematics of the arm in closed form.

The swing angle follows from the direction of the target. What is left is a triangle in the plane of
the arm: boom, stick, and the line from the boom's joint to the target; the law of cosines gives the
stick's angle up to its sign, the elbow. Conventions as in `forward`.

A solution may pass a joint limit by 1e-9 rad, so that a pose at the limit survives rounding.
"""

from __future__ import annotations

from math import cos, degrees, hypot, pi, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, numbers
from backhoe.basics.tiles import for_each_tile
from backhoe.machine import BACKHOE, JOINTS, Machine

TARGET = "values (x, y, z, angle)"
"""What a target must be, for errors."""

_ELBOWS = {"up": -1.0, "down": 1.0}
_FAILURES = ("raise", "nan")
_LIMIT_ROUNDING = 1e-9
_STRETCH_ROUNDING = 1e-12
_ON_AXIS = 1e-9
_TILE = 16384


def inverse_kinematics(
    target: ArrayLike,
    elbow: str = "up",
    machine: Machine = BACKHOE,
    limits: bool | None = None,
    on_failure: str = "raise",
) -> NDArray:
    """Joint angles that bring the stick's tip to a point, with the bucket's joint given.

    Source: ours; the thesis iterates with the Jacobian (eq. 2.4, see `solve_damped`). The target is
    the x of its section 2.1.1.

    Args:
        target: x, y, z of the stick's tip in the base frame [m] and the bucket's joint angle [rad],
            shape (..., 4).
        elbow: "up" puts the stick's joint above the line from the boom's joint to the target,
            "down" below it.
        limits: whether a solution outside the joint limits is a failure. By default it is, unless
            the stick of this machine can never bend to this side: then the answer is geometry, not
            a posture to drive to. `BACKHOE` never has its elbow down.
        on_failure: "raise", or "nan" to get NaN in all four joints where there is no solution: what
            a map of the workspace needs.

    Returns:
        Joint angles swing, boom, stick, bucket, shape (..., 4) [rad]; the first three in (-pi, pi].

    Raises:
        ValueError: the last axis is not 4, a value is not finite, elbow or on_failure is unknown;
            and unless on_failure is "nan": a target is out of reach, on the swing axis, or outside
            a joint's limits.
    """
    target = numbers(target, "target", (..., 4), meaning=TARGET)
    bend = _ELBOWS[choice(elbow, "elbow", _ELBOWS)]
    choice(on_failure, "on_failure", _FAILURES)
    if limits is None:
        limits = _can_bend(bend, machine)
    targets = target.reshape(-1, 4)
    q = np.empty_like(targets)
    solved = np.empty(len(targets), dtype=bool)

    def solve_tile(tile: slice) -> None:
        with np.errstate(invalid="ignore"):
            angles = _angles_to(np.ascontiguousarray(targets[tile].T), bend, machine)
            for joint, angle in enumerate(angles):
                q[tile, joint] = angle
            solved[tile] = _within(angles, machine) if limits else np.isfinite(angles[1])

    for_each_tile(solve_tile, len(targets), _TILE)
    if not solved.all():
        failed = np.flatnonzero(~solved)
        if on_failure == "raise":
            first = failed[0]
            reason = _reason(targets[first], q[first], machine)
            raise ValueError(_located(reason, first, len(failed), target.shape[:-1]))
        q[failed] = np.nan
    return q.reshape(target.shape)


def _angles_to(target: NDArray, bend: float, machine: Machine) -> tuple:
    """The solution for one tile, target (4, n); four angles (n,), NaN out of reach."""
    x, y, z, bucket = target
    swing, r = _swing_to(x, y, machine)
    return swing, *_boom_and_stick_to(r, z, bend, machine), bucket


def _swing_to(x: NDArray, y: NDArray, machine: Machine) -> tuple[NDArray, NDArray]:
    """Swing angle that faces a point, and the point's distance from the swing axis."""
    back = machine.base.offset - x
    r = np.sqrt(back * back + y * y)
    swing = _angle(back, y, r)
    _replace(swing, swing <= -pi, pi)
    _replace(r, r <= _ON_AXIS, np.nan)
    return swing, r


def _boom_and_stick_to(r: NDArray, z: NDArray, bend: float, machine: Machine) -> tuple:
    """Boom and stick angle that bring the stick's tip to (r, z) in the plane of the arm."""
    L2, L3 = machine.boom.length, machine.stick.length
    r, z = _from_boom_joint(r, z, machine)
    square_distance = r * r + z * z
    cos_q3 = (square_distance - (L2 * L2 + L3 * L3)) / (2 * L2 * L3)
    square = 1 - cos_q3 * cos_q3
    _replace(square, np.abs(square) < _STRETCH_ROUNDING, 0.0)
    sin_q3 = bend * np.sqrt(square)
    along, across = L2 + L3 * cos_q3, L3 * sin_q3
    sin_p2, cos_p2 = z * along - r * across, r * along + z * across
    boom = _angle(*_turned_back(machine.boom.angle_offset, sin_p2, cos_p2), square_distance)
    stick = _angle(*_turned_back(machine.stick.angle_offset, sin_q3, cos_q3), 1.0)
    return boom, stick


def _from_boom_joint(r: NDArray, z: NDArray, machine: Machine) -> tuple:
    return r - machine.swing.offset, z - (machine.base.height + machine.swing.height)


def _turned_back(offset: float, y: NDArray, x: NDArray) -> tuple[NDArray, NDArray]:
    """The vector (x, y) turned by -offset, y first."""
    return y * cos(offset) - x * sin(offset), x * cos(offset) + y * sin(offset)


def _angle(y: NDArray, x: NDArray, length: NDArray | float) -> NDArray:
    """arctan2(y, x) of a vector of known length by its half-angle, twice as fast."""
    angle = 2 * np.arctan(y / (length + np.abs(x)))
    return np.where(x < 0, np.copysign(pi, y) - angle, angle)


def _replace(values: NDArray, where: NDArray, by: float) -> None:
    if where.any():
        values[where] = by


def _within(angles: tuple, machine: Machine) -> NDArray:
    """Where all four joint angles are within their limits; NaN is not."""
    good = True
    for angle, joint in zip(angles, machine.joints, strict=True):
        good &= angle >= joint.lower - _LIMIT_ROUNDING
        good &= angle <= joint.upper + _LIMIT_ROUNDING
    return good


def _can_bend(bend: float, machine: Machine) -> bool:
    """Whether the stick's limits let it bend to this side of the boom's line at all."""
    joint, offset = machine.stick.joint, machine.stick.angle_offset
    return max(bend * (joint.lower + offset), bend * (joint.upper + offset)) > 0


def _reason(target: NDArray, q: NDArray, machine: Machine) -> str:
    """Why one target has no solution, in words."""
    x, y, z, _ = target.tolist()
    where = f"target ({round(x, 3)}, {round(y, 3)}, {round(z, 3)}) m"
    r = hypot(x - machine.base.offset, y)
    if r <= _ON_AXIS:
        return f"{where} lies on the swing axis, where every swing angle fits: move it off the axis"
    if np.isfinite(q).all():
        return f"{where} needs {_worst_joint(q, machine)}"
    distance = hypot(*_from_boom_joint(r, z, machine))
    L2, L3 = machine.boom.length, machine.stick.length
    if distance > L2 + L3:
        return f"{where} is {distance - L2 - L3:.3g} m outside the reach of the stick"
    return (
        f"{where} is {abs(L2 - L3) - distance:.3g} m too close to the boom's joint for the stick to"
        " fold to"
    )


def _worst_joint(q: NDArray, machine: Machine) -> str:
    joint = int(np.argmax(np.maximum(machine.lower - q, q - machine.upper)))
    low, high = degrees(machine.lower[joint]), degrees(machine.upper[joint])
    side, limit = ("above", high) if q[joint] > machine.upper[joint] else ("below", low)
    return (
        f"the {JOINTS[joint]} at {degrees(q[joint]):.1f} deg, {side} its limit of {limit:.1f} deg"
        " (limits=False ignores the limits)"
    )


def _located(reason: str, index: int, count: int, shape: tuple[int, ...]) -> str:
    if not shape:
        return reason
    where = ", ".join(str(i) for i in np.unravel_index(index, shape))
    return f"{reason} (the first of {count} without a solution, at index {where})"
