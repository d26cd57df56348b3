"""The simulation in PyBullet: rigid bodies, contacts, rays and cameras.

The arm is torque-controlled; PyBullet's own motors and all its damping are off. The forces come
from `forces`, so PyBullet integrates the same machine as the analytic backend, by its own
articulated-body algorithm, and adds contacts.
"""

from __future__ import annotations

import tempfile
from math import pi, radians
from pathlib import Path
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
        self._engine = bullet.pybullet()
        self._client = bullet.connect()
        engine, client = self._engine, self._client
        engine.setTimeStep(self.dt, physicsClientId=client)
        engine.setGravity(0, 0, -self.machine.gravity, physicsClientId=client)
        with tempfile.TemporaryDirectory() as folder:
            hulls = _write_hulls(self.machine, Path(folder)) if self.scene.truck else {}
            path = Path(folder) / "backhoe.urdf"
            path.write_text(urdf(self.machine, hulls, self.base))
            self._body = engine.loadURDF(
                str(path),
                useFixedBase=True,
                flags=engine.URDF_USE_INERTIA_FROM_FILE,
                physicsClientId=client,
            )
        for lower, upper in truck_boxes(self.scene.truck):
            _add_box(engine, client, lower, upper)
        self._joint = _joints_by_name(engine, self._body, client)
        for index in (-1, *self._joint.values()):
            engine.changeDynamics(
                self._body,
                index,
                linearDamping=0,
                angularDamping=0,
                jointDamping=0,
                physicsClientId=client,
            )
        moving = ALL_JOINTS if self.base == "tracks" else JOINTS
        self._moving = [self._joint[name] for name in moving]
        self._first = len(ALL_JOINTS) - len(moving)
        engine.setJointMotorControlArray(
            self._body,
            self._moving,
            engine.VELOCITY_CONTROL,
            forces=[0.0] * len(moving),
            physicsClientId=client,
        )

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
        for name, value in (("width", width), ("height", height), ("samples", samples)):
            if isinstance(value, bool) or not isinstance(value, int) or value < 1:
                raise ValueError(f"{name} must be a whole number, 1 or more, got {value!r}")
        if not 0 < field_of_view < pi:
            raise ValueError(f"field_of_view must be between 0 and pi rad, got {field_of_view!r}")
        eye, target = np.asarray(eye, dtype=float), np.asarray(target, dtype=float)
        if eye.shape != (3,) or target.shape != (3,) or not np.isfinite([eye, target]).all():
            raise ValueError(f"eye and target must be finite (x, y, z), got {eye} and {target}")
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
        end = np.asarray(end, dtype=float)
        start = np.asarray(start, dtype=float)
        if end.ndim != 2 or end.shape[1] != 3 or start.shape not in ((3,), end.shape):
            raise ValueError(
                f"rays go from (3,) or (n, 3) to (n, 3) points, got {start.shape} and {end.shape}"
            )
        if not (np.isfinite(start).all() and np.isfinite(end).all()):
            raise ValueError("rays must start and end at finite points")
        if self._rays is None:
            from backhoe.simulation.rays import Rays

            self._rays = Rays(self)
        return self._rays.cast(np.broadcast_to(start, end.shape), end)

    def _shut(self) -> None:
        for view in (self._renderer, self._rays):
            if view is not None:
                view.close()
        self._engine.disconnect(physicsClientId=self._client)

    def _integrate(self, pushed: NDArray) -> None:
        engine, client = self._engine, self._client
        engine.setJointMotorControlArray(
            self._body,
            self._moving,
            engine.TORQUE_CONTROL,
            forces=pushed[self._first :].tolist(),
            physicsClientId=client,
        )
        engine.stepSimulation(physicsClientId=client)
        self._read()

    def _read(self) -> None:
        states = self._engine.getJointStates(self._body, self._moving, physicsClientId=self._client)
        angles, rates, *_ = zip(*states, strict=True)
        held = (0.0,) * self._first
        self._q, self._dq = np.array(held + angles), np.array(held + rates)

    def _place(self, q: NDArray, dq: NDArray) -> None:
        for index, angle, speed in zip(
            self._moving, q[self._first :], dq[self._first :], strict=True
        ):
            self._engine.resetJointState(
                self._body, index, angle, speed, physicsClientId=self._client
            )
        self._read()

    def _engine_snapshot(self) -> int:
        return self._engine.saveState(physicsClientId=self._client)

    def _engine_restore(self, state: int) -> None:
        self._engine.restoreState(stateId=state, physicsClientId=self._client)

    def _engine_forget(self, state: int) -> None:
        if not self._closed:
            self._engine.removeState(state, physicsClientId=self._client)

    def _carry(self, payload: float) -> None:
        inertia = self.machine.bucket.inertia
        self._engine.changeDynamics(
            self._body,
            self._joint["bucket"],
            mass=self.machine.bucket.mass + payload,
            localInertiaDiagonal=(inertia, inertia, inertia),
            physicsClientId=self._client,
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


def _add_box(engine: ModuleType, client: int, lower: NDArray, upper: NDArray) -> None:
    """A box that stands still, between two corners (3,) [m]."""
    shape = engine.createCollisionShape(
        engine.GEOM_BOX, halfExtents=((upper - lower) / 2).tolist(), physicsClientId=client
    )
    engine.createMultiBody(
        baseCollisionShapeIndex=shape,
        basePosition=((upper + lower) / 2).tolist(),
        physicsClientId=client,
    )


def _joints_by_name(engine: ModuleType, body: int, client: int) -> dict[str, int]:
    return {
        engine.getJointInfo(body, index, physicsClientId=client)[1].decode(): index
        for index in range(engine.getNumJoints(body, physicsClientId=client))
    }
