"""The self filter: points that the sensors see on the machine itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import instance, instances, not_negative, numbers, pose
from backhoe.perception.cloud.filters import FARTHEST

PADDING = 0.05
"""What the source adds to the links' surface [m]."""


class Convex(NamedTuple):
    """A convex volume in its link's frame.

    Attributes:
        planes: outward unit normals and offsets, `n . p + d <= 0` inside, shape (k, 4) [1, m].
        middle: of a sphere about it, shape (3,) [m].
        radius: of that [m].
    """

    planes: NDArray
    middle: NDArray
    radius: float


def hull(vertices: ArrayLike) -> Convex:
    """The convex hull of points, (n, 3) [m].

    Raises:
        ValueError: not finite, another shape, or points that lie in a plane.
    """
    from scipy.spatial import ConvexHull, QhullError

    vertices = numbers(vertices, "vertices", ("n", 3), meaning="coordinates [m]", within=FARTHEST)
    try:
        planes = np.unique(ConvexHull(vertices).equations.round(12), axis=0)
    except (QhullError, ValueError) as error:
        raise ValueError("vertices must be four or more that do not lie in a plane") from error
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    return Convex(planes, middle, float(np.linalg.norm(vertices - middle, axis=1).max()))


def box(low: ArrayLike, high: ArrayLike) -> Convex:
    """A box between two corners, each (3,) [m].

    Raises:
        ValueError: not finite, another shape, or a low corner that is not below the high one.
    """
    named = zip(("low", "high"), (low, high), strict=True)
    ends = np.array([numbers(end, name, (3,), within=FARTHEST) for name, end in named])
    if (ends[0] >= ends[1]).any():
        raise ValueError(f"low must be below high along every axis, got {ends[0]} and {ends[1]}")
    return hull([[ends[i, 0], ends[j, 1], ends[k, 2]] for i, j, k in np.ndindex(2, 2, 2)])


def self_filter(
    points: ArrayLike,
    volumes: Mapping[str, Sequence[Convex]],
    poses: Mapping[str, ArrayLike],
    padding: float = PADDING,
) -> NDArray:
    """Which points are on none of the machine's links.

    Source: Mastalli 2013, section 5.3.3.

    Args:
        points: shape (n, 3) [m].
        volumes: the convex parts of each link that the sensors see, in the link's frame.
        poses: `T` of each of these links, seen from the points' frame, shape (4, 4) [1, m].
        padding: how far each face of a part is moved outwards [m].

    Returns:
        True for a point to keep, shape (n,).

    Raises:
        ValueError: points, poses or padding that are not finite or of another shape, a link
            without a pose, a pose that turns and moves no rigid body.
        TypeError: a part that is no `Convex`.
    """
    points = np.ascontiguousarray(numbers(points, "points", ("n", 3), meaning="coordinates [m]"))
    padding = not_negative(padding, "padding", "m")
    planes, first, middles, radii = [np.empty((0, 4))], [0], [], []
    instance(volumes, "volumes", Mapping)
    instance(poses, "poses", Mapping)
    for link, parts in volumes.items():
        if link not in poses:
            listed = ", ".join(map(str, poses)) or "none"
            raise ValueError(f"poses must have the link {link!r}, got {listed}")
        T = pose(numbers(poses[link], f"the pose of {link}", (4, 4)), f"the pose of {link}")
        R = T[:3, :3]
        for part in instances(parts, f"volumes of {link}", Convex, "make one by box or hull"):
            normals = part.planes[:, :3] @ R.T
            planes.append(np.c_[normals, part.planes[:, 3] - normals @ T[:3, 3]])
            first.append(first[-1] + len(normals))
            middles.append(R @ part.middle + T[:3, 3])
            radii.append(part.radius)
    keep = np.ones(len(points), bool)
    if radii:
        from backhoe.perception.cloud import engine

        spheres = np.array(middles), np.array(radii) + 3 * padding
        engine.outside(points, np.vstack(planes), np.array(first), *spheres, padding, keep)
    return keep
