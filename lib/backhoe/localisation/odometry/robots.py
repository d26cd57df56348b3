"""Robots on wheels and tracks: from wheel speeds to the velocity of the body and of the pose.

In the body, with x forward and y left, the wheels' speeds u and the velocity are tied by constant
matrices, u = W (v_x, v_y, omega) and (v_x, v_y, omega) = B u; the heading turns B into the Jacobian
J(psi) of PUCP (6). Wheels are in the order left, right; left before right, front before rear.

Source: PUCP guide 2024, section 2, which names the robots and gives none of their matrices;
Mastalli 2013, eqs. (2.8) to (2.10), corrected. Reference: Lynch and Park, Modern Robotics (2017),
section 13.2.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, tan

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers, positive, whole
from backhoe.machine import BACKHOE, Machine


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot by what its wheels roll when its body moves.

    Attributes:
        name: what it is.
        wheels: names of its n wheels, in order.
        rolling: W, wheel speeds of a body velocity, shape (n, 3) [rad/m, rad/m, 1].
        body: B, the body velocity that explains wheel speeds best, shape (3, n) [m, m, 1]: the
            pseudoinverse of W. A differential drive cannot tell v_y, for which B says 0.
    """

    name: str
    wheels: tuple[str, ...]
    rolling: NDArray
    body: NDArray

    def jacobian(self, psi: ArrayLike) -> NDArray:
        """J(psi) of PUCP (6): rates of x, y, psi for each wheel's speed.

        Args:
            psi: heading, shape (...) [rad].

        Returns:
            Shape (..., 3, n) [m, m, 1].

        Raises:
            ValueError: psi is not finite numbers.
        """
        psi = numbers(psi, "psi")
        turn = np.zeros((*psi.shape, 3, 3))
        turn[..., 0, 0] = turn[..., 1, 1] = np.cos(psi)
        turn[..., 1, 0] = np.sin(psi)
        turn[..., 0, 1] = -turn[..., 1, 0]
        turn[..., 2, 2] = 1.0
        return turn @ self.body

    def rate(self, pose: ArrayLike, u: ArrayLike) -> NDArray:
        """Rate of the pose, f(x, u) of PUCP (9) = J(psi) u.

        Args:
            pose: x, y, psi, shape (..., 3) [m, m, rad].
            u: wheel speeds, shape (..., n) [rad/s].

        Returns:
            Shape (..., 3) [m/s, m/s, rad/s].

        Raises:
            ValueError: pose does not end in 3, or u in n finite numbers.
        """
        pose = numbers(pose, "pose", (..., 3), meaning="values (x, y, psi)")
        return (self.jacobian(pose[..., 2]) @ self._speeds(u)[..., None])[..., 0]

    def velocity(self, u: ArrayLike) -> NDArray:
        """v_x, v_y, omega (..., 3) [m/s, m/s, rad/s] from wheel speeds (..., n) [rad/s]."""
        return self._speeds(u) @ self.body.T

    def wheel_speeds(self, velocity: ArrayLike) -> NDArray:
        """Wheel speeds (..., n) [rad/s] from v_x, v_y, omega (..., 3) [m/s, m/s, rad/s]."""
        meaning = "values (v_x, v_y, omega)"
        return numbers(velocity, "velocity", (..., 3), meaning=meaning) @ self.rolling.T

    def unexplained(self, u: ArrayLike) -> NDArray:
        """The part of wheel speeds that no motion without slip explains, shape (..., n) [rad/s].

        0 for any speeds of two tracks or three wheels; four wheels have one such part, which tells
        of slip.
        """
        u = self._speeds(u)
        return u - self.velocity(u) @ self.rolling.T

    def _speeds(self, u: ArrayLike) -> NDArray:
        wheels = self.wheels
        return numbers(u, "u", (..., len(wheels)), meaning=f"values ({', '.join(wheels)})")


def differential(radius: float, gauge: float, name: str = "differential drive") -> Robot:
    """Two wheels on one axis, and a vehicle on tracks that do not slip along themselves.

    Args:
        radius: of the wheels or sprockets [m].
        gauge: distance between the wheels' middles [m].
        name: what it is.

    Returns:
        The robot, wheels left, right.

    Raises:
        ValueError: a length is not positive.
    """
    r, half = positive(radius, "radius", "m"), positive(gauge, "gauge", "m") / 2
    return _robot(name, ("left", "right"), np.array([[1, 0, -half], [1, 0, half]]) / r)


def tracks(machine: Machine = BACKHOE, *, gauge: float | None = None) -> Robot:
    """The backhoe on its tracks, by the speeds of its sprockets.

    Args:
        machine: its sprocket radius and gauge count.
        gauge: an effective gauge, longer than the machine's own, that makes up for the slip of
            turning [m]; see `calibration` and `skid_steer.identify`.

    Returns:
        The robot, wheels left, right.

    Raises:
        ValueError: gauge is not positive.
    """
    gauge = machine.tracks.gauge if gauge is None else gauge
    return differential(machine.tracks.sprocket_radius, gauge, "tracks")


def omni(radius: float, distance: float, count: int = 3, first: float = 0.0) -> Robot:
    """Omnidirectional wheels evenly on a ring, each rolling along the ring.

    Wheel i stands at angle `first` + 2 pi i / count from x; positive speeds turn the robot
    anticlockwise. Rollers let it slide along its own axis.

    Args:
        radius: of the wheels [m].
        distance: from the robot's middle to each wheel [m].
        count: number of wheels, 3 or more.
        first: angle of the first wheel [rad].

    Returns:
        The robot, wheels anticlockwise from the first.

    Raises:
        ValueError: a length is not positive, or fewer than 3 wheels.
    """
    r, distance = positive(radius, "radius", "m"), positive(distance, "distance", "m")
    count = whole(count, "count", least=3)
    angles = number(first, "first", "rad") + 2 * pi * np.arange(count) / count
    rim = np.stack([-np.sin(angles), np.cos(angles), np.full(count, distance)], axis=-1)
    names = tuple(f"wheel {i}" for i in range(count))
    return _robot(f"{count} omnidirectional wheels", names, rim / r)


def mecanum(
    radius: float, half_length: float, half_width: float, roller_angle: float = pi / 4
) -> Robot:
    """Four mecanum wheels; seen from above, the rollers on top form an X.

    A wheel pushes only along the axis of the roller that touches the ground. With (x_i, y_i) its
    place and s_i = -1, 1, 1, -1 the side to which that axis leans,

        r u_i = (v_x - omega y_i) + s_i tan(roller_angle) (v_y + omega x_i).

    Args:
        radius: of the wheels [m].
        half_length, half_width: from the middle to the axles, and to the wheels' middles [m].
        roller_angle: between the wheel's plane and the axis of its rollers [rad].

    Returns:
        The robot, wheels front left, front right, rear left, rear right.

    Raises:
        ValueError: a length is not positive, or the angle is not between 0 and pi/2.
    """
    r = positive(radius, "radius", "m")
    a, b = positive(half_length, "half_length", "m"), positive(half_width, "half_width", "m")
    roller_angle = number(roller_angle, "roller_angle", "rad", above=0, below=pi / 2)
    x, y = np.array([a, a, -a, -a]), np.array([b, -b, b, -b])
    lean = np.array([-1, 1, 1, -1]) * tan(roller_angle)
    names = ("front left", "front right", "rear left", "rear right")
    rim = np.stack([np.ones(4), lean, lean * x - y], axis=-1)
    return _robot("mecanum wheels", names, rim / r)


def _robot(name: str, wheels: tuple[str, ...], rolling: NDArray) -> Robot:
    body = np.linalg.pinv(rolling)
    body[np.abs(body) < 1e-15 * np.abs(body).max()] = 0.0
    for matrix in (rolling, body):
        matrix.setflags(write=False)
    return Robot(name, wheels, rolling, body)
