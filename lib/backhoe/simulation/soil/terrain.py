"""Ground that keeps its volume: a heightmap that slumps to its angle of repose.

Heights stand on a regular grid in the world frame (x forward, y left, z up): `heights[i, j]` is the
soil's surface at x = origin_x + j cell, y = origin_y + i cell, and fills a column of cell^2.
"""

from __future__ import annotations

from functools import cache
from math import inf, pi, tan
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative, number, numbers, positive
from backhoe.simulation.soil.bucket_pose import BucketPose
from backhoe.simulation.soil.cells import Cells

SETTLING_SWEEPS = 20_000


class Contact(NamedTuple):
    """Where the shell stands on the ground: area [m^2], mean depth [m] and mean u [m]."""

    area: float = 0.0
    sunk: float = 0.0
    lever: float = 0.0


class Cut(NamedTuple):
    """What a bucket's shell does in one step.

    Volume cut by the edge and volume pressed out [m^3]; contact; least and greatest u of the shell
    [m]; first row, end row, first column, end column of the cells that it covers.
    """

    cut: float
    pressed: float
    contact: Contact
    u_low: float
    u_high: float
    covered: tuple[int, int, int, int]


class Terrain:
    """Soil on a grid, with an optional rigid floor below which nothing is dug.

    Args:
        heights: surface, shape (ny, nx), at least 2 by 2 [m]; copied.
        cell: spacing of the grid [m].
        origin: (x, y) of heights[0, 0] in the world [m].
        floor: rigid ground under the soil, same shape as heights [m], minus infinity where there
            is none; None for soil without end.

    Attributes:
        heights, floor: to be read, shape (ny, nx) [m]; only the methods change them.
        ceiling: above which no soil flows, because a bucket stands there, shape (ny, nx) [m].
        version: counts the changes; a drawing made at one version stays right until the next.

    Raises:
        ValueError: wrong shape, a value that is not finite, a cell that is not positive, or soil
            below its floor.
    """

    def __init__(
        self,
        heights: ArrayLike,
        cell: float,
        origin: tuple[float, float] = (0.0, 0.0),
        floor: ArrayLike | None = None,
    ) -> None:
        surface = np.array(numbers(heights, "heights", ("ny", "nx")), order="C")
        if min(surface.shape) < 2:
            raise ValueError(f"heights must have at least 2 by 2 cells, got {surface.shape}")
        self.has_floor = floor is not None
        ground = np.full_like(surface, -inf)
        if self.has_floor:
            ground[:] = numbers(floor, "floor", surface.shape, finite=False)
            if not (surface >= ground).all():
                raise ValueError("heights must not lie below the floor")
        self.cell = positive(cell, "cell", "m")
        self.origin = tuple(numbers(origin, "origin", (2,), meaning="x, y [m]").tolist())
        box = np.array([0, surface.shape[0], 0, surface.shape[1]])
        ceiling = np.full_like(surface, inf)
        self._cells = Cells(surface, ground, ceiling, box, *self.origin, self.cell)
        self._plain = tuple(self._cells)
        self._covered: tuple[int, int, int, int] | None = None
        self.heights, self.floor, self.ceiling = map(_to_read, (surface, ground, ceiling))
        self.version = 0
        self._top = (-1, 0.0)

    @classmethod
    def flat(cls, x: tuple[float, float], y: tuple[float, float], cell: float) -> Terrain:
        """Level ground at z = 0 over at least x[0] to x[1] by y[0] to y[1] [m]."""
        (x0, x1), (y0, y1) = numbers((x, y), "x and y", (2, 2), meaning="ranges [m]").tolist()
        if not (x0 < x1 and y0 < y1):
            raise ValueError(f"flat needs rising ranges, got {x} and {y}")
        cell = positive(cell, "cell", "m")
        rows, columns = (int(np.ceil(side / cell)) + 1 for side in (y1 - y0, x1 - x0))
        return cls(np.zeros((rows, columns)), cell, (x0, y0))

    @classmethod
    def bed(
        cls,
        centre: tuple[float, float],
        length: float,
        width: float,
        floor: float,
        wall: float,
        cell: float = 0.08,
    ) -> Terrain:
        """An empty truck bed, its sides along x and y: a floor inside a ring of wall cells.

        Args:
            centre: (x, y) of the bed [m].
            length: inside, along x [m].
            width: inside, along y [m].
            floor: height of the floor [m].
            wall: height of the wall's top [m].
            cell: largest spacing of its grid [m].

        Raises:
            ValueError: a size is not positive, or the wall is not above the floor.
        """
        sizes = {"length": length, "width": width, "cell": cell}
        length, width, cell = (positive(size, name, "m") for name, size in sizes.items())
        floor = number(floor, "floor", "m")
        wall = number(wall, "wall", "m", above=floor)
        rows, columns = (round(side / cell) for side in (width, length))
        if min(rows, columns) < 2:
            raise ValueError(f"a bed needs at least 2 cells a side, got {rows} by {columns}")
        surface = np.full((rows + 2, columns + 2), wall)
        surface[1:-1, 1:-1] = floor
        corner = (centre[0] - (columns + 1) / 2 * cell, centre[1] - (rows + 1) / 2 * cell)
        return cls(surface, cell, corner, floor=surface)

    def with_heap(self, x: float, y: float, height: float, radius: float) -> Terrain:
        """The same ground with a cone of `height` and `radius` [m] at (x, y) on top."""
        height, radius = not_negative(height, "height", "m"), positive(radius, "radius", "m")
        grid_x, grid_y = self.grid()
        distance = np.hypot(grid_x - x, grid_y - y)
        heap = height * np.maximum(1 - distance / radius, 0.0)
        floor = self.floor if self.has_floor else None
        return Terrain(self.heights + heap, self.cell, self.origin, floor)

    def grid(self) -> tuple[NDArray, NDArray]:
        """World x and y of every height, each of shape (ny, nx) [m]."""
        rows, columns = self.heights.shape
        x = self.origin[0] + self.cell * np.arange(columns)
        y = self.origin[1] + self.cell * np.arange(rows)
        return tuple(np.meshgrid(x, y))

    @property
    def volume(self) -> float:
        """Soil above the floor, or above z = 0 where there is none [m^3]."""
        bottom = np.where(self.floor > -inf, self.floor, 0.0) if self.has_floor else 0.0
        thickness = self.heights - bottom
        return float(thickness.sum()) * self.cell**2

    @property
    def top(self) -> float:
        """Highest point [m]."""
        if self._top[0] != self.version:
            self._top = (self.version, float(self.heights.max()))
        return self._top[1]

    def height_at(self, points: ArrayLike) -> NDArray:
        """Height of the surface, bilinear between the cells.

        Args:
            points: world (x, y), shape (..., 2) [m].

        Returns:
            Heights, shape (...) [m].

        Raises:
            ValueError: last axis is not 2, or a point is off the map or not finite.
        """
        points = numbers(points, "points", (..., 2), meaning="x, y [m]", finite=False)
        at = (points - self.origin) / self.cell
        last = np.array(self.heights.shape[::-1]) - 1
        inside = ((at >= 0) & (at <= last)).all(axis=-1)
        if not inside.all():
            raise ValueError(f"point {points[~inside].reshape(-1, 2)[0]} m is off the map")
        corner = np.minimum(at.astype(int), last - 1)
        (a, b), (j, i) = np.moveaxis(at - corner, -1, 0), np.moveaxis(corner, -1, 0)
        h = self.heights
        near = (1 - a) * h[i, j] + a * h[i, j + 1]
        far = (1 - a) * h[i + 1, j] + a * h[i + 1, j + 1]
        return (1 - b) * near + b * far

    def depth_at(self, here: BucketPose, u: float, half: float) -> float:
        """Mean depth of the tip below the soil on a line across, 2 `half` wide, at u [m]."""
        return _engine().cut_depth(self._plain, tuple(here), u, half)

    def dig(
        self, profile: NDArray, half: float, last: BucketPose, here: BucketPose, sinkage: float
    ) -> Cut:
        """Move a bucket's shell a step of less than a cell through the soil.

        Args:
            profile: of the shell, in its tip frame, shape (n, 2) [m].
            half: half its width [m].
            last, here: its poses before and after the step.
            sinkage: how far soil stands into the shell before it is pressed away [m].

        Returns:
            What is taken out of the ground. Where the shell stands no soil flows until `lift`.
        """
        self.lift()
        cut, pressed, contact, *span, self._covered = _engine().dig(
            self._plain, profile, half, tuple(last), tuple(here), sinkage
        )
        self.version += cut > 0.0 or pressed > 0.0
        return Cut(cut, pressed, Contact(*contact), *span, self._covered)

    def lift(self) -> None:
        """Let soil flow again where the shell kept it away."""
        if self._covered is not None:
            i, end_i, j, end_j = self._covered
            self._cells.ceiling[i:end_i, j:end_j] = inf
            self._covered = None

    def lay(
        self,
        start: tuple[float, float],
        end: tuple[float, float],
        volume: float,
        from_height: float = inf,
    ) -> float:
        """Lay a volume [m^3] evenly along the line from `start` to `end`, (x, y) each [m].

        Returns:
            The part that found no place: beside the map, or over soil above `from_height` [m^3].
        """
        if volume <= 0:
            return volume
        missed = _engine().lay(self._plain, start, end, from_height, volume)
        self.version += missed < volume
        return missed

    def overflow_onto(self, ground: Terrain) -> float:
        """Tip what lies on the outermost cells, the walls of a bed, onto the ground beside them.

        Returns:
            What fell beside the ground's map [m^3].
        """
        fell, missed = _engine().overflow(self._plain, ground._plain)
        self.version += fell > 0
        ground.version += fell > missed
        return missed

    def relax(self, repose: float, sweeps: int = SETTLING_SWEEPS) -> int:
        """Let slopes steeper than `repose` [rad] slide; returns how many sweeps found slides.

        Raises:
            ValueError: repose is not between 0 and 90 degrees.
        """
        if self.settled:
            return 0
        repose = number(repose, "repose", "rad", above=0.0, below=pi / 2)
        used = _engine().relax(self._plain, tan(repose) * self.cell, sweeps)
        self.version += used > 0
        return used

    @property
    def settled(self) -> bool:
        """True when no slope is left to look at."""
        first_row, end_row, first_column, end_column = self._cells.box.tolist()
        return first_row >= end_row or first_column >= end_column

    def snapshot(self) -> dict[str, NDArray]:
        """A copy of what changes: heights, shape (ny, nx) [m], and where soil may still slide."""
        return {"heights": self.heights.copy(), "box": self._cells.box.copy()}

    def restore(self, snapshot: dict[str, NDArray]) -> None:
        """Return to a snapshot of this terrain, shape (ny, nx) [m]; counts as a change.

        Raises:
            ValueError: the snapshot is of a map of another shape.
        """
        heights = numbers(snapshot["heights"], "the snapshot's heights", self.heights.shape)
        self._cells.heights[:], self._cells.box[:] = heights, snapshot["box"]
        self.version += 1


def _to_read(array: NDArray) -> NDArray:
    """The same cells without leave to write."""
    view = array.view()
    view.flags.writeable = False
    return view


@cache
def _engine() -> ModuleType:
    """The compiled loops, loaded when soil moves."""
    from backhoe.simulation.soil import engine

    return engine
