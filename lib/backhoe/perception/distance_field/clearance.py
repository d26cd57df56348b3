"""How near the posed machine is to what stands around: spheres over its links, in the field."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import instance, number, numbers, pose, positive, short
from backhoe.perception.distance_field.field import DistanceField

MOST = 1 << 20
"""Triangles that a mesh may be cut into."""


class Clearance(NamedTuple):
    """The place where the machine is nearest to an obstacle.

    Attributes:
        distance: from its surface to the middle of the nearest occupied voxel [m]; below 0 where
            they overlap.
        link: which link that is.
        point: middle of the nearest sphere, in the field's frame, shape (3,) [m].
        away: the way out, gradient of the distance, shape (3,) [1].
    """

    distance: float
    link: str
    point: NDArray
    away: NDArray


def covering_spheres(vertices: ArrayLike, faces: ArrayLike, size: float) -> NDArray:
    """Spheres whose union covers every triangle of a mesh.

    Triangles are halved until none is longer than `size`, and those whose middles share a cube of
    that edge get one sphere. For what is outside of a closed mesh its surface is all that counts.

    Args:
        vertices: shape (n, 3) [m].
        faces: three vertices a triangle, shape (m, 3), indices [1].
        size: edge of the cubes [m]; no sphere's radius is above 2.1 times it.

    Returns:
        Middles and radii, shape (k, 4) [m].

    Raises:
        ValueError: shapes, an index out of range, a size that is not above 0, or so small that
            there would be a million triangles.
    """
    vertices = numbers(vertices, "vertices", ("n", 3), meaning="corners x, y, z [m]")
    index = numbers(faces, "faces", ("m", 3), meaning="three vertices a triangle")
    if (index != np.floor(index)).any() or index.min() < 0 or index.max() >= len(vertices):
        raise ValueError(f"faces must be indices from 0 to {len(vertices) - 1}")
    size = positive(size, "size", "m")
    corners = vertices[index.astype(int)]
    while True:
        lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=-1)
        long = lengths.max(axis=1) > size
        if not long.any():
            break
        if len(corners) > MOST:
            raise ValueError(f"size must be larger: {size} m cuts the mesh into too many triangles")
        mine, at = corners[long], lengths[long].argmax(axis=1)
        mine = np.take_along_axis(mine, (at[:, None, None] + np.arange(3)[:, None]) % 3, axis=1)
        a, b, c = np.moveaxis(mine, 1, 0)
        half = (a + b) / 2
        corners = np.concatenate(
            [corners[~long], np.stack([a, half, c], 1), np.stack([half, b, c], 1)]
        )
    _, which = np.unique(np.floor(corners.mean(axis=1) / size), axis=0, return_inverse=True)
    order = np.argsort(which, kind="stable")
    corners, first = corners[order], np.flatnonzero(np.diff(which[order], prepend=-1))
    low = np.minimum.reduceat(corners.min(axis=1), first)
    high = np.maximum.reduceat(corners.max(axis=1), first)
    middles = (low + high) / 2
    away = corners - np.repeat(middles, np.diff(first, append=len(corners)), axis=0)[:, None]
    radii = np.maximum.reduceat(np.linalg.norm(away, axis=-1).max(axis=1), first)
    return np.column_stack([middles, radii])


def clearance(
    field: DistanceField,
    spheres: Mapping[str, ArrayLike],
    poses: Mapping[str, ArrayLike],
    beyond: float | None = None,
) -> Clearance:
    """Least distance of the posed links to what is occupied, and where.

    The true gap between the links' surface and the occupied voxels is larger than `distance` less
    sqrt(3) cells: half from voxels that reach beyond their middles, half from the interpolation.

    Args:
        field: distances.
        spheres: of each link, in its frame, shape (k, 4) [m].
        poses: of these links in the field's frame, shape (4, 4) [1, m].
        beyond: as for `DistanceField.query`: distance said of spheres outside of the grid [m].

    Raises:
        ValueError: shapes, a link without a pose, no spheres, a sphere outside and no `beyond`.
        TypeError: field is none, or spheres or poses are no mapping.
    """
    field = instance(field, "field", DistanceField)
    instance(spheres, "spheres", Mapping), instance(poses, "poses", Mapping)
    found = []
    for link, given in spheres.items():
        if link not in poses:
            raise ValueError(f"poses must have the link {link!r}, got {short(list(poses))}")
        balls = numbers(given, f"spheres of {link}", ("k", 4), meaning="middle and radius [m]")
        number(balls[:, 3].min(), f"least radius of {link}", "m", least=0.0)
        T = pose(numbers(poses[link], f"the pose of {link}", (4, 4)), f"the pose of {link}")
        middles = balls[:, :3] @ T[:3, :3].T + T[:3, 3]
        distances, gradients = field.query(middles, beyond)
        k = int(np.argmin(distances - balls[:, 3]))
        gap = float(distances[k] - balls[k, 3])
        found.append(Clearance(gap, link, middles[k], gradients[k]))
    if not found:
        raise ValueError("spheres must have a link with spheres, got none")
    return min(found, key=lambda one: one.distance)
