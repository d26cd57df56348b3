"""The machine on its tracks in the simulation, driven by a velocity controller.

The arm is held in one posture; what moves is x, y and heading. One `step` is one sample of the
velocity controller: it sees wanted and measured speeds and gives the forces of the tracks, which
the simulation holds over its own steps of 1 ms. The same names as every other plant that a tracker
drives: `pose`, `twist`, `time`, `dt`, `step(v, omega)`, `reset()`.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import function, number, numbers
from backhoe.machine import BACKHOE, Machine
from backhoe.simulation.backends import open_world
from backhoe.simulation.clock import STEP, ticks
from backhoe.simulation.hold import Hold
from backhoe.simulation.protocol import World
from backhoe.simulation.scene import FLAT, Scene
from backhoe.vehicle.tracking import Limits
from backhoe.vehicle.travel.posture import POSTURE
from backhoe.vehicle.travel.velocity import VelocityPI

_CALL = "controller(v_ref, omega_ref, v, omega, dt) -> (left, right) [N]"


class TrackedPlant:
    """The backhoe as a plant for tracking; use it in a `with` statement or close it yourself.

    Args:
        world: a simulation on tracks to drive in, left open at the end; default a new one without
            soil, closed by `close`.
        controller: forces of the tracks from speeds, `VelocityPI` or your own: it is called as
            controller(v_ref, omega_ref, v, omega, dt) and returns (left, right) [N].
        machine, backend, scene: of the new world; as in `simulation.open_world`.
        dt: sample time of the controller [s], a whole multiple of the world's step.
        posture: joint angles in which the arm is held, shape (4,) [rad]; default `POSTURE`, in a
            given world the present ones.
        pose: x, y [m] and heading [rad] at the start, shape (3,); default the origin, in a given
            world where it stands.

    Raises:
        TypeError: the controller cannot be called.
        ValueError: dt is no whole multiple of the world's step, posture or pose is malformed, or a
            machine, backend or scene comes with a world.
    """

    def __init__(
        self,
        world: World | None = None,
        *,
        controller: Callable | None = None,
        machine: Machine = BACKHOE,
        backend: str = "auto",
        dt: float = 0.02,
        posture: ArrayLike | None = None,
        scene: Scene = FLAT,
        pose: ArrayLike | None = None,
    ) -> None:
        if controller is not None:
            function(controller, "controller", _CALL)
        self._ticks = ticks(dt, STEP if world is None else world.dt)
        self._opened = world is None
        if world is None:
            start = POSTURE if posture is None else posture
            world = open_world(machine, backend=backend, scene=scene, q=start, soil=False)
        elif machine is not BACKHOE or backend != "auto" or scene is not FLAT:
            raise ValueError("machine, backend and scene are those of the given world: leave them")
        self.world, self.machine, self.backend = world, world.machine, world.backend
        self.dt = self._ticks * world.dt
        self.controller = VelocityPI(machine=self.machine) if controller is None else controller
        self._hold = Hold(world.q if posture is None else posture, self.machine)
        self._started = pose
        try:
            if self._opened or pose is not None:
                self.reset()
        except ValueError:
            self.close()
            raise

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.world.time

    @property
    def pose(self) -> NDArray:
        """x, y, heading, shape (3,) [m, m, rad]; the heading counts on through full turns."""
        return self.world.pose

    @property
    def twist(self) -> NDArray:
        """Forward and turning speed in the machine's own frame, shape (2,) [m/s, rad/s]."""
        dx, dy, omega = self.world.twist
        heading = self.world.pose[2]
        return np.array([dx * cos(heading) + dy * sin(heading), omega])

    @property
    def lateral_speed(self) -> float:
        """Speed to the left in the machine's own frame [m/s]: slip, for tracks."""
        dx, dy, _ = self.world.twist
        heading = self.world.pose[2]
        return float(dy * cos(heading) - dx * sin(heading))

    @property
    def limits(self) -> Limits:
        """Speeds that the tracks can drive; `tracking.follow` keeps to them, turning first."""
        return Limits.of_tracks(self.machine)

    @property
    def traction(self) -> NDArray:
        """What the drives of the left and right track gave last, shape (2,) [N]."""
        return self.world.traction

    @property
    def belts(self) -> NDArray:
        """Speed of the left and right belt, shape (2,) [m/s]."""
        return self.world.belts

    @property
    def q(self) -> NDArray:
        """Joint angles, shape (4,) [rad]."""
        return self.world.q

    def step(self, v: float, omega: float) -> None:
        """Drive for one sample with wanted forward and turning speed [m/s, rad/s].

        Raises:
            ValueError: v or omega is not finite; the controller returns something else than two
                finite forces.
            RuntimeError: the simulation is closed, or the machine ran away.
        """
        v, omega = number(v, "v", "m/s"), number(omega, "omega", "rad/s")
        pair = self.controller(v, omega, *self.twist.tolist(), self.dt)
        forces = numbers(pair, "forces", (2,), meaning=f"two: {_CALL}")
        world, hold = self.world, self._hold
        for _ in range(self._ticks):
            world.step(hold(world.q, world.dq), traction=forces)

    def reset(self, pose: ArrayLike | None = None) -> None:
        """Start again at time 0, at rest, the arm in its posture, the controller fresh.

        Args:
            pose: x, y, heading, shape (3,) [m, m, rad]; default where the plant started.
        """
        self.world.reset(self._hold.q, self._started if pose is None else pose)
        if callable(getattr(self.controller, "reset", None)):
            self.controller.reset()

    def close(self) -> None:
        """Close the world if it was opened here; a second call does nothing."""
        if self._opened:
            self.world.close()

    def __enter__(self) -> TrackedPlant:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()
