"""Pictures of a simulation from PyBullet's software renderer; no screen and no GPU needed.

A renderer has a physics server of its own that holds only what is seen. It is posed anew for each
picture, so that looking never changes the motion.
"""

from __future__ import annotations

import itertools
import tempfile
from collections.abc import Sequence
from math import cos, sin
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.kinematics import link_transforms
from backhoe.machine import JOINTS
from backhoe.simulation import bullet, texture
from backhoe.simulation.camera import Camera
from backhoe.simulation.protocol import World
from backhoe.simulation.scene import Scene
from backhoe.view import shapes
from backhoe.view.appearance import Visual, bucket_load, struts, truck_visuals, visuals
from backhoe.view.shapes import Mesh

HORIZON = 160.0
"""Half side of the flat country around the scene [m]."""

SKY = np.array([[0.55, 0.70, 0.86], [0.90, 0.93, 0.95]])
"""Colour at the top of the picture and at its lower end."""

SUN = np.array([-0.36, -0.48, 0.80])
"""Direction to the light."""

AMBIENT, DIFFUSE = 0.55, 0.6
TILE = 32
"""Cells along each side of a part of the ground that is drawn anew as a whole."""

THIN = 0.01
"""Soil thinner than this is not drawn on the truck's floor [m]."""

SUN_DISTANCE = 300.0
SUN_PIXELS = 1024
SHADOW_MARGIN = 0.06
"""How far behind the nearest lit point a point must lie to be in the shadow [m]."""


class Renderer:
    """Draws one simulation, again and again.

    Raises:
        ImportError: PyBullet is not installed.
    """

    def __init__(self, world: World) -> None:
        self._server = bullet.Server()
        self._world = world
        self._folder = tempfile.TemporaryDirectory(prefix="backhoe-")
        self._shown: dict[str, tuple[object, int | None]] = {}
        self._versions: dict[str, object] = {}
        path = Path(self._folder.name) / "ground.png"
        path.write_bytes(texture.png(texture.ground(world.seed)))
        self._texture = self._server.loadTexture(str(path))
        self._links = [
            (link, self._add((part.vertices, part.faces), part.colour))
            for link, parts in visuals(world.machine).items()
            for part in parts
        ]
        for part in truck_visuals(world.scene.truck):
            self._add((part.vertices, part.faces), part.colour)
        self._struts = [
            (strut, [self._add((p.vertices, p.faces), p.colour) for p in (strut.barrel, strut.rod)])
            for strut in struts(world.machine)
        ]
        flat = country(world.scene)
        self._add_ground(flat, np.tile([0.0, 0.0, 1.0], (len(flat[0]), 1)))

    def picture(
        self,
        width: int,
        height: int,
        eye: ArrayLike,
        target: ArrayLike,
        field_of_view: float,
        shadow: bool,
        samples: int,
    ) -> NDArray:
        """The scene as it is now, shape (height, width, 3), uint8."""
        self._pose_machine()
        self._show_soil()
        shape = height * samples, width * samples
        camera = Camera.at(eye, target, field_of_view, shape, 0.1, 4 * HORIZON)
        colours, depth, seen = self._look(camera)
        if shadow:
            colours = colours * self._shade(camera, depth)[..., None]
        colours = np.where(seen[..., None], colours, _sky(shape[0])[:, None])
        return _downsample(colours, samples)

    def _look(self, camera: Camera) -> tuple[NDArray, NDArray, NDArray]:
        """Colours (rows, columns, 3), depth and whether something is seen (rows, columns)."""
        server, (rows, columns) = self._server, camera.shape
        _, _, colours, depth, bodies = server.getCameraImage(
            columns,
            rows,
            camera.view.T.ravel().tolist(),
            camera.lens.T.ravel().tolist(),
            lightDirection=SUN.tolist(),
            lightColor=(1.0, 0.98, 0.94),
            lightAmbientCoeff=AMBIENT,
            lightDiffuseCoeff=DIFFUSE,
            lightSpecularCoeff=0.05,
            shadow=0,
            renderer=server.ER_TINY_RENDERER,
        )
        colours = np.reshape(np.array(colours, dtype=np.uint8), (rows, columns, 4))
        depth = np.reshape(np.array(depth), (rows, columns))
        return colours[..., :3], depth, np.reshape(np.array(bodies), (rows, columns)) >= 0

    def _shade(self, camera: Camera, depth: NDArray) -> NDArray:
        """Light that is left where the sun does not reach, 0..1, shape (rows, columns).

        The scene is seen once from the sun; what the sun does not see lies in the shadow.
        """
        grid = self._world.scene.grid()
        middle = np.array([*(np.ptp(side) / 2 + side.min() for side in grid), 0.0])
        radius = 0.75 * max(np.ptp(side) for side in grid)
        sun = Camera.at(
            middle + SUN_DISTANCE * SUN,
            middle,
            2 * np.arctan(radius / SUN_DISTANCE),
            (SUN_PIXELS, SUN_PIXELS),
            SUN_DISTANCE - 1.5 * radius,
            SUN_DISTANCE + 1.5 * radius,
        )
        _, sunlit, _ = self._look(sun)
        points = camera.unproject(depth)
        normal = np.cross(np.gradient(points, axis=0), np.gradient(points, axis=1))
        normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12)
        facing = np.maximum(normal @ SUN, 0.0)
        row, column, ahead = sun.project(points)
        margin = SHADOW_MARGIN / np.maximum(facing, 0.2)
        nearest = np.pad(sun.distance(sunlit), 1, constant_values=np.inf)
        dark = np.zeros(depth.shape)
        for down, right in ((0, 0), (0, 1), (1, 0), (1, 1), (0, -1), (-1, 0), (-1, -1)):
            at = (
                np.clip(row + down, -1, SUN_PIXELS) + 1,
                np.clip(column + right, -1, SUN_PIXELS) + 1,
            )
            dark += (ahead > nearest[at] + margin) / 7
        return 1 - dark * (1 - AMBIENT / (AMBIENT + DIFFUSE * facing))

    def close(self) -> None:
        """Release the server and the texture."""
        self._server.disconnect()
        self._folder.cleanup()

    def _pose_machine(self) -> None:
        world, frames = self._world, link_frames(self._world)
        load = bucket_load(world.ground.bucket_volume, world.machine) if world.ground else None
        self._show("load", None if load is None else round(world.ground.bucket_volume, 4), load)
        for link, body in [*self._links, ("bucket", self._shown["load"][1])]:
            if body is not None:
                self._server.place(body, frames[link])
        for strut, (barrel, rod) in self._struts:
            base = frames[strut.base_link] @ [*strut.base, 1.0]
            tip = frames[strut.tip_link] @ [*strut.tip, 1.0]
            along = (tip - base)[:3] / np.linalg.norm(tip - base)
            across = frames[strut.base_link][:3, 2]
            T = np.eye(4)
            T[:3, :3] = np.stack([along, np.cross(across, along), across], axis=-1)
            for body, origin in ((barrel, base), (rod, tip)):
                T[:3, 3] = origin[:3]
                self._server.place(body, T)

    def _show_soil(self) -> None:
        ground = self._world.ground
        if ground is None:
            scene = self._world.scene
            self._show_terrain("terrain", 0, scene.grid(), scene.heights(self._world.seed))
            return
        terrain, bed = ground.terrain, ground.bed
        self._show_terrain("terrain", terrain.version, terrain.grid(), terrain.heights)
        if bed is not None:
            inside = slice(1, -1), slice(1, -1)
            x, y = bed.grid()
            loaded = ground.truck_volume > 1e-3
            bare = bed.heights - bed.floor < THIN
            heights = np.where(bare, bed.floor - THIN, bed.heights)[inside]
            self._show_terrain(
                "bed", (bed.version, loaded), (x[inside], y[inside]), heights, loaded
            )

    def _show_terrain(
        self,
        name: str,
        version: object,
        grid: tuple[NDArray, NDArray],
        heights: NDArray,
        visible: bool = True,
    ) -> None:
        """Draw a heightmap in tiles, anew only those that have changed since its last version."""
        if self._versions.get(name) == version:
            return
        self._versions[name] = version
        normals = _grid_normals(heights, grid)
        for top, left in itertools.product(*(range(0, side - 1, TILE) for side in heights.shape)):
            around = tuple(slice(max(first - 1, 0), first + TILE + 2) for first in (top, left))
            seen = heights[around].tobytes() if visible else None
            key = f"{name} {top} {left}"
            if self._shown.get(key, (None, None))[0] == seen:
                continue
            self._remove(key)
            part, body = np.s_[top : top + TILE + 1, left : left + TILE + 1], None
            if visible:
                mesh = shapes.grid(grid[0][part], grid[1][part], heights[part])
                body = self._add_ground(mesh, normals[part].reshape(-1, 3))
            self._shown[key] = seen, body

    def _show(self, name: str, version: object, part: Visual | None) -> None:
        if name in self._shown and self._shown[name][0] == version:
            return
        self._remove(name)
        body = None if part is None else self._add((part.vertices, part.faces), part.colour)
        self._shown[name] = (version, body)

    def _remove(self, name: str) -> None:
        _, body = self._shown.pop(name, (None, None))
        if body is not None:
            self._server.removeBody(body)

    def _add(self, mesh: Mesh, colour: Sequence[float]) -> int:
        """A body of one colour with flat faces."""
        vertices, faces = mesh
        corners = vertices[faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        return self._body(
            corners.reshape(-1, 3),
            np.arange(3 * len(faces)),
            np.repeat(normals, 3, axis=0),
            rgbaColor=colour,
        )

    def _add_ground(self, mesh: Mesh, normals: NDArray) -> int:
        vertices, faces = mesh
        body = self._body(
            vertices,
            faces.ravel(),
            normals,
            uvs=((vertices[:, :2] + 2 * HORIZON) / texture.SIDE).tolist(),
            rgbaColor=(1, 1, 1, 1),
        )
        self._server.changeVisualShape(body, -1, textureUniqueId=self._texture)
        return body

    def _body(self, vertices: NDArray, indices: NDArray, normals: NDArray, **look: object) -> int:
        shape = self._server.createVisualShape(
            self._server.GEOM_MESH,
            vertices=vertices.tolist(),
            indices=indices.tolist(),
            normals=normals.tolist(),
            specularColor=(0.1, 0.1, 0.1),
            **look,
        )
        return self._server.createMultiBody(baseVisualShapeIndex=shape)


def country(scene: Scene) -> Mesh:
    """The flat ground around the scene's grid, out to the horizon."""
    x, y = scene.grid()
    far = np.r_[np.arange(0.0, 20.0, 2.0), np.geomspace(20.0, HORIZON, 14)]
    lines = [np.unique(np.r_[-far[::-1], far, side.min(), side.max()]) for side in (x, y)]
    around_x, around_y = np.meshgrid(*lines)
    vertices, faces = shapes.grid(around_x, around_y, np.zeros_like(around_x))
    middle = vertices[faces].mean(axis=1)
    inside = (np.abs(middle[:, 0] - (x.min() + x.max()) / 2) < np.ptp(x) / 2) & (
        np.abs(middle[:, 1] - (y.min() + y.max()) / 2) < np.ptp(y) / 2
    )
    return vertices, faces[~inside]


def link_frames(world: World) -> dict[str, NDArray]:
    """Poses in the world, (4, 4) each: undercarriage, swing, boom, stick, bucket."""
    x, y, yaw = world.pose
    T_world_base = np.array(
        [[cos(yaw), -sin(yaw), 0, x], [sin(yaw), cos(yaw), 0, y], [0, 0, 1, 0], [0, 0, 0, 1]]
    )
    T_links = T_world_base @ link_transforms(world.q, machine=world.machine)
    return dict(zip(JOINTS, T_links, strict=True), undercarriage=T_world_base)


def _grid_normals(heights: NDArray, grid: tuple[NDArray, NDArray]) -> NDArray:
    x, y = grid
    slope_y, slope_x = np.gradient(heights, y[:, 0], x[0])
    normals = np.stack([-slope_x, -slope_y, np.ones_like(heights)], axis=-1)
    return normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def _sky(rows: int) -> NDArray:
    down = np.linspace(0.0, 1.0, rows)[:, None]
    return np.uint8(255 * (SKY[0] + np.minimum(2 * down, 1.0) * (SKY[1] - SKY[0])))


def _downsample(picture: NDArray, samples: int) -> NDArray:
    if samples == 1:
        return np.uint8(picture + 0.5)
    rows, columns, _ = picture.shape
    blocks = picture.reshape(rows // samples, samples, columns // samples, samples, 3)
    return np.uint8(blocks.mean(axis=(1, 3)) + 0.5)
