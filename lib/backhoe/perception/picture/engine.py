"""The light of each pixel, compiled."""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.perception.picture import loops

shade, *_ = compiled(loops.shade, loops.texture_at, nogil=True, error_model="numpy")
