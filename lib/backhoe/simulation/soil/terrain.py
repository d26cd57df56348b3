"""Ground that keeps its volume: a heightmap that slumps to its angle of repose.

Heights stand on a regular grid in the world frame (x forward, y left, z up): `heights[i, j]` is the
soil's surface at x = origin_x + j cell, y = origin_y + i cell, and fills a column of cell^2.
"""

from __future__ import annotations

from math import isfinite, pi, tan
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array

SETTLING_SWEEPS = 20_000


class Terrain:
    """Soil on a grid, with an optional rigid floor below which nothing is dug.

    Args:
        heights: surface, shape (ny, nx), at least 2 by 2 [m]; copied.
        cell: spacing of the grid [m].
        origin: (x, y) of heights[0, 0] in the world [m].
        floor: rigid ground under the soil, same shape as heights [m]; None for soil without end.

    Attributes:
        heights: change them through the methods, or call `touch` afterwards.
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
        self.heights = _surface("heights", heights)
        if isinstance(cell, bool) or not isinstance(cell, Real) or not 0 < cell < np.inf:
            raise ValueError(f"cell must be a positive length in m, got {cell!r}")
        self.cell = float(cell)
        corner = real_array(origin, "origin must be two numbers (x, y)")
        if corner.shape != (2,) or not np.isfinite(corner).all():
            raise ValueError(f"origin must be a finite (x, y), got {origin!r}")
        self.origin = (float(corner[0]), float(corner[1]))
        self.has_floor = floor is not None
        if floor is None:
            self.floor = np.full_like(self.heights, -np.inf)
        else:
            self.floor = _surface("floor", floor)
            if self.floor.shape != self.heights.shape:
                raise ValueError(
                    f"floor must have the shape of heights {self.heights.shape}, "
                    f"got {self.floor.shape}"
                )
            if (self.heights < self.floor).any():
                raise ValueError("heights must not lie below the floor")
        self.version = 0
        self.ceiling = np.full_like(self.heights, np.inf)
        self.box = np.array([0, self.heights.shape[0], 0, self.heights.shape[1]])
        self._top = (-1, 0.0)

    @classmethod
    def flat(cls, x: tuple[float, float], y: tuple[float, float], cell: float) -> Terrain:
        """Level ground at z = 0 over at least x[0] to x[1] by y[0] to y[1] [m]."""
        if not (cell > 0 and x[0] < x[1] and y[0] < y[1]):
            raise ValueError(f"flat needs rising ranges and a positive cell, got {x}, {y}, {cell}")
        rows, columns = (int(np.ceil((end - start) / cell)) + 1 for start, end in (y, x))
        return cls(np.zeros((rows, columns)), cell, (x[0], y[0]))

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
        if not (min(length, width, cell) > 0 and floor < wall):
            raise ValueError(
                "a bed needs positive length, width and cell and its wall above its floor, "
                f"got {length}, {width}, {cell}, floor {floor}, wall {wall}"
            )
        rows, columns = (round(side / cell) for side in (width, length))
        if min(rows, columns) < 2:
            raise ValueError(f"a bed needs at least 2 cells a side, got {rows} by {columns}")
        surface = np.full((rows + 2, columns + 2), float(wall))
        surface[1:-1, 1:-1] = floor
        corner = (centre[0] - (columns + 1) / 2 * cell, centre[1] - (rows + 1) / 2 * cell)
        return cls(surface, cell, corner, floor=surface)

    def with_heap(self, x: float, y: float, height: float, radius: float) -> Terrain:
        """The same ground with a cone of `height` and `radius` [m] at (x, y) on top."""
        if not (height >= 0 and radius > 0):
            raise ValueError(f"a heap needs height >= 0 and radius > 0, got {height}, {radius}")
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
    def frame(self) -> tuple[float, float, float]:
        """Position of the first height and the spacing, (x, y, cell) [m]."""
        return (*self.origin, self.cell)

    @property
    def volume(self) -> float:
        """Soil above the floor, or above z = 0 where there is none [m^3]."""
        thickness = self.heights - self.floor if self.has_floor else self.heights
        return float(thickness.sum()) * self.cell**2

    @property
    def top(self) -> float:
        """Highest point [m]."""
        if self._top[0] != self.version:
            self._top = (self.version, float(self.heights.max()))
        return self._top[1]

    def contains(self, x: float, y: float) -> bool:
        """True where (x, y) [m] lies on the map."""
        rows, columns = self.heights.shape
        a, b = (x - self.origin[0]) / self.cell, (y - self.origin[1]) / self.cell
        return 0 <= a <= columns - 1 and 0 <= b <= rows - 1

    def height_at(self, points: ArrayLike) -> NDArray:
        """Height of the surface, bilinear between the cells.

        Args:
            points: world (x, y), shape (..., 2) [m].

        Returns:
            Heights, shape (...) [m].

        Raises:
            ValueError: last axis is not 2, or a point is off the map or not finite.
        """
        points = np.asarray(points, dtype=float)
        if points.ndim == 0 or points.shape[-1] != 2:
            raise ValueError(f"points must end in 2 (x, y), got shape {points.shape}")
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

    def deposit(self, x: float, y: float, volume: float, spread: float = 0.2) -> None:
        """Drop a volume in a mound of radius `spread` [m] around (x, y), cut off at the map's rim.

        Raises:
            ValueError: volume [m^3] is negative or not finite, spread is not positive, or (x, y)
                is off the map.
        """
        if not (isfinite(volume) and volume >= 0):
            raise ValueError(f"volume must be finite and not negative, got {volume!r} m^3")
        if not spread > 0:
            raise ValueError(f"spread must be positive, got {spread!r} m")
        if not self.contains(x, y):
            raise ValueError(f"deposit at ({x}, {y}) m is off the map")
        grid_x, grid_y = self.grid()
        apart = np.hypot(grid_x - x, grid_y - y)
        weight = np.maximum(1 - (apart / max(spread, 1.5 * self.cell)) ** 2, 0.0)
        self.heights += weight * (volume / (weight.sum() * self.cell**2))
        self.touch()

    def lay(
        self,
        start: tuple[float, float],
        end: tuple[float, float],
        volume: float,
        from_height: float = np.inf,
    ) -> float:
        """Lay a volume evenly along the line from `start` to `end`.

        Returns:
            The part that found no place: beside the map, or over soil above `from_height` [m^3].
        """
        if volume <= 0:
            return volume
        from backhoe.simulation.soil.kernels import lay

        missed = lay(self.heights, self.frame, self.box, start, end, from_height, volume)
        self.version += missed < volume
        return missed

    def overflow_onto(self, ground: Terrain) -> float:
        """Tip what lies on the outermost cells, the walls of a bed, onto the ground beside them.

        Returns:
            What fell beside the ground's map [m^3].
        """
        from backhoe.simulation.soil.kernels import overflow

        fell, missed = overflow(
            self.heights, self.floor, self.frame, self.box,
            ground.heights, ground.frame, ground.box,
        )  # fmt: skip
        self.version += fell > 0
        ground.version += fell > missed
        return missed

    def relax(self, repose: float, sweeps: int = SETTLING_SWEEPS) -> int:
        """Let slopes steeper than `repose` [rad] slide; returns how many sweeps found slides.

        Raises:
            ValueError: repose is not between 0 and 90 degrees.
        """
        if not 0 < repose < pi / 2:
            raise ValueError(f"repose must lie between 0 and pi/2 rad, got {repose!r}")
        if self.settled:
            return 0
        from backhoe.simulation.soil.kernels import relax

        limit = tan(repose) * self.cell
        used = relax(self.heights, self.floor, self.ceiling, self.box, limit, sweeps)
        self.version += used > 0
        return used

    @property
    def settled(self) -> bool:
        """True when no slope is left to look at."""
        first_row, end_row, first_column, end_column = self.box.tolist()
        return first_row >= end_row or first_column >= end_column

    def steepness(self) -> NDArray:
        """Length of the downhill gradient of each cell, shape (ny, nx) [1]: what slides."""
        h = self.heights
        drop = np.zeros((2, *h.shape))
        for axis in (0, 1):
            fall = np.diff(h, axis=axis)
            head = tuple(slice(None, -1) if a == axis else slice(None) for a in (0, 1))
            tail = tuple(slice(1, None) if a == axis else slice(None) for a in (0, 1))
            np.maximum(drop[axis][head], -fall, out=drop[axis][head])
            np.maximum(drop[axis][tail], fall, out=drop[axis][tail])
        return np.hypot(*drop) / self.cell

    def touch(self) -> None:
        """Say that heights were changed: the next `relax` looks at the whole map."""
        self.version += 1
        self.box[:] = 0, self.heights.shape[0], 0, self.heights.shape[1]

    def snapshot(self) -> dict[str, NDArray]:
        """A copy of what changes."""
        return {"heights": self.heights.copy(), "box": self.box.copy()}

    def restore(self, snapshot: dict[str, NDArray]) -> None:
        """Return to a snapshot of this terrain; counts as a change.

        Raises:
            ValueError: the snapshot is of a map of another shape.
        """
        if snapshot["heights"].shape != self.heights.shape:
            raise ValueError(
                f"snapshot is of a map {snapshot['heights'].shape}, "
                f"this one is {self.heights.shape}"
            )
        self.heights[:], self.box[:] = snapshot["heights"], snapshot["box"]
        self.version += 1


def _surface(name: str, values: ArrayLike) -> NDArray:
    surface = np.array(real_array(values, f"{name} must be numbers"), order="C")
    if surface.ndim != 2 or min(surface.shape) < 2:
        raise ValueError(f"{name} must be (ny, nx) with at least 2 by 2 cells, got {surface.shape}")
    if not np.isfinite(surface).all():
        raise ValueError(f"{name} must be finite")
    return surface
