"""The bucket's shell on its way through the ground: what is cut, pushed away and stood upon.

The shell moves in steps of at most half a cell. What its edge cuts while it moves towards the mouth
goes into the bucket; what has no room there, and what the shell displaces, is laid down beside it.
"""

from __future__ import annotations

from math import ceil, cos, hypot, sin
from typing import NamedTuple

import numpy as np

from backhoe.basics.angles import wrap
from backhoe.machine import Shell
from backhoe.simulation.soil.bucket_pose import BucketPose, between, distance, turn
from backhoe.simulation.soil.terrain import Contact, Terrain


class Dug(NamedTuple):
    """Volume taken into the bucket and laid beside the map [m^3], and the shell's contact."""

    taken: float
    missed: float
    contact: Contact


class Digger:
    """A bucket's shell in the soil of one terrain.

    Args:
        terrain: that it digs.
        shell: its profile and width.
        sinkage: how far soil stands into the shell before it is pressed away [m].
    """

    def __init__(self, terrain: Terrain, shell: Shell, sinkage: float) -> None:
        self.terrain, self.sinkage = terrain, sinkage
        self.half = shell.width / 2
        self.profile, self.lip = np.array(shell.profile), shell.profile[-1]
        self.reach = max(hypot(x, y) for x, y in shell.profile)

    def move(self, before: BucketPose, now: BucketPose, room: float) -> Dug:
        """Drive the shell from one pose to the next with `room` [m^3] left in the bucket."""
        if min(before.tip[2], now.tip[2]) - self.reach > self.terrain.top:
            return Dug(0.0, 0.0, Contact())
        swept = abs(wrap(now.pitch - before.pitch)) + abs(turn(before, now))
        path = distance(before, now) + swept * (self.reach + self.half)
        steps = max(ceil(path / (self.terrain.cell / 2)), 1)
        last, taken, missed, contact = before, 0.0, 0.0, Contact()
        for step in range(1, steps + 1):
            here = now if step == steps else between(before, now, step / steps)
            dug = self._step(last, here, room - taken)
            taken, missed, contact = taken + dug.taken, missed + dug.missed, dug.contact
            last = here
        return Dug(taken, missed, contact)

    def depth(self, now: BucketPose, cells: float) -> float:
        """Mean height of the soil above the teeth, some cells along the heading [m]."""
        return self.terrain.depth_at(now, cells * self.terrain.cell, self.half)

    def depth_ahead(self, now: BucketPose, side: float) -> float:
        """Depth of the teeth that counts for the soil ahead, on one side along the heading [m].

        Where the surface slopes a wedge breaks out elsewhere than on level ground: the mean of the
        depth at the teeth and of that one depth further ahead comes near it.
        """
        at_teeth = self.depth(now, 1.5 * side)
        if at_teeth == 0.0:
            return 0.0
        u = side * (1.5 * self.terrain.cell + at_teeth)
        return (at_teeth + self.terrain.depth_at(now, u, self.half)) / 2

    def lower_lip(self, now: BucketPose) -> tuple[float, float]:
        """u and height over the tip of the lip over which soil falls out [m]."""
        (x, y), c, s = self.lip, cos(now.pitch), sin(now.pitch)
        u, z = x * c - y * s, x * s + y * c
        return (0.0, 0.0) if z >= 0 else (u, z)

    def before_mouth(self, now: BucketPose) -> float:
        """Nearest u in front of the teeth from where no soil gets under the shell [m]."""
        return 1.5 * self.terrain.cell * now.mouth_side

    def _step(self, last: BucketPose, here: BucketPose, room: float) -> Dug:
        cut, pressed, contact, u_low, u_high, _ = self.terrain.dig(
            self.profile, self.half, last, here, self.sinkage
        )
        if cut == 0.0 and pressed == 0.0:
            return Dug(0.0, 0.0, contact)
        along, across, up = _displacement(last, here)
        taken = missed = 0.0
        if along * sin(here.pitch) - up * cos(here.pitch) >= 0.0:
            taken = min(cut, max(room, 0.0))
            u = self.before_mouth(here)
            missed = self._lay(here, (u, -self.half), (u, self.half), cut - taken)
        else:
            pressed += cut
        missed += self._push_aside(here, (along, across, up), pressed, u_low, u_high)
        return Dug(taken, missed, contact)

    def _push_aside(
        self,
        here: BucketPose,
        moved: tuple[float, float, float],
        volume: float,
        u_low: float,
        u_high: float,
    ) -> float:
        """Lay what the shell displaced beside its footprint, on the side to which it moved."""
        along, across, up = moved
        margin, half = 1.5 * self.terrain.cell, self.half
        if abs(along) > max(abs(up), abs(across)):
            u = u_high + margin if along > 0 else u_low - margin
            return self._lay(here, (u, -half), (u, half), volume)
        if abs(across) > abs(up):
            v = half + margin if across > 0 else -half - margin
            return self._lay(here, (u_low, v), (u_high, v), volume)
        return sum(
            self._lay(here, (u_low, v), (u_high, v), volume / 2)
            for v in (-half - margin, half + margin)
        )

    def _lay(
        self, here: BucketPose, start: tuple[float, float], end: tuple[float, float], volume: float
    ) -> float:
        return self.terrain.lay(here.point(*start), here.point(*end), volume)


def _displacement(last: BucketPose, here: BucketPose) -> tuple[float, float, float]:
    dx, dy, dz = (b - a for a, b in zip(last.tip, here.tip, strict=True))
    return (*here.components(dx, dy), dz)
