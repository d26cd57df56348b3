"""Rays through heightmaps and meshes, and a camera's view of them, compiled."""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.perception.rays import loops, raster

cast, cover, *_ = compiled(
    loops.cast,
    raster.cover,
    loops.hit_cell,
    loops.hit_field,
    loops.box_entry,
    loops.hit_triangle,
    loops.hit_body,
    loops.plain_at,
    loops.meet,
    loops.slope_normal,
    loops.triangle_normal,
    raster.sides,
    raster.extent,
    raster.fill,
    raster.cross,
    nogil=True,
    error_model="numpy",
)
