"""The loops of `loops`, compiled."""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.whole_body import loops

solve, programme, within = compiled(loops.solve, loops.programme, loops.within)
