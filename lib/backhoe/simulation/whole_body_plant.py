"""Tracks and arm of a simulated machine as one plant, driven by wanted velocities.

What a whole-body controller gives, u along the heading, omega and the joints' speeds, becomes belt
speeds and, a thousand times a second, joint torques. The machine does not have these velocities at
once: belts speed up as fast as they can and slip, joints answer within their `servo`'s bandwidth,
and soil holds the bucket. What it has got is `v`.

In a turn the tracks must slide sideways, and the belts turn the machine by about three quarters of
what they would without slip. What is missing, as a gyro measures it, adds up and is given on top.
"""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.dynamics import terms
from backhoe.basics.inputs import not_negative, numbers, positive
from backhoe.machine import BACKHOE, Machine
from backhoe.simulation.clock import ticks
from backhoe.simulation.protocol import World
from backhoe.simulation.servo import BANDWIDTH
from backhoe.whole_body.robots import Excavator

TURNING = 4.0
"""Gain of the turn that is missing [1/s]: ours."""

MOST_ADDED = 0.3
"""Largest turning speed that is given on top [rad/s]: a machine that is held gathers no more."""

_VELOCITIES = "u, omega and the speeds of swing, boom, stick, bucket"


class WholeBodyPlant:
    """The simulated machine as a plant for `whole_body`; the world is left open at the end.

    Args:
        world: a simulation on tracks, with or without soil; it is driven from where it stands.
        dt: how long velocities are held [s], a whole multiple of the world's step.
        bandwidth: of the joints' drives [rad/s]; see `servo`.
        turning: gain of the turn that slip takes [1/s]; 0 for belts that know of no slip.

    Attributes:
        world, machine, dt: as given.
        robot: the machine for `whole_body.jacobian` and the like.

    Raises:
        ValueError: dt is no whole multiple of the step, bandwidth is not positive, turning is
            negative, or the world's base cannot move.
    """

    def __init__(
        self,
        world: World,
        *,
        dt: float = 0.01,
        bandwidth: float = BANDWIDTH,
        turning: float = TURNING,
    ) -> None:
        if getattr(world, "base", "tracks") == "fixed":
            raise ValueError("a fixed base cannot drive: open the world with tracks")
        from backhoe.simulation import engine

        self._drive = engine.speed_torque
        self.world, self.machine = world, world.machine
        self.robot = Excavator(world.machine)
        self._ticks = ticks(dt, world.dt)
        self.dt = self._ticks * world.dt
        self._bandwidth = positive(bandwidth, "bandwidth", "rad/s")
        self._turning = not_negative(turning, "turning", "1/s")
        machine = world.machine
        self._arm = np.array(terms.arm_of(machine))
        self._friction = np.array([machine.viscous, machine.coulomb])
        self._limit = np.array(machine.torque_limit, dtype=float)
        self._torque = np.zeros(4)
        self.wake()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.world.time

    @property
    def q(self) -> NDArray:
        """x, y, heading and joint angles, shape (7,) [m, m, rad, ...]."""
        return np.concatenate([self.world.pose, self.world.q])

    @property
    def v(self) -> NDArray:
        """Velocities it has: u, omega and the joints' speeds, shape (6,) [m/s, rad/s, ...]."""
        heading = self.world.pose[2]
        dx, dy, omega = self.world.twist
        return np.concatenate([[dx * cos(heading) + dy * sin(heading), omega], self.world.dq])

    def step(self, v: ArrayLike) -> None:
        """Go on for `dt` with wanted velocities.

        Args:
            v: u, omega and the joints' speeds, shape (6,) [m/s, rad/s, ...].

        Raises:
            ValueError: not six finite numbers.
            RuntimeError: the simulation is closed, or the machine ran away.
            Tipped: the machine tips over (a RuntimeError).
        """
        v = numbers(v, "v", (6,), meaning=_VELOCITIES)
        world, torque, angle, dt = self.world, self._torque, self._angle, self.world.dt
        missing = self._missing + self.dt * self._turning * (v[1] - float(world.twist[2]))
        self._missing = min(max(missing, -MOST_ADDED), MOST_ADDED)
        belts, speed = belt_speeds(v[0], v[1] + self._missing, self.machine), v[2:]
        payload = 0.0 if world.ground is None else world.ground.payload
        self._arm[-1] = self.machine.bucket.mass + payload
        fixed = self._arm, self._friction, self._limit, self._bandwidth
        state = np.empty((2, 4))
        for _ in range(self._ticks):
            state[0], state[1] = world.q, world.dq
            self._drive(*fixed, state, speed, dt, angle, torque)
            world.step(torque, belts)

    def wake(self) -> None:
        """Take the present posture for the wanted one: after a reset or restore of the world."""
        self._angle, self._missing = self.world.q.copy(), 0.0


def belt_speeds(u: float, omega: float, machine: Machine = BACKHOE) -> NDArray:
    """Speed of the left and right belt that drive and turn the machine so, without slip.

    Args:
        u, omega: forward and turning speed [m/s, rad/s].
        machine: its gauge counts.

    Returns:
        Shape (2,) [m/s].
    """
    half = machine.tracks.gauge / 2 * omega
    return np.array([u - half, u + half])
