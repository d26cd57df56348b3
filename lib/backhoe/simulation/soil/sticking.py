"""Sticky soil: what stays on the walls of a tipped bucket, and falls when the bucket is shaken.

A layer of thickness h on a wall weighs rho g h on each square metre, and rho a h more pulls at it
while the wall accelerates with a. It stays as long as the soil's grip on steel is stronger:

    h = PEEL * adhesion / (rho (g + a))

Adhesion is measured over a whole surface that is torn off or sheared at once. A layer in a bucket
peels from its edge, so that it has the grip of a small part only; which part is our choice. Soils
without adhesion leave nothing.
"""

from __future__ import annotations

import numpy as np

from backhoe.basics.inputs import not_negative
from backhoe.machine import Machine, Shell
from backhoe.simulation.soil.soils import SoilParameters

PEEL = 0.03
"""Part of the adhesion that holds a layer which peels: ours; a stiff clay then leaves 5 cm."""


class StuckLayer:
    """What sticks to one bucket's walls in one soil.

    Attributes:
        keeps: volume that sticks now [m^3]: as much as at rest until the bucket is shaken, less
            after that, and as much as at rest again when it has dug.
    """

    def __init__(self, parameters: SoilParameters, machine: Machine) -> None:
        self._area, self._gravity = wall_area(machine.shell), machine.gravity
        self._grip = PEEL * parameters.adhesion / parameters.density
        self.keeps = self.volume()

    def volume(self, acceleration: float = 0.0) -> float:
        """What sticks while the walls accelerate [m^3].

        Args:
            acceleration: of the walls, its amount [m/s^2].
        """
        a = not_negative(acceleration, "acceleration", "m/s^2")
        return self._area * self._grip / (self._gravity + a)

    def shake(self, acceleration: float) -> None:
        """Let fall what does not stick at this acceleration [m/s^2]."""
        self.keeps = min(self.keeps, self.volume(acceleration))


def wall_area(shell: Shell) -> float:
    """Inner area of a bucket: its bent back and its two cheeks [m^2]."""
    along = np.hypot(*np.diff(np.array(shell.profile), axis=0).T).sum()
    return float(along * shell.width + 2 * shell.section_area)
