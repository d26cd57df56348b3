"""Soil that moves: the bucket digs, carries, spills and fills a truck; volume is kept throughout.

    ground = soil.Ground(terrain, bed, hold=0.001)
    force = ground.advance(T_tip, tip_velocity, 0.01)      # 100 times a second
    force = ground.force(tip_position, tip_velocity)       # each millisecond in between

World frame: x forward, y left, z up. T_tip is the pose of the bucket's tip frame: origin at the
teeth, x from the pin through the teeth, y towards the back plate, z across. What is where:
`terrain` (the map), `digging` (the shell in the soil), `bucket_fill` (what it holds), `sticking`
(what clings to it), `rocks`, `soils` (their numbers), `earthmoving` (a blade in soil), `force` (on
the bucket), `bucket_pose`, `cells` (the loops).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import dist, inf, isfinite

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import wrap
from backhoe.basics.inputs import instance, numbers, positive, real_numbers
from backhoe.machine import BACKHOE, Machine
from backhoe.simulation.soil.bucket_fill import BucketFill
from backhoe.simulation.soil.bucket_pose import BucketPose, distance, from_transform
from backhoe.simulation.soil.digging import Digger
from backhoe.simulation.soil.force import Resistance, SoilForce
from backhoe.simulation.soil.rocks import Rock, Rocks
from backhoe.simulation.soil.soils import SANDY_LOAM, SoilParameters
from backhoe.simulation.soil.sticking import StuckLayer
from backhoe.simulation.soil.terrain import Contact, Terrain

SWEEPS = 4
"""How many cells far loose soil slides in one advance."""
EMPTYING_TIME = 0.15
"""Time constant of the last of the outflow [s]."""
CRUMBS = 1e-4
"""What is left of an emptying bucket's load falls at once when it is less than this [m^3]."""
LONGEST_STEP = 1.0
"""A tip that moves further than this in one advance [m] was put there, not driven."""


class Ground:
    """All the soil of a scene: on the ground, in the bucket and in the truck.

    Args:
        terrain: the ground; it is settled to the angle of repose. Rocks must be its floor.
        bed: the truck's bed (`Terrain.bed`), or None.
        parameters: strength and weight of the soil.
        machine: gives the bucket's shell and gravity.
        rocks: that lie in the ground, fixed (`Rock`).
        hold: how long the simulation keeps a force before it asks again [s]. The force is softened
            so that the bucket does not chatter: 1 ms gives the soil's full strength at 0.2 m/s.

    Attributes:
        bucket_volume: in the bucket [m^3].
        off_map_volume: fallen beside the map [m^3]; it counts in `total_volume`.
        moment: that goes with the last force, about the tip, raising the pitch [N m].

    Raises:
        TypeError: terrain or bed is no Terrain, parameters no SoilParameters.
        ValueError: hold is not positive.
    """

    def __init__(
        self,
        terrain: Terrain,
        bed: Terrain | None = None,
        parameters: SoilParameters = SANDY_LOAM,
        machine: Machine = BACKHOE,
        rocks: Sequence[Rock] = (),
        *,
        hold: float = 0.01,
    ) -> None:
        self.terrain = instance(terrain, "terrain", Terrain)
        self.bed = None if bed is None else instance(bed, "bed", Terrain)
        hold = positive(hold, "hold", "s")
        self.parameters = instance(parameters, "parameters", SoilParameters)
        self.machine = machine
        self.fill = BucketFill(machine.shell, parameters.repose)
        self.bucket_volume = self.off_map_volume = self.moment = 0.0
        self._strength = SoilForce(parameters, machine, hold)
        self._digger = Digger(terrain, machine.shell, self._strength.sinkage)
        self._rocks = Rocks(rocks, machine, self._strength.mass, hold) if rocks else None
        self._stuck = StuckLayer(parameters, machine) if parameters.adhesion > 0 else None
        self._velocity: Sequence[float] | None = None
        self._before: BucketPose | None = None
        self._felt: Resistance | None = None
        terrain.relax(parameters.repose)
        if bed is not None:
            bed.relax(parameters.repose)

    @property
    def truck_volume(self) -> float:
        """Soil in the truck [m^3]."""
        return self.bed.volume if self.bed is not None else 0.0

    @property
    def total_volume(self) -> float:
        """All soil, wherever it is [m^3]: constant."""
        lost = self.off_map_volume
        return self.terrain.volume + self.bucket_volume + self.truck_volume + lost

    @property
    def payload(self) -> float:
        """Mass of the soil in the bucket [kg]."""
        return self.bucket_volume * self.parameters.density

    @property
    def touches(self) -> bool:
        """Whether the soil at the last advance resists the bucket: if not, `force` is zero."""
        felt = self._felt
        if self._rocks is not None and self._before is not None and self._rocks.near(self._before):
            return True
        return felt is not None and (felt.cutting > 0.0 or felt.bearing > 0.0)

    def advance(
        self,
        T_tip: ArrayLike,
        tip_velocity: ArrayLike,
        dt: float,
        pitch_rate: float | None = None,
    ) -> NDArray:
        """Move the soil on by one tick: cut, fill, spill, slide.

        Args:
            T_tip: pose of the bucket's tip frame in the world, shape (4, 4).
            tip_velocity: velocity of the tip in the world, shape (3,) [m/s].
            dt: time since the last call [s].
            pitch_rate: of the bucket [rad/s]; default the change of its pitch since the last call.

        Returns:
            Force of the soil on the bucket at its tip, world frame, shape (3,) [N].

        Raises:
            ValueError: wrong shape, a value that is not finite, dt not positive, the arm's plane
                not upright, or a tip that has jumped by more than 1 m (see `forget_pose`).
        """
        now = from_transform(T_tip)
        velocity = _vector(tip_velocity, "tip_velocity")
        if not 0.0 < dt < inf:
            positive(dt, "dt", "s")
        return np.array(self.move(now, velocity, dt, pitch_rate))

    def move(
        self,
        now: BucketPose,
        velocity: Sequence[float],
        dt: float,
        pitch_rate: float | None = None,
    ) -> tuple[float, float, float]:
        """The same as `advance` for loops that know the bucket's pose: finite numbers, unchecked.

        Raises:
            ValueError: a tip that has jumped by more than 1 m.
        """
        before = self._before or now
        if distance(before, now) > LONGEST_STEP:
            raise ValueError(
                f"the tip jumped from {before.tip} to {now.tip} m in one advance: after placing "
                "the machine by hand call forget_pose()"
            )
        taken, missed, contact = self._digger.move(
            before, now, self.fill.heaped - self.bucket_volume
        )
        self.bucket_volume += taken
        self.off_map_volume += missed
        if self._stuck is not None:
            self._shake(velocity, dt, taken)
        self._spill(now, dt)
        self._settle()
        if pitch_rate is None:
            pitch_rate = wrap(now.pitch - before.pitch) / dt
        self._felt = self._feel(now, velocity, contact, pitch_rate)
        self._before = now
        return self._answer(now.tip[2], velocity, pitch_rate, now)

    def force(
        self,
        tip_position: ArrayLike,
        tip_velocity: ArrayLike,
        pitch_rate: float | None = None,
        T_tip: ArrayLike | None = None,
    ) -> NDArray:
        """The force for the tip's position and speed now, in the soil of the last advance.

        Cheap, so that a simulation can ask each millisecond; no soil moves.

        Args:
            tip_position: in the world, shape (3,) [m].
            tip_velocity: in the world, shape (3,) [m/s].
            pitch_rate: of the bucket [rad/s]; default that of the last advance.
            T_tip: pose of the tip frame now, shape (4, 4): without it no rock is felt.

        Returns:
            Force at the tip, world frame, shape (3,) [N].

        Raises:
            ValueError: a wrong shape or a value that is not finite.
        """
        position = _vector(tip_position, "tip_position")
        velocity = _vector(tip_velocity, "tip_velocity")
        if pitch_rate is None:
            pitch_rate = 0.0 if self._felt is None else self._felt.pitch_rate
        now = None if T_tip is None or self._rocks is None else from_transform(T_tip)
        return np.array(self._answer(position[2], velocity, pitch_rate, now))

    def forget_pose(self) -> None:
        """Start a new path: the machine was put elsewhere without digging its way there."""
        self._before = self._felt = self._velocity = None

    def snapshot(self) -> dict[str, object]:
        """A copy of everything that changes."""
        return {
            "terrain": self.terrain.snapshot(),
            "bed": None if self.bed is None else self.bed.snapshot(),
            "volumes": (self.bucket_volume, self.off_map_volume),
            "bucket": (self._before, self._felt, self.moment),
            "stuck": (self._velocity, None if self._stuck is None else self._stuck.keeps),
        }

    def restore(self, snapshot: dict[str, object]) -> None:
        """Return to a snapshot of this ground.

        Raises:
            ValueError: the snapshot is of another scene.
        """
        if (snapshot["bed"] is None) != (self.bed is None):
            raise ValueError("the snapshot is of another scene: one of the two has no truck")
        self.terrain.restore(snapshot["terrain"])
        if self.bed is not None:
            self.bed.restore(snapshot["bed"])
        self.bucket_volume, self.off_map_volume = snapshot["volumes"]
        self._before, self._felt, self.moment = snapshot["bucket"]
        self._velocity, keeps = snapshot["stuck"]
        if self._stuck is not None:
            self._stuck.keeps = keeps

    def _answer(
        self, z: float, velocity: Sequence[float], pitch_rate: float, now: BucketPose | None
    ) -> tuple[float, float, float]:
        felt = self._felt
        push = (0.0,) * 4 if felt is None else felt.wrench(z, velocity, pitch_rate)
        if self._rocks is not None and now is not None:
            rock = self._rocks.push(now, velocity, pitch_rate)
            push = tuple(a + b for a, b in zip(push, rock, strict=True))
        *force, self.moment = push
        return tuple(force)

    def _shake(self, velocity: Sequence[float], dt: float, taken: float) -> None:
        """Let the tip's acceleration tear at what sticks to the walls, unless they dig."""
        before, self._velocity = self._velocity or velocity, velocity
        if taken > 0.0:
            self._stuck.keeps = self._stuck.volume()
        else:
            self._stuck.shake(dist(velocity, before) / dt)

    def _spill(self, now: BucketPose, dt: float) -> None:
        """Let what the bucket cannot hold at its pitch fall over the lower lip."""
        if self.bucket_volume <= 0.0:
            return
        in_air = now.tip[2] > self.terrain.top
        support = 0.0 if in_air else self._digger.depth(now, 2 * now.mouth_side)
        held = self.fill.retained(now.pitch, support)
        if self._stuck is not None:
            held = max(held, self._stuck.keeps)
        surplus = self.bucket_volume - held
        if surplus <= 0.0:
            return
        falls = min(self.parameters.spill_rate * dt, surplus * min(dt / EMPTYING_TIME, 1.0))
        if self.bucket_volume - falls < CRUMBS:
            falls = self.bucket_volume
        self.bucket_volume -= falls
        self._drop(now, falls)

    def _drop(self, now: BucketPose, volume: float) -> None:
        """Let soil fall from the lower lip, over the whole width: into the truck, else past it."""
        lip, below = self._digger.lower_lip(now)
        u, half, z = lip + self._digger.before_mouth(now), self._digger.half, now.tip[2] + below
        start, end = now.point(u, -half), now.point(u, half)
        if self.bed is not None:
            volume = self.bed.lay(start, end, volume, from_height=z)
        self.off_map_volume += self.terrain.lay(start, end, volume)

    def _settle(self) -> None:
        """Let loose soil slide a few cells; the truck's overflow falls beside it."""
        repose, ground, bed = self.parameters.repose, self.terrain, self.bed
        ground.relax(repose, SWEEPS)
        ground.lift()
        if bed is not None and not bed.settled:
            bed.relax(repose, SWEEPS)
            self.off_map_volume += bed.overflow_onto(ground)

    def _feel(
        self,
        now: BucketPose,
        velocity: tuple[float, float, float],
        contact: Contact,
        pitch_rate: float,
    ) -> Resistance | None:
        if now.tip[2] > self.terrain.top and contact.area == 0.0:
            return None
        depth = self._digger.depth_ahead(now, self._strength.ahead(now, velocity))
        volume, before = self.bucket_volume, self._felt
        return self._strength.resistance(now, velocity, contact, depth, volume, pitch_rate, before)


def _vector(values: ArrayLike, name: str) -> list[float]:
    """Three finite numbers; the door is asked what is wrong where they are none."""
    vector = real_numbers(values, name)
    three = vector.tolist()
    if vector.shape != (3,) or not isfinite(sum(three)):
        numbers(vector, name, (3,))
    return three
