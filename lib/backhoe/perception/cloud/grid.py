"""A voxel grid: one point instead of many."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive

WIDEST = 1 << 21
"""Voxels along an axis that an index is kept for."""

FEW = 1 << 13
"""Voxels that there is room for at first."""


def voxel_grid(points: ArrayLike, leaf: float) -> NDArray:
    """The centroid of the points in each voxel that has some.

    Voxels begin at the multiples of the leaf: floor(points / leaf) are their indices.
    Source: Mastalli 2013, section 5.3.2; PCL's `VoxelGrid`.

    Args:
        points: shape (n, 3) [m].
        leaf: edge of a voxel [m].

    Returns:
        Centroids in the order in which voxels appear, shape (M, 3) [m].

    Raises:
        ValueError: no points, values that are not finite, a leaf that is not above 0, or one so
            small that the cloud is 2 million voxels wide or more.
    """
    points = numbers(points, "points", ("n", 3), meaning="coordinates [m]", finite=False)
    leaf = positive(leaf, "leaf", "m")
    from backhoe.perception.cloud import engine

    points, ends = np.ascontiguousarray(points), np.empty((2, 3))
    if not engine.extent(points, ends):
        numbers(points, "points")
    with np.errstate(over="ignore"):
        low, high = np.floor(ends / leaf)
    if not ((high - low < WIDEST) & (np.abs(low) < 1 << 50) & (np.abs(high) < 1 << 50)).all():
        wide, far = np.ptp(ends, axis=0).max(), np.abs(ends).max()
        raise ValueError(
            f"leaf must be above {wide / WIDEST:.3g} m for a cloud that is {wide:.3g} m wide and "
            f"{far:.3g} m from its origin, got {leaf}"
        )
    room, size = FEW, len(points)
    while True:
        room = min(room, size)
        slots = np.full(2 << (room - 1).bit_length(), -1, np.int32)
        voxels = np.zeros((room, 8))
        done, filled = engine.gather(points, leaf, slots, voxels, 0, 0)
        if done == size:
            return voxels[:filled, 3:6] / voxels[:filled, 6:7]
        room = max(8 * room, int(1.5 * filled * size / max(done, 1)))
