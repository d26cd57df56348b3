"""Octree maps: occupied, free and unknown space in cubes of several sizes.

- `tree`: the map, its queries, its files
- `log_odds`: what a look adds to a voxel, and how many looks a map takes to keep up
- `rays`: which voxels a scan passes and hits; `nodes`: the octree in arrays; `queries`, `stream`:
  answers and files; `engine`: all four compiled
- `files`: the headers of OctoMap's `.bt` and `.ot`

Source: Mastalli 2013, section 5.4, eqs. (5.2) to (5.6).
"""

from __future__ import annotations

from backhoe.perception.octree.log_odds import looks_until, updated
from backhoe.perception.octree.tree import POLICIES, RULES, Leaves, Met, OccupancyOctree

__all__ = [
    "POLICIES",
    "RULES",
    "Leaves",
    "Met",
    "OccupancyOctree",
    "looks_until",
    "updated",
]
