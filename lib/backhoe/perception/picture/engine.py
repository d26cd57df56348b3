"""The light of each pixel, compiled."""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.perception.picture import loops
from backhoe.perception.rays.loops import plain_at, slope_normal, triangle_normal

shade, show, *_ = compiled(
    loops.shade,
    loops.show,
    loops.light,
    loops.texture_at,
    plain_at,
    slope_normal,
    triangle_normal,
    nogil=True,
    error_model="numpy",
)
