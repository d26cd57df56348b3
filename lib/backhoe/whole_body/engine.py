"""The loops of `loops`, compiled."""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.whole_body import loops

solve, _, programme, within = compiled(
    loops.solve, loops.solve_sized, loops.programme, loops.within
)
