"""Closed triangle meshes for the pictures: prisms, beams, boxes, cylinders, grids.

Every function returns vertices (n, 3) [m] and faces (m, 3), counter-clockwise seen from outside.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Mesh = tuple[NDArray, NDArray]


def prism(outline: ArrayLike, near: float, far: float) -> Mesh:
    """Extrude `outline` (n, 2), seen whole from its mean point, along z from `near` to `far`."""
    outline = np.asarray(outline, dtype=float)
    n = len(outline)
    rim = np.vstack([outline, outline.mean(axis=0)])
    vertices = np.vstack([np.c_[rim, np.full(n + 1, z)] for z in (near, far)])
    first = np.arange(n)
    second = (first + 1) % n
    centre = np.full(n, n)
    top = n + 1
    faces = np.vstack(
        [
            np.c_[centre, second, first],
            np.c_[centre + top, first + top, second + top],
            np.c_[first, second, second + top],
            np.c_[first, second + top, first + top],
        ]
    )
    return _outward(vertices, faces)


def beam(one_side: ArrayLike, other_side: ArrayLike, near: ArrayLike, far: ArrayLike) -> Mesh:
    """A bent bar between two polylines (n, 2) of equal length, from z = `near` to `far`.

    `near` and `far` are scalars or one value for each of the n stations.
    """
    one_side, other_side = np.asarray(one_side, float), np.asarray(other_side, float)
    n = len(one_side)
    near, far = np.broadcast_to(near, n), np.broadcast_to(far, n)
    vertices = np.vstack(
        [
            np.c_[one_side, near],
            np.c_[one_side, far],
            np.c_[other_side, far],
            np.c_[other_side, near],
        ]
    )
    faces = [[0, n, 2 * n], [0, 2 * n, 3 * n]]
    end = n - 1
    faces += [[end, 2 * n + end, n + end], [end, 3 * n + end, 2 * n + end]]
    for edge in range(4):
        a, b = edge * n, (edge + 1) % 4 * n
        for i in range(n - 1):
            faces += [[a + i, a + i + 1, b + i + 1], [a + i, b + i + 1, b + i]]
    return _outward(vertices, np.array(faces))


def box(lower: ArrayLike, upper: ArrayLike) -> Mesh:
    """An upright box between two opposite corners (3,)."""
    (x0, y0, z0), (x1, y1, z1) = np.minimum(lower, upper), np.maximum(lower, upper)
    return beam([(x0, y0), (x1, y0)], [(x0, y1), (x1, y1)], z0, z1)


def cylinder(start: ArrayLike, end: ArrayLike, radius: float, sides: int = 14) -> Mesh:
    """A round bar from `start` to `end`, each (3,)."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    axis = (end - start) / np.linalg.norm(end - start)
    across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    across /= np.linalg.norm(across)
    angle = np.arange(sides) * 2 * np.pi / sides
    vertices, faces = prism(
        radius * np.c_[np.cos(angle), np.sin(angle)], 0.0, float(np.linalg.norm(end - start))
    )
    turn = np.stack([across, np.cross(axis, across), axis])
    return vertices @ turn + start, faces


def grid(x: NDArray, y: NDArray, z: NDArray) -> Mesh:
    """An open surface over a grid; x, y, z of shape (rows, columns), seen from above."""
    rows, columns = z.shape
    corner = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]
    faces = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], -2).reshape(-1, 3)
    return np.stack([x, y, z], -1).reshape(-1, 3), faces


def join(*meshes: Mesh) -> Mesh:
    """Several meshes as one."""
    offset, vertices, faces = 0, [], []
    for points, triangles in meshes:
        vertices.append(points)
        faces.append(triangles + offset)
        offset += len(points)
    return np.vstack(vertices), np.vstack(faces)


def mirror(mesh: Mesh, axis: int) -> Mesh:
    """The mesh and its mirror image in the plane through the origin across `axis`."""
    vertices, faces = mesh
    other = vertices.copy()
    other[:, axis] *= -1
    return join(mesh, (other, faces[:, ::-1]))


def volume(mesh: Mesh) -> float:
    """Enclosed volume [m^3] of a closed mesh, negative if its faces point inwards."""
    vertices, faces = mesh
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def _outward(vertices: NDArray, faces: NDArray) -> Mesh:
    return vertices, faces if volume((vertices, faces)) > 0 else faces[:, ::-1]
