"""Poses in the plane as a group: composing, inverting and the exponential of SE(2).

`compose(a, b)` is T_a @ T_b: b seen from a, put into the world. psi is never wrapped, so a
composition counts full turns.

Reference: Lynch and Park, Modern Robotics (2017), section 3.3.3; Mastalli 2013, (4.3), is exp with
v_y = 0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import alike, numbers, positive

__all__ = [
    "compose",
    "relative",
    "se2_exp",
    "se2_matrix",
    "sides_of_twist",
    "twist_of_sides",
]


def se2_exp(xi: ArrayLike) -> NDArray:
    """Pose after a body velocity held for a time, starting from the origin.

    Args:
        xi: v_x T, v_y T, omega T, shape (..., 3) [m, m, rad].

    Returns:
        x, y, psi, shape (..., 3) [m, m, rad], psi = omega T unwrapped.

    Raises:
        ValueError: xi does not end in 3 finite numbers.
    """
    xi = numbers(xi, "xi", (..., 3), meaning="values (v_x T, v_y T, omega T)")
    half = xi[..., 2] / 2
    chord = np.sinc(half / np.pi)
    x, y = _turned(chord * xi[..., 0], chord * xi[..., 1], half)
    return np.stack([x, y, xi[..., 2]], axis=-1)


def compose(a: ArrayLike, b: ArrayLike) -> NDArray:
    """Pose b, seen from a, in the frame that a is seen from.

    Args:
        a, b: poses, shapes (..., 3), alike or one of them (3,) [m, m, rad].

    Returns:
        Shape (..., 3); the headings add up, unwrapped.

    Raises:
        ValueError: a or b does not end in 3 finite numbers, or their shapes do not fit.
    """
    a, b = _pair(a, b)
    x, y = _turned(b[..., 0], b[..., 1], a[..., 2])
    return np.stack([a[..., 0] + x, a[..., 1] + y, a[..., 2] + b[..., 2]], axis=-1)


def relative(a: ArrayLike, b: ArrayLike) -> NDArray:
    """Pose b seen from pose a: `compose(a, relative(a, b))` is b.

    Args:
        a, b: poses in one frame, as for `compose`.

    Returns:
        Shape (..., 3) [m, m, rad].

    Raises:
        ValueError: as for `compose`.
    """
    a, b = _pair(a, b)
    x, y = _turned(b[..., 0] - a[..., 0], b[..., 1] - a[..., 1], -a[..., 2])
    return np.stack([x, y, b[..., 2] - a[..., 2]], axis=-1)


def se2_matrix(pose: ArrayLike) -> NDArray:
    """T of a pose (..., 3) [m, m, rad], shape (..., 3, 3); ValueError as for `compose`."""
    pose = numbers(pose, "pose", (..., 3), meaning="values (x, y, psi)")
    T = np.zeros((*pose.shape, 3))
    T[..., 0, 0] = T[..., 1, 1] = np.cos(pose[..., 2])
    T[..., 1, 0] = np.sin(pose[..., 2])
    T[..., 0, 1] = -T[..., 1, 0]
    T[..., :2, 2] = pose[..., :2]
    T[..., 2, 2] = 1.0
    return T


def twist_of_sides(left: ArrayLike, right: ArrayLike, gauge: float) -> tuple[NDArray, NDArray]:
    """Motion of a body on two tracks, or on wheels at two sides, from that of its sides.

    Source: Mastalli 2013, eq. (2.9); D'Angelo 2022, eq. (2.3).

    Args:
        left, right: speeds of the sides along the ground, shape (...) [m/s]; or their ways [m].
        gauge: distance between the sides [m].

    Returns:
        v [m/s] and omega, anticlockwise [rad/s], shape (...); or distance [m] and turn [rad].

    Raises:
        ValueError: left and right differ in shape, a value is not finite, or gauge is not positive.
    """
    left, right = numbers(left, "left"), numbers(right, "right")
    alike(left=left, right=right)
    return (left + right) / 2, (right - left) / positive(gauge, "gauge", "m")


def sides_of_twist(v: ArrayLike, omega: ArrayLike, gauge: float) -> tuple[NDArray, NDArray]:
    """Motion of the left and right side: the inverse of `twist_of_sides`, same shapes, errors."""
    v, turn = numbers(v, "v"), positive(gauge, "gauge", "m") / 2 * numbers(omega, "omega")
    return v - turn, v + turn


def _turned(x: NDArray, y: NDArray, angle: NDArray) -> tuple[NDArray, NDArray]:
    cos, sin = np.cos(angle), np.sin(angle)
    return cos * x - sin * y, sin * x + cos * y


def _pair(a: ArrayLike, b: ArrayLike) -> list[NDArray]:
    a = numbers(a, "a", (..., 3), meaning="values (x, y, psi)")
    b = numbers(b, "b", (..., 3), meaning="values (x, y, psi)")
    if a.shape != b.shape and (3,) not in (a.shape, b.shape):
        raise ValueError(
            f"poses must be alike in shape or one of them (3,), got {a.shape}, {b.shape}"
        )
    return np.broadcast_arrays(a, b)
