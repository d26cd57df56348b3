"""What earthwork should look like: a slope, or the bottom of a trench, and how far the soil is off.

A design is a strip with an origin, a direction in which `along` runs, and a width, half of it on
each side. Heights in the world, z = 0 the flat ground; errors are soil minus design, so positive
where soil is left.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan, cos, hypot, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import instance, not_negative, number, numbers, positive
from backhoe.simulation.scene import Scene


class Design:
    """What both designs have in common; they say where it starts and how high it is there.

    `origin` (x, y) [m], `direction` [rad], `run` the horizontal length and `width` [m].
    """

    origin: tuple[float, float]
    direction: float
    width: float
    run: float

    def along_across(self, x: ArrayLike, y: ArrayLike) -> tuple[NDArray, NDArray]:
        """Horizontal distances from the origin along the direction and to its left [m].

        Args:
            x, y: in the world, of one shape (...) [m].
        """
        x, y = numbers(x, "x") - self.origin[0], numbers(y, "y") - self.origin[1]
        c, s = cos(self.direction), sin(self.direction)
        return x * c + y * s, y * c - x * s

    def point(self, along: ArrayLike, across: ArrayLike = 0.0) -> NDArray:
        """Point of the design's surface, shape (..., 3) [m]; also beyond its border.

        Args:
            along, across: as `along_across` gives them, shapes that broadcast [m].
        """
        along, across = np.broadcast_arrays(numbers(along, "along"), numbers(across, "across"))
        c, s = cos(self.direction), sin(self.direction)
        x, y = self.origin[0] + along * c - across * s, self.origin[1] + along * s + across * c
        return np.stack([x, y, self._level(along)], axis=-1)

    def height(self, x: ArrayLike, y: ArrayLike) -> NDArray:
        """Height of the design, NaN beyond its border, shape (...) [m].

        Args:
            x, y: in the world, of one shape (...) [m].
        """
        along, across = self.along_across(x, y)
        inside = (along >= 0) & (along <= self.run) & (np.abs(across) <= self.width / 2)
        return np.where(inside, self._level(along), np.nan)

    def mask(self, scene: Scene, margin: float = 0.0) -> NDArray:
        """Cells of a scene's grid that count, shape (rows, columns).

        A cell is a column of soil on a square. One whose square the border cuts is partly another
        surface's, which stands there at its angle of repose, so only whole squares count.

        Args:
            scene: whose grid.
            margin: by which a square must lie within the border besides [m].
        """
        along, across = self.along_across(*instance(scene, "scene", Scene).grid())
        c, s = abs(cos(self.direction)), abs(sin(self.direction))
        inside = not_negative(margin, "margin", "m") + scene.cell / 2 * (c + s) - 1e-9
        far = np.abs(along - self.run / 2) <= self.run / 2 - inside
        return far & (np.abs(across) <= self.width / 2 - inside)

    def errors(self, heights: ArrayLike, scene: Scene, margin: float = 0.0) -> NDArray:
        """Soil minus design, NaN in cells that do not count, shape (rows, columns) [m].

        Args:
            heights: of the soil on the scene's grid, shape (rows, columns) [m].
            scene, margin: as for `mask`.

        Raises:
            ValueError: heights of another shape, or a value that is not finite.
        """
        x, y = instance(scene, "scene", Scene).grid()
        heights = numbers(heights, "heights", x.shape, meaning="of the scene's grid [m]")
        return np.where(self.mask(scene, margin), heights - self.height(x, y), np.nan)

    def _level(self, along: NDArray) -> NDArray:
        raise NotImplementedError


@dataclass(frozen=True)
class SlopeDesign(Design):
    """A plane slope that rises from the flat ground.

    `foot` is the middle of its lower edge (x, y) [m] and `direction` points uphill [rad]; it rises
    1 m on `ratio` m of horizontal way, is `length` long up the slope itself and `width` wide [m].

    Raises:
        ValueError: ratio, length or width not positive, a value that is not finite.
    """

    foot: tuple[float, float]
    direction: float = 0.0
    ratio: float = 2.0
    length: float = 6.0
    width: float = 1.0

    def __post_init__(self) -> None:
        _placed(self, "foot", "direction")
        for name, unit in (("ratio", ""), ("length", "m"), ("width", "m")):
            positive(getattr(self, name), f"SlopeDesign.{name}", unit)

    @property
    def origin(self) -> tuple[float, float]:
        """The foot (x, y) [m]."""
        return self.foot

    @property
    def angle(self) -> float:
        """Of the slope from the horizontal [rad]."""
        return atan(1 / self.ratio)

    @property
    def run(self) -> float:
        """Horizontal length [m]."""
        return self.length * self.ratio / hypot(1.0, self.ratio)

    @property
    def crest(self) -> float:
        """Height of its upper edge [m]."""
        return self.run / self.ratio

    def _level(self, along: NDArray) -> NDArray:
        return along / self.ratio


@dataclass(frozen=True)
class TrenchDesign(Design):
    """The bottom of a trench: plane, level along its width.

    `start` is the middle of its near end (x, y) [m], `heading` the way it runs [rad]; `length`,
    `width` and `depth` below the flat ground at the start [m]; `fall` how much lower it gets a
    metre [m/m], 0 for a flat bottom.

    Raises:
        ValueError: length, width or depth not positive, a bottom that comes out of the ground, a
            value that is not finite.
    """

    start: tuple[float, float] = (4.2, 0.0)
    heading: float = 0.0
    length: float = 4.0
    width: float = 0.9
    depth: float = 0.4
    fall: float = 0.0

    def __post_init__(self) -> None:
        _placed(self, "start", "heading")
        for name in ("length", "width", "depth"):
            positive(getattr(self, name), f"TrenchDesign.{name}", "m")
        number(self.fall, "TrenchDesign.fall", "m/m", above=-self.depth / self.length)

    @property
    def origin(self) -> tuple[float, float]:
        """The start (x, y) [m]."""
        return self.start

    @property
    def direction(self) -> float:
        """The heading [rad]."""
        return self.heading

    @property
    def run(self) -> float:
        """Horizontal length [m]."""
        return self.length

    def _level(self, along: NDArray) -> NDArray:
        return -self.depth - self.fall * along


def _placed(design: Design, place: str, angle: str) -> None:
    kind = type(design).__name__
    numbers(getattr(design, place), f"{kind}.{place}", (2,), meaning="x, y [m]")
    number(getattr(design, angle), f"{kind}.{angle}", "rad")
