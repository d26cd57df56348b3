"""What a survey is held to: the true surface of ground, truck and load, the heap's true height."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from backhoe.mission.worksite import Look
from backhoe.perception.laser import deskew
from backhoe.simulation.scene import LOADING
from backhoe.simulation.soil import Terrain
from backhoe.view.appearance import truck_visuals

BOX = np.array([[-2.4, -3.6, -1.2], [9.2, 7.4, 4.4]])
"""The part of the world in which the map is judged, lowest and highest corner [m]."""

RANGE = 12.0
"""How far a scan marks the map [m]."""

CELL, RIM = 0.2, 0.4
"""Cells of the heap's heights, and its outermost part, which does not count [m]."""

DARK = 0.4
"""Depth under the ground from where on nothing can be known [m]."""


class Truth(NamedTuple):
    """Voxels of `BOX`, shape (x, y, z) each.

    Attributes:
        ground, truck: those with a part of the ground's surface, or of the truck's and its load's,
            and their neighbours.
        hit: those in which beams truly end within `RANGE`, but for those on the machine.
    """

    ground: NDArray
    truck: NDArray
    hit: NDArray


def voxels(resolution: float) -> NDArray:
    """Middles of the voxels in `BOX`, shape (x, y, z, 3) [m], for their edge [m]."""
    first, last = np.round(BOX / resolution).astype(int)
    axes = [(np.arange(a, b) + 0.5) * resolution for a, b in zip(first, last, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)


@lru_cache(maxsize=32)
def truth_of(look: Look, resolution: float) -> Truth:
    """What was true at a look, for a voxel's edge [m]; shapes as in `Truth`."""
    from scipy.ndimage import binary_dilation

    x, y = np.meshgrid(*(np.arange(a, b, 0.04) for a, b in BOX[:, :2].T))
    ground = np.stack([x, y, terrain_of(look).height_at(np.stack([x, y], -1))], -1).reshape(-1, 3)
    truck, beams = [np.empty((0, 3))], []
    if look.truck:
        x, y = look.bed_grid
        truck = [_truck_points(), np.stack([x, y, look.bed], -1)[1:-1, 1:-1].reshape(-1, 3)]
    for scan in look.scans.values():
        there = (scan.truth < RANGE) & ~np.isin(scan.surface, look.own)
        beams.append(deskew(scan.laser, scan.time, scan.truth, look.motion)[there])
    near = np.ones((3, 3, 3))
    full = (_having(np.concatenate(p), resolution) for p in ([ground], truck, beams))
    ground, truck, hit = full
    return Truth(binary_dilation(ground, near), binary_dilation(truck, near), hit)


def in_the_dark(looks: tuple[Look, ...], resolution: float) -> NDArray:
    """Voxels that lie deep in the ground during all looks, (x, y, z) [1]."""
    lowest = np.min([look.terrain for look in looks], axis=0)
    middles = voxels(resolution)
    ground = Terrain(lowest, LOADING.cell, LOADING.corner).height_at(middles[..., :2])
    return middles[..., 2] < ground - DARK


def heap_heights(points: NDArray, look: Look) -> tuple[NDArray, NDArray]:
    """Mean height of points (n, 3) [m] in each cell of the heap, and their mean error, (m,) [m].

    NaN for a cell without a point.
    """
    heap = LOADING.heaps[0]
    reach = heap.radius - RIM
    side = round(2 * reach / CELL)
    middle = (np.arange(side) + 0.5) * CELL - reach
    cells = np.hypot(*np.meshgrid(middle, middle, indexing="ij")).ravel() < reach
    place = points[:, :2] - (heap.x, heap.y)
    inside = (np.abs(place) < reach).all(axis=1)
    index = np.floor((place[inside] + reach) / CELL).astype(int).clip(0, side - 1) @ (side, 1)
    z = points[inside, 2]
    errors = z - terrain_of(look).height_at(points[inside, :2])
    count = np.bincount(index, minlength=side**2).astype(float)
    count[count == 0] = np.nan
    return tuple((np.bincount(index, of, side**2) / count)[cells] for of in (z, errors))


def terrain_of(look: Look) -> Terrain:
    """The true ground at a look."""
    return Terrain(look.terrain, LOADING.cell, LOADING.corner)


def _having(points: NDArray, resolution: float) -> NDArray:
    shape = voxels(resolution).shape[:3]
    index = np.floor(points / resolution + 1e-9).astype(int)
    index -= np.round(BOX[0] / resolution).astype(int)
    index = index[((index >= 0) & (index < shape)).all(axis=1)]
    full = np.zeros(shape, bool)
    full[tuple(index.T)] = True
    return full


@lru_cache(maxsize=1)
def _truck_points(spacing: float = 0.05) -> NDArray:
    """Points all over the truck's surface, shape (n, 3) [m]."""
    points = []
    for part in truck_visuals(LOADING.truck):
        for a, b, c in part.vertices[part.faces]:
            n = int(np.ceil(max(np.linalg.norm(b - a), np.linalg.norm(c - a)) / spacing)) + 1
            u, v = (share.ravel() for share in np.meshgrid(*[np.linspace(0, 1, n)] * 2))
            u, v = u[u + v < 1 + 1e-9, None], v[u + v < 1 + 1e-9, None]
            points.append(a + u * (b - a) + v * (c - a))
    return np.concatenate(points)
