"""What a 3D replay shows: a tree of nodes with meshes and motions, height fields and scalars.

A node's pose in its parent is `before @ motion @ after`; meshes, children and fields hang after it.
The world has z up, metres and radians. `recording_file` turns a `Recording` into a small file.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, times

HEIGHT_STEP = 3e-3  # m, what heights are rounded to
MOTIONS = {"fixed": 0, "revolute": 1, "planar": 3, "free": 7}  # values a frame


@dataclass(frozen=True)
class Mesh:
    """Triangles: vertices (n, 3) [m], faces (m, 3) indices, colour (r, g, b, a) from 0 to 1."""

    vertices: ArrayLike
    faces: ArrayLike
    colour: tuple[float, float, float, float] = (0.7, 0.7, 0.7, 1.0)


@dataclass(frozen=True)
class Morph:
    """A mesh whose shape follows a scalar: shapes (k, n, 3) [m] at k rising knots of it."""

    scalar: str
    knots: ArrayLike
    shapes: ArrayLike
    faces: ArrayLike
    colour: tuple[float, float, float, float] = (0.45, 0.33, 0.22, 1.0)


@dataclass(frozen=True)
class Node:
    """One moving or fixed frame.

    `motion` says how it moves between `before` and `after` (4, 4): "fixed"; "revolute", values
    (frames,) [rad] about z; "planar", values (frames, 3) = x, y [m], yaw [rad]; "free", values
    (frames, 7) = x, y, z [m] and a unit quaternion xyzw. The parent is named before its children.
    """

    name: str
    parent: str | None = None
    motion: str = "fixed"
    values: ArrayLike | None = None
    before: ArrayLike = field(default_factory=lambda: np.eye(4))
    after: ArrayLike = field(default_factory=lambda: np.eye(4))
    meshes: tuple[Mesh | Morph, ...] = ()


class HeightField:
    """Heights of a grid over time, kept as the few cells that change from frame to frame.

    Args:
        name: what the player calls it.
        heights: first frame, shape (ny, nx) [m].
        cell: spacing of the points [m].
        origin: x, y of point [0, 0] in the node's frame [m].
        node: name of the node that carries the field, None for the world.
        bed: True for a load that hides where it is zero, False for the ground.
        level: z of height zero in the node's frame [m].
    """

    def __init__(
        self,
        name: str,
        heights: ArrayLike,
        cell: float,
        origin: tuple[float, float],
        node: str | None = None,
        bed: bool = False,
        level: float = 0.0,
    ) -> None:
        self.name, self.node, self.bed, self.level = name, node, bed, float(level)
        self.cell, self.origin = float(cell), (float(origin[0]), float(origin[1]))
        self.first = self._steps(heights, ("ny", "nx"))
        self._last = self.first.copy()
        self.changes: list[tuple[NDArray, NDArray]] = []

    def _steps(self, heights: ArrayLike, shape: tuple) -> NDArray:
        heights = numbers(heights, f"heights of {self.name!r}", shape)
        steps = np.rint(heights / HEIGHT_STEP)
        if np.abs(steps).max(initial=0) > 32767:
            most = round(32767 * HEIGHT_STEP)
            raise ValueError(f"heights of {self.name!r} must stay within {most} m of zero")
        return steps.astype(np.int32)

    def append(self, heights: ArrayLike) -> None:
        """Add the next frame, shape (ny, nx) [m].

        Raises:
            ValueError: another shape than the first frame, or a value is not finite.
        """
        steps = self._steps(heights, self.first.shape)
        cells = np.flatnonzero(steps != self._last)
        self.changes.append((cells, (steps - self._last).ravel()[cells]))
        self._last = steps

    @property
    def frames(self) -> int:
        """Frames so far, the first included."""
        return 1 + len(self.changes)

    def heights(self, frame: int) -> NDArray:
        """Heights of one frame as the player shows them, shape (ny, nx) [m]."""
        steps = self.first.copy().ravel()
        for cells, change in self.changes[:frame]:
            steps[cells] += change
        return steps.reshape(self.first.shape) * HEIGHT_STEP


@dataclass(frozen=True)
class Scalar:
    """A number to read out: name, values (frames,), label, unit and decimals shown."""

    name: str
    values: ArrayLike
    label: str
    unit: str = ""
    digits: int = 2


@dataclass(frozen=True)
class Line:
    """A fixed line in the world: points (n, 3) [m]."""

    points: ArrayLike
    colour: tuple[float, float, float, float] = (0.1, 0.4, 0.8, 1.0)


@dataclass(frozen=True)
class Recording:
    """Everything that a replay shows.

    `times` (frames,) [s] rising; `labels` are (time, text) shown from that time on; `camera` is
    (eye, target) in the world [m]; `follow` and `trail` name the nodes that the following camera
    looks at and whose path can be drawn.

    Raises:
        ValueError: no frame, times that do not rise, a value that is not finite, a shape that does
            not fit the frames, or a name that is missing or twice there.
    """

    times: ArrayLike
    nodes: tuple[Node, ...]
    fields: tuple[HeightField, ...] = ()
    scalars: tuple[Scalar, ...] = ()
    lines: tuple[Line, ...] = ()
    labels: tuple[tuple[float, str], ...] = ()
    camera: tuple[ArrayLike, ArrayLike] = ((10.2, -8.6, 5.8), (2.4, 1.2, 1.1))
    follow: str | None = None
    trail: str | None = None

    def __post_init__(self) -> None:
        frames = len(times(self.times, "times", least=1))
        names: set[str] = set()
        for node in self.nodes:
            _check_node(node, frames, names)
        scalars = {scalar.name for scalar in self.scalars}
        for scalar in self.scalars:
            numbers(scalar.values, f"scalar {scalar.name!r}", (frames,))
        for mesh in (mesh for node in self.nodes for mesh in node.meshes):
            if isinstance(mesh, Morph) and mesh.scalar not in scalars:
                raise ValueError(f"a morph follows the unknown scalar {mesh.scalar!r}")
        for ground in self.fields:
            if ground.frames != frames:
                raise ValueError(
                    f"field {ground.name!r} has {ground.frames} frames, the times have {frames}"
                )
        wanted = [ground.node for ground in self.fields] + [self.follow, self.trail]
        for name in wanted:
            if name is not None and name not in names:
                raise ValueError(f"there is no node {name!r}: the nodes are {sorted(names)}")

    @property
    def frames(self) -> int:
        """Number of frames."""
        return len(np.atleast_1d(self.times))

    @property
    def duration(self) -> float:
        """Time from the first to the last frame [s]."""
        return float(self.times[-1] - self.times[0])


def _check_node(node: Node, frames: int, names: set[str]) -> None:
    if node.name in names:
        raise ValueError(f"two nodes are called {node.name!r}")
    if node.parent is not None and node.parent not in names:
        raise ValueError(f"node {node.name!r} comes before its parent {node.parent!r}")
    if node.motion not in MOTIONS:
        raise ValueError(f"motion of {node.name!r} must be one of {list(MOTIONS)}")
    names.add(node.name)
    columns = MOTIONS[node.motion]
    if columns:
        shape = (frames,) if columns == 1 else (frames, columns)
        numbers(node.values, f"motion of {node.name!r}", shape, meaning="a row for each frame")
