"""The ground as heights with variance and age, and what is left over: things above it.

- `heights`: the map; `loops`: its work on a cell, `engine`: the same, compiled
- `layers`: soil told from what stands on it
- `levels`: several surfaces a cell, for comparison
- `volume`: soil dug between two scans, and how sure that is
"""

from __future__ import annotations

from backhoe.perception.terrain_map.heights import TerrainMap
from backhoe.perception.terrain_map.layers import is_soil
from backhoe.perception.terrain_map.levels import Levels, surface_levels
from backhoe.perception.terrain_map.volume import COMMON, Volume, dug_volume, shared_errors

__all__ = [
    "COMMON",
    "Levels",
    "TerrainMap",
    "Volume",
    "dug_volume",
    "is_soil",
    "shared_errors",
    "surface_levels",
]
