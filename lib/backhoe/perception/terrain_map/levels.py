"""Multi-level surface map: several surfaces above each other in a cell.

Source: Triebel, Pfaff and Burgard 2006; Mastalli 2013, section 5.4.1 and Fig. 5.11.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative, numbers, positive


class Levels(NamedTuple):
    """Surfaces, sorted by cell, from below upwards.

    Attributes:
        cells: column and row, floor(x / cell) and floor(y / cell), shape (n, 2).
        low, high: lowest and highest point of each, shape (n,) [m].
        count: its points, shape (n,) [1].
    """

    cells: NDArray
    low: NDArray
    high: NDArray
    count: NDArray

    @property
    def memory(self) -> int:
        """What they take [bytes]."""
        return sum(array.nbytes for array in self)


def surface_levels(points: ArrayLike, cell: float, gap: float = 0.3) -> Levels:
    """Points of a cell that follow each other within `gap` are one surface, thick or thin.

    Args:
        points: shape (n, 3) [m].
        cell: side, from multiples of it [m].
        gap: height without points that parts two surfaces [m]; the machine's or man's height.

    Raises:
        ValueError: no points, not finite, a cell not above 0 or too small, a negative gap.
    """
    points = numbers(points, "points", ("n", 3), meaning="coordinates [m]")
    cell, gap = positive(cell, "cell", "m"), not_negative(gap, "gap", "m")
    with np.errstate(over="ignore"):
        keys = np.floor(points[:, :2] / cell)
    if not (np.abs(keys) < 1 << 31).all():
        raise ValueError(f"cell must be larger for a cloud so wide, got {cell}")
    keys = keys.astype(np.int32)
    order = np.lexsort((points[:, 2], keys[:, 0], keys[:, 1]))
    keys, z = keys[order], points[order, 2]
    new = (np.diff(keys, axis=0) != 0).any(axis=1) | (np.diff(z) > gap)
    first = np.flatnonzero(np.r_[True, new])
    last = np.r_[first[1:], len(z)]
    return Levels(keys[first], z[first].astype("f4"), z[last - 1].astype("f4"), last - first)
