"""Formulas of Sasig and Chicaiza 2017 (slides) as printed. Not for use.

The appendix of chapter 12 tests them; `backhoe.whole_body` has what they should be.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers
from backhoe.whole_body import SLIDES, SlidesRobot

__all__ = ["omega_obs", "robot_jacobian", "u_obs"]


def robot_jacobian(q: ArrayLike, robot: SlidesRobot = SLIDES) -> NDArray:
    """J: the hand's velocity by u, omega and the speeds of q1, q2, q3.

    Of the second row the slide shows how each entry begins and the sign after it; the rest is
    hidden. Here it goes on, after the sign shown, as the first row does, with C_theta for S_theta.

    Args:
        q: x_o, y_o [m], theta, q1, q2, q3 [rad], shape (6,).
        robot: its lengths.

    Returns:
        Shape (3, 5) [1 in the first column, m/rad in the others].

    Raises:
        ValueError: another shape, or a value that is not finite.
    """
    _, _, theta, q1, q2, q3 = numbers(q, "q", (6,), meaning="x, y, theta and 3 joints")
    (C, C1, C2, C23), (S, S1, S2, S23) = (
        f(np.array([theta, q1, q2, q2 + q3])) for f in (np.cos, np.sin)
    )
    a, l2, l3 = robot.a, robot.l2, robot.l3
    h_ax, h_ay = l2 * C2 * C1 + l3 * C23 * C1, l2 * C2 * S1 + l3 * C23 * S1
    begins = -np.array([l2 * C2 * S1 + l3 * C23 * S1, l2 * C1 * S2 + l3 * S23 * C1, l3 * S23 * C1])
    goes_on = np.array([l2 * C1 * C2 + l3 * C23 * C1, l3 * S23 * S1 + l2 * S1 * S2, l3 * S23 * S1])
    return np.array(
        [
            [C, -(a + h_ax) * S - h_ay * C, *(begins * C + np.array([-1, 1, 1]) * goes_on * S)],
            [S, (a + h_ax) * C - h_ay * S, *(begins * S + np.array([1, 1, -1]) * goes_on * C)],
            [0, 0, 0, l3 * C23 + l2 * C2, l3 * C23],
        ]
    )


def omega_obs(d: float, alpha: float, r: float, k: float = 1.0) -> float:
    """omega_obs = k (r - d) sign(alpha) [pi/2 - |alpha|].

    Args:
        d: distance of the obstacle [m]; alpha: its bearing, positive to the left [rad].
        r: distance from which it matters [m].
        k: gain, without a unit or a sign in the slides.

    Returns:
        Turning velocity [rad/s].

    Raises:
        ValueError: not finite numbers.
    """
    return float(_repulsion(d, alpha, r, k) * np.sign(alpha))


def u_obs(d: float, alpha: float, r: float, k: float = 1.0) -> float:
    """u_obs = k (r - d) [pi/2 - |alpha|].

    Args:
        d, alpha, r, k: as for `omega_obs` [m], [rad], [m].

    Returns:
        Velocity along the heading [m/s].

    Raises:
        ValueError: not finite numbers.
    """
    return float(_repulsion(d, alpha, r, k))


def _repulsion(d: float, alpha: float, r: float, k: float) -> float:
    d, r = number(d, "d", "m"), number(r, "r", "m")
    return number(k, "k") * (r - d) * (np.pi / 2 - abs(number(alpha, "alpha", "rad")))
