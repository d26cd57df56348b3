"""Rays against machine, truck and soil as they are drawn: what a laser scanner would hit.

The rays have a physics server of their own, so that scanning never changes the motion.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.simulation import bullet
from backhoe.simulation.protocol import World
from backhoe.simulation.render import country, link_frames
from backhoe.view import shapes
from backhoe.view.appearance import truck_visuals, visuals
from backhoe.view.shapes import Mesh

BATCH = 16_000
"""Rays in one call: PyBullet takes at most 16384."""


class Rays:
    """Casts rays in one simulation, again and again.

    Raises:
        ImportError: PyBullet is not installed.
    """

    def __init__(self, world: World) -> None:
        self._server = bullet.Server()
        self._world = world
        self._links = {
            link: self._add(shapes.join(*((part.vertices, part.faces) for part in parts)))
            for link, parts in visuals(world.machine).items()
        }
        parts = [(part.vertices, part.faces) for part in truck_visuals(world.scene.truck)]
        if parts:
            self._add(shapes.join(*parts))
        self._add(country(world.scene))
        self._soil: dict[str, tuple[int, int]] = {}
        self._untouched = world.scene.heights(world.seed)

    def cast(self, start: NDArray, end: NDArray) -> NDArray:
        """First hits between start and end, each (n, 3), in the world; NaN where there is none."""
        server = self._server
        for link, T in link_frames(self._world).items():
            server.place(self._links[link], T)
        self._follow_soil()
        server.performCollisionDetection()
        hits = [
            hit
            for first in range(0, len(start), BATCH)
            for hit in server.rayTestBatch(
                start[first : first + BATCH].tolist(), end[first : first + BATCH].tolist()
            )
        ]
        points = np.array([hit[3] for hit in hits], dtype=float).reshape(-1, 3)
        points[np.array([hit[0] for hit in hits], dtype=int) < 0] = np.nan
        return points

    def close(self) -> None:
        """Release the server."""
        self._server.disconnect()

    def _follow_soil(self) -> None:
        ground = self._world.ground
        if ground is None:
            self._lay("terrain", 0, *self._world.scene.grid(), self._untouched)
            return
        self._lay("terrain", ground.terrain.version, *ground.terrain.grid(), ground.terrain.heights)
        if ground.bed is not None:
            inside = slice(1, -1), slice(1, -1)
            x, y = ground.bed.grid()
            self._lay("bed", ground.bed.version, x[inside], y[inside], ground.bed.heights[inside])

    def _lay(self, name: str, version: int, x: NDArray, y: NDArray, heights: NDArray) -> None:
        laid, body = self._soil.get(name, (None, None))
        if laid == version:
            return
        if body is not None:
            self._server.removeBody(body)
        self._soil[name] = version, self._add(shapes.grid(x, y, heights))

    def _add(self, mesh: Mesh) -> int:
        server, (vertices, faces) = self._server, mesh
        shape = server.createCollisionShape(
            server.GEOM_MESH,
            vertices=vertices.tolist(),
            indices=faces.ravel().tolist(),
            flags=server.GEOM_FORCE_CONCAVE_TRIMESH,
        )
        return server.createMultiBody(baseCollisionShapeIndex=shape)
