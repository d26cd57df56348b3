"""Errors of a vehicle's pose against a way-point: eq. (5.1) of D'Angelo 2022.

rho is the distance to the way-point, dy how far it lies to the left of the vehicle's axis, alpha
how much farther left the path goes on from there than the vehicle looks. A positive dy and a
positive alpha both ask for a turn to the left. Printed is alpha = theta - phi, which asks for the
contrary; here alpha = phi - theta. Angles are wrapped, which the print leaves out.
"""

from __future__ import annotations

from math import atan2, hypot, pi, remainder, sin
from typing import NamedTuple

from numpy.typing import ArrayLike

from backhoe.vehicle.tracking.protocol import _floats


class PoseErrors(NamedTuple):
    """rho, the distance [m]; dy, to the left of the vehicle's axis [m]; alpha, wrapped [rad]."""

    rho: float
    dy: float
    alpha: float


def wrap(angle: float) -> float:
    """The same direction as `angle` [rad], within (-pi, pi]."""
    wrapped = remainder(angle, 2 * pi)
    return pi if wrapped <= -pi else wrapped


def pose_errors(
    pose: ArrayLike, waypoint: ArrayLike, next_waypoint: ArrayLike | None = None
) -> PoseErrors:
    """Errors rho, dy and alpha of a pose.

    Source: D'Angelo 2022, eq. (5.1), with alpha's sign turned and the angles wrapped.

    Args:
        pose: x, y, heading theta, shape (3,) [m, m, rad]; theta may be any number of turns.
        waypoint: x, y of the current way-point, shape (2,) [m].
        next_waypoint: x, y of the one after it, shape (2,) [m]. None, or the same point again:
            there is no direction phi to look to, and alpha is 0.

    Returns:
        PoseErrors(rho [m], dy [m], alpha [rad]).

    Raises:
        ValueError: not three or two finite numbers.
    """
    x, y, theta = _floats(pose, 3, "pose must be x, y, heading")
    goal_x, goal_y = _floats(waypoint, 2, "waypoint must be x, y")
    if next_waypoint is None:
        return errors_in_floats(goal_x - x, goal_y - y, theta, 0.0, 0.0)
    next_x, next_y = _floats(next_waypoint, 2, "next_waypoint must be x, y")
    return errors_in_floats(goal_x - x, goal_y - y, theta, next_x - goal_x, next_y - goal_y)


def errors_in_floats(
    dx: float, dy: float, theta: float, onward_x: float, onward_y: float
) -> PoseErrors:
    """`pose_errors` of the ways to the way-point and onward from there, in floats [m]."""
    rho = hypot(dx, dy)
    beta = atan2(dy, dx) - theta
    if onward_x == 0.0 and onward_y == 0.0:
        return PoseErrors(rho, rho * sin(beta), 0.0)
    return PoseErrors(rho, rho * sin(beta), wrap(atan2(onward_y, onward_x) - theta))
