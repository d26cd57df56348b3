"""Rays through heightmaps and meshes, compiled."""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.perception.rays import loops

cast, *_ = compiled(
    loops.cast,
    loops.hit_cell,
    loops.hit_field,
    loops.box_entry,
    loops.hit_triangle,
    loops.hit_body,
    nogil=True,
    error_model="numpy",
)
