"""How far it is from anywhere to the nearest occupied voxel, and which way is out."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, flag, instance, number, numbers, positive, truths, whole
from backhoe.perception.octree import OccupancyOctree

LARGEST = 1 << 27
"""Voxels that a field may have: 1 GiB."""

REACH = 1 << 15
"""Voxels of an octree on each side of its origin."""


def distance_transform(occupied: ArrayLike, cell: float = 1.0, *, signed: bool = False) -> NDArray:
    """Distance from the middle of each voxel to that of the nearest occupied one, exactly.

    Source: Felzenszwalb and Huttenlocher 2012: along each axis the lower envelope of parabolas.

    Args:
        occupied: truth values, shape (a, b, c) or (a, b).
        cell: edge of a voxel [m].
        signed: whether occupied voxels get minus their distance to the nearest free one, not 0.

    Returns:
        The same shape [m]; inf where nothing is occupied, minus inf where all is.

    Raises:
        ValueError: no truth values, other shapes, no or too many voxels, a cell not above 0.
    """
    occupied, cell = _grid(occupied), positive(cell, "cell", "m")
    distance = _distance(occupied)
    if flag(signed, "signed"):
        distance -= _distance(~occupied)
    return cell * distance


class DistanceField:
    """Distances on a grid, to be asked for anywhere in it.

    Args:
        occupied: truth values, shape (nx, ny, nz), 2 or more each.
        cell: edge of a voxel [m].
        corner: middle of the first voxel, shape (3,) [m].
        signed: as for `distance_transform`.

    Attributes:
        distances: shape (nx, ny, nz) [m].

    Raises:
        ValueError: as `distance_transform`; fewer than two voxels along an axis.
    """

    def __init__(
        self, occupied: ArrayLike, cell: float, corner: ArrayLike, *, signed: bool = False
    ) -> None:
        self.corner = numbers(corner, "corner", (3,), meaning="x, y, z [m]")
        self.cell = positive(cell, "cell", "m")
        occupied = truths(occupied, "occupied", ("nx", "ny", "nz"))
        whole(min(occupied.shape), "voxels of occupied along each axis", least=2)
        self.distances = distance_transform(occupied, cell, signed=signed)

    @classmethod
    def of_octree(
        cls,
        tree: OccupancyOctree,
        box: ArrayLike,
        *,
        unknown: str = "free",
        signed: bool = False,
    ) -> DistanceField:
        """The field of an octree's occupied voxels within a box.

        Args:
            tree: the map.
            box: lowest and highest corner, shape (2, 3) [m]; what lies beyond is not seen.
            unknown: "free", or "occupied" for a planner that must not go where nobody has looked.
            signed: as for `distance_transform`.

        Raises:
            ValueError: a box outside the map, too small or with its corners the wrong way round.
            TypeError: tree is no octree.
        """
        tree = instance(tree, "tree", OccupancyOctree)
        low, high = numbers(box, "box", (2, 3), meaning="lowest and highest corner [m]")
        as_occupied = choice(unknown, "unknown", ("free", "occupied")) == "occupied"
        size = tree.resolution
        first, last = np.floor(low / size), np.floor(high / size)
        counts = last - first + 1
        if (counts < 2).any() or not counts.prod() <= LARGEST:
            raise ValueError(f"box must span 2 to {LARGEST} voxels of {size} m, got {box}")
        axes = [(f + np.arange(int(n)) + 0.5) * size for f, n in zip(first, counts, strict=True)]
        if max(-first.min(), last.max()) >= REACH:
            raise ValueError(
                f"box must lie within {REACH * size:.0f} m of the map's origin, got {box}"
            )
        odds = tree.log_odds(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1))
        occupied = (odds >= 0) | (np.isnan(odds) & as_occupied)
        return cls(occupied, size, (first + 0.5) * size, signed=signed)

    def query(self, points: ArrayLike, beyond: float | None = None) -> tuple[NDArray, NDArray]:
        """Distances and their gradients, trilinear between the middles of voxels.

        Args:
            points: shape (..., 3) [m].
            beyond: distance said of points outside of the grid [m], with gradient 0; None refuses
                such points.

        Returns:
            Distances, shape (...) [m], and gradients, shape (..., 3) [1], which point away from the
            nearest obstacle; where nothing is occupied, inf and 0.

        Raises:
            ValueError: another shape, not finite, or a point outside and no `beyond`.
        """
        points = numbers(points, "points", (..., 3), meaning="coordinates [m]")
        last = np.array(self.distances.shape) - 1
        at = (points - self.corner) / self.cell
        inside = ((at >= -1e-9) & (at <= last + 1e-9)).all(axis=-1)
        if beyond is None and not inside.all():
            top = self.corner + last * self.cell
            raise ValueError(
                f"points must be between {self.corner} and {top} m, got "
                f"{points[~inside].reshape(-1, 3)[0]}: take a larger box, or give beyond"
            )
        at = np.clip(np.where(inside[..., None], at, 0.0), 0.0, last)
        corner = np.minimum(at.astype(int), last - 1)
        share = at - corner
        finite = np.isfinite(self.distances[0, 0, 0])  # if one is not, none is
        known = self.distances if finite else np.zeros_like(self.distances)
        distance, gradient = np.zeros(inside.shape), np.zeros((*inside.shape, 3))
        for step in np.ndindex(2, 2, 2):
            value = known[tuple(np.moveaxis(corner + step, -1, 0))]
            weights = np.where(np.array(step, bool), share, 1.0 - share)
            distance = distance + value * weights.prod(axis=-1)
            for axis in range(3):
                others = np.delete(weights, axis, axis=-1).prod(axis=-1)
                gradient[..., axis] += (2 * step[axis] - 1) * value * others / self.cell
        if not finite:
            distance = np.full_like(distance, self.distances[0, 0, 0])
        if beyond is not None:
            far = number(beyond, "beyond", "m", finite=False)
            distance = np.where(inside, distance, far)
            gradient = np.where(inside[..., None], gradient, 0.0)
        return distance, gradient


def _grid(occupied: ArrayLike) -> NDArray:
    grid = truths(occupied, "occupied", (..., "a", "b"))
    if grid.ndim > 3:
        truths(grid, "occupied", ("a", "b", "c"))
    whole(grid.size, "voxels of occupied", most=LARGEST)
    return grid


def _distance(occupied: NDArray) -> NDArray:
    """In voxels."""
    from backhoe.perception.distance_field import engine

    grid = np.where(occupied, 0.0, np.inf)
    engine.squared_distances(grid if grid.ndim == 3 else grid[None])
    return np.sqrt(grid)
