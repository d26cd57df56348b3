"""The whole machine draws the edge of its bucket along strokes.

A stroke's goals go by a clock. Each period the error of the edge and its next goal make the wanted
velocity of the edge; the part `whole_body` makes velocities of tracks and joints of it, within
bounds. The clock goes on by the share of the wanted velocity that they really give, so an edge that
is slowed down stays on its way. Between two strokes the bucket is emptied aside, and the tracks
drive to where the next one begins.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import atan, cos, hypot, pi, radians, sin

import numpy as np
from numpy.typing import NDArray

from backhoe.machine import Machine
from backhoe.mission.calls import ESTIMATORS, call_part, reset
from backhoe.mission.estimation import EstimatedPlant
from backhoe.mission.passes import Stroke, edge_posture
from backhoe.mission.records import recorder_of
from backhoe.simulation.protocol import World
from backhoe.simulation.whole_body_plant import WholeBodyPlant
from backhoe.whole_body import hand, jacobian, joint_bounds, limited_velocity, wanted_velocity

PERIOD = 0.01
"""Of the whole-body controller [s]."""

SAMPLE = 2
"""Periods between two looks at the sensors."""

FRAME = 5
"""Samples between two pictures of a replay."""

W = 0.97
"""Share of the edge's error that a period leaves [1]: the drives are not quicker."""

CREEP, TURN = 0.25, 0.1
"""Largest speeds of the tracks during a stroke [m/s, rad/s]."""

SOFT = np.array([0.4, 0.3, 0.4, 0.4, 0.6, 1.0])
"""How fast tracks and joints speed up or slow down during a stroke [m/s^2, rad/s^2]."""

SMALL = 1.0
"""What (m/s)^2 or (rad/s)^2 away from the preferred velocities cost the library's part beside the
way that is lost: enough that no speed is bought with turning tracks [1]."""

GENTLE = 0.12
"""Share of the joints' largest speeds that a stroke may use [1]."""

KEEPING = np.array([3.0, 1.0, 1.0])
"""How fast reach and heading of the tracks, and the arm's direction, are regained [1/s]."""

TRAVEL, BENDING, BRISK = 0.4, 0.4, 0.5
"""Speeds of the tracks between two strokes [m/s, rad/s], and share of the joints' largest [1]."""

HERE = 0.02
"""The tracks have arrived when no more is left [m]."""

JOINING = 0.4
"""Time in which a stroke joins its planned way from where the edge is [s]."""

PATIENCE = 8.0
"""A stroke that takes so many times as long as planned is given up [1]."""

FORWARD = -pi / 2
"""Swing angle of an arm that points forward [rad]."""

ASIDE = radians(80)
"""How far the arm swings to empty the bucket [rad]."""

CARRYING = (4.5, 2.3, -pi)
"""Reach, height [m] and pitch [rad] of the edge of the full bucket over the spoil."""

OPENING = radians(95)
"""How far the bucket then opens [rad]."""

POURING = 0.3
"""Time for the last soil to fall [s]."""


def library_part(
    J: NDArray, b: NDArray, preferred: NDArray, lower: NDArray, upper: NDArray
) -> NDArray:
    """`whole_body` of `GRADE_PARTS` as the library does it, shapes as there [m/s, rad/s]."""
    return limited_velocity(J, b, lower, upper, preferred=preferred, small=SMALL).v


class Seen:
    """The plant as its sensors see it every `dt` [s]: what `EstimatedPlant` asks for."""

    dt = SAMPLE * PERIOD

    def __init__(self, plant: WholeBodyPlant) -> None:
        self._plant, self.machine = plant, plant.machine

    def __getattr__(self, name: str) -> object:
        return getattr(self._plant.world, name)

    @property
    def twist(self) -> NDArray:
        """Forward and turning speed, shape (2,) [m/s, rad/s]."""
        return self._plant.v[:2]


class Tracer:
    """Does strokes with a machine in a world.

    Args:
        world: with soil, left open.
        parts: given parts of `GRADE_PARTS` by name.
        fixes, seed: as for `EstimatedPlant`.
        record: whether to keep pictures.

    Attributes:
        log: a tuple for every sample, see `keep`.
        excess: of the velocities that the part asked for over their largest, each period of a
            stroke, list of floats [1].
        given_up: number of strokes given up.
        soil_lost: largest change of all soil [m^3].
    """

    def __init__(
        self, world: World, parts: dict, fixes: float | None, seed: int, record: bool
    ) -> None:
        self.world, self.machine = world, world.machine
        self.plant = WholeBodyPlant(world, dt=PERIOD)
        self._sensors = None
        if estimators := {name: parts[name] for name in ESTIMATORS if name in parts}:
            self._sensors = EstimatedPlant(Seen(self.plant), estimators, fixes, seed)
        self._part = _checked(parts["whole_body"]) if "whole_body" in parts else library_part
        self.recorder = recorder_of(world) if record else None
        self.fastest = np.concatenate([[CREEP, TURN], GENTLE * self.machine.speed_limit])
        self.log, self.excess, self.given_up, self.soil_lost = [], [], 0, 0.0
        self._soil, self._periods, self._number = world.ground.total_volume, 0, 0
        self._rest()

    @property
    def q(self) -> NDArray:
        """x, y, heading as the sensors say, and the joint angles, shape (7,) [m, m, rad, ...]."""
        pose = self.world.pose if self._sensors is None else self._sensors.pose
        return np.concatenate([pose, self.world.q])

    def do(self, strokes: list[Stroke]) -> None:
        """Do strokes one after another, and empty the bucket after each."""
        for self._number, stroke in enumerate(strokes, start=1):
            reach, z, pitch = stroke.goals[0, [4, 2, 3]]
            self._go(stroke.name, self._move(self._posture((reach, z, pitch)), stroke.stand))
            self._go("", self._trace(stroke))
            self._rest()
            over = self._posture(CARRYING, stroke.side * ASIDE)
            self._go("empty the bucket", self._move(over))
            self._go("", self._move(over + np.array([0.0, 0.0, 0.0, OPENING])))
            self._go("", (np.zeros(6) for _ in range(round(POURING / PERIOD))))

    def keep(self) -> None:
        """Log time, number of the stroke, q, estimated pose, goal, v, share, margin and load."""
        world, ground = self.world, self.world.ground
        self.soil_lost = max(self.soil_lost, abs(ground.total_volume - self._soil))
        state = world.time, self._number, self.plant.q, self.q[:3], self._goal, self._v
        self.log.append((*state, self._share, world.margin, ground.bucket_volume))
        if self.recorder is not None and self._periods % (FRAME * SAMPLE) == 0:
            self.recorder.capture()

    def _rest(self) -> None:
        self._goal, self._v, self._share = np.full(4, np.nan), np.zeros(6), np.nan

    def _go(self, label: str, motion: Iterator[NDArray]) -> None:
        if label and self.recorder is not None:
            self.recorder.label(label)
        for v in motion:
            self._v = v
            self.plant.step(v)
            self._periods += 1
            if self._periods % SAMPLE == 0:
                if self._sensors is not None:
                    self._sensors.sense()
                self.keep()

    def _trace(self, stroke: Stroke) -> Iterator[NDArray]:
        """Velocities that lead the edge along a stroke."""
        q, robot = self.q, self.plant.robot
        goals, clock, heading = _from(hand(q, robot), stroke.goals), 0.0, stroke.stand[2]
        steps, last = np.diff(goals, axis=0), len(goals) - 2
        J, h = np.zeros((4, 6)), np.zeros(4)
        J[3, 3:] = 1.0
        for _ in range(round(PATIENCE * len(goals))):
            if clock >= last:
                return
            k, q = int(clock), self.q
            now, after = goals[k : k + 2] + (clock - k) * steps[k : k + 2]
            J[:3], h[:3] = jacobian(q, robot), hand(q, robot)
            h[3] = pitch_of(q[3:], self.machine)
            b = wanted_velocity(h, now[:4], after[:4], W, PERIOD)
            preferred = self._preferred(q, h, now, after, heading)
            lower, upper = self._bounds(q)
            asked = self._part(J, b, preferred, lower, upper)
            v = np.minimum(np.maximum(asked, lower), upper)
            self.excess.append(float(np.max(np.abs(asked - v) / self.fastest)))
            most = SOFT * PERIOD
            v = self._v + np.minimum(np.maximum(v - self._v, -most), most)
            square = float(b @ b)
            share = min(max(float(b @ (J @ v)) / square, 0.0), 1.0) if square > 0.0 else 1.0
            self._goal, self._share = now[:4], share
            yield v
            clock += share
        self.given_up += 1

    def _preferred(
        self, q: NDArray, h: NDArray, now: NDArray, after: NDArray, heading: float
    ) -> NDArray:
        """Velocities that keep reach and heading, and the arm pointing forward, shape (6,)."""
        c, s, offset = cos(q[2]), sin(q[2]), self.machine.base.offset
        reach = hypot(h[0] - q[0] - offset * c, h[1] - q[1] - offset * s)
        dx, dy, _, _, less = (after - now) / PERIOD
        most = self.fastest
        keeping = np.array([reach - now[4], heading - q[2], FORWARD - q[3]]) * KEEPING
        preferred = np.zeros(6)
        preferred[:3] = np.minimum(np.maximum(keeping, -most[:3]), most[:3])
        preferred[0] += dx * c + dy * s - less  # at the full speed of the way, as b is
        return preferred

    def _bounds(self, q: NDArray) -> tuple[NDArray, NDArray]:
        """Bounds of the six velocities: speed limits, and the joints stay in range."""
        machine, lower, upper = self.machine, -self.fastest, self.fastest.copy()
        lower[2:], upper[2:] = joint_bounds(q[3:], machine.lower, machine.upper, upper[2:], PERIOD)
        return lower, upper

    def _posture(self, edge: tuple[float, float, float], aside: float = 0.0) -> NDArray:
        q = edge_posture(edge, self.machine)
        q[0] = FORWARD + aside
        return q

    def _move(self, goal: NDArray, stand: NDArray | None = None) -> Iterator[NDArray]:
        """Velocities that bend the arm to a posture and drive the tracks to where they stand."""
        begin, start = self.world.q, self.q[:2]
        change = goal - begin
        needed = np.max(np.abs(change) / (BRISK * self.machine.speed_limit))
        count = max(round(1.5 * float(needed) / PERIOD), 1)
        k, tracks = 0, None if stand is None else self._drive(start, stand)
        while k < count or tracks is not None:
            part = min((k + 1) / count, 1.0)
            wanted = begin + change * part**2 * (3 - 2 * part)
            speed = change * 6 * part * (1 - part) / (count * PERIOD)
            twist = (0.0, 0.0) if tracks is None else tracks
            yield np.concatenate([twist, speed + 2.0 * (wanted - self.world.q)])
            tracks, k = None if tracks is None else self._drive(start, stand), k + 1

    def _drive(self, start: NDArray, stand: NDArray) -> tuple[float, float] | None:
        """Speeds u, omega on a smooth way from a start (2,) to a stand (3,); None if there."""
        c, s = cos(stand[2]), sin(stand[2])
        (x0, y0), (x, y) = (
            (dx * c + dy * s, dy * c - dx * s)
            for dx, dy in (start - stand[:2], self.q[:2] - stand[:2])
        )
        sense = -1.0 if x0 > 0.0 else 1.0
        if sense * x > -HERE:
            return None
        part = min(max(1 - x / x0, 0.0), 1.0)
        way, slope = y0 * (1 - part**2 * (3 - 2 * part)), y0 * 6 * part * (1 - part) / x0
        wanted = atan(slope) + sense * min(max(1.5 * (way - y), -0.4), 0.4)
        omega = min(max(2.0 * (wanted - self.q[2] + stand[2]), -BENDING), BENDING)
        return sense * min(TRAVEL, 0.05 - 0.5 * sense * x), omega


def _from(start: NDArray, goals: NDArray) -> NDArray:
    """Goals (n, 5) that begin where the edge is (3,) [m], and join the others smoothly."""
    part = np.minimum(np.arange(len(goals)) * PERIOD / JOINING, 1.0)
    eased = goals.copy()
    eased[:, :3] += np.outer(1 - part**2 * (3 - 2 * part), start - goals[0, :3])
    return eased


def pitch_of(q: NDArray, machine: Machine) -> NDArray:
    """Pitch of the bucket for joint angles q (..., 4), counted on beyond -pi, shape (...) [rad]."""
    return q[..., 1:].sum(axis=-1) + sum(link.angle_offset for link in machine.links)


def _checked(part: Callable) -> Callable:
    """A student's part with its answers and errors named."""
    reset(part)
    return lambda *given: call_part("whole_body", part, *given, shape=(6,))
