"""A machine at work whose eyes keep what they see, and what was true then.

It is led along its plan: the joints follow the planned angles exactly, so that no dynamics has to
be computed and the same is seen wherever Python runs. The soil is that of the simulation. The truck
comes before the first cycle and leaves after the last.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.kinematics import inverse_kinematics
from backhoe.machine import BACKHOE, JOINTS
from backhoe.machine.sensors import LASERS
from backhoe.mission.parts import WayPoint, hand_made_plan, smooth_trajectory
from backhoe.mission.records import recorder_of
from backhoe.perception.camera import Rectified
from backhoe.perception.laser import Motion
from backhoe.simulation import forces
from backhoe.simulation.clock import STEP, TICKS_PER_DIG
from backhoe.simulation.scanning import Scan, Scanner, stereo_now
from backhoe.simulation.scene import LOADING, untouched_ground
from backhoe.simulation.soil import SANDY_LOAM

TICK = TICKS_PER_DIG * STEP
"""Between two visits to the soil [s]."""

EYES = {name: replace(laser, line_rate=25.0) for name, laser in LASERS.items()}
"""The machine's lasers, turning half as fast: 16,880 beams a sweep of both."""

SWEEP = LASERS["left"].nod_period / 2
"""Time that a look takes: half a nod of both lasers [s]."""

LOOKS_AFTER = 5
"""Looks at where the truck was: as many misses as free a voxel of which the map is sure."""

CODA = 2
"""Looks after those, on the way back to the heap and at it."""

SET_OFF = 1.0
"""From the start of a swing to the look that is taken while it lasts [s]."""


@dataclass(frozen=True, eq=False)
class Pair:
    """A rectified stereo pair: `left`, `right` (rows, columns), uint8 [grey levels]; `depth` of
    the left one's pixels, true, [m], NaN where nothing is; `surface`, index in `Look.names`;
    `Q` (4, 4) and `T_world_camera` (4, 4), the left one's pose [m]."""

    left: NDArray
    right: NDArray
    depth: NDArray
    surface: NDArray
    Q: NDArray
    T_world_camera: NDArray


@dataclass(frozen=True, eq=False)
class Look:
    """What the eyes saw during one sweep of both lasers, and the truth.

    `event` what happened; `time` of its start [s]; `truck` whether it was there; `motion`
    of the machine meanwhile, its time from 0 on; `scans` of the lasers; `pair` or None; `names` of
    the surfaces; `terrain` and `bed`, heights as they were, shape (ny, nx) [m], and the bed's x, y.
    """

    event: str
    time: float
    truck: bool
    motion: Motion
    scans: dict[str, Scan]
    pair: Pair | None
    names: tuple[str, ...]
    terrain: NDArray
    bed: NDArray
    bed_grid: tuple[NDArray, NDArray]

    @property
    def own(self) -> list[int]:
        """Numbers of the machine's surfaces."""
        return [self.names.index(link) for link in ("undercarriage", *JOINTS)]


class Led:
    """A machine without dynamics, with its soil: what Sight and the replay read of a world."""

    backend = "led"
    machine, scene, pose = BACKHOE, LOADING, np.zeros(3)

    def __init__(self, seed: int) -> None:
        self.seed, self.time = seed, 0.0
        self.ground = untouched_ground(LOADING, BACKHOE, seed, STEP, SANDY_LOAM)
        self.q = _posture(hand_made_plan(0)[0])
        self._reach = forces.numbers_of(BACKHOE, True).reach

    def dig(self, q: NDArray, dq: NDArray) -> None:
        """One tick of the soil; at its end the joints have angles and speeds, (4,) [rad, rad/s]."""
        from backhoe.simulation import engine

        self.q, self.time = q, self.time + TICK
        still = np.zeros(3)
        T, velocity = engine.tip_motion(self._reach, np.r_[still, q], np.r_[still, dq])
        self.ground.advance(T, velocity, TICK, float(dq[1:].sum()))


class Site:
    """The work, step by step; `looks` are what was seen, `recorder` what the replay needs."""

    def __init__(self, cycles: int, seed: int, record: bool) -> None:
        self.led = Led(seed)
        self.recorder = recorder_of(self.led) if record else None
        self.looks: list[Look] = []
        self._scanner = Scanner(self.led, EYES, seed)
        self._scanner.sight.truck = False
        self._work(cycles)

    def _work(self, cycles: int) -> None:
        sight = self._scanner.sight
        self._look("before", pair=True)
        sight.truck = True
        self._look("the truck has come")
        for cycle in range(cycles):
            *digging, tip, empty = plan = hand_made_plan(cycle)
            *digging, swing = digging
            self._lead([] if cycle == 0 else plan[:1])
            self._lead(digging[1:])
            self._lead([swing], look=cycle == 0)
            self._look("over the truck", pair=cycle == 0)
            self._lead([tip, empty])
            self._look("tipped out")
        sight.truck = False
        for _ in range(LOOKS_AFTER):
            self._look("the truck has left")
        self._lead(plan[:1], look=True)
        self._look("after", pair=True)

    def _lead(self, waypoints: list[WayPoint], look: bool = False) -> None:
        """Move through way-points; with `look`, also look while the machine moves."""
        if not waypoints:
            return
        led = self.led
        self._label(waypoints[0].name)
        times = np.cumsum([0.0, *(point.time for point in waypoints)])
        t = np.arange(1, round(times[-1] / TICK) + 1) * TICK
        q_way = np.array([led.q, *map(_posture, waypoints)])
        path = np.stack(smooth_trajectory(times, q_way, t), axis=1)
        for step, (q, dq) in enumerate(path):
            led.dig(q, dq)
            self._capture()
            if look and step == round(SET_OFF / TICK):
                coming = path[step : step + round(SWEEP / TICK) + 1, 0]
                time = np.arange(len(coming)) * TICK
                self._see("while it swings", Motion(time, coming, np.zeros((len(coming), 3))))

    def _look(self, event: str, pair: bool = False) -> None:
        self._label(event)
        self._see(event, Motion.standing(self.led.q), pair)
        self.led.time += SWEEP
        self._capture()

    def _see(self, event: str, motion: Motion, pair: bool = False) -> None:
        led, scanner = self.led, self._scanner
        scans = {
            name: scanner.scan(laser, motion, laser.sweep_lines) for name, laser in EYES.items()
        }
        ground, sight = led.ground, scanner.sight
        self.looks.append(
            Look(
                event,
                led.time,
                sight.truck,
                motion,
                scans,
                self._pair() if pair else None,
                sight.names,
                ground.terrain.heights.copy(),
                ground.bed.heights.copy(),
                ground.bed.grid(),
            )
        )

    def _pair(self) -> Pair:
        camera, T_left, T_right = stereo_now(self.led)
        left, right = (self._scanner.sight.look(camera, T) for T in (T_left, T_right))
        baseline = float(np.linalg.norm(T_right[:3, 3] - T_left[:3, 3]))
        Q = Rectified(camera.K, np.eye(3), np.eye(3), baseline).Q
        return Pair(left.grey, right.grey, left.depth, left.surface, Q, T_left)

    def _label(self, text: str) -> None:
        if self.recorder is not None:
            self.recorder.label(text)

    def _capture(self) -> None:
        if self.recorder is not None:
            self.recorder.capture()


@lru_cache(maxsize=2)
def worked(cycles: int, seed: int, record: bool = False) -> Site:
    """The site after so many cycles; what is swapped in changes nothing of what the eyes saw."""
    return Site(cycles, seed, record)


def _posture(waypoint: WayPoint) -> NDArray:
    return inverse_kinematics(np.array(waypoint.target))
