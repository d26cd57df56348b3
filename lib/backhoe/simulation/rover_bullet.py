"""The rover in PyBullet: a body of Bullet under the library's wheel friction, or Bullet's own.

Bullet carries the body on four elastic, frictionless spheres and gives each wheel's load. The
slipping model goes some milliseconds ahead with these loads from the velocity that Bullet says, and
what it adds to momentum and angular momentum is the force of the ground: it attacks on the ground,
so the body pitches and rolls, and loads shift. All damping of the motion is off; the same inputs
repeat bit for bit.
"""

from __future__ import annotations

from math import atan2, cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from backhoe.simulation import bullet
from backhoe.simulation.clock import STEP
from backhoe.simulation.rover import Rover
from backhoe.simulation.rover_urdf import body_middle, rover_urdf

SETTLING = 400
"""Steps before time 0 in which the wheels find their loads."""

SINKING = 0.003
"""How far a tyre gives under its load [m], ours: four rigid wheels would have no definite loads."""

TYRE_DAMPING = 0.5
"""Damping ratio of a tyre under its share of the mass: ours."""


class BulletRover(Rover):
    """A `Rover` whose body PyBullet moves; arguments as there.

    Raises:
        ImportError: PyBullet is not installed.
    """

    backend = "pybullet"
    _wheels, _rub = "fixed", 0.0

    def _open(self) -> None:
        self._server = bullet.Server()
        self._lever = body_middle(self.vehicle)[0]

    def _shut(self) -> None:
        self._server.disconnect()

    def _place(self) -> None:
        server = self._server
        server.resetSimulation()
        server.setTimeStep(STEP)
        server.setGravity(0, 0, -self.vehicle.gravity)
        self._ground = server.createMultiBody(0, server.createCollisionShape(server.GEOM_PLANE))
        x, y, heading = self._state[:3]
        self._body = server.load_urdf(
            rover_urdf(self.vehicle, wheels=self._wheels),
            (x, y, 0.0),
            (0.0, 0.0, sin(heading / 2), cos(heading / 2)),
        )
        share = self.vehicle.mass / 4
        stiffness = share * self.vehicle.gravity / SINKING
        server.free(
            self._body,
            lateralFriction=self._rub,
            contactStiffness=stiffness,
            contactDamping=2 * TYRE_DAMPING * (stiffness * share) ** 0.5,
            spinningFriction=0,
            rollingFriction=0,
        )
        for _ in range(SETTLING):
            server.stepSimulation()
        self._read()

    def _move(self, start: NDArray, seconds: float) -> None:
        server, p, ahead = self._server, self.vehicle, self._state
        force = (_in_world(ahead) - _in_world(start)) * (p.mass / seconds)
        moment = p.inertia * (ahead[5] - start[5]) / seconds
        server.setTimeStep(seconds)
        server.applyExternalForce(
            self._body,
            -1,
            [force.real, force.imag, 0.0],
            [start[0], start[1], 0.0],
            server.WORLD_FRAME,
        )
        server.applyExternalTorque(self._body, -1, [0.0, 0.0, moment], server.WORLD_FRAME)
        server.stepSimulation()
        ahead[2] = start[2]
        self._read()

    def _read(self) -> None:
        """Pose, velocity and loads as Bullet has them, into the state."""
        server, state = self._server, self._state
        (x, y, _), (_, _, qz, qw) = server.getBasePositionAndOrientation(self._body)
        (dx, dy, _), (_, _, omega) = server.getBaseVelocity(self._body)
        heading = 2 * atan2(qz, qw)
        heading += 2 * pi * round((float(state[2]) - heading) / (2 * pi))
        c, s, lever = cos(heading), sin(heading), self._lever
        along, across = c * dx + s * dy, c * dy - s * dx
        state[:6] = x - c * lever, y - s * lever, heading, along, across - omega * lever, omega
        loads = [0.0] * 5
        for contact in server.getContactPoints(self._body, self._ground):
            loads[contact[3]] += contact[9]
        self._loads = np.array(loads[:4])


class ContactRover(BulletRover):
    """The rover on Bullet's own contacts and friction, for comparison; arguments as `Rover`.

    The wheels are Bullet's, with the rotors' inertia added; the friction coefficient along the
    wheel counts for both directions.
    """

    _wheels = "continuous"
    _grouped = False

    def _open(self) -> None:
        self._rub = self.vehicle.friction_longitudinal
        super()._open()

    def _place(self) -> None:
        super()._place()
        self._server.changeDynamics(self._ground, -1, lateralFriction=1.0)
        self._server.switch_off(self._body, range(4))
        self._turning = np.zeros(4)

    def _move(self, start: NDArray, seconds: float) -> None:
        """Bullet has moved the body already."""

    def _advance(self, rotors: NDArray) -> None:
        if (rotors != self._turning).any():
            self._add_rotors(rotors)
        rolling = self._loads * self.vehicle.rolling * self.vehicle.wheel_radius**2
        torque = self._drive - (self._damping + rolling) * self._state[6:]
        self._server.push(self._body, range(4), torque)
        states = self._server.getJointStates(self._body, range(4))
        self._state[6:] = [state[1] for state in states]
        self._read()

    def _add_rotors(self, rotors: NDArray) -> None:
        p = self.vehicle
        across = p.wheel_inertia / 2 + p.wheel_mass * p.wheel_width**2 / 12
        for wheel, inertia in enumerate(rotors):
            turning = [across, p.wheel_inertia + inertia, across]
            self._server.changeDynamics(self._body, wheel, localInertiaDiagonal=turning)
        self._turning = rotors.copy()


def _in_world(state: NDArray) -> complex:
    """Velocity in the world as a complex number, x + iy [m/s]."""
    return complex(state[3], state[4]) * complex(cos(state[2]), sin(state[2]))
