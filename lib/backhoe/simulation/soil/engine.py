"""The loops of `cells`, compiled by Numba on first use and kept on disk.

Only `terrain` imports this module, and only when soil moves: Numba takes half a second to load.
Records come as plain tuples: Numba takes those over faster.
"""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.simulation.soil import cells

dig, lay, relax, overflow, cut_depth, *_ = compiled(
    cells.dig,
    cells.lay,
    cells.relax,
    cells.overflow,
    cells.cut_depth,
    cells.turned,
    cells.grow,
    cells.lowest_neighbour,
    cells.slide,
    cells.drop_on,
    cells.height_at,
    cells.underside,
    cells.footprint,
)
