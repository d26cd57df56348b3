"""Errors of a vehicle's pose against a way-point: eq. (5.1) of D'Angelo 2022.

rho is the distance to the way-point, dy how far it lies to the left of the vehicle's axis, alpha
how much farther left the path goes on from there than the vehicle looks. A positive dy and a
positive alpha both ask for a turn to the left. Printed is alpha = theta - phi, which asks for the
contrary; here alpha = phi - theta. Angles are wrapped, which the print leaves out.
"""

from __future__ import annotations

from math import atan2, hypot, sin
from typing import NamedTuple

from numpy.typing import ArrayLike

from backhoe.basics.angles import wrap
from backhoe.basics.inputs import numbers


class PoseErrors(NamedTuple):
    """rho, the distance [m]; dy, to the left of the vehicle's axis [m]; alpha, wrapped [rad]."""

    rho: float
    dy: float
    alpha: float


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
    x, y, theta = numbers(pose, "pose", (3,), meaning="x, y, heading").tolist()
    goal_x, goal_y = numbers(waypoint, "waypoint", (2,), meaning="x, y").tolist()
    after = waypoint if next_waypoint is None else next_waypoint
    next_x, next_y = numbers(after, "next_waypoint", (2,), meaning="x, y").tolist()
    rho, beta = hypot(goal_x - x, goal_y - y), atan2(goal_y - y, goal_x - x) - theta
    onward = next_x - goal_x, next_y - goal_y
    alpha = wrap(atan2(onward[1], onward[0]) - theta) if any(onward) else 0.0
    return PoseErrors(rho, rho * sin(beta), alpha)
