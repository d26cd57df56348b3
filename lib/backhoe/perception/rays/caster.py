"""What rays can hit, and the casting of many of them: a laser's beams, a camera's pixels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import (
    MOST_PIXELS,
    alike,
    flag,
    instances,
    number,
    numbers,
    pose,
    positive,
    real_numbers,
    whole,
)
from backhoe.basics.tiles import for_each_tile
from backhoe.perception.rays.loops import BLOCK, Surfaces
from backhoe.perception.rays.tree import box_tree

TILE = 4096


@dataclass(frozen=True)
class HeightField:
    """Ground as triangles over a grid: `heights[i, j]` at x = x0 + j cell, y = y0 + i cell.

    Each cell is cut from its corner (i, j) to (i + 1, j + 1).

    Attributes:
        heights: shape (rows, columns), 2 or more each [m].
        cell: side of a cell [m].
        origin: x0, y0 in the world [m].

    Raises:
        ValueError: shapes, or a cell that is not positive.
    """

    heights: NDArray
    cell: float
    origin: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        heights = numbers(self.heights, "heights", ("rows", "columns"), meaning="heights [m]")
        number(min(heights.shape), "rows and columns of heights", least=2)
        positive(self.cell, "cell", "m")
        numbers(self.origin, "origin", (2,), meaning="x0, y0 [m]")
        object.__setattr__(self, "heights", np.ascontiguousarray(heights))


class Body:
    """A rigid body of triangles.

    Args:
        vertices: in the body's frame, shape (n, 3) [m].
        faces: which three make a triangle, shape (m, 3), indices [1].

    Raises:
        ValueError: shapes, or an index out of range.
    """

    def __init__(self, vertices: ArrayLike, faces: ArrayLike) -> None:
        vertices = numbers(vertices, "vertices", ("n", 3), meaning="corners x, y, z [m]")
        index = numbers(faces, "faces", ("m", 3), meaning="three vertices a triangle").astype(int)
        if index.min() < 0 or index.max() >= len(vertices):
            raise ValueError(f"faces must be indices from 0 to {len(vertices) - 1}")
        corners = vertices[index]
        self.boxes, self.tree, order = box_tree(corners)
        a, b, c = np.moveaxis(corners[order], 1, 0)
        self.triangles = np.concatenate([a, b - a, c - a], axis=1)
        self.middle = (self.boxes[0, :3] + self.boxes[0, 3:]) / 2
        self.radius = float(np.linalg.norm(vertices - self.middle, axis=1).max()) + 1e-9


@dataclass(frozen=True)
class Hits:
    """Where n rays first meet a surface.

    Attributes:
        t: start + t vector is the point; inf for a ray that meets none, shape (n,) [1].
        surface: number of what is hit: fields, bodies, then the plain; -1 for none, (n,).
        normal: of length 1, upwards for fields, as its corners turn for a body, (n, 3) [1].
        points: shape (n, 3) [m]; NaN where nothing is hit.
    """

    t: NDArray
    surface: NDArray
    normal: NDArray
    points: NDArray


class RayCaster:
    """Casts rays against heightmaps, posed bodies and a plain around them.

    Args:
        fields: heightmaps.
        bodies: in their own frames.
        poses: of the bodies in the world, shape (bodies, 4, 4) [1, m]; None for all at the origin.
        plain: whether z = 0 goes on around the first field, out to `reach` [m].
        reach: half side of that plain [m].

    Raises:
        ValueError: shapes, or a pose that is none.
        TypeError: a field or body that is none.
    """

    def __init__(
        self,
        fields: Sequence[HeightField] = (),
        bodies: Sequence[Body] = (),
        poses: ArrayLike | None = None,
        *,
        plain: bool = False,
        reach: float = 160.0,
    ) -> None:
        fields = instances(fields, "fields", HeightField)
        self._bodies = bodies = instances(bodies, "bodies", Body)
        self._owners = np.repeat(np.arange(len(bodies)), [len(b.triangles) for b in bodies])
        hole = np.zeros(5)
        if flag(plain, "plain"):
            hole[4] = positive(reach, "reach", "m")
            if fields:
                (x0, y0), (rows, columns) = fields[0].origin, fields[0].heights.shape
                width, height = (columns - 1) * fields[0].cell, (rows - 1) * fields[0].cell
                hole[:4] = x0, x0 + width, y0, y0 + height
        forest = _forest(self._bodies)
        self._scene = Surfaces(*_ground(fields), np.zeros((len(bodies), 17)), *forest, hole)
        self._scene.bodies[:, 16] = np.cumsum([0, *(len(b.boxes) for b in bodies)])[: len(bodies)]
        self.pose(np.tile(np.eye(4), (len(bodies), 1, 1)) if poses is None else poses)

    @property
    def fields(self) -> int:
        """How many heightmaps there are."""
        return len(self._scene.fields)

    @property
    def surfaces(self) -> int:
        """How many surfaces there are, in the order of `Hits.surface`."""
        return self.fields + len(self._bodies) + int(self._scene.plain[4] > 0)

    @property
    def scene(self) -> Surfaces:
        """All of it as the loops take it [m]."""
        return self._scene

    @property
    def owners(self) -> NDArray:
        """Number of the body that each triangle belongs to, shape (t,) [1]."""
        return self._owners

    def pose(self, poses: ArrayLike) -> None:
        """Move the bodies to poses in the world, shape (bodies, 4, 4) [m]."""
        if not self._bodies:
            return
        wanted = (len(self._bodies), 4, 4)
        T = pose(numbers(poses, "poses", wanted, meaning="a pose for each body"), "poses")
        R, p = T[:, :3, :3], T[:, :3, 3]
        bodies = self._scene.bodies
        bodies[:, :9] = np.swapaxes(R, 1, 2).reshape(-1, 9)
        bodies[:, 9:12] = -np.einsum("bji,bj->bi", R, p)
        middles = np.array([body.middle for body in self._bodies])
        bodies[:, 12:15] = np.einsum("bij,bj->bi", R, middles) + p
        bodies[:, 15] = [body.radius for body in self._bodies]

    def cast(self, start: ArrayLike, vector: ArrayLike, most: float = inf) -> Hits:
        """First hits of rays start + t vector, t from 0 to below `most`.

        Args:
            start: shape (n, 3), or (3,) for one that serves all [m].
            vector: shape (n, 3) [m]; end - start for hits up to an end with most = 1.
            most: largest t [1].

        Raises:
            ValueError: shapes, values that are not finite, or a vector of length 0.
        """
        vector = numbers(vector, "vector", ("n", 3), meaning="x, y, z [m]")
        start = real_numbers(start, "start")
        start = numbers(start, "start", (3,) if start.ndim == 1 else ("n", 3), meaning="points [m]")
        start = np.ascontiguousarray(
            np.broadcast_to(start, vector.shape) if start.ndim == 1 else start
        )
        alike(start=start, vector=vector)
        number(np.abs(vector).sum(axis=1).min(), "least length of a vector", "m", above=0)
        most = number(most, "most", above=0, finite=False)

        from backhoe.perception.rays import engine

        n = len(vector)
        vector = np.ascontiguousarray(vector)
        t, surface, normal = np.empty(n), np.empty(n, dtype=np.int64), np.empty((n, 3))

        def some(part: slice) -> None:
            engine.cast(
                self._scene,
                start[part],
                vector[part],
                most,
                t[part],
                surface[part],
                normal[part],
            )

        for_each_tile(some, n, TILE)
        hit = np.isfinite(t)
        points = start + np.where(hit, t, np.nan)[:, None] * vector
        return Hits(t, surface, normal, points)

    def covered(
        self, K: NDArray, T: NDArray, width: int
    ) -> Callable[[int, int], tuple[NDArray, NDArray]]:
        """Prepare what a camera without distortion sees of fields and bodies, for `picture.view`.

        Args:
            K: intrinsic matrix, shape (3, 3) [pixels].
            T: the camera's pose in the world, shape (4, 4) [m]: x right, y down, z ahead.
            width: of the picture [pixels].

        Returns:
            A function of the first row and the one after the last: inverse depths [1/m] and numbers
            of triangles as `raster.cover` has them, -1 for none, shape (rows, width) each.

        Raises:
            ValueError: shapes, numbers that are not finite, or a pose that is none.
        """
        from backhoe.perception.rays import engine

        K = numbers(K, "K", (3, 3), meaning="an intrinsic matrix [pixels]")
        width = whole(width, "width", least=1, most=MOST_PIXELS)
        corners, triangles = self._before(pose(numbers(T, "T", (4, 4), meaning="a pose"), "T"))
        fields = self._scene.fields
        lens = K[0, 0], K[1, 1], K[0, 2], K[1, 2]

        def rows(top: int, bottom: int) -> tuple[NDArray, NDArray]:
            shape = bottom - top, width
            nearest, which = np.zeros(shape), np.full(shape, -1, dtype=np.int32)
            engine.cover(fields, corners, triangles, lens, top, bottom, width, nearest, which)
            return nearest, which

        return rows

    def _before(self, T: NDArray) -> tuple[NDArray, NDArray]:
        """Heights' points (n, 3) and bodies' triangles (t, 9) in a camera's frame [m]."""
        scene, R, eye = self._scene, T[:3, :3], T[:3, 3]
        corners = (_points(scene) - eye) @ R
        turns = scene.bodies[:, :9].reshape(-1, 3, 3)
        triangles = scene.triangles.reshape(-1, 3, 3) @ (turns @ R)[self._owners]
        starts = np.einsum("bji,bj->bi", turns, scene.bodies[:, 9:12]) + eye
        triangles[:, 0] -= (starts @ R)[self._owners]
        return corners, triangles.reshape(-1, 9)


def _points(scene: Surfaces) -> NDArray:
    """Where the heights of all fields are, shape (n, 3) [m]."""
    points = [np.empty((0, 3))]
    for x0, y0, cell, rows, columns, first in scene.fields[:, :6].tolist():
        i, j = np.divmod(np.arange(int(rows * columns)), int(columns))
        z = scene.heights[int(first) : int(first) + len(i)]
        points.append(np.stack([x0 + cell * j, y0 + cell * i, z], axis=-1))
    return np.concatenate(points)


def _ground(fields: Sequence[HeightField]) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Rows, heights, and the lowest and highest of each block, of all fields."""
    rows, heights, low, high = [], [], [], []
    for field in fields:
        z = field.heights
        before = sum(map(len, heights)), sum(map(len, low))
        rows.append([*field.origin, field.cell, *z.shape, *before, z.min(), z.max()])
        heights.append(z.ravel())
        starts = [np.arange(0, side - 1, BLOCK) for side in z.shape]
        for extreme, into in ((np.minimum, low), (np.maximum, high)):
            cells = extreme(extreme(z[:-1, :-1], z[1:, 1:]), extreme(z[:-1, 1:], z[1:, :-1]))
            blocks = extreme.reduceat(extreme.reduceat(cells, starts[0], 0), starts[1], 1)
            into.append(blocks.ravel())
    flat = (np.concatenate(part) if part else np.zeros(0) for part in (heights, low, high))
    return np.array(rows, dtype=float).reshape(-1, 9), *flat


def _forest(bodies: Sequence[Body]) -> tuple[NDArray, NDArray, NDArray]:
    """Boxes, tree and triangles of all bodies, one after the other."""
    trees, nodes, triangles = [], 0, 0
    for body in bodies:
        leaf = body.tree[:, 1] > 0
        shift = np.where(leaf, triangles, nodes)
        trees.append(body.tree + np.stack([shift, 0 * shift], axis=1))
        nodes, triangles = nodes + len(body.boxes), triangles + len(body.triangles)
    if not bodies:
        return np.zeros((0, 6)), np.zeros((0, 2), dtype=int), np.zeros((0, 9))
    return (
        np.concatenate([body.boxes for body in bodies]),
        np.concatenate(trees),
        np.concatenate([body.triangles for body in bodies]),
    )
