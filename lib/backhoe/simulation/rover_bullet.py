"""The rover in PyBullet: a body of Bullet under the library's wheel friction, or Bullet's own.

Bullet carries the body on four elastic, frictionless spheres and gives each wheel's load. The
slipping model goes some milliseconds ahead with these loads from the velocity that Bullet says, and
what it adds to momentum and angular momentum is the force of the ground: it attacks on the ground,
so the body pitches and rolls, and loads shift. All damping of the motion is off; the same inputs
repeat bit for bit.
"""

from __future__ import annotations

import tempfile
from math import atan2, cos, pi, sin
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from backhoe.simulation import bullet
from backhoe.simulation.rover import STEP, Rover
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
    _wheels, _shape, _rub = "fixed", "sphere", 0.0

    def _open(self) -> None:
        self._engine = bullet.pybullet()
        self._client = bullet.connect()
        self._lever = body_middle(self.vehicle)[0]

    def _shut(self) -> None:
        self._engine.disconnect(physicsClientId=self._client)

    def _place(self) -> None:
        engine, client = self._engine, self._client
        engine.resetSimulation(physicsClientId=client)
        engine.setTimeStep(STEP, physicsClientId=client)
        engine.setGravity(0, 0, -self.vehicle.gravity, physicsClientId=client)
        plane = engine.createCollisionShape(engine.GEOM_PLANE, physicsClientId=client)
        self._ground = engine.createMultiBody(0, plane, physicsClientId=client)
        x, y, heading = self._state[:3]
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "rover.urdf"
            path.write_text(rover_urdf(self.vehicle, wheels=self._wheels, shape=self._shape))
            self._body = engine.loadURDF(
                str(path),
                [x, y, 0.0],
                [0.0, 0.0, sin(heading / 2), cos(heading / 2)],
                flags=engine.URDF_USE_INERTIA_FROM_FILE,
                physicsClientId=client,
            )
        share = self.vehicle.mass / 4
        stiffness = share * self.vehicle.gravity / SINKING
        damping = 2 * TYRE_DAMPING * (stiffness * share) ** 0.5
        for link in range(-1, 4):
            engine.changeDynamics(
                self._body,
                link,
                lateralFriction=self._rub,
                contactStiffness=stiffness,
                contactDamping=damping,
                spinningFriction=0,
                rollingFriction=0,
                linearDamping=0,
                angularDamping=0,
                jointDamping=0,
                physicsClientId=client,
            )
        for _ in range(SETTLING):
            engine.stepSimulation(physicsClientId=client)
        self._read()

    def _move(self, start: NDArray, seconds: float) -> None:
        engine, client, p, ahead = self._engine, self._client, self.vehicle, self._state
        force = (_in_world(ahead) - _in_world(start)) * (p.mass / seconds)
        moment = p.inertia * (ahead[5] - start[5]) / seconds
        engine.setTimeStep(seconds, physicsClientId=client)
        engine.applyExternalForce(
            self._body,
            -1,
            [force.real, force.imag, 0.0],
            [start[0], start[1], 0.0],
            engine.WORLD_FRAME,
            physicsClientId=client,
        )
        engine.applyExternalTorque(
            self._body, -1, [0.0, 0.0, moment], engine.WORLD_FRAME, physicsClientId=client
        )
        engine.stepSimulation(physicsClientId=client)
        ahead[2] = start[2]
        self._read()

    def _read(self) -> None:
        """Pose, velocity and loads as Bullet has them, into the state."""
        engine, client, state = self._engine, self._client, self._state
        (x, y, _), (_, _, qz, qw) = engine.getBasePositionAndOrientation(
            self._body, physicsClientId=client
        )
        (dx, dy, _), (_, _, omega) = engine.getBaseVelocity(self._body, physicsClientId=client)
        heading = 2 * atan2(qz, qw)
        heading += 2 * pi * round((float(state[2]) - heading) / (2 * pi))
        c, s, lever = cos(heading), sin(heading), self._lever
        along, across = c * dx + s * dy, c * dy - s * dx
        state[:6] = x - c * lever, y - s * lever, heading, along, across - omega * lever, omega
        loads = [0.0] * 5
        for contact in engine.getContactPoints(self._body, self._ground, physicsClientId=client):
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
        self._engine.changeDynamics(
            self._ground, -1, lateralFriction=1.0, physicsClientId=self._client
        )
        self._engine.setJointMotorControlArray(
            self._body,
            range(4),
            self._engine.VELOCITY_CONTROL,
            forces=[0.0] * 4,
            physicsClientId=self._client,
        )
        self._turning = np.zeros(4)

    def _move(self, start: NDArray, seconds: float) -> None:
        """Bullet has moved the body already."""

    def _advance(self, rotors: NDArray) -> None:
        engine, client, p = self._engine, self._client, self.vehicle
        if (rotors != self._turning).any():
            self._add_rotors(rotors)
        speeds = self._state[6:]
        rolling = self._loads * p.rolling * p.wheel_radius**2
        torque = self._drive - (self._damping + rolling) * speeds
        engine.setJointMotorControlArray(
            self._body,
            range(4),
            engine.TORQUE_CONTROL,
            forces=torque.tolist(),
            physicsClientId=client,
        )
        engine.stepSimulation(physicsClientId=client)
        states = engine.getJointStates(self._body, range(4), physicsClientId=client)
        self._state[6:] = [state[1] for state in states]
        self._read()

    def _add_rotors(self, rotors: NDArray) -> None:
        p = self.vehicle
        across = p.wheel_inertia / 2 + p.wheel_mass * p.wheel_width**2 / 12
        for wheel, inertia in enumerate(rotors):
            self._engine.changeDynamics(
                self._body,
                wheel,
                localInertiaDiagonal=[across, p.wheel_inertia + inertia, across],
                physicsClientId=self._client,
            )
        self._turning = rotors.copy()


def _in_world(state: NDArray) -> complex:
    """Velocity in the world as a complex number, x + iy [m/s]."""
    return complex(state[3], state[4]) * complex(cos(state[2]), sin(state[2]))
