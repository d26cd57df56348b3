"""Robots of a platform and an arm: where the hand is, and how it moves.

A robot's posture q is x, y, theta of the platform and then its joints; its velocities v are u along
the heading, omega, and then the joints' speeds. The platform cannot move sideways, so there is one
velocity less than there are coordinates.

Source: Sasig and Chicaiza 2017, geometric and kinematic model of the mobile manipulator.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.basics.inputs import instance, not_negative, numbers, positive, short, whole
from backhoe.basics.named import named, shown_by_name
from backhoe.machine import BACKHOE as MACHINE
from backhoe.machine import Machine


class Robot(Protocol):
    """What `hand` and `jacobian` ask of a robot: the hand as its platform sees it."""

    joints: int

    def reach(self, q_arm: NDArray) -> NDArray:
        """Hand in the platform's frame for joint angles (..., joints) [rad], (..., 3) [m]."""

    def reach_jacobian(self, q_arm: NDArray) -> NDArray:
        """Its derivative by the angles, shape (..., 3, joints) [m/rad]."""

    def axes(self, q_arm: NDArray) -> NDArray:
        """Axes of the joints in the platform's frame, unit vectors, shape (..., 3, joints) [1]."""


@shown_by_name
@dataclass(frozen=True)
class SlidesRobot:
    """The slides' robot: an arm of three joints, `a` ahead of the axle's middle.

    `h` is the height of the shoulder, `l2` and `l3` the links [m]. The slides print no numbers;
    these are our choice, of the size of the robot in their pictures.
    """

    a: float = 0.2
    h: float = 0.4
    l2: float = 0.275
    l3: float = 0.275
    joints = 3

    def __post_init__(self) -> None:
        not_negative(self.a, "SlidesRobot.a", "m")
        for name in ("h", "l2", "l3"):
            positive(getattr(self, name), f"SlidesRobot.{name}", "m")

    def reach(self, q_arm: NDArray) -> NDArray:
        """Hand in the platform's frame, (..., 3) [m]; q1 turns, q2 and q3 lift, (..., 3) [rad]."""
        q1, q2, q3 = np.moveaxis(_angles(q_arm), -1, 0)
        r, z = self._side_view(q2, q2 + q3)
        return np.stack([self.a + r * np.cos(q1), r * np.sin(q1), z], axis=-1)

    def reach_jacobian(self, q_arm: NDArray) -> NDArray:
        """Its derivative by q1, q2, q3, shape (..., 3, 3) [m/rad]."""
        q1, q2, q3 = np.moveaxis(_angles(q_arm), -1, 0)
        cosine, sine, q23 = np.cos(q1), np.sin(q1), q2 + q3
        r, z = self._side_view(q2, q23)
        J = np.empty((*q1.shape, 3, 3))
        J[..., :, 0] = np.stack([-r * sine, r * cosine, np.zeros_like(r)], axis=-1)
        hinges = ((0.0, self.h), (self.l2 * np.cos(q2), self.h + self.l2 * np.sin(q2)))
        for column, (x, height) in enumerate(hinges, start=1):
            ahead, above = r - x, z - height
            J[..., :, column] = np.stack([-above * cosine, -above * sine, ahead], axis=-1)
        return J

    def axes(self, q_arm: NDArray) -> NDArray:
        """Axes of the joints, shape (..., 3, 3) [1]: up, then twice to the right of the arm."""
        q_arm = _angles(q_arm)
        axes = np.zeros((*q_arm.shape[:-1], 3, 3))
        axes[..., 2, 0] = 1.0
        axes[..., 0, 1:] = np.sin(q_arm[..., :1])
        axes[..., 1, 1:] = -np.cos(q_arm[..., :1])
        return axes

    def _side_view(self, q2: NDArray, q23: NDArray) -> tuple[NDArray, NDArray]:
        """Distance of the hand from the shoulder's axis, and its height [m]."""
        r = self.l2 * np.cos(q2) + self.l3 * np.cos(q23)
        return r, self.h + self.l2 * np.sin(q2) + self.l3 * np.sin(q23)


def _angles(q_arm: ArrayLike) -> NDArray:
    return numbers(q_arm, "q_arm", (..., 3), meaning="joints")


@shown_by_name
@dataclass(frozen=True)
class Excavator:
    """The backhoe as such a robot: tracks, four joints, and the tip of the bucket as its hand."""

    machine: Machine = MACHINE
    joints = 4

    def __post_init__(self) -> None:
        instance(self.machine, "Excavator.machine", Machine)

    def reach(self, q_arm: NDArray) -> NDArray:
        """Bucket's tip in the vehicle's frame, (..., 3) [m]; swing to bucket, (..., 4) [rad]."""
        return kinematics.forward_kinematics(q_arm, machine=self.machine)[..., :3, 3]

    def reach_jacobian(self, q_arm: NDArray) -> NDArray:
        """Its derivative by the four angles, shape (..., 3, 4) [m/rad]."""
        return kinematics.jacobian(q_arm, machine=self.machine)[..., :3, :]

    def axes(self, q_arm: NDArray) -> NDArray:
        """Axes of the joints, shape (..., 3, 4) [1]."""
        return kinematics.jacobian(q_arm, machine=self.machine)[..., 3:, :]


SLIDES = named("SLIDES", SlidesRobot())
BACKHOE = named("BACKHOE", Excavator())


def hand(q: ArrayLike, robot: Robot = BACKHOE) -> NDArray:
    """Where the hand is in the world.

    Args:
        q: x, y [m], theta and the joints [rad], shape (..., 3 + joints).
        robot: `BACKHOE`, `SLIDES` or one of your own.

    Returns:
        Shape (..., 3) [m].

    Raises:
        ValueError: q has another length, or a value is not finite.
    """
    q = posture(q, robot)
    at = (heading(q) @ reach(q, robot)[..., None])[..., 0]
    at[..., :2] += q[..., :2]
    return at


def jacobian(q: ArrayLike, robot: Robot = BACKHOE) -> NDArray:
    """Velocity of the hand in the world by the velocities of the robot: `hand` moves at J @ v.

    Source: Sasig and Chicaiza 2017, kinematic model of the mobile manipulator; of its second row,
    which the slide hides in part, the term of q2 needs a minus.

    Args:
        q: as for `hand`, shape (..., 3 + joints) [m, m, rad, ...].
        robot: as for `hand`.

    Returns:
        J for v = u [m/s], omega and the joints' speeds [rad/s], shape (..., 3, 2 + joints) [1 in
        the first column, m/rad in the others].

    Raises:
        ValueError: as for `hand`.
    """
    q = posture(q, robot)
    at, shape = reach(q, robot), (*q.shape[:-1], 3, robot.joints)
    J = np.zeros((*q.shape[:-1], 3, 2 + robot.joints))  # in the platform's axes
    J[..., 0, 0] = 1.0
    J[..., 0, 1], J[..., 1, 1] = -at[..., 1], at[..., 0]
    J[..., 2:] = numbers(robot.reach_jacobian(q[..., 3:]), "reach_jacobian of the robot", shape)
    return heading(q) @ J


def heading(q: NDArray) -> NDArray:
    """The platform's axes in the world at a checked posture q, (..., 3 + joints) to (..., 3, 3)."""
    R = np.zeros((*q.shape[:-1], 3, 3))
    R[..., 0, 0] = R[..., 1, 1] = np.cos(q[..., 2])
    R[..., 1, 0] = np.sin(q[..., 2])
    R[..., 0, 1] = -R[..., 1, 0]
    R[..., 2, 2] = 1.0
    return R


def reach(q: NDArray, robot: Robot) -> NDArray:
    """The hand in the platform's frame at a checked posture q, (..., 3 + joints) to (..., 3) [m].

    Raises:
        ValueError: the robot gives something else.
    """
    return numbers(robot.reach(q[..., 3:]), "reach of the robot", (*q.shape[:-1], 3))


def posture(q: ArrayLike, robot: Robot) -> NDArray:
    """q checked: x, y [m], theta and the joints [rad], shape (..., 3 + joints).

    Raises:
        TypeError: robot is none.
        ValueError: its joints are not 1 or more, another length, or a value is not finite.
    """
    joints_of(robot)
    meaning = f"values: x, y, theta and {robot.joints} joints"
    return numbers(q, "q", (..., 3 + robot.joints), meaning=meaning)


def joints_of(robot: Robot) -> int:
    """How many joints it has.

    Raises:
        TypeError: robot is none.
        ValueError: no whole number of 1 or more.
    """
    if isinstance(robot, type) or not hasattr(robot, "reach_jacobian"):
        raise TypeError(f"robot must be SLIDES, BACKHOE or like them, got {short(robot)}")
    return whole(robot.joints, "joints of the robot", least=1)
