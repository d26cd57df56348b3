"""Distances to the nearest obstacle, for planners: how near is the arm, and which way is out.

- `field`: the exact Euclidean transform, and what is asked of it; `loops`, `engine`: its loops
- `clearance`: spheres over the machine's links, and the least distance of all
"""

from __future__ import annotations

from backhoe.perception.distance_field.clearance import Clearance, clearance, covering_spheres
from backhoe.perception.distance_field.field import DistanceField, distance_transform

__all__ = ["Clearance", "DistanceField", "clearance", "covering_spheres", "distance_transform"]
