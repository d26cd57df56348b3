"""More velocities than equations: the least of them, those that change nothing, and how easily the
hand moves.

Source: Sasig and Chicaiza 2017, design of the controller and secondary task.
"""

from __future__ import annotations

from math import prod

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, not_negative, numbers
from backhoe.whole_body.robots import BACKHOE, Robot, posture

PARTS = ("arm", "whole")


def minimum_norm(
    J: ArrayLike,
    b: ArrayLike,
    preferred: ArrayLike | None = None,
    *,
    weights: ArrayLike | None = None,
    damping: float = 0.0,
) -> NDArray:
    """Of all v with J v = b the least, or the one nearest to a preferred one.

    v = v0 + J^T (J J^T)^-1 (b - J v0), which is J^+ b + (I - J^+ J) v0: the particular solution and
    the homogeneous one in one step. Source: Sasig and Chicaiza 2017, v_c.

    Args:
        J: m equations for n > m velocities, shape (..., m, n), in any units.
        b: what J v should be, shape (..., m).
        preferred: v0, shape (..., n); zero if None.
        weights: what each velocity costs, shape (n,), positive: the sum of w (v - v0)^2 is least;
            all alike if None. They also make metres and radians comparable.
        damping: lambda of J J^T + lambda^2 I; above 0, J v misses b near a singularity, and the
            velocities stay bounded.

    Returns:
        v, shape (..., n), in the units of b over those of J.

    Raises:
        ValueError: shapes that do not fit, values that are not finite, weights that are not
            positive, or rows of J that depend on each other while damping is 0.
    """
    J = _matrices(J)
    *leading, m, n = J.shape
    b = numbers(b, "b", (*leading, m), meaning=f"one value for each of the {m} rows of J")
    wanted = np.zeros((*leading, n)) if preferred is None else preferred
    v0 = numbers(wanted, "preferred", (*leading, n), meaning=f"one value a column of J, {n}")
    damping = not_negative(damping, "damping")
    scale = None if weights is None else _scale(weights, n)
    if scale is not None:
        J, v0 = J / scale, v0 * scale
    v, count = np.empty((*leading, n)), prod(leading)
    from backhoe.whole_body import engine

    flat = J.reshape(count, m, n), b.reshape(count, m), v0.reshape(count, n)
    scratch = np.empty((m, m)), np.empty(m)
    singular = engine.solve(*flat, damping, v.reshape(count, n), *scratch)
    if singular >= 0:
        at = f" at {tuple(map(int, np.unravel_index(singular, leading)))}" if leading else ""
        raise ValueError(
            f"the {m} rows of J must not depend on each other, but they do{at}: the hand cannot "
            "move in every direction there; leave the singularity, or give damping above 0"
        )
    return v if scale is None else v / scale


def null_projector(J: ArrayLike) -> NDArray:
    """I - J^+ J, which takes from any v what moves the hand.

    Args:
        J: shape (..., m, n), in its own units; its rows may depend on each other.

    Returns:
        N with J N = 0, N N = N and N = N^T, shape (..., n, n).

    Raises:
        ValueError: J is not a matrix, or a value is not finite.
    """
    J = _matrices(J)
    return np.eye(J.shape[-1]) - np.linalg.pinv(J) @ J


def manipulability(J: ArrayLike, weights: ArrayLike | None = None) -> NDArray:
    """w = sqrt(det(J J^T)), the product of the singular values: 0 where a direction is lost.

    Of a whole robot it says nothing of its arm, since the platform moves the hand too: take the
    arm's columns for that. Source: Sasig and Chicaiza 2017, secondary task.

    Args:
        J: shape (..., m, n), m not above n.
        weights: as for `minimum_norm`, shape (n,); all alike if None.

    Returns:
        Shape (...), in the units of J to the power m.

    Raises:
        ValueError: J is not a matrix, has more rows than columns, or a value is not finite;
            weights that are not positive.
    """
    J = _matrices(J)
    if weights is not None:
        J = J / _scale(weights, J.shape[-1])
    return np.prod(np.linalg.svd(J, compute_uv=False), axis=-1)


def manipulability_gradient(q: ArrayLike, robot: Robot = BACKHOE, part: str = "arm") -> NDArray:
    """How the manipulability changes with the joints: dw/dq = w trace(J^+ dJ/dq).

    Args:
        q: posture as for `hand`, shape (..., 3 + joints) [m, m, rad, ...].
        robot: as for `hand`.
        part: "arm" for the arm's own columns, "whole" for platform and arm.

    Returns:
        Derivative by each joint, shape (..., joints) [m^3/rad]. The platform's place and heading
        change nothing.

    Raises:
        ValueError: as for `hand`, or another part.
    """
    whole = choice(part, "part", PARTS) == "whole"
    arm = posture(q, robot)[..., 3:]
    J, axes = robot.reach_jacobian(arm), robot.axes(arm)
    first, last = (
        np.minimum.outer(*2 * [range(robot.joints)]),
        np.maximum.outer(*2 * [range(robot.joints)]),
    )
    change = np.cross(axes[..., first], J[..., last], axis=-3)
    if whole:
        up, none = np.array([0.0, 0.0, 1.0]), np.zeros_like(J)
        turning = np.cross(up, np.moveaxis(J, -2, -1))
        reach = robot.reach(arm)
        platform = np.stack([np.broadcast_to([1.0, 0, 0], reach.shape), np.cross(up, reach)], -1)
        J = np.concatenate([platform, J], axis=-1)
        moved = np.stack([none, np.moveaxis(turning, -1, -2)], axis=-2)
        change = np.concatenate([moved, change], axis=-2)
    inverse = np.linalg.pinv(J)
    w = manipulability(J)
    return w[..., None] * np.einsum("...ki,...ikj->...j", inverse, change)


def _matrices(J: ArrayLike) -> NDArray:
    J = numbers(J, "J", (..., "m", "n"), meaning="a matrix")
    if J.shape[-2] > J.shape[-1]:
        raise ValueError(
            f"J must not have more equations (rows) than velocities (columns), got {J.shape[-2:]}"
        )
    return J


def _scale(weights: ArrayLike, n: int) -> NDArray:
    weights = numbers(weights, "weights", (n,), meaning="one weight a column of J")
    if (weights <= 0).any():
        raise ValueError(f"weights must be positive, got {weights.min()}")
    return np.sqrt(weights)
