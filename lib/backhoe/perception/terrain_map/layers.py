"""Two layers from one cloud: what is soil, and what stands on it or hangs over it."""

from __future__ import annotations

from math import pi, tan

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative, number, numbers, positive

WIDEST = 1 << 26
"""Cells that a cloud may spread over: half a GiB."""


def is_soil(
    points: ArrayLike,
    steepest: float = pi / 5,
    tolerance: float = 0.15,
    cell: float = 0.1,
) -> NDArray:
    """Which points are ground: those near the highest surface under the cloud that soil can form.

    Soil does not stand steeper than its angle of repose for long. So nowhere can ground be higher
    than the lowest point of any other cell plus the way there times tan(steepest). What is higher
    stands on the ground or hangs over it: a truck, its bed, the arm. Heaps are ground; no plane is
    fitted. What is lower than the tolerance, a stone or the foot of a wheel, passes for soil.

    Args:
        points: without those on the machine itself, shape (n, 3) [m].
        steepest: slope that soil can have [rad]; a little above its angle of repose.
        tolerance: above that surface [m]; for noise, stones and steps in a fresh cut.
        cell: within which the lowest point counts [m].

    Returns:
        True for ground, shape (n,) [1].

    Raises:
        ValueError: no points, not finite, a slope that is not between 0 and 90 degrees, a negative
            tolerance, a cell not above 0, or one too small for so wide a cloud.
    """
    points = numbers(points, "points", ("n", 3), meaning="coordinates [m]")
    steepest = number(steepest, "steepest", "rad", above=0.0, below=pi / 2)
    tolerance, cell = not_negative(tolerance, "tolerance", "m"), positive(cell, "cell", "m")
    low = points[:, :2].min(axis=0)
    with np.errstate(over="ignore"):
        columns, rows = np.floor((points[:, :2].max(axis=0) - low) / cell) + 1
        if not rows * columns <= WIDEST:
            raise ValueError(f"cell must be larger for a cloud of {rows:g} by {columns:g} cells")
    j, i = np.floor((points[:, :2] - low) / cell).astype(int).T
    surface = np.full((int(rows), int(columns)), np.inf)
    np.minimum.at(surface, (i, j), points[:, 2])
    from backhoe.perception.terrain_map import engine

    engine.envelope(surface, tan(steepest) * cell)
    return points[:, 2] <= surface[i, j] + tolerance
