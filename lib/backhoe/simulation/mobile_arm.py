"""The slides' robot as a body in PyBullet: two driven wheels, a castor and an arm of three joints.

Its drives are Bullet's velocity motors, whose wanted speeds approach those that were told as a lag
does in `whole_body.KinematicPlant`. Wheels roll and grip by Bullet's contacts, with all that a body
on wheels does: so it comes near to that model, and never quite. Masses are ours, of the size of the
robot in the slides' pictures. The URDF is generated and never kept as a file.
"""

from __future__ import annotations

from math import atan2, cos, pi, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import instance, numbers, positive
from backhoe.simulation import bullet
from backhoe.simulation.clock import ticks
from backhoe.simulation.rover_urdf import link_urdf
from backhoe.whole_body.robots import SLIDES, SlidesRobot, posture

STEP = 0.005
"""Of Bullet [s]."""

RADIUS, HALF_TRACK = 0.1, 0.2
"""Of the driven wheels [m]."""

BODY, WHEEL, LINK = 30.0, 1.0, 1.2
"""Masses of body, wheel and each link of the arm [kg]."""

BALLAST = 0.05
"""How far ahead of the axle the body's centre of mass lies [m]."""

LAG = 0.05
"""Of all drives [s]."""

STRENGTH = (20.0, 20.0, 40.0, 40.0, 40.0)
"""Largest torques of wheels and joints [N m]."""

_SETTLING = 100
_DRIVES = ("left", "right", "q1", "q2", "q3")


class MobileArm:
    """The robot as a plant for `whole_body.follow`; use it in a `with` statement or close it.

    Args:
        robot: its lengths; the castor stands under the arm's foot and 10 cm further.
        q: posture at the start as for `whole_body.hand`, shape (6,) [m, m, rad, ...].
        dt: how long velocities are held, a whole multiple of `STEP` [s].
        lag: of its drives [s].

    Raises:
        ImportError: PyBullet is not installed; `whole_body.KinematicPlant` needs none.
        TypeError: robot is no `SlidesRobot`.
        ValueError: q, dt or lag is malformed.
    """

    backend = "pybullet"

    def __init__(
        self,
        robot: SlidesRobot = SLIDES,
        q: ArrayLike | None = None,
        *,
        dt: float = 0.1,
        lag: float = LAG,
    ) -> None:
        self.robot = instance(robot, "robot", SlidesRobot)
        self._start = posture(np.zeros(6) if q is None else q, robot).copy()
        self._ticks = ticks(dt, STEP)
        self.dt, self.lag = self._ticks * STEP, positive(lag, "lag", "s")
        self._kept = float(np.exp(-STEP / lag))
        self._server = bullet.Server()
        self.reset()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._count * STEP

    def step(self, v: ArrayLike) -> None:
        """Go on for dt with wanted velocities.

        Args:
            v: u, omega and the joints' speeds, shape (5,) [m/s, rad/s].

        Raises:
            ValueError: not five finite numbers.
        """
        u, omega, *joints = numbers(v, "v", (5,), meaning="u, omega and three speeds").tolist()
        turn = omega * HALF_TRACK
        self._run(np.array([(u - turn) / RADIUS, (u + turn) / RADIUS, *joints]), self._ticks)
        self._count += self._ticks
        self._read()

    def reset(self) -> None:
        """Back to the start, at rest, at time 0."""
        server, (x, y, heading, *joints) = self._server, self._start.tolist()
        server.resetSimulation()
        server.setTimeStep(STEP)
        server.setGravity(0, 0, -9.81)
        server.createMultiBody(0, server.createCollisionShape(server.GEOM_PLANE))
        turned = 0.0, 0.0, sin(heading / 2), cos(heading / 2)
        self._body = server.load_urdf(mobile_arm_urdf(self.robot), (x, y, 0.0), turned)
        server.free(self._body, lateralFriction=0, spinningFriction=0, rollingFriction=0)
        index = server.joints(self._body)
        self._drives = [index[name] for name in _DRIVES]
        for wheel in self._drives[:2]:
            server.changeDynamics(self._body, wheel, lateralFriction=1)
        for joint, angle in zip(self._drives[2:], joints, strict=True):
            server.resetJointState(self._body, joint, angle)
        self._speed = np.zeros(5)
        self._run(np.zeros(5), _SETTLING)
        self._count, self.q = 0, self._start.copy()
        self._read()

    def close(self) -> None:
        """Release the simulation; a second call does nothing."""
        if self._server is not None:
            self._server.disconnect()
            self._server = None

    def __enter__(self) -> MobileArm:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _run(self, wanted: NDArray, count: int) -> None:
        server = self._server
        if server is None:
            raise RuntimeError("this robot is closed: open a new one")
        for _ in range(count):
            self._speed = wanted + self._kept * (self._speed - wanted)
            server.setJointMotorControlArray(
                self._body,
                self._drives,
                server.VELOCITY_CONTROL,
                targetVelocities=self._speed.tolist(),
                forces=STRENGTH,
            )
            server.stepSimulation()

    def _read(self) -> None:
        """Posture and velocities as Bullet has them; it says where the body's middle is."""
        server = self._server
        (x, y, _), (_, _, qz, qw) = server.getBasePositionAndOrientation(self._body)
        (dx, dy, _), (_, _, omega) = server.getBaseVelocity(self._body)
        states = server.getJointStates(self._body, self._drives[2:])
        heading = 2 * atan2(qz, qw)
        heading += 2 * pi * round((float(self.q[2]) - heading) / (2 * pi))
        c, s = cos(heading), sin(heading)
        joints, speeds = ([state[which] for state in states] for which in (0, 1))
        self.q = np.array([x - BALLAST * c, y - BALLAST * s, heading, *joints])
        self.v = np.array([c * dx + s * dy, omega, *speeds])


def mobile_arm_urdf(robot: SlidesRobot = SLIDES) -> str:
    """URDF of the robot, its frame on the ground below the middle of the axle.

    Args:
        robot: its lengths.

    Returns:
        The XML text, with the joints left, right, q1, q2, q3.
    """
    foot, height = robot.a, 2 * RADIUS
    castor = foot + 0.1
    parts = [
        link_urdf("body", (BALLAST, 0.0, height), BODY, (0.4, 0.8, 1.0)),
        link_urdf("castor", (0.0, 0.0, 0.0), 0.1, (1e-4,) * 3, _ball(RADIUS / 2)),
        _joint("castor", "fixed", "body", (castor, 0.0, RADIUS / 2), "1 0 0"),
    ]
    for name, side in (("left", HALF_TRACK), ("right", -HALF_TRACK)):
        parts.append(link_urdf(name, (0.0, 0.0, 0.0), WHEEL, (0.003, 0.005, 0.003), _ball(RADIUS)))
        parts.append(_joint(name, "continuous", "body", (0.0, side, RADIUS), "0 1 0"))
    hinges = (
        ("q1", foot, robot.h, "0 0 1"),
        ("q2", 0.0, 0.0, "0 -1 0"),
        ("q3", robot.l2, 0.0, "0 -1 0"),
    )
    before = "body"
    for (name, ahead, above, axis), length in zip(hinges, (0.0, robot.l2, robot.l3), strict=True):
        thick, long = LINK * 0.03**2, LINK * (0.03**2 + length**2 / 12)
        parts.append(link_urdf(name, (length / 2, 0.0, 0.0), LINK, (thick, long, long)))
        parts.append(_joint(name, "continuous", before, (ahead, 0.0, above), axis))
        before = name
    return "\n".join(['<?xml version="1.0"?>', '<robot name="mobile_arm">', *parts, "</robot>"])


def _ball(radius: float) -> str:
    return f'<sphere radius="{radius}"/>'


def _joint(name: str, kind: str, parent: str, at: tuple, axis: str) -> str:
    x, y, z = at
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{name}"/>'
        f'<origin xyz="{x} {y} {z}"/><axis xyz="{axis}"/></joint>'
    )
