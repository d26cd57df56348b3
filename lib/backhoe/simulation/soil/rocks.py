"""Rocks in the ground: balls that no bucket cuts, moves or passes.

A rock is fixed and smooth. Where the bucket's shell meets it, it is pushed back along the line from
the rock's middle to the nearest point of the shell, by a stiff spring with a damper that never
pulls: as hard as the machine pushes. The push is handed on as if it acted in the arm's plane; the
bucket's side plates pass a rock unfelt. Soil lies on a rock as on a floor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, sqrt

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import numbers, positive
from backhoe.machine import Machine
from backhoe.simulation.soil.bucket_pose import BucketPose
from backhoe.simulation.soil.cells import turned

STIFFNESS = 1e7
"""Of rock and steel where they meet [N/m]: our choice, 1 cm under 100 kN; less if `hold` asks."""

DAMPING = 0.5
"""Of the same, as a ratio of the critical one [1]."""


@dataclass(frozen=True)
class Rock:
    """A ball with its middle at (x, y, z) and `radius` [m], in the world frame."""

    x: float
    y: float
    z: float
    radius: float

    def __post_init__(self) -> None:
        numbers((self.x, self.y, self.z), "Rock.x, y and z", (3,))
        positive(self.radius, "Rock.radius", "m")

    def top_at(self, x: NDArray, y: NDArray) -> NDArray:
        """Height of its upper side at (x, y), minus infinity beside it [m], same shape."""
        aside = (x - self.x) ** 2 + (y - self.y) ** 2
        inside = aside < self.radius**2
        return np.where(
            inside, self.z + np.sqrt(np.where(inside, self.radius**2 - aside, 0)), -np.inf
        )


class Rocks:
    """All rocks of a ground, as one machine's bucket meets them.

    Args:
        rocks: where they lie.
        machine: whose bucket.
        mass: least effective mass of the bucket's tip [kg].
        hold: how long a force is kept before it is asked for again [s].
    """

    def __init__(self, rocks: Sequence[Rock], machine: Machine, mass: float, hold: float) -> None:
        self.rocks = tuple(rocks)
        self._profile = np.array(machine.shell.profile)
        self._half = machine.shell.width / 2
        self._reach = max(hypot(u, z) for u, z in machine.shell.profile) + self._half
        self.stiffness = min(STIFFNESS, mass / (4 * hold**2))
        self.damping = min(2 * DAMPING * sqrt(self.stiffness * mass), 0.3 * mass / hold)

    def near(self, now: BucketPose, margin: float = 0.1) -> bool:
        """Whether a rock could be met within `margin` [m]."""
        return any(
            hypot(rock.x - now.tip[0], rock.y - now.tip[1], rock.z - now.tip[2])
            < rock.radius + self._reach + margin
            for rock in self.rocks
        )

    def push(
        self, now: BucketPose, velocity: Sequence[float], pitch_rate: float
    ) -> tuple[float, float, float, float]:
        """Force on the tip in the world (x, y, z) [N] and moment that raises the pitch [N m].

        Args:
            now: pose of the bucket.
            velocity: of its tip, in the world [m/s].
            pitch_rate: of the bucket [rad/s].
        """
        along = across = up = moment = 0.0
        if self.near(now, 0.0):
            moving = (*now.components(velocity[0], velocity[1]), velocity[2])
            for rock in self.rocks:
                f_along, f_across, f_up, f_moment = self._push_of(rock, now, moving, pitch_rate)
                along, across, up = along + f_along, across + f_across, up + f_up
                moment += f_moment
        ex, ey = now.heading
        return along * ex + across * ey, along * ey - across * ex, up, moment

    def _push_of(
        self, rock: Rock, now: BucketPose, velocity: tuple[float, float, float], pitch_rate: float
    ) -> tuple[float, float, float, float]:
        """Force along, across and up [N], and moment [N m], of one rock."""
        u, v = now.components(rock.x - now.tip[0], rock.y - now.tip[1])
        middle = np.array([u, rock.z - now.tip[2]])
        nearest = _nearest(np.column_stack(turned(self._profile, now.pitch)), middle)
        (off_u, off_z), off_v = nearest - middle, min(max(v, -self._half), self._half) - v
        distance = hypot(off_u, off_v, off_z)
        if not 0.0 < distance < rock.radius:
            return 0.0, 0.0, 0.0, 0.0
        nu, nv, nz = off_u / distance, off_v / distance, off_z / distance
        leaving = nu * (velocity[0] - pitch_rate * nearest[1])
        leaving += nv * velocity[1] + nz * (velocity[2] + pitch_rate * nearest[0])
        deep = rock.radius - distance
        force = max(self.stiffness * deep - self.damping * leaving, 0.0)
        moment = force * (nearest[0] * nz - nearest[1] * nu)
        return force * nu, force * nv, force * nz, float(moment)


def _nearest(line: NDArray, point: NDArray) -> NDArray:
    """The point of a line through corners (n, 2) that is nearest to another point, (2,) [m]."""
    starts, sides = line[:-1], np.diff(line, axis=0)
    part = ((point - starts) * sides).sum(axis=1) / (sides**2).sum(axis=1)
    feet = starts + np.clip(part, 0.0, 1.0)[:, None] * sides
    return feet[((feet - point) ** 2).sum(axis=1).argmin()]
