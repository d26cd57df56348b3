"""What can go wrong on the site, each once: what the mission is tried with.

A fault changes what the sensors say, what the machine does, or where things stand; the mission is
told of none of it, and must find out.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.pid import ARM_GAINS
from backhoe.basics.inputs import choice
from backhoe.simulation.scene import Scene
from backhoe.simulation.soil import Rock


@dataclass(frozen=True)
class Fault:
    """A machine and a site without a fault; each fault below changes one answer.

    Attributes:
        name: in `FAULTS`.
        what: it is, in words.
    """

    name: str = "none"
    what: str = "nothing goes wrong"

    def scene(self, scene: Scene) -> Scene:
        """The site as it is, when the order says `scene`."""
        return scene

    def readings(self, time: float, values: tuple) -> tuple:
        """Of left and right sprocket, gyro [rad/s] and fix (2,) [m] or None at a time [s]."""
        return values

    def ranges(self, look: int, ranges: NDArray) -> NDArray:
        """Ranges of a laser at a look, counted from 0: shape (n, m), its lines by its beams [m]."""
        return ranges

    def delay(self, look: int) -> float:
        """How long after a look its points come [s]."""
        return 0.0

    def torque(self, loads: int, q: NDArray, dq: NDArray, torque: NDArray) -> NDArray:
        """That the joints get [N m], after so many loads, at angles and speeds (4,)."""
        return torque

    def truck_there(self, loads: int, swing: float) -> bool:
        """Whether the truck is there after so many loads, at an angle of the swing [rad]."""
        return True


@dataclass(frozen=True)
class LostScan(Fault):
    name: str = "lost scan"
    what: str = "the lasers return nothing at `count` looks from look `first` on, 0 the first"
    first: int = 1
    count: int = 1

    def ranges(self, look: int, ranges: NDArray) -> NDArray:
        return np.full_like(ranges, np.nan) if 0 <= look - self.first < self.count else ranges


@dataclass(frozen=True)
class EncoderSlip(Fault):
    name: str = "encoder slip"
    what: str = "the left sprocket spins, 3 rad/s too fast, from 4 to 6 s"

    def readings(self, time: float, values: tuple) -> tuple:
        left, *others = values
        return (left + (3.0 if 4.0 < time < 6.0 else 0.0), *others)


@dataclass(frozen=True)
class GyroReversed(Fault):
    name: str = "gyro reversed"
    what: str = "the gyro's wires are changed over: it says minus what it feels"

    def readings(self, time: float, values: tuple) -> tuple:
        left, right, gyro, fix = values
        return left, right, -gyro, fix


@dataclass(frozen=True)
class HeapElsewhere(Fault):
    name: str = "heap elsewhere"
    what: str = "the heap lies `by` x, y [m] from where the order says"
    by: tuple[float, float] = (1.6, -0.8)

    def scene(self, scene: Scene) -> Scene:
        moved = [replace(h, x=h.x + self.by[0], y=h.y + self.by[1]) for h in scene.heaps]
        return replace(scene, heaps=tuple(moved))


@dataclass(frozen=True)
class TruckElsewhere(Fault):
    name: str = "truck elsewhere"
    what: str = "the truck stands `by` x, y [m] from where the order says"
    by: tuple[float, float] = (-0.7, 0.5)

    def scene(self, scene: Scene) -> Scene:
        truck = scene.truck
        truck = replace(truck, x=truck.x + self.by[0], y=truck.y + self.by[1])
        return replace(scene, truck=truck)


@dataclass(frozen=True)
class TruckLeaves(Fault):
    name: str = "truck leaves"
    what: str = "the truck leaves after `after` loads, when the full bucket is half way to it"
    after: int = 1

    def truck_there(self, loads: int, swing: float) -> bool:
        return loads < self.after or swing < np.radians(-45)


@dataclass(frozen=True)
class StuckJoint(Fault):
    name: str = "stuck joint"
    what: str = "after `after` loads joint number `joint` stands still, whatever it is told"
    after: int = 1
    joint: int = 2
    held: list[float] = field(default_factory=list, compare=False)

    def torque(self, loads: int, q: NDArray, dq: NDArray, torque: NDArray) -> NDArray:
        if loads < self.after:
            return torque
        j, torque = self.joint, torque.copy()
        if not self.held:
            self.held.append(float(q[j]))
        torque[j] = ARM_GAINS.kp[j] * (self.held[0] - q[j]) - ARM_GAINS.kd[j] * dq[j]
        return torque


@dataclass(frozen=True)
class PerceptionLate(Fault):
    name: str = "perception late"
    what: str = "every look's points come `late` seconds after it"
    late: float = 3.0

    def delay(self, look: int) -> float:
        return self.late


@dataclass(frozen=True)
class BuriedRock(Fault):
    name: str = "buried rock"
    what: str = "a rock of `radius` lies in the heap, its middle at x, y, z [m]"
    at: tuple[float, float, float] = (5.4, 1.3, 0.2)
    radius: float = 0.4

    def scene(self, scene: Scene) -> Scene:
        return replace(scene, rocks=(*scene.rocks, Rock(*self.at, self.radius)))


FAULTS = {
    fault.name: fault
    for fault in (
        LostScan(),
        EncoderSlip(),
        HeapElsewhere(),
        TruckElsewhere(),
        TruckLeaves(),
        StuckJoint(),
        GyroReversed(),
        PerceptionLate(),
        BuriedRock(),
    )
}
"""By name."""


def fault_of(fault: str | Fault | None) -> Fault:
    """A fault, the one of a name in `FAULTS`, or for None one that does nothing.

    Raises:
        ValueError: there is none of that name.
    """
    if fault is None:
        return Fault()
    if not isinstance(fault, Fault):
        fault = FAULTS[choice(fault, "fault", FAULTS)]
    return replace(fault, held=[]) if isinstance(fault, StuckJoint) else fault
