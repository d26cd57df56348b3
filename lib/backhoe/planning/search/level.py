"""A bucket that is kept level: the way is searched in three joints, the fourth follows.

The bucket's pitch is the sum of the angles of boom, stick and bucket. Keep it, and the soil has no
reason to fall; what is left to plan is swing, boom and stick, so the search has a dimension less.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import instance, number, numbers
from backhoe.machine import BACKHOE, Machine
from backhoe.planning.search.arm_world import ArmWorld


def pitch(q: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """Pitch of the bucket: of the line from its pin to its teeth, from the horizontal outwards.

    Args:
        q: joint angles, shape (..., 4) [rad].
        machine: whose joints have these offsets.

    Returns:
        Shape (...), not wrapped: -pi with the mouth up and level [rad].

    Raises:
        ValueError: the last axis is not 4, or a value is not finite.
        TypeError: machine is no Machine.
    """
    q = numbers(q, "q", (..., 4), meaning="joints (swing, boom, stick, bucket)")
    instance(machine, "machine", Machine)
    return q[..., 1:].sum(axis=-1) + sum(link.angle_offset for link in machine.links)


class LevelWorld:
    """The world of an arm whose bucket keeps one pitch, for planners in three joints.

    Args:
        world: of all four joints.
        pitch: that is kept [rad].

    Attributes:
        lower, upper: limits of swing, boom and stick, shape (3,) [rad].

    Raises:
        ValueError: a pitch that is not finite.
        TypeError: world is no ArmWorld.
    """

    def __init__(self, world: ArmWorld, pitch: float) -> None:
        self.world = instance(world, "world", ArmWorld)
        self.pitch = number(pitch, "pitch", "rad")
        self.lower, self.upper = world.lower[:3], world.upper[:3]
        self._offset = sum(link.angle_offset for link in world.machine.links)

    def joints(self, p: ArrayLike) -> NDArray:
        """All four joints, shape (..., 4), for swing, boom and stick, shape (..., 3) [rad]."""
        p = numbers(p, "p", (..., 3), meaning="joints (swing, boom, stick)")
        bucket = self.pitch - self._offset - p[..., 1] - p[..., 2]
        return np.concatenate([p, bucket[..., None]], axis=-1)

    def is_free(self, p: ArrayLike) -> NDArray:
        """As `ArmWorld.is_free`, of swing, boom and stick, shape (..., 3) [rad]."""
        return self.world.is_free(self.joints(p))
