"""How easily the hand moves: of the arm alone, or of the whole robot.

The two differ. The platform moves the hand too, so of the whole robot little is lost when the arm
is stretched; and one of its velocities is in m/s, the others in rad/s. A length makes them
comparable: a turn counts as the way of a point so far from its axis.

Source: Sasig and Chicaiza 2017, secondary task.
"""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, number, numbers, positive, whole
from backhoe.whole_body.linear import matrices, scale_of
from backhoe.whole_body.robots import BACKHOE, Robot, jacobian, joints_of, posture, reach

PARTS = ("arm", "whole")
LOST = 1e-13
"""Below this share of the largest singular value the smallest is rounding: a direction is lost."""


def manipulability(J: ArrayLike, weights: ArrayLike | None = None) -> NDArray:
    """w = sqrt(det(J J^T)), the product of the singular values: 0 where a direction is lost.

    Of a whole robot it says little of its arm, since the platform moves the hand too: take the
    arm's columns for that. Source: Sasig and Chicaiza 2017, secondary task.

    Args:
        J: shape (..., m, n), m not above n.
        weights: as for `minimum_norm`, shape (n,); all alike if None. See `length_weights`.

    Returns:
        Shape (...), in the units of J to the power m.

    Raises:
        ValueError: J is not a matrix, has more rows than columns, or a value is not finite;
            weights that are not positive.
    """
    J = _weighted(J, weights)
    return np.prod(np.linalg.svd(J, compute_uv=False), axis=-1)


def manipulability_gradient(
    q: ArrayLike,
    robot: Robot = BACKHOE,
    part: str = "arm",
    weights: ArrayLike | None = None,
) -> NDArray:
    """How the manipulability changes with the joints: the sum of dJ/dq times J's cofactors.

    That is w trace(J^+ dJ/dq), without the division by a small singular value. An axis turns the
    levers of those after it, and their axes: column k changes with joint j by the axis of the
    first of them, times the lever of the last. The platform turns about the first axis of all.

    Args:
        q: posture as for `hand`, shape (..., 3 + joints) [m, m, rad, ...].
        robot: as for `hand`.
        part: "arm" for the arm's own columns, "whole" for platform and arm.
        weights: of all velocities of the robot, shape (2 + joints,); all alike if None.

    Returns:
        Derivative by each joint, shape (..., joints), in the units of `manipulability` over rad.
        The platform's place and heading change nothing. 0 where a direction is lost: w has a kink
        there, and grows either way.

    Raises:
        ValueError: as for `hand` and `manipulability`, or another part.
    """
    first = 2 if choice(part, "part", PARTS) == "arm" else 0
    q, n = posture(q, robot), robot.joints
    weights = np.ones(2 + n) if weights is None else weights
    scale = scale_of(weights, 2 + n)[first:]
    arm, shape = q[..., 3:], (*q.shape[:-1], 3, n)
    J = numbers(robot.reach_jacobian(arm), "reach_jacobian of the robot", shape)
    axes = numbers(robot.axes(arm), "axes of the robot", shape)
    forwards, up = (np.broadcast_to(np.eye(3)[:, i : i + 1], (*shape[:-1], 1)) for i in (0, 2))
    turn = np.cross(up[..., 0], reach(q, robot))[..., None]
    J, axes = np.concatenate([turn, J], axis=-1), np.concatenate([up, axes], axis=-1)
    every = np.arange(1 + n)
    before, after = np.minimum.outer(every, every), np.maximum.outer(every, every)
    change = np.cross(axes[..., before], J[..., after], axis=-3)[..., 1:]
    change = np.concatenate([np.zeros((*shape[:-1], 1, n)), change], axis=-2)[..., first:, :]
    J = matrices(np.concatenate([forwards, J], axis=-1)[..., first:])
    U, sigma, V = np.linalg.svd(J / scale, full_matrices=False)
    others = np.stack([np.prod(np.delete(sigma, i, axis=-1), axis=-1) for i in range(3)], axis=-1)
    others = np.where(sigma[..., -1:] > LOST * sigma[..., :1], others, 0.0)
    return np.einsum("...im,...m,...mk,...ikj->...j", U, others, V / scale, change)


def characteristic_length(robot: Robot = BACKHOE, q: ArrayLike | None = None) -> float:
    """How far from the axes the hand is: the root mean square over turning velocities and postures.

    Args:
        robot: as for `hand`.
        q: postures of the job, shape (..., 3 + joints) [m, m, rad, ...]. If None each joint takes
            all angles alike; four a joint give that mean exactly for joints in a chain, since no
            squared lever has more than twice an angle in it.

    Returns:
        Length [m].

    Raises:
        ValueError: as for `hand`, or no posture at all.
    """
    if q is None:
        angles = np.array(list(product(np.arange(4) * np.pi / 2, repeat=joints_of(robot))))
        q = np.concatenate([np.zeros((len(angles), 3)), angles], axis=-1)
    levers = np.linalg.norm(jacobian(q, robot)[..., 1:], axis=-2)
    if not levers.size:
        raise ValueError(f"q must have a posture or more, got shape {np.shape(q)}")
    return positive(float(np.sqrt((levers**2).mean())), "characteristic length", "m")


def length_weights(robot: Robot = BACKHOE, length: float | None = None) -> NDArray:
    """Weights that count a turn as the way of a point at that length, in metres: 1, L^2, L^2, ...

    With them w has no unit and says the same in metres and in feet, and the least velocities are
    least in (m/s)^2.

    Args:
        robot: as for `hand`.
        length: L [m]; the robot's `characteristic_length` if None.

    Returns:
        For `minimum_norm` and `manipulability`, shape (2 + joints,) [1, m^2, ...].

    Raises:
        ValueError: length is not from 1e-6 to 1e6 m.
    """
    L = characteristic_length(robot) if length is None else length
    L = number(L, "length", "m", least=1e-6, most=1e6)
    return np.array([1.0] + (1 + joints_of(robot)) * [L * L])


class Ellipsoid(NamedTuple):
    """Semi-axes, largest first, shape (..., m), and their unit directions as columns (..., m, m).

    The largest entry of each direction is positive.
    """

    axes: NDArray
    directions: NDArray

    def forces(self) -> Ellipsoid:
        """That of the forces which joints of unit effort hold: the same directions, axes inverted.

        Infinite where the hand cannot move: the structure holds, not the joints.
        """
        with np.errstate(divide="ignore"):
            return Ellipsoid(1 / self.axes[..., ::-1], self.directions[..., ::-1])

    def surface(self, points: int = 33) -> NDArray:
        """Points on it about the origin.

        Args:
            points: along each turn, at least 4.

        Returns:
            Shape (..., points, 2), or (..., points, points, 3) of a mesh, in the units of the axes.

        Raises:
            ValueError: not 2 or 3 axes, an infinite one, or too few points.
        """
        axes = numbers(self.axes, "axes", (..., "m"), meaning="finite semi-axes")
        m, points = axes.shape[-1], whole(points, "points", least=4)
        if m not in (2, 3):
            raise ValueError(f"only 2 or 3 axes can be drawn, got {m}")
        turn = np.linspace(0, 2 * np.pi, points)
        ball = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
        if m == 3:
            tilt = np.linspace(-np.pi / 2, np.pi / 2, points)[:, None, None]
            height = np.broadcast_to(np.sin(tilt), (points, points, 1))
            ball = np.concatenate([np.cos(tilt) * ball, height], axis=-1)
        shape = (self.directions * axes[..., None, :]).reshape(-1, m, m)
        drawn = np.einsum("kij,...j->k...i", shape, ball)
        return drawn.reshape(*axes.shape[:-1], *ball.shape)


def ellipsoid(J: ArrayLike, weights: ArrayLike | None = None) -> Ellipsoid:
    """Velocities of the hand that velocities v with |v| = 1 give it; its volume grows with w.

    Two rows of J give its shadow on their plane.

    Args:
        J: of the arm or of the whole robot, shape (..., m, n).
        weights: as for `manipulability`: sum of w v^2 = 1.

    Returns:
        Semi-axes, the singular values, in the units of J; and directions.

    Raises:
        ValueError: as for `manipulability`.
    """
    U, sigma, _ = np.linalg.svd(_weighted(J, weights), full_matrices=False)
    largest = np.take_along_axis(U, np.abs(U).argmax(axis=-2)[..., None, :], axis=-2)
    return Ellipsoid(sigma, U * np.sign(largest))


def _weighted(J: ArrayLike, weights: ArrayLike | None) -> NDArray:
    J = matrices(J)
    return J if weights is None else J / scale_of(weights, J.shape[-1])
