"""The simulated scene for rays of our own: machine, truck and soil as they are drawn.

What `rays` does in PyBullet, without it: the same surfaces, for either backend.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.perception.camera import Pinhole
from backhoe.perception.picture import Paint, Texture, View, view
from backhoe.perception.rays import Body, HeightField, Hits, RayCaster
from backhoe.simulation.protocol import World
from backhoe.simulation.render import HORIZON, link_frames
from backhoe.simulation.soil import Terrain
from backhoe.view import shapes
from backhoe.view.appearance import truck_visuals, visuals

EARTH, PAINTED, SMOOTH = Paint(0.5, 0.3), Paint(0.6, 0.1), Paint(0.75)
"""Soil; the machine, scratched; the truck, newly painted: a stereo pair cannot match its sides."""


class Sight:
    """Casts rays in one simulation, again and again; follows its motion and its soil.

    Surfaces are numbered by `names`: terrain, bed where there is a truck, links, truck, country.

    Attributes:
        truck: whether the scene's truck is there now, with what is in its bed; set it to False
            when it has left.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        parts = visuals(world.machine)
        self._links = list(parts)
        self._bodies = [_body(parts[link]) for link in self._links]
        truck = truck_visuals(world.scene.truck)
        self._truck = _body(truck) if truck else None
        self.truck = self._truck is not None
        self._versions: tuple | None = None
        self._texture: Texture | None = None
        self._caster: RayCaster | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Surfaces in the order of their numbers."""
        beds = ["bed"] if len(self._grounds()) > 1 else []
        return ("terrain", *beds, *self._links, *(["truck"] if self._there() else []), "country")

    def cast(self, start: ArrayLike, vector: ArrayLike, most: float = np.inf) -> Hits:
        """Hits as `perception.rays.RayCaster.cast` gives them, shape (n,) [m], in the scene as it
        is now."""
        return self.caster().cast(start, vector, most)

    def look(self, camera: Pinhole, T_world_camera: ArrayLike) -> View:
        """The scene as a camera sees it now, with true depth; pose (4, 4) [m]: x right, y down, z
        ahead."""
        if self._texture is None:
            self._texture = Texture.of_noise(self._world.seed)
        special = dict.fromkeys(("terrain", "bed", "country"), EARTH) | {"truck": SMOOTH}
        paints = [special.get(name, PAINTED) for name in self.names]
        return view(self.caster(), camera, T_world_camera, paints, self._texture)

    def caster(self, frames: Mapping[str, NDArray] | None = None) -> RayCaster:
        """The scene as it is now, or with the machine's links elsewhere: their poses (4, 4) [m]."""
        versions = (self._there(), *(field.version for field in self._grounds()))
        frames = link_frames(self._world) if frames is None else frames
        bodies = [*self._bodies, *([self._truck] if self._there() else [])]
        poses = np.tile(np.eye(4), (len(bodies), 1, 1))
        poses[: len(self._links)] = [frames[link] for link in self._links]
        if self._caster is None or versions != self._versions:
            self._versions = versions
            self._caster = RayCaster(self._fields(), bodies, poses, plain=True, reach=HORIZON)
        else:
            self._caster.pose(poses)
        return self._caster

    def _there(self) -> bool:
        return self.truck and self._truck is not None

    def _grounds(self) -> list[Terrain]:
        """What is there of terrain and bed."""
        ground = self._world.ground
        if ground is None:
            return []
        return [ground.terrain, *([ground.bed] if ground.bed is not None and self.truck else [])]

    def _fields(self) -> list[HeightField]:
        world, ground = self._world, self._world.ground
        if ground is None:
            scene = world.scene
            return [HeightField(scene.heights(world.seed), scene.cell, scene.corner)]
        fields = [_field(*ground.terrain.grid(), ground.terrain.heights)]
        if len(self._grounds()) > 1:
            inside = slice(1, -1), slice(1, -1)
            x, y = ground.bed.grid()
            fields.append(_field(x[inside], y[inside], ground.bed.heights[inside]))
        return fields


def _field(x: NDArray, y: NDArray, heights: NDArray) -> HeightField:
    return HeightField(np.array(heights), float(x[0, 1] - x[0, 0]), (x[0, 0], y[0, 0]))


def _body(parts: tuple) -> Body:
    return Body(*shapes.join(*((part.vertices, part.faces) for part in parts)))
