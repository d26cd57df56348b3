"""The loops of `loops`, compiled on first use and kept on disk."""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.perception.cloud import loops

extent, gather, outside = compiled(loops.extent, loops.gather, loops.outside)
