"""Soil dug between two scans, with a standard deviation that can be believed.

Heights of a map err in three ways, and a sum over many cells treats them differently:

- each cell's own noise: half of it is above, half below, and the sum grows with the root of cells;
- what a scan has in common, an error of the sensor's pose or range: it grows with the area;
- cells that no ray reached: filled in by a membrane over the gap, all of it wrong together.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import alike, covariance, instance, numbers, truths
from backhoe.perception.terrain_map.heights import TerrainMap

COMMON = 7
"""Errors that all points of a scan share: x, y, z [m], turns about x, y, z [rad], range [m]."""


HIDDEN = 0.1
"""Share of cells without a point above which no deviation would be honest [1]."""

FARTHEST = 1e5
"""Of a sensor from the map's origin [m]; no variance of a common error is larger."""

AROUND = 3
"""Cells on each side to which a plane is fitted for a slope."""


class Volume(NamedTuple):
    """Volume dug, positive where soil went [m^3], and its standard deviations [m^3].

    Attributes:
        value: the volume.
        deviation: of the value, all together.
        cells, gaps, common: the three parts, whose squares add up to the square of that.
    """

    value: float
    deviation: float
    cells: float
    gaps: float
    common: float


def dug_volume(
    before: TerrainMap,
    after: TerrainMap,
    inside: ArrayLike,
    origins: ArrayLike,
    common: ArrayLike,
    still: ArrayLike | None = None,
) -> Volume:
    """Soil that went between two scans of the same ground.

    Args:
        before, after: maps of the same cells, one scan each.
        inside: which cells count, shape (rows, columns), truth values.
        origins: where the sensor stood, before and after, shape (2, 3) [m].
        common: covariance of each scan's common errors, those of `COMMON`, shape (7, 7)
            [m^2, m rad, rad^2]; the two scans err independently.
        still: cells that surely have not changed, shape (rows, columns), truth values: what seems
            to have moved there is used to correct the common errors. None for no such cells.

    Returns:
        The volume with its standard deviations.

    Raises:
        ValueError: maps of different cells, masks of another shape or type, no cell inside, a cell
            that is inside and still, a gap with no seen cell around, or too much hidden: more than
            a tenth of the cells inside.
        TypeError: a map that is none.
    """
    for name, one in (("before", before), ("after", after)):
        instance(one, name, TerrainMap)
    alike(before=before.heights, after=after.heights)
    if (before.corner, before.cell) != (after.corner, after.cell):
        raise ValueError("before and after must be maps of the same corner and cell")
    inside = truths(inside, "inside", before.heights.shape)
    still = np.zeros_like(inside) if still is None else truths(still, "still", before.heights.shape)
    if not inside.any() or (inside & still).any():
        raise ValueError("inside must have cells, none of which are still")
    origins = numbers(
        origins, "origins", (2, 3), meaning="where the sensor stood [m]", within=FARTHEST
    )
    common = numbers(common, "common", (COMMON, COMMON), within=FARTHEST)
    C = np.kron(np.eye(2), covariance(common, "common", COMMON))

    area, value, cells, gaps = before.cell**2, 0.0, 0.0, 0.0
    filled, shares = [], []
    for sign, one in ((1.0, before), (-1.0, after)):
        heights, weights, gap = _membrane(one, inside)
        value += sign * area * heights[inside].sum()
        known = weights > 0
        cells += area**2 * np.sum(weights[known] ** 2 * one.variance[known])
        gaps += area**2 * gap
        filled.append(heights)
        shares.append(weights)
    influence = [
        sign * shared_errors(z, before, origin)
        for sign, z, origin in zip((1.0, -1.0), filled, origins, strict=True)
    ]
    g = area * np.concatenate(
        [np.einsum("ij,ijk->k", weights, J) for weights, J in zip(shares, influence, strict=True)]
    )
    seen = still & ~np.isnan(before.heights) & ~np.isnan(after.heights)
    if seen.any():
        H = np.concatenate([J[seen] for J in influence], axis=1)
        weighed = H.T / np.maximum((before.variance + after.variance)[seen], 1e-12)
        C = np.linalg.solve(np.eye(2 * COMMON) + C @ weighed @ H, C)
        value -= g @ C @ weighed @ (before.heights - after.heights)[seen]
    shared = max(float(g @ C @ g), 0.0)
    total = cells + gaps + shared
    return Volume(float(value), *(float(part**0.5) for part in (total, cells, gaps, shared)))


def shared_errors(heights: ArrayLike, ground: TerrainMap, origin: ArrayLike) -> NDArray:
    """By how much each cell's height errs for the seven errors that a scan has in common.

    A pose that errs by d and turns by w moves a point p by d + w x (p - o), a range too long by b
    moves it by b u. Off the surface, upwards, it gets by the part of that along (-s_x, -s_y, 1).

    Args:
        heights: without gaps where it matters, shape (rows, columns) [m].
        ground: the map whose cells they are.
        origin: of the rays, o, shape (3,) [m].

    Returns:
        Shape (rows, columns, 7) [m/m, m/rad, m/m]; 0 where a height or its slope is unknown.

    Raises:
        ValueError: shapes, an origin that is not finite.
    """
    instance(ground, "ground", TerrainMap)
    heights = numbers(heights, "heights", ground.heights.shape, finite=False)
    origin = numbers(origin, "origin", (3,), meaning="a point [m]", within=FARTHEST)
    up = np.concatenate([-_slopes(heights, ground.cell), np.ones((*heights.shape, 1))], axis=-1)
    way = np.stack([*ground.grid(), heights], axis=-1) - origin
    ahead = np.sum(up * way, axis=-1) / np.linalg.norm(way, axis=-1)
    return np.nan_to_num(np.concatenate([up, np.cross(way, up), ahead[..., None]], axis=-1))


def _slopes(heights: NDArray, cell: float) -> NDArray:
    """Along x and y, shape (rows, columns, 2) [1]: of planes fitted to the cells around.

    A slope between two noisy neighbours would be too steep at random, and would make an error of
    the pose look smaller than it is.
    """
    from scipy import ndimage

    i, j = np.mgrid[-AROUND : AROUND + 1, -AROUND : AROUND + 1].astype(float)
    known = ~np.isnan(heights)

    def total(kernel: NDArray, values: NDArray) -> NDArray:
        return ndimage.correlate(values, kernel, mode="constant")

    z, there = np.where(known, heights, 0.0), known.astype(float)
    basis = np.ones_like(i), j, i
    A = np.stack([np.stack([total(a * b, there) for a in basis], -1) for b in basis], -2)
    right = np.stack([total(b, z) for b in basis], -1)
    planes = np.linalg.solve(A + 1e-9 * np.eye(3), right[..., None])[..., 1:, 0] / cell
    return np.where(known[..., None], planes, np.nan)


def _membrane(ground: TerrainMap, inside: NDArray) -> tuple[NDArray, NDArray, float]:
    """Heights with the gaps inside filled, weights of seen cells in their sum, variance of gaps.

    A gap is filled so that each of its cells is the mean of its four neighbours. Where neighbours
    differ from that mean by a standard deviation d / 2, as the seen cells tell, the sum of a gap
    errs by d^2 1^T L^-1 1, with L the gap's Laplacian: a Gaussian Markov field.
    """
    from scipy import ndimage, sparse
    from scipy.sparse.linalg import spsolve

    heights, known = ground.heights.copy(), ~np.isnan(ground.heights)
    weights, gap = (inside & known).astype(float), inside & ~known
    if not gap.any():
        return heights, weights, 0.0
    hidden = gap.sum() / inside.sum()
    if hidden > HIDDEN:
        raise ValueError(
            f"inside must be seen but for {HIDDEN:.0%} of its cells, {hidden:.0%} are hidden: "
            "look from elsewhere, or ask for a smaller place"
        )
    edge = ndimage.binary_dilation(known)
    labels, parts = ndimage.label(gap)
    if set(range(1, parts + 1)) - set(np.unique(labels[edge & gap])):
        raise ValueError("inside has a gap with no seen cell around it: look from elsewhere")
    place = np.full(gap.shape, -1)
    place[gap] = np.arange(gap.sum())
    flat, n = np.arange(gap.size).reshape(gap.shape), int(gap.sum())
    L, border = sparse.lil_matrix((n, n)), sparse.lil_matrix((n, gap.size))
    diagonal = np.zeros(n)
    for mine, theirs in _neighbours():
        pair = gap[mine] & (known | gap)[theirs]
        a, b, beside = place[mine][pair], place[theirs][pair], flat[theirs][pair]
        diagonal[a] += 1.0
        L[a[b >= 0], b[b >= 0]] = -1.0
        border[a[b < 0], beside[b < 0]] = 1.0
    L.setdiag(diagonal)
    border = border.tocsr()
    pull = border @ np.nan_to_num(heights).ravel()
    filled, share = spsolve(L.tocsc(), np.stack([pull, np.ones(n)], axis=1)).reshape(n, 2).T
    weights += (border.T @ share).reshape(gap.shape)
    heights[gap] = filled
    return heights, weights, _stiffness(ground.heights, inside) * float(share.sum())


def _stiffness(heights: NDArray, inside: NDArray) -> float:
    """d^2: twice the mean square of the steps between neighbours inside; slopes count as chance."""
    z = np.where(inside, heights, np.nan)
    steps = np.concatenate([np.diff(z, axis=axis).ravel() for axis in (0, 1)])
    known = steps[~np.isnan(steps)]
    return 2.0 * float(np.mean(known**2)) if known.size else np.inf


def _neighbours() -> list[tuple[tuple, tuple]]:
    """Slices of the cells that have a neighbour on a side, and of these neighbours."""
    head, tail, all_ = slice(0, -1), slice(1, None), slice(None)
    pairs = [((head, all_), (tail, all_)), ((all_, head), (all_, tail))]
    return pairs + [(theirs, mine) for mine, theirs in pairs]
