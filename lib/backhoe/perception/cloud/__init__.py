"""Clouds of points: thinned out, and rid of shadows, strays and the machine itself.

- `grid`: one centroid for each voxel; `engine`: its loop and the self filter's compiled
- `filters`: shadows along a scan, points with few or far neighbours
- `body`: points on the machine's own links

Source: Mastalli 2013, section 5.3; names and definitions are those of PCL (Rusu and Cousins 2011).
"""

from __future__ import annotations

from backhoe.perception.cloud.body import Convex, box, hull, self_filter
from backhoe.perception.cloud.filters import (
    incidence,
    radius_outliers,
    shadow_filter,
    statistical_outliers,
)
from backhoe.perception.cloud.grid import voxel_grid

__all__ = [
    "Convex",
    "box",
    "hull",
    "incidence",
    "radius_outliers",
    "self_filter",
    "shadow_filter",
    "statistical_outliers",
    "voxel_grid",
]
