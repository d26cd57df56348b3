"""The machine alone: drive to the heap, look, choose, dig, weigh, load, until the truck is full.

What it knows are the order, where heap and truck should be, and its sensors. `body` moves and minds
itself, `eyes` see; here is what to do next, and what to do when something is not as ordered.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import atan2, cos, hypot, pi, radians, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.dynamics import inverse_dynamics
from backhoe.arm.kinematics import inverse_kinematics, pose
from backhoe.machine import Machine
from backhoe.mission.autonomy.actions import Goal, along
from backhoe.mission.autonomy.body import Body, Doubt, Halt, Stall
from backhoe.mission.autonomy.choice import DIRECTIONS, REACHES, best_strip, polar, stroke
from backhoe.mission.autonomy.eyes import AREA, Eyes, Ground, filled
from backhoe.mission.autonomy.ways import MARGINS, around, carrying, moved, raised, world_seen
from backhoe.mission.calls import call_part
from backhoe.simulation.scene import Scene
from backhoe.vehicle.tracking import from_points

HEAP = 0.2
"""Ground higher than this is heap [m]."""

LEAST_HEAP = 0.5
"""A heap of less than this is not worth driving to [m^2]."""

NEAREST, BEST, FARTHEST = 4.2, 5.6, 6.4
"""Distances of a heap's middle from the swing axis that the arm digs at, and the best [m]."""

POOR = 0.2
"""With less of a full bucket than this it does not swing, but looks and chooses anew [1]."""

HOPELESS = 3
"""So many such buckets one after another end the work."""

ALONE = radians(12)
"""To each side of where the bucket was held fast it does not dig any more [rad]."""

STEP, STEPS = 0.8, 2
"""How far it drives into the work when nothing more is in reach [m], and how often at most."""

WAITS = 3
"""So often the machine looks whether the truck has come back."""

DUMPS = (0.0, -1.0, 0.9)
"""Where along the bed it tips, from its middle [m], load after load."""

BACK = "swing back"
"""Name of the movement that may fall back on the way that was taken to the truck."""

REACH_OF_TIPPING = 3.6, 6.6
"""Distances of the stick's tip from the swing axis above the truck [m]."""


Q, DQ, TORQUE = (Body.COLUMNS.index(name) for name in ("q", "dq", "torque"))


class Load(NamedTuple):
    """One bucket: when it began and when it was lifted, tipped out [s], the strip, what the machine
    weighed and what was truly in it and came into the truck [m^3], and digs until it was full
    enough."""

    begin: float
    lifted: float
    end: float
    strip: object
    weighed: float
    dug: float
    loaded: float
    digs: int


@dataclass(frozen=True)
class Order:
    """What the machine is told: the site as it should be, where to stand, how much to load.

    Attributes:
        scene: with a heap and a truck.
        stand: where to dig from, x, y, heading [m, m, rad].
        wanted: soil to be loaded [m^3].
        loads: buckets at most.
    """

    scene: Scene
    stand: tuple[float, float, float]
    wanted: float
    loads: int


class Mission:
    """The work; `loads` and `events` are its diary, events as (time [s], what)."""

    def __init__(self, body: Body, eyes: Eyes, order: Order, parts: dict) -> None:
        self.body, self.eyes, self.order, self.parts = body, eyes, order, parts
        self.machine: Machine = body.machine
        self.loads: list[Load] = []
        self.events: list[tuple[float, str]] = []
        self.full = _heaped(body)
        self._stand, self._steps = np.array(order.stand), 0
        self._alone: list[float] = []
        self._way: NDArray | None = None

    def do(self) -> str:
        """Work until the order is done or nothing more can be; why it ended."""
        self._drive_to(self._stand)
        self._look()
        self._come_near()
        self._above_truck()
        begin, poor = self.body.time, 0
        while len(self.loads) < self.order.loads:
            if sum(load.weighed for load in self.loads) >= self.order.wanted:
                return "the order is loaded"
            heights, deviation = polar(Ground(self.eyes.map), self.body.pose)
            for direction in self._alone:
                heights[np.abs(DIRECTIONS - direction) < ALONE] = 0.0
            ground = heights, deviation, DIRECTIONS, REACHES
            strip = self._ask("dig_choice", best_strip, *ground)
            if strip is None or poor == HOPELESS:
                if not self._step_nearer():
                    return "the heap is gone"
                poor = 0
                continue
            weighed = self._dig(strip, heights)
            if weighed < POOR * self.full:
                poor += 1
                self._note(f"only {weighed:.2f} m^3 in the bucket: chose anew")
            else:
                self._load(begin, strip, weighed, poor + 1)
                poor, begin = 0, self.body.time
            self._look()
        return "all buckets are loaded"

    def _ask(self, name: str, library: Callable, *given: object) -> object:
        """A student's part, with its errors named, or the library's in its place."""
        part = self.parts.get(name)
        return library(*given) if part is None else call_part(name, part, *given)

    def _note(self, what: str) -> None:
        self.events.append((self.body.time, what))

    def _look(self, event: str = "look at the heap") -> None:
        lost = self.eyes.lost
        self.eyes.look(event)
        if self.eyes.lost > lost:
            self._note(f"{self.eyes.lost - lost} lost or late looks: looked again")

    # Driving

    def _drive_to(self, stand: NDArray) -> None:
        for _ in range(4):
            try:
                arrived = self.body.drive(_curve(self.body.pose, stand))
            except Doubt as doubt:
                self._note(f"stopped: {doubt}")
                self.body.begin("try the gyro")
                self.body.hold(2.0)
                if not self.body.try_gyro():
                    raise Halt(f"the gyro is reversed: {doubt}") from doubt
                continue
            if arrived:
                self.body.hold(0.5)
                return
            raise Halt("the machine did not come to where it should stand")
        raise Halt("the sensors disagree again and again")

    def _come_near(self) -> None:
        """Find the heap, and drive nearer if the arm does not reach it."""
        for _ in range(3):
            heap = self._heap()
            if heap is None:
                raise Halt("no heap is in sight")
            axis = self._axis()
            way = heap - axis
            distance, bearing = hypot(*way), _wrap(atan2(way[1], way[0]) - self.body.pose[2])
            if abs(bearing) > radians(60):
                raise Halt(f"the heap lies {np.degrees(bearing):.0f} deg aside: out of the swing")
            if distance < NEAREST:
                raise Halt(f"the heap lies {distance:.1f} m from the swing axis: too near to dig")
            if distance <= FARTHEST:
                return
            self._note(f"the heap lies {distance:.1f} m from the swing axis: drove nearer")
            heading = self.body.pose[2] + bearing
            ahead = (distance - BEST) * np.array([cos(heading), sin(heading)])
            self._stand = np.array([*(self.body.pose[:2] + ahead), heading])
            self._drive_to(self._stand)
            self._look()
        raise Halt("the heap cannot be reached")

    def _step_nearer(self) -> bool:
        """Drive a little into the work if the heap goes on there; whether it did."""
        heap, truck = self._heap(), self.eyes.truck
        if heap is None or truck is None or self._steps == STEPS:
            return False
        self._steps += 1
        heading = self.body.pose[2]
        step = STEP * np.array([cos(heading), sin(heading)])
        least, most = REACH_OF_TIPPING
        if not least < hypot(*(truck[:2] - self._axis() - step)) + 0.4 < most:
            return False
        self._note(f"drove {STEP} m nearer to what is left")
        self._carry("fold the arm", self._ready())
        self._drive_to(np.array([*(self.body.pose[:2] + step), heading]))
        self._look()
        return True

    def _heap(self) -> NDArray | None:
        """Middle of the largest heap in the map, (2,) [m]."""
        from scipy.ndimage import label

        corner, _, _, cell = AREA
        high = np.nan_to_num(filled(np.asarray(self.eyes.map.heights)), nan=0.0) > HEAP
        marks, count = label(high)
        if not count:
            return None
        sizes = np.bincount(marks.ravel())[1:] * cell**2
        if sizes.max() < LEAST_HEAP:
            return None
        i, j = np.nonzero(marks == 1 + int(sizes.argmax()))
        return np.array([corner[0] + cell * j.mean(), corner[1] + cell * i.mean()])

    def _axis(self) -> NDArray:
        x, y, heading = self.body.pose
        return np.array([x, y]) + self.machine.base.offset * np.array([cos(heading), sin(heading)])

    # Digging

    def _dig(self, strip: object, heights: NDArray) -> float:
        """Dig a strip; soil in the bucket [m^3]."""
        times, path = self._ask("primitive", stroke, strip, heights, DIRECTIONS, REACHES)
        try:
            self._arm(along("dig", times, path, begin=self._time_to(path[0])))
        except Stall as stall:
            self.body.give_way()
            self._note(f"{stall}: lifted, and left that place alone")
            self._alone.append(strip.direction)
            came = np.array([row[Q] for row in self.body.log[-100::20]][::-1])
            back = np.vstack([came, raised(came[-1], self.machine)])
            self._arm(Goal("back out and lift", lambda q: moved(np.vstack([q, back]))))
        return self._weigh()

    def _weigh(self) -> float:
        """Soil in the bucket as the joints' torques say, over the end of the lift [m^3]."""
        rows = self.body.log[-25:]
        q, dq, torque = (np.array([row[k] for row in rows]) for k in (Q, DQ, TORQUE))
        ddq = np.gradient(dq, rows[1][0] - rows[0][0], axis=0)
        bucket, unit = self.machine.bucket, 1000.0
        heavier = replace(self.machine, bucket=replace(bucket, mass=bucket.mass + unit))
        empty = inverse_dynamics(q, dq, ddq, machine=self.machine, friction=True)
        loaded = inverse_dynamics(q, dq, ddq, machine=heavier, friction=True)
        per_kg, missing = (loaded - empty)[:, 1:3] / unit, (torque - empty)[:, 1:3]
        mass = float((per_kg * missing).sum() / (per_kg**2).sum())
        return max(mass, 0.0) / self.body.world.ground.parameters.density

    # Loading

    def _load(self, begin: float, strip: object, weighed: float, digs: int) -> None:
        ground, lifted = self.body.world.ground, self.body.time
        dug, before = ground.bucket_volume, ground.truck_volume
        above = self._above_truck()
        self._carry("swing to the truck", above)
        for _ in range(WAITS):
            self._look("look at the truck")
            if self.eyes.truck is not None:
                break
            self._note("the truck is not there: waited with the full bucket")
        else:
            self._put_back(strip)
            raise Halt("the truck has left: the soil is back on the heap, the bucket empty")
        again = self._above_truck()
        if hypot(*(again[:2] - above[:2])) > 0.3:
            self._note("the truck has moved: followed it")
            self._carry("follow the truck", again)
            self._way = None
        x, y, z, _ = again
        tip = np.array([[x, y, z, 1.75]] * 2)
        self._arm(along("tip out", [0.0, 0.4], tip, begin=2.6))
        self.body.loads += 1
        end, loaded = self.body.time, ground.truck_volume - before
        self.loads.append(Load(begin, lifted, end, strip, weighed, dug, loaded, digs))
        self._carry(BACK, self._ready())

    def _put_back(self, strip: object) -> None:
        self._carry("swing back to the heap", self._ready())
        target = pose(self.body.server.q_ref, machine=self.machine)
        target[3] = 1.75
        self._arm(along("empty onto the heap", [0.0, 0.4], np.array([target] * 2), begin=2.6))

    def _above_truck(self) -> NDArray:
        """Where the stick's tip goes to tip out, x, y, z and the bucket's angle there, (4,)."""
        truck = self.order.scene.truck
        found = (truck.x, truck.y) if self.eyes.truck is None else self.eyes.truck[:2]
        x, y, heading = self.body.pose
        dx, dy = found[0] + DUMPS[len(self.loads) % len(DUMPS)] - x, found[1] - y
        c, s, offset = cos(heading), sin(heading), self.machine.base.offset
        ahead, left = dx * c + dy * s - offset, dy * c - dx * s
        distance, angle = hypot(ahead, left) + 0.4, atan2(left, ahead)
        least, most = REACH_OF_TIPPING
        if not least <= distance <= most:
            raise Halt(
                f"the truck stands {distance - 0.4:.1f} m from the swing axis: tipping out needs "
                f"{least - 0.4:.1f} to {most - 0.4:.1f} m"
            )
        z = truck.wall + 2.0
        x, y = offset + distance * cos(angle), distance * sin(angle)
        q = inverse_kinematics([x, y, z, 0.0], machine=self.machine)
        return np.array([x, y, z, carrying(q, self.machine)])

    def _ready(self) -> NDArray:
        """Above the heap, x, y, z and the bucket's angle, (4,)."""
        heap = self._heap()
        angle = 0.0
        if heap is not None:
            way = heap - self._axis()
            angle = _wrap(atan2(way[1], way[0]) - self.body.pose[2])
        offset = self.machine.base.offset
        return np.array([offset + 5.8 * cos(angle), 5.8 * sin(angle), 4.0, radians(20)])

    def _carry(self, name: str, target: NDArray) -> None:
        """Move the arm around the truck."""
        truck, belief, terrain = self.eyes.truck, self.body.pose, self.eyes.map
        size = self.order.scene.truck
        if truck is not None:
            size = replace(size, x=truck.x, y=truck.y)

        def motion(q: NDArray) -> tuple[NDArray, NDArray]:
            goal = inverse_kinematics(target, machine=self.machine)
            if truck is None:
                return moved(np.stack([q, goal]))
            closed = np.array([*q[:3], carrying(q, self.machine)])
            up = (raised(posture, self.machine) for posture in (q, closed))
            for begin in (q, closed, *up):
                for margin in MARGINS:
                    world = world_seen(size, terrain, belief, margin, self.machine)
                    if world.is_free(np.stack([begin, goal])).all():
                        path = self._ask("planner", around, begin, goal, world.is_free)
                        self._way = path
                        return moved(path if begin is q else np.vstack([q, path]))
            if name == BACK and self._way is not None:
                self._note("no room was seen on the way back: went as it had come")
                return moved(np.vstack([q, self._way[::-1]]))
            raise ValueError("above the truck or here the arm has no room")

        self._arm(Goal(name, motion))

    def _arm(self, *goals: Goal) -> None:
        self.body.do(*goals)

    def _time_to(self, point: NDArray) -> float:
        q = inverse_kinematics(point, machine=self.machine)
        return float(moved(np.stack([self.body.server.q_ref, q]))[0][-1])


def _curve(start: NDArray, end: NDArray) -> object:
    """A way from one pose to another, both (3,) [m, m, rad], with their headings."""
    length = hypot(*(end[:2] - start[:2]))
    s = np.linspace(0.0, 1.0, max(int(length / 0.1), 2) + 1)[:, None]
    a, b = (length * np.array([cos(p[2]), sin(p[2])]) for p in (start, end))
    points = (
        (2 * s**3 - 3 * s**2 + 1) * start[:2]
        + (s**3 - 2 * s**2 + s) * a
        + (3 * s**2 - 2 * s**3) * end[:2]
        + (s**3 - s**2) * b
    )
    return from_points(points, 0.1)


def _wrap(angle: float) -> float:
    return (angle + pi) % (2 * pi) - pi


def _heaped(body: Body) -> float:
    return body.world.ground.fill.heaped
