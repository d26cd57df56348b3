"""The loops of `loops`, compiled on first use and kept on disk."""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.perception.distance_field import loops

squared_distances, _ = compiled(loops.squared_distances, loops.lower_envelope)
