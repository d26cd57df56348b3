"""The simulation in PyBullet: rigid bodies, contacts, rays and cameras.

The arm is torque-controlled; PyBullet's own motors and all its damping are off. The forces come
from `forces`, so PyBullet integrates the same machine as the analytic backend, by its own
articulated-body algorithm, and adds contacts.
"""

from __future__ import annotations

import tempfile
from math import pi, radians
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers, whole
from backhoe.machine import JOINTS, Machine
from backhoe.simulation import bullet
from backhoe.simulation.loop import Loop
from backhoe.simulation.urdf import ALL_JOINTS, T_urdf_dh, urdf
from backhoe.view.appearance import truck_boxes, visuals

TOUCHING = 8
"""Directions in which a link of the arm has a corner that touches."""


class BulletWorld(Loop):
    """A `Loop` whose motion PyBullet integrates; arguments as there.

    Raises:
        ImportError: PyBullet is not installed.
    """

    backend = "pybullet"

    def _open(self) -> None:
        self._renderer = self._rays = None
        self._server = bullet.Server()
        self._server.setTimeStep(self.dt)
        self._server.setGravity(0, 0, -self.machine.gravity)
        with tempfile.TemporaryDirectory() as folder:
            hulls = _write_hulls(self.machine, Path(folder)) if self.scene.truck else {}
            text = urdf(self.machine, hulls, self.base)
            self._body = self._server.load_urdf(text, useFixedBase=True)
        for lower, upper in truck_boxes(self.scene.truck):
            _add_box(self._server, lower, upper)
        self._server.free(self._body)
        self._joint = self._server.joints(self._body)
        moving = ALL_JOINTS if self.base == "tracks" else JOINTS
        self._moving = [self._joint[name] for name in moving]
        self._first = len(ALL_JOINTS) - len(moving)
        self._server.switch_off(self._body, self._moving)
        self._contacts, self._touching = self._server.getContactPoints, False

    def render(
        self,
        width: int = 640,
        height: int = 480,
        eye: ArrayLike = (10.5, -8.5, 5.0),
        target: ArrayLike = (2.4, 0.8, 1.5),
        field_of_view: float = radians(45),
        shadow: bool = True,
        samples: int = 1,
    ) -> NDArray:
        """A picture of the scene as it is now, by PyBullet's software renderer.

        Args:
            width, height: size [pixels].
            eye, target: where the camera is and looks at in the world, shape (3,) [m].
            field_of_view: vertical [rad].
            shadow: whether the sun casts shadows; takes about as long again.
            samples: each pixel is the mean of samples x samples: 2 for smooth edges.

        Returns:
            Red, green and blue, shape (height, width, 3), uint8.

        Raises:
            ValueError: a size or angle out of range, eye and target at one place.
            RuntimeError: the simulation is closed.
        """
        self._check_open()
        width, height = whole(width, "width", least=1), whole(height, "height", least=1)
        samples = whole(samples, "samples", least=1)
        field_of_view = number(field_of_view, "field_of_view", "rad", above=0.0, below=pi)
        eye, target = (
            numbers(point, name, (3,), meaning="x, y, z [m]")
            for point, name in ((eye, "eye"), (target, "target"))
        )
        if np.allclose(eye[:2], target[:2]):
            raise ValueError("eye must not be straight above, below or at the target")
        if self._renderer is None:
            from backhoe.simulation.render import Renderer

            self._renderer = Renderer(self)
        return self._renderer.picture(width, height, eye, target, field_of_view, shadow, samples)

    def cast_rays(self, start: ArrayLike, end: ArrayLike) -> NDArray:
        """Where rays first hit machine, truck or soil, as a laser scanner would.

        Args:
            start, end: ends of the rays in the world, shape (n, 3) [m]; a single start (3,) serves
                all.

        Returns:
            First hits from the start, shape (n, 3) [m]; NaN where a ray hits nothing.

        Raises:
            ValueError: another shape, or a value that is not finite.
            RuntimeError: the simulation is closed.
        """
        self._check_open()
        end = numbers(end, "end", ("n", 3), meaning="x, y, z [m]")
        start = numbers(start, "start", (3,) if np.ndim(start) == 1 else end.shape)
        if self._rays is None:
            from backhoe.simulation.rays import Rays

            self._rays = Rays(self)
        return self._rays.cast(np.broadcast_to(start, end.shape), end)

    def _shut(self) -> None:
        for view in (self._renderer, self._rays):
            if view is not None:
                view.close()
        self._server.disconnect()

    def _integrate(self) -> None:
        self._server.push(self._body, self._moving, self._state.forces[self._first :])
        self._read()
        if self.scene.truck is not None:
            self._feel()

    def _feel(self) -> None:
        """What the truck gives the machine: all contacts of the last step."""
        contacts = self._contacts(self._body)
        if contacts or self._touching:
            self._touching, touch = bool(contacts), self._balance.touch
            touch[:] = 0.0
            for _, _, _, _, _, at, _, normal, _, *forces in contacts:
                pressed, rubbed, along, scraped, across = forces
                force = np.dot([pressed, rubbed, scraped], [normal, along, across])
                touch += np.r_[force, np.cross(at, force)]

    def _read(self) -> None:
        angles, rates, *_ = zip(*self._server.getJointStates(self._body, self._moving), strict=True)
        self._state.q[self._first :], self._state.dq[self._first :] = angles, rates

    def _place(self) -> None:
        for index, angle in zip(self._moving, self._state.q[self._first :], strict=True):
            self._server.resetJointState(self._body, index, angle)
        self._read()

    def _keep(self) -> int:
        return self._server.saveState()

    def _bring_back(self, state: int) -> None:
        self._server.restoreState(stateId=state)
        self._touching = True

    def _forget(self, state: int) -> None:
        if not self._closed:
            self._server.removeState(state)

    def _carry(self, payload: float) -> None:
        self._server.changeDynamics(
            self._body,
            self._joint["bucket"],
            mass=self.machine.bucket.mass + payload,
            localInertiaDiagonal=[self.machine.bucket.inertia] * 3,
        )


def _write_hulls(machine: Machine, folder: Path) -> dict[str, Path]:
    """One OBJ file for each link of the arm, in the link's URDF frame: its convex hull collides.

    The hull has only the corners that lie furthest out in `TOUCHING` directions.
    """
    angle = np.arange(TOUCHING) * 2 * np.pi / TOUCHING
    directions = np.c_[np.cos(angle), np.sin(angle), np.zeros(TOUCHING)]
    files = {}
    for link in JOINTS[1:]:
        points = np.vstack([part.vertices for part in visuals(machine)[link]])
        width = np.abs(points[:, 2]).max()
        outline = points[np.unique((points @ directions.T).argmax(axis=0))]
        corners = np.vstack([outline * [1, 1, 0] + [0, 0, side * width] for side in (-1, 1)])
        T = T_urdf_dh(link, machine)
        corners = corners @ T[:3, :3].T + T[:3, 3]
        lines = [f"v {x:.4f} {y:.4f} {z:.4f}" for x, y, z in corners]
        lines += [f"f 1 {i} {i + 1}" for i in range(2, len(corners))]
        files[link] = folder / f"{link}.obj"
        files[link].write_text("\n".join(lines))
    return files


def _add_box(server: bullet.Server, lower: NDArray, upper: NDArray) -> None:
    """A box that stands still, between two corners (3,) [m]."""
    half = ((upper - lower) / 2).tolist()
    shape = server.createCollisionShape(server.GEOM_BOX, halfExtents=half)
    server.createMultiBody(
        baseCollisionShapeIndex=shape, basePosition=((upper + lower) / 2).tolist()
    )
