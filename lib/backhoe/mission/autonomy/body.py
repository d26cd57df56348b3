"""The machine that does what it is told: controller, log, sensors, and a watch on itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.arm import dynamics, pid
from backhoe.arm.dynamics.terms import arm_of
from backhoe.localisation.drives import SLIPPING
from backhoe.machine import JOINTS, Machine
from backhoe.mission.autonomy.actions import BRAKING, Action, ActionServer, Goal
from backhoe.mission.autonomy.faults import Fault
from backhoe.mission.calls import LIBRARY, call_part, reset
from backhoe.mission.driving import LOOKAHEAD
from backhoe.mission.estimation import EstimatedPlant
from backhoe.mission.records import recorder_of
from backhoe.mission.route import SPEED
from backhoe.simulation.protocol import World
from backhoe.simulation.tracked_plant import TrackedPlant
from backhoe.vehicle.tracking import Path, PurePursuit, follow
from backhoe.vehicle.tracks import tracks_twist

SAMPLE = 20
"""Steps between two looks at the sensors, and two rows of the log: 50 Hz."""

BEHIND, LONG = 0.15, 0.3
"""A joint that is so far behind [rad] for so long [s] does not do what it is told."""

DISAGREE, OVER = 0.15, 0.5
"""Gyro and tracks may disagree by so much [rad/s], as a mean over so long [s]."""

TESTED = 0.25, 1.0
"""How fast the machine turns on the spot [rad/s] to try its gyro, and for how long each way [s]."""


class Halt(Exception):
    """The machine stops, safely and for good; the message is its reason."""


class Stall(Halt):
    """A joint does not move as it is told: seized, or the bucket held fast."""


class Doubt(Exception):
    """The machine stops because its sensors disagree; the message says how."""


class Sensors(EstimatedPlant):
    """An estimated plant that keeps watch on its encoders, its gyro and its fixes."""

    fault = Fault()

    def watch(self, fault: Fault) -> None:
        """Let a fault change what is read, and begin to compare."""
        self.fault, self._window = fault, []

    def _sensors(self) -> tuple:
        values = self.fault.readings(self._plant.time, super()._sensors())
        left, right, gyro, _ = values
        _, omega = tracks_twist(left, right, self.machine)
        self._window = [
            *self._window[1 - round(OVER / self.dt) :],
            (SLIPPING * float(omega), gyro),
        ]
        return values

    def check(self) -> None:
        """Raise a Doubt if gyro and tracks disagree about the turn."""
        if len(self._window) == round(OVER / self.dt):
            omega, gyro = np.mean(self._window, axis=0)
            if abs(omega - gyro) > DISAGREE:
                self._window = []
                raise Doubt(f"the gyro says {gyro:+.2f} rad/s, the tracks {omega:+.2f}")

    def same_way(self) -> bool:
        """Whether gyro and tracks have lately turned the same way."""
        omega, gyro = np.mean(self._window, axis=0)
        return omega * gyro > 0


class Body:
    """The machine in its world, doing what it is told.

    Args:
        world: with soil, left open.
        parts: given parts of `AUTONOMY_PARTS` by name.
        fixes, seed: as for `EstimatedPlant`.
        fault: what goes wrong.
        record: whether to keep pictures.

    Attributes:
        server: of its movements.
        loads: how many buckets it has emptied into the truck.
        log: rows of `COLUMNS`.
    """

    COLUMNS = (
        *("time", "pose", "belief", "q", "dq", "q_ref", "torque"),
        *("bucket", "truck", "margin", "power", "phase"),
    )

    def __init__(
        self, world: World, parts: dict, fixes: float | None, seed: int, fault: Fault, record: bool
    ) -> None:
        self.world, self.machine, self.fault = world, world.machine, fault
        self.plant = TrackedPlant(world)
        estimators = {name: parts[name] for name in ("odometry", "localisation") if name in parts}
        self.sensors = Sensors(self.plant, estimators or {"odometry": LIBRARY}, fixes, seed)
        self.sensors.watch(fault)
        self.server = ActionServer(world.q, world.dt, self.machine)
        self.recorder = recorder_of(world) if record else None
        self.loads, self.phase, self.log = 0, "", []
        self.late = np.zeros(4)
        self._controller = _controller(parts.get("controller"), self.machine, world.dt)
        self._tick = 0

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.world.time

    @property
    def pose(self) -> NDArray:
        """x, y, heading where it takes itself to be, shape (3,) [m, m, rad]."""
        return np.array(self.sensors.pose)

    def begin(self, phase: str) -> None:
        """Name what the machine does from now on."""
        self.phase = phase
        if self.recorder is not None:
            self.recorder.label(phase)

    def do(self, *goals: Goal, watch: Callable[[], None] | None = None) -> None:
        """Let the arm do movements one after another.

        Args:
            goals: the movements.
            watch: called 50 times a second; it may cancel them.

        Raises:
            Halt: one failed, or a joint does not move as it is told.
        """
        actions = [self.server.send(goal) for goal in goals]
        for action in actions:
            self.begin(action.goal.name)
            while not action.done:
                self.tick()
                if watch is not None and self._tick % SAMPLE == 0:
                    watch()
            if action.status == "failed":
                raise Halt(self._why(action))

    def give_way(self) -> None:
        """Cancel what the arm does, and let it stay where it is."""
        self.server.cancel_all("the arm gives way")
        self.server.q_ref, self.server.dq_ref = self.world.q, np.zeros(4)
        self.hold(BRAKING)

    def hold(self, time: float) -> None:
        """Let the arm stay where it is for some time [s]."""
        for _ in range(round(time / self.world.dt)):
            self.tick()

    def tick(self, traction: NDArray | None = None) -> None:
        """One step of the world, with the tracks at rest or driven by forces (2,) [N]."""
        world = self.world
        q, dq = world.q, world.dq
        q_ref, dq_ref = self.server.step(q)
        torque = self._controller(q_ref, dq_ref, q, dq)
        torque = self.fault.torque(self.loads, q, dq, torque)
        if traction is None:
            world.step(torque)
        else:
            world.step(torque, traction=traction)
        self._tick += 1
        if self._tick % SAMPLE == 0:
            if traction is not None:
                self.sensors.sense()
            self._keep(q_ref)
            self._mind(q_ref - q)

    def drive(self, path: Path) -> bool:
        """Drive along a path, as the sensors say; whether it takes itself to have arrived.

        Raises:
            Doubt, Halt: the sensors disagree.
        """
        self.plant.controller.reset()
        return follow(PurePursuit(lookahead=LOOKAHEAD), _Driven(self), path, speed=SPEED).reached

    def try_gyro(self) -> bool:
        """Turn a little to the left and back; whether the gyro turns with the tracks."""
        driven, same = _Driven(self, checks=False), True
        for rate in (TESTED[0], -TESTED[0]):
            for _ in range(round(TESTED[1] / driven.dt)):
                driven.step(0.0, rate)
            same = same and self.sensors.same_way()
        self.sensors.watch(self.fault)
        return same

    def _keep(self, q_ref: NDArray) -> None:
        world, ground = self.world, self.world.ground
        dq, torque = world.dq, world.torque
        power = np.maximum(torque * dq, 0.0).sum()
        power += np.maximum(world.traction * world.belts, 0.0).sum()
        row = world.time, world.pose, self.pose, world.q, dq, q_ref, torque, ground.bucket_volume
        self.log.append((*row, ground.truck_volume, world.margin, power, self.phase))
        if self.recorder is not None:
            self.recorder.capture()

    def _mind(self, error: NDArray) -> None:
        far = np.abs(error) > BEHIND
        self.late = np.where(far, self.late + SAMPLE * self.world.dt, 0.0)
        if (self.late > LONG).any():
            joint = int(self.late.argmax())
            self.late[:] = 0.0
            raise Stall(
                f"the {JOINTS[joint]} is {np.abs(error[joint]):.2f} rad from where it should be "
                f"for {LONG} s"
            )

    def _why(self, action: Action) -> str:
        return f"{action.goal.name}: {action.result}"


class _Driven:
    """The body as a plant for `tracking.follow`."""

    def __init__(self, body: Body, checks: bool = True) -> None:
        self._checks, self._body, self.dt, self.limits = (
            checks,
            body,
            body.plant.dt,
            body.plant.limits,
        )

    def __getattr__(self, name: str) -> object:
        return getattr(self._body.sensors, name)

    def step(self, v: float, omega: float) -> None:
        """One sample with wanted speeds [m/s, rad/s]."""
        body, plant = self._body, self._body.plant
        forces = plant.controller(v, omega, *plant.twist.tolist(), self.dt)
        for _ in range(SAMPLE):
            body.tick(forces)
        if self._checks:
            body.sensors.check()


class Holding:
    """Chapter 3's controller and the torque of gravity in one compiled step.

    Args:
        machine: whose arm.
        dt: step [s].
    """

    def __init__(self, machine: Machine, dt: float) -> None:
        from backhoe.simulation import engine

        self._hold, self._dt = engine.hold, dt
        self._fixed = np.array(arm_of(machine)), np.array(pid.ARM_GAINS), machine.torque_limit
        self._integral, self._torque = np.zeros(4), np.zeros(4)

    def __call__(self, q_ref: NDArray, dq_ref: NDArray, q: NDArray, dq: NDArray) -> NDArray:
        """Torques, shape (4,) [N m], for wanted and measured angles and speeds (4,) each."""
        self._hold(*self._fixed, self._integral, q_ref, dq_ref, q, dq, self._dt, self._torque)
        return self._torque


def _controller(part: Callable | None, machine: Machine, dt: float) -> Callable:
    """Chapter 3's controller, or a student's with its answers checked, and gravity's torque."""
    if part is None:
        return Holding(machine, dt)
    reset(part)

    def controller(q_ref: NDArray, dq_ref: NDArray, q: NDArray, dq: NDArray) -> NDArray:
        torque = call_part("controller", part, q_ref, dq_ref, q, dq, dt, shape=(4,))
        return torque + dynamics.gravity_torque(q, machine)

    return controller
