"""A voxel grid: one point instead of many."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive

WIDEST = 1 << 21
"""Voxels along an axis that an index is kept for."""

FARTHEST = 1 << 50
"""Voxels from the origin to where coordinates still tell one from the next."""

BUCKET = 1 << 12
"""Points that are gathered together, so few that their voxels fit the processor's cache."""


def voxel_grid(points: ArrayLike, leaf: float) -> NDArray:
    """The centroid of the points in each voxel that has some.

    Voxels begin at the multiples of the leaf: floor(points / leaf) are their indices. Points are
    first dealt into buckets by their voxels, so that the cost of a point does not grow.
    Source: Mastalli 2013, section 5.3.2; PCL's `VoxelGrid`.

    Args:
        points: shape (n, 3) [m].
        leaf: edge of a voxel [m].

    Returns:
        Centroids, shape (M, 3) [m]; the same points in the same order give the same order, which
        otherwise means nothing.

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
    with np.errstate(over="ignore", invalid="ignore"):
        low, high = np.floor(ends / leaf)
        fits = (high - low < WIDEST) & (np.abs(low) < FARTHEST) & (np.abs(high) < FARTHEST)
    if not fits.all():
        wide, far = np.ptp(ends, axis=0).max(), np.abs(ends).max()
        raise ValueError(
            f"leaf must be above {wide / WIDEST:.3g} m for a cloud that is {wide:.3g} m wide and "
            f"{far:.3g} m from its origin, got {leaf}"
        )
    size, bits = len(points), max((len(points) // BUCKET).bit_length(), 1)
    keys, dealt_keys, dealt = (
        np.empty(size, np.int64),
        np.empty(size, np.int64),
        np.empty((size, 3)),
    )
    starts = np.zeros((1 << bits) + 1, np.int64)
    engine.count(points, leaf, low.astype(np.int64), keys, 32 - bits, starts)
    engine.deal(points, keys, 32 - bits, starts[:-1].copy(), dealt, dealt_keys)
    most = int(np.diff(starts).max())
    slots = np.full(1 << (2 * most - 1).bit_length(), -1, np.int32)
    sums, names, centroids = np.empty((most, 4)), np.empty(most, np.int64), np.empty((size, 3))
    filled = engine.gather(dealt, dealt_keys, starts, slots, sums, names, centroids)
    return centroids[:filled].copy()
