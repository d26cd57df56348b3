"""Obstacles for platform and arm: how far they are, and velocities v0 that lead away from them.

The avoiding velocities are wishes for the null space, as those of `secondary`. What must not happen
is a limit: with `clearance` it is A = -change, c = gain distance of `limited_velocity`, which lets
no distance fall faster than it is left.

Source: Sasig and Chicaiza 2017, secondary task. Its own terms turn to neither side for an obstacle
dead ahead, and drive towards it: here they are mended.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import flag, not_negative, numbers, positive
from backhoe.whole_body.manipulability import length_weights
from backhoe.whole_body.robots import BACKHOE, Robot, hand, jacobian, posture


class Clearance(NamedTuple):
    """Distances (..., pairs) [m], and rows of d' = change v, (..., pairs, n) [1, m/rad]."""

    distance: NDArray
    change: NDArray


def steer_clear(
    q: ArrayLike,
    obstacles: ArrayLike,
    *,
    within: float,
    brake: float,
    turn: float,
    size: float = 0.0,
    forwards: bool = True,
    robot: Robot = BACKHOE,
) -> NDArray:
    """Platform past upright obstacles: it brakes, and turns to the side that is free.

    Both go with the nearness, 0 at `within` and beyond, 1 at contact, and with the cosine of the
    bearing, 0 abeam and behind. An obstacle dead ahead counts as one on the left. So v0 is
    continuous but for the side, which some bearing must decide.

    Args:
        q: posture as for `hand`, shape (..., 3 + joints) [m, m, rad, ...].
        obstacles: where they stand, shape (k, 2) [m].
        within: distance from which they matter [m].
        brake, turn: at contact, 0 or more [m/s], [rad/s]. For robots like the slides', as fast a
            brake as the hand and a turn of 15 times that over `within` lead past a post dead ahead.
        size: radius of the platform plus that of an obstacle [m].
        forwards: False for a platform that backs up.
        robot: as for `hand`.

    Returns:
        v0, shape (..., 2 + joints) [m/s, rad/s], of several obstacles the sum.

    Raises:
        ValueError: shapes that do not fit, values that are not finite or out of range.
    """
    q, posts = posture(q, robot), numbers(obstacles, "obstacles", ("k", 2), meaning="x and y [m]")
    within, size = positive(within, "within", "m"), not_negative(size, "size", "m")
    way = 1.0 if flag(forwards, "forwards") else -1.0
    x, y = np.moveaxis(posts - q[..., None, :2], -1, 0)
    cosine, sine = way * np.cos(q[..., 2, None]), way * np.sin(q[..., 2, None])
    ahead, left = x * cosine + y * sine, y * cosine - x * sine
    distance = np.hypot(ahead, left)
    near = np.clip(1 - (distance - size) / within, 0, 1)
    near = near * np.maximum(ahead, 0) / np.maximum(distance, np.finfo(float).tiny)
    v0 = np.zeros((*q.shape[:-1], 2 + robot.joints))
    v0[..., 0] = -way * not_negative(brake, "brake", "m/s") * near.sum(axis=-1)
    side = np.where(left >= 0, -1.0, 1.0)
    v0[..., 1] = not_negative(turn, "turn", "rad/s") * (side * near).sum(axis=-1)
    return v0


def keep_clear(
    q: ArrayLike,
    obstacles: ArrayLike,
    *,
    within: float,
    speed: float,
    size: float = 0.0,
    length: float | None = None,
    robot: Robot = BACKHOE,
) -> NDArray:
    """Arm away from balls: each of its points is pushed straight off, the hand's own task apart.

    Args:
        q, within, robot: as for `steer_clear`.
        obstacles: centres, shape (k, 3) [m].
        speed: of the push at contact, 0 or more [m/s].
        size: radius of the arm plus that of a ball [m].
        length: as for `to_manipulability` [m].

    Returns:
        v0, shape (..., 2 + joints) [m/s, rad/s], each distance up its gradient.

    Raises:
        ValueError: as for `steer_clear`.
    """
    balls = numbers(obstacles, "obstacles", ("k", 3), meaning="x, y and z [m]")
    distance, change = clearance(q, balls, size=size, robot=robot)
    near = np.clip(1 - distance / positive(within, "within", "m"), 0, 1)
    push = not_negative(speed, "speed", "m/s") * np.einsum("...p,...pn->...n", near, change)
    return push / length_weights(robot, length)


def clearance(
    q: ArrayLike, obstacles: ArrayLike, *, size: float = 0.0, robot: Robot = BACKHOE
) -> Clearance:
    """How far the platform is from upright obstacles, or points of the arm from balls.

    Points of the arm are its hinges after the first joint, the middles between them, and the hand.

    Args:
        q, robot: as for `hand`.
        obstacles: of the platform (k, 2), of the arm (k, 3) [m].
        size: of both together, see `steer_clear` and `keep_clear` [m].

    Returns:
        Distances, negative within, point by point and for each obstacle in turn; and their change.

    Raises:
        ValueError: as for `steer_clear`.
    """
    q, obstacles = posture(q, robot), numbers(obstacles, "obstacles", ("k", "m"), meaning="points")
    cosine, sine = np.cos(q[..., 2]), np.sin(q[..., 2])
    if obstacles.shape[-1] == 2:
        points = q[..., None, :2]
        J = np.zeros((*q.shape[:-1], 1, 2, 2 + robot.joints))
        J[..., 0, 0, 0], J[..., 0, 1, 0] = cosine, sine
    else:
        obstacles = numbers(obstacles, "obstacles", ("k", 3), meaning="2 or 3 coordinates [m]")
        points, J = _arm(q, robot)
    apart = points[..., :, None, :] - obstacles
    distance = np.linalg.norm(apart, axis=-1)
    away = apart / np.maximum(distance, np.finfo(float).tiny)[..., None]
    change = np.einsum("...pki,...pin->...pkn", away, J)
    pairs = points.shape[-2] * len(obstacles)
    shape = (*q.shape[:-1], pairs)
    distance = distance.reshape(shape) - not_negative(size, "size", "m")
    return Clearance(distance, change.reshape(*shape, 2 + robot.joints))


def _arm(q: NDArray, robot: Robot) -> tuple[NDArray, NDArray]:
    """Points of the arm in the world, (..., p, 3), and their Jacobians, (..., p, 3, 2 + joints).

    The platform turns about the first axis, the joints about the others. Each passes the hand as
    far off as its column of the Jacobian says: the foot of the hand on it is the hinge.
    """
    cosine, sine, n = np.cos(q[..., 2]), np.sin(q[..., 2]), robot.joints
    zero, columns = np.zeros_like(cosine), np.swapaxes(jacobian(q, robot), -1, -2)
    R = np.stack([cosine, -sine, zero, sine, cosine, zero, zero, zero, zero + 1], axis=-1)
    axes = np.zeros_like(columns[..., 1:, :])
    axes[..., 0, 2] = 1.0
    arm = numbers(robot.axes(q[..., 3:]), "axes of the robot", (*zero.shape, 3, n))
    axes[..., 1:, :] = np.swapaxes(R.reshape(*zero.shape, 3, 3) @ arm, -1, -2)
    tip = hand(q, robot)[..., None, :]
    feet = tip + np.cross(axes, columns[..., 1:, :])
    ends = np.concatenate([feet[..., 2:, :], tip], axis=-2)
    points = np.concatenate([ends, (ends[..., :-1, :] + ends[..., 1:, :]) / 2], axis=-2)
    turning = np.cross(axes[..., None, :, :], points[..., :, None, :] - feet[..., None, :, :])
    before = np.r_[np.arange(2, n + 2), np.arange(3, n + 2)]  # axes that move each point
    turning *= (np.arange(n + 1) < before[:, None])[..., None]
    drive = np.broadcast_to(columns[..., None, :1, :], (*points.shape[:-1], 1, 3))
    return points, np.swapaxes(np.concatenate([drive, turning], axis=-2), -1, -2)
