"""D'Angelo's tracking equations exactly as printed in chapters 5 to 7 and 9.

Not for use: the appendix of lesson 05 tests them, `backhoe.vehicle.tracking` has the right ones.
What the print leaves open is read so:

- (6.8b) writes the inner rate h(y_n, t_n) without its input u_n; it is taken with the input 0;
- (6.11), (7.1c) and (9.10) write arctan of a fraction; `two_arguments=True` reads atan2, as the
  source's own listing in section 7.1 does.
"""

from __future__ import annotations

from collections.abc import Callable
from math import atan, atan2, copysign, cos, factorial, hypot, inf, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "cost_612",
    "gains_614",
    "gradient_913",
    "heading_611",
    "pose_errors_51",
    "runge_kutta_71",
    "step_68",
    "taylor_62",
    "taylor_613",
]


def pose_errors_51(
    pose: ArrayLike, waypoint: ArrayLike, next_waypoint: ArrayLike
) -> tuple[float, float, float, float]:
    """rho, beta, Delta y and alpha = theta - phi as printed in (5.1), angles not wrapped.

    Args:
        pose: x, y, theta, shape (3,) [m, m, rad].
        waypoint, next_waypoint: WP_n and WP_n+1, shape (2,) [m].

    Returns:
        rho [m], beta [rad], Delta y [m], alpha [rad].
    """
    x, y, theta = pose
    (goal_x, goal_y), (next_x, next_y) = waypoint, next_waypoint
    rho = hypot(goal_x - x, goal_y - y)
    beta = atan2(goal_y - y, goal_x - x) - theta
    phi = atan2(next_y - goal_y, next_x - goal_x)
    return rho, beta, rho * sin(beta), theta - phi


def taylor_62(derivative: Callable[[int, float], float], m: int, t0: float, t: float) -> float:
    """y(t) of (6.2): what is printed as an equality is the polynomial, without its remainder.

    Args:
        derivative: derivative(k, t), the k-th derivative of y at time t [s].
        m: order of the polynomial.
        t0, t: where it is expanded, and where it is asked for [s].
    """
    return sum(derivative(k, t0) * (t - t0) ** k / factorial(k) for k in range(m + 1))


def step_68(
    h: Callable[[NDArray, float, float], ArrayLike],
    y: ArrayLike,
    u: float,
    u_next: float,
    t: float,
    T0: float,
) -> NDArray:
    """y_n+1 of (6.8) as printed, the inner rate of (6.8b) without its input.

    Args:
        h: rate h(y, u, t) of the shape of y.
        y: state y_n, shape (n,).
        u, u_next: inputs u_n and u_n+1.
        t, T0: time t_n and sample time [s].

    Returns:
        y_n+1, shape (n,).
    """
    y = np.asarray(y, float)
    start = np.asarray(h(y, u, t))
    end = np.asarray(h(y + T0 * np.asarray(h(y, 0.0, t)), u_next, t + T0))
    return y + T0 / 2 * (start + end)


def heading_611(dx: float, dy: float, *, two_arguments: bool = False) -> float:
    """theta_d of (6.11) and (9.10), arctan(dy / dx), in [-pi/2, pi/2] [rad].

    Args:
        dx, dy: way to the goal [m].
        two_arguments: take atan2(dy, dx) instead.
    """
    if two_arguments:
        return atan2(dy, dx)
    return atan(dy / dx) if dx else atan(copysign(inf, dy))


def taylor_613(
    pose: ArrayLike,
    goal: ArrayLike,
    T0: float,
    kv2: float = 0.4,
    kw2: float = 0.4,
    *,
    two_arguments: bool = False,
) -> tuple[float, float]:
    """V_n and W_n as printed in (6.13) and (9.14), theta_d - theta_n not wrapped.

    Args:
        pose: x, y, theta, shape (3,) [m, m, rad].
        goal: x_d, y_d at n+1, shape (2,) [m].
        T0: sample time [s].
        kv2, kw2: k_v^2 and k_w^2.
        two_arguments: read (6.11) with atan2.

    Returns:
        V_n [m/s], W_n [rad/s].
    """
    x, y, theta = pose
    dx, dy = goal[0] - x, goal[1] - y
    theta_d = heading_611(dx, dy, two_arguments=two_arguments)
    V = kv2 * (dx / T0 * cos(theta_d) + dy / T0 * sin(theta_d))
    return V, kw2 * (theta_d - theta) / T0


def cost_612(
    V: float, W: float, pose: ArrayLike, goal: ArrayLike, T0: float, k_squared: ArrayLike
) -> float:
    """J_n of (6.12) with (6.10) and (6.9) put in, and theta_d by atan2.

    Args:
        V, W: inputs [m/s, rad/s].
        pose: x, y, theta, shape (3,) [m, m, rad].
        goal: x_d, y_d at n+1, shape (2,) [m].
        T0: sample time [s].
        k_squared: k_1^2 to k_4^2, shape (4,).
    """
    x, y, theta = pose
    k1, k2, k3, k4 = k_squared
    dx, dy = goal[0] - x, goal[1] - y
    theta_d = heading_611(dx, dy, two_arguments=True)
    miss = (dx - V * cos(theta) * T0) ** 2 + (dy - V * sin(theta) * T0) ** 2
    return k1 * miss + k2 * V**2 + k3 * (theta_d - theta - W * T0) ** 2 + k4 * W**2


def gradient_913(
    V: float, W: float, pose: ArrayLike, goal: ArrayLike, T0: float, k_squared: ArrayLike
) -> tuple[float, float]:
    """dJ/dV and dJ/dW as printed in (9.13): the first terms lack their minus signs.

    Args: as for `cost_612`.
    """
    x, y, theta = pose
    k1, k2, k3, k4 = k_squared
    dx, dy = goal[0] - x, goal[1] - y
    theta_d = heading_611(dx, dy, two_arguments=True)
    ahead = 2 * (dx - V * cos(theta) * T0) * cos(theta) * T0
    aside = 2 * (dy - V * sin(theta) * T0) * sin(theta) * T0
    turn = k3 * 2 * (theta_d - theta - W * T0) * T0
    return k1 * (ahead + aside) + k2 * 2 * V, turn + k4 * 2 * W


def gains_614(k_squared: ArrayLike, T0: float) -> tuple[float, float]:
    """k_v^2 and k_w^2 of (6.14) and (9.15).

    Args:
        k_squared: k_1^2 to k_4^2, not negative, the first and third positive, shape (4,).
        T0: sample time [s].
    """
    k1, k2, k3, k4 = k_squared
    return k1 / (k1 + k2 / T0**2), k3 / (k3 + k4 / T0**2)


def runge_kutta_71(
    pose: ArrayLike,
    twist: ArrayLike,
    waypoint: ArrayLike,
    T0: float,
    kv: float = 0.4,
    kw: float = 0.5,
    *,
    two_arguments: bool = False,
) -> tuple[float, float]:
    """V_n+1 and W_n+1 as printed in (7.1), theta_d - theta_n not wrapped.

    Args:
        pose: x, y, theta, shape (3,) [m, m, rad].
        twist: V_n, W_n, shape (2,) [m/s, rad/s].
        waypoint: wp_n; for the goal of the sample it has to be that of n+1; shape (2,) [m].
        T0: sample time [s].
        kv, kw: gains, 0.4 and 0.5 in the source's listing.
        two_arguments: read (7.1c) with atan2, as the listing does.

    Returns:
        V_n+1 [m/s], W_n+1 [rad/s].
    """
    x, y, theta = pose
    V_n, W_n = twist
    dx, dy = waypoint[0] - x, waypoint[1] - y
    up, across = kv * 2 / T0 * dy - V_n * sin(theta), kv * 2 / T0 * dx - V_n * cos(theta)
    theta_d = heading_611(across, up, two_arguments=two_arguments)
    V = kv * 2 / T0 * (dx * cos(theta_d) + dy * sin(theta_d)) - V_n * cos(theta_d - theta)
    return V, kw * (2 / T0 * (theta_d - theta) - W_n)
