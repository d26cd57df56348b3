"""The loops of `loops`, compiled on first use and kept on disk."""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.perception.cloud import loops

extent, count, deal, gather, outside, _ = compiled(
    loops.extent, loops.count, loops.deal, loops.gather, loops.outside, loops.mixed
)
