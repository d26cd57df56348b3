"""The loops of `loops`, compiled on first use and kept on disk."""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.perception.terrain_map import loops

gather, slopes, lift, update, envelope, _ = compiled(
    loops.gather, loops.slopes, loops.lift, loops.update, loops.envelope, loops.slope
)
