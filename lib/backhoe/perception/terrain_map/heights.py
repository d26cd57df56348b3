"""Heights of the ground with their variances, cell by cell, that keep up with digging."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative, number, numbers, positive, real_numbers, whole

GATE = 4.0
"""Standard deviations beyond which a cell has been dug or filled [1]."""

ROUGHNESS = 0.01
"""How far points of a cell lie off its plane, standard deviation [m]."""

MOST = 1e3
"""Largest standard deviation of a scan [m]."""

LARGEST = 1 << 26
"""Cells that a map may have: 2 GiB."""


class TerrainMap:
    """Ground as one height a cell, each with its variance and age.

    Cell (i, j) reaches half a cell around x = corner_x + j cell, y = corner_y + i cell, as in
    `simulation.Scene`: give its corner, rows, columns and cell, and heights lie beside the truth.

    Args:
        corner: x, y of the first height, shape (2,) [m].
        rows, columns: along y and x.
        cell: side [m].
        growth: how fast a height becomes uncertain when nobody looks [m^2/s].
        roughness: standard deviation of points about their cell's plane [m].
        gate: standard deviations beyond which a cell starts anew instead of being averaged [1].

    Attributes:
        heights: shape (rows, columns) [m]; NaN where nothing has been seen.
        variance: of the heights, without what a whole scan has in common [m^2]; NaN likewise.
        seen: time of the last point, shape (rows, columns) [s]; NaN likewise.
        changed: time since which a height stands there: its first point, or when it was dug or
            filled [s]; NaN likewise.

    Raises:
        ValueError: not finite, a size, cell or gate that is not above 0, or 6e7 cells or more.
    """

    def __init__(
        self,
        corner: ArrayLike,
        rows: int,
        columns: int,
        cell: float,
        *,
        growth: float = 0.0,
        roughness: float = ROUGHNESS,
        gate: float = GATE,
    ) -> None:
        self.corner = tuple(numbers(corner, "corner", (2,), meaning="x, y [m]").tolist())
        rows, columns = whole(rows, "rows", least=1), whole(columns, "columns", least=1)
        whole(rows * columns, "rows times columns", most=LARGEST)
        self.cell = positive(cell, "cell", "m")
        self.growth = not_negative(growth, "growth", "m^2/s")
        self.roughness = not_negative(roughness, "roughness", "m")
        self.gate = positive(gate, "gate")
        unknown = np.full((4, rows, columns), np.nan)
        self.heights, self.variance, self.seen, self.changed = unknown

    @property
    def memory(self) -> int:
        """What its cells take [bytes]."""
        return 4 * self.heights.nbytes

    def grid(self) -> tuple[NDArray, NDArray]:
        """x and y of every height, each of shape (rows, columns) [m]."""
        rows, columns = self.heights.shape
        x, y = (
            start + self.cell * np.arange(count)
            for start, count in zip(self.corner, (columns, rows), strict=True)
        )
        return tuple(np.meshgrid(x, y))

    def insert(
        self,
        points: ArrayLike,
        origin: ArrayLike,
        time: float = 0.0,
        *,
        range_deviation: float = 0.02,
        common_deviation: float = 0.0,
    ) -> int:
        """Add the points of a scan, all of them ground; those beside the map are left out.

        A cell's measurement is the mean height of its points, brought to the cell's middle along
        the slope. Noise of the range lifts a point off its surface by u_z - s u_xy of it, with u
        the ray's direction and s the slope: little where the ray grazes.

        Args:
            points: shape (n, 3) [m]; none are allowed.
            origin: of the rays, shape (3,) [m].
            time: of the scan [s].
            range_deviation: of each range, standard deviation [m].
            common_deviation: of what lifts the whole scan, such as an error of the sensor's pose
                [m]; it widens the gate, and is not averaged away.

        Returns:
            How many cells had been dug or filled.

        Raises:
            ValueError: another shape, not finite, a deviation below 0 or above 1 km, a time
                before the last.
        """
        points = real_numbers(points, "points")
        if points.shape != (0, 3):
            numbers(points, "points", ("n", 3), meaning="coordinates [m]")
        origin = numbers(origin, "origin", (3,), meaning="a point [m]")
        last = np.nanmax(self.seen, initial=-np.inf)
        time = number(time, "time", "s", least=last)
        ranging = number(range_deviation, "range_deviation", "m", least=0.0, most=MOST) ** 2
        common = number(common_deviation, "common_deviation", "m", least=0.0, most=MOST) ** 2
        if not len(points):
            return 0
        from backhoe.perception.terrain_map import engine

        points = np.ascontiguousarray(points, dtype=float)
        place = *self.corner, self.cell
        rows, columns = self.heights.shape
        sums, gradient = np.zeros((rows, columns, 4)), np.zeros((rows, columns, 2))
        lifts = np.zeros((rows, columns))
        engine.gather(points, *place, sums)
        engine.slopes(self.heights, sums, self.cell, gradient)
        engine.lift(points, origin, *place, gradient, lifts)
        how = ranging, self.roughness**2, common, self.growth, self.gate
        cells = self.heights, self.variance, self.seen, self.changed
        return engine.update(*cells, sums, gradient, lifts, time, how)

    def age(self, now: float) -> NDArray:
        """Time since each cell was seen, shape (rows, columns) [s]; NaN where it never was."""
        return number(now, "now", "s") - self.seen
