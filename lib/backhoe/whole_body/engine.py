"""The loop of `loops`, compiled."""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.whole_body import loops

(solve,) = compiled(loops.solve)
