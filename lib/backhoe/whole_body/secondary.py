"""What the null space is for: velocities v0 that a robot prefers, beside the task of its hand.

Each function gives v0 for `minimum_norm(J, b, v0)` or `limited_velocity(J, b, ..., preferred=v0)`;
several are added. They are wishes: what of them would move the hand is projected away, so none of
them keeps a limit. `limits` does.

Source: Sasig and Chicaiza 2017, secondary tasks.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative, numbers
from backhoe.whole_body.manipulability import length_weights, manipulability_gradient
from backhoe.whole_body.robots import BACKHOE, Robot, posture


def to_posture(q: ArrayLike, wanted: ArrayLike, gain: ArrayLike, robot: Robot = BACKHOE) -> NDArray:
    """Joints back to preferred angles: their speeds are gain (wanted - q).

    Args:
        q: posture as for `hand`, shape (..., 3 + joints) [m, m, rad, ...].
        wanted: angles, shape (joints,) [rad].
        gain: of all joints or of each, 0 or more, shape () or (joints,) [1/s].
        robot: as for `hand`.

    Returns:
        v0, shape (..., 2 + joints) [m/s, rad/s].

    Raises:
        ValueError: shapes that do not fit, values that are not finite, or a gain below 0.
    """
    joints = posture(q, robot)[..., 3:]
    gain = numbers(gain, "gain")
    if gain.shape not in ((), (robot.joints,)) or (gain < 0).any():
        raise ValueError(f"gain must be one number of 0 or more, or one a joint, got {gain}")
    return _arm(gain * (numbers(wanted, "wanted", (robot.joints,)) - joints))


def to_manipulability(
    q: ArrayLike,
    gain: float,
    robot: Robot = BACKHOE,
    part: str = "arm",
    length: float | None = None,
) -> NDArray:
    """Joints the way in which the hand comes to move most easily: gain times the gradient of w.

    w is counted with `length_weights` and has no unit.

    Args:
        q, robot: as for `hand`.
        gain: 0 or more [rad^2/s].
        part: as for `manipulability_gradient`; "whole" is blind to the arm.
        length: as for `length_weights` [m]; found anew each time if None, which takes longer than
            the rest.

    Returns:
        v0, shape (..., 2 + joints) [m/s, rad/s]; 0 on a singularity, which `to_posture` leaves.

    Raises:
        ValueError: as for `manipulability_gradient`, or a gain below 0.
    """
    slope = manipulability_gradient(q, robot, part, length_weights(robot, length))
    return _arm(not_negative(gain, "gain", "rad^2/s") * slope)


def from_limits(
    q: ArrayLike, lowest: ArrayLike, highest: ArrayLike, gain: float, robot: Robot = BACKHOE
) -> NDArray:
    """Joints towards the middle of their ranges: minus the gain times a gradient.

    That of half the mean of ((q - middle) / range)^2. It grows slowly, and does not keep a limit.

    Args:
        q, robot: as for `hand`.
        lowest, highest: range of each joint, shape (joints,) [rad].
        gain: 0 or more [rad^2/s].

    Returns:
        v0, shape (..., 2 + joints) [m/s, rad/s].

    Raises:
        ValueError: shapes that do not fit, values that are not finite, a range that is empty, or a
            gain below 0.
    """
    joints = posture(q, robot)[..., 3:]
    lowest = numbers(lowest, "lowest", (robot.joints,), meaning="one angle a joint")
    highest = numbers(highest, "highest", (robot.joints,), meaning="one angle a joint")
    if (lowest >= highest).any():
        raise ValueError(f"lowest must be below highest, got {lowest} and {highest}")
    offset = joints - (lowest + highest) / 2
    slope = offset / (robot.joints * (highest - lowest) ** 2)
    return _arm(-not_negative(gain, "gain", "rad^2/s") * slope)


def _arm(speeds: NDArray) -> NDArray:
    """Speeds of the joints beside a platform that stands."""
    return np.concatenate([np.zeros((*speeds.shape[:-1], 2)), speeds], axis=-1)
