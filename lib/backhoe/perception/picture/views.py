"""Pictures by rays, with the true depth of each pixel: what a camera sees, without a renderer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import instance, instances, number, numbers, pose
from backhoe.basics.tiles import for_each_tile
from backhoe.perception.camera import Pinhole
from backhoe.perception.picture.texture import Texture
from backhoe.perception.rays import RayCaster

SUN = np.array([-0.36, -0.48, 0.80])
"""Direction to the light."""

STRIPES = 8
"""Parts of a picture that threads make side by side."""

_LIGHT = SUN / np.linalg.norm(SUN)


@dataclass(frozen=True)
class Paint:
    """How a surface looks: `brightness` 0 to 1, how strongly its texture shows (`contrast`, the
    standard deviation in shares of the brightness), and the share of light in the shade."""

    brightness: float
    contrast: float = 0.0
    ambient: float = 0.5

    def __post_init__(self) -> None:
        for name in ("brightness", "contrast", "ambient"):
            number(getattr(self, name), f"Paint.{name}", least=0, most=1)


@dataclass(frozen=True)
class View:
    """What a camera sees, shape (rows, columns) each: `grey`, uint8 [grey levels]; `depth` along
    its axis [m], NaN where nothing is; `surface`, numbered as by `rays.Hits`, -1 for none."""

    grey: NDArray
    depth: NDArray
    surface: NDArray


def looking(eye: ArrayLike, target: ArrayLike) -> NDArray:
    """Pose of a level camera in the world, shape (4, 4) [m]: x right, y down, z ahead.

    Args:
        eye, target: where it is and what it looks at, shape (3,) [m].

    Raises:
        ValueError: both are one place, or one is above the other.
    """
    eye, target = (
        numbers(p, name, (3,), meaning="x, y, z [m]")
        for name, p in (("eye", eye), ("target", target))
    )
    ahead = target - eye
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    number(
        float(np.linalg.norm(right)), "distance of eye and target as seen from above", "m", above=0
    )
    T = np.eye(4)
    for k, axis in enumerate((right, np.cross(ahead, right), ahead)):
        T[:3, k] = axis / np.linalg.norm(axis)
    T[:3, 3] = eye
    return T


def view(
    caster: RayCaster,
    camera: Pinhole,
    T_world_camera: ArrayLike,
    paints: Sequence[Paint],
    texture: Texture,
) -> View:
    """A picture with true depth, one ray a pixel; the lens's distortion included.

    Without distortion triangles are drawn, which gives what the rays give, several times as fast.

    Args:
        caster: what there is to see.
        camera: its lens and size.
        T_world_camera: its pose, shape (4, 4) [m]: x right, y down, z ahead.
        paints: one for each surface of the caster.
        texture: that all paints with contrast show.

    Raises:
        ValueError: shapes, or another number of paints than of surfaces.
        TypeError: a caster, camera, paint or texture that is none.
    """
    for name, value, kind in (("caster", caster, RayCaster), ("camera", camera, Pinhole)):
        instance(value, name, kind)
    instance(texture, "texture", Texture)
    coats = instances(paints, "paints", Paint)
    if len(coats) != caster.surfaces:
        raise ValueError(f"paints must be one for each of {caster.surfaces}, got {len(paints)}")
    table = np.array([[p.brightness, p.contrast, p.ambient] for p in coats])
    T = pose(numbers(T_world_camera, "T_world_camera", (4, 4), meaning="a pose"), "T_world_camera")
    width, height = camera.size
    shape = height, width
    depth, surface = np.empty(shape), np.empty(shape, dtype=np.int64)
    grey = np.empty(shape, dtype=np.uint8)
    how = table, texture.levels, texture.pixels, texture.side
    make = _through_lens if camera.distortion.any() else _straight
    for_each_tile(make(caster, camera, T, how, depth, surface, grey), height, -(-height // STRIPES))
    return View(grey, np.where(surface >= 0, depth, np.nan), surface)


def _straight(
    caster: RayCaster,
    camera: Pinhole,
    T: NDArray,
    how: tuple,
    depth: NDArray,
    surface: NDArray,
    grey: NDArray,
) -> Callable[[slice], None]:
    """A function that fills rows of a picture taken without distortion, a triangle after the
    other."""
    from backhoe.perception.picture import engine

    K, covered = camera.K, caster.covered(camera.K, T, camera.size[0])
    lens = K[0, 0], K[1, 1], K[0, 2], K[1, 2]

    def some(rows: slice) -> None:
        nearest, which = covered(rows.start, rows.stop)
        scene, owners = caster.scene, caster.owners
        filled = depth[rows], surface[rows], grey[rows]
        engine.show(scene, owners, nearest, which, T, lens, rows.start, *how, _LIGHT, *filled)

    return some


def _through_lens(
    caster: RayCaster,
    camera: Pinhole,
    T: NDArray,
    how: tuple,
    depth: NDArray,
    surface: NDArray,
    grey: NDArray,
) -> Callable[[slice], None]:
    """As `_straight`, for a lens that bends the rays: each is cast on its own."""
    from backhoe.perception.picture import engine

    def some(rows: slice) -> None:
        columns = np.arange(camera.size[0])
        pixels = np.stack(np.meshgrid(columns, np.arange(rows.start, rows.stop)), axis=-1)
        plane = camera.undistort(pixels.reshape(-1, 2).astype(float))
        blind = np.isnan(plane[:, 0])
        plane[blind] = 0.0
        vector = np.c_[plane, np.ones(len(plane))] @ T[:3, :3].T
        hits = caster.cast(T[:3, 3], vector)
        seen = hits.points, hits.t, vector, hits.surface, hits.normal
        light = np.empty(len(plane), dtype=np.uint8)
        engine.shade(
            *seen, caster.scene.bodies, caster.fields, *how, 1 / camera.K[0, 0], _LIGHT, light
        )
        shape = depth[rows].shape
        depth[rows] = hits.t.reshape(shape)
        surface[rows] = np.where(blind, -1, hits.surface).reshape(shape)
        grey[rows] = np.where(blind, 0, light).reshape(shape)

    return some
