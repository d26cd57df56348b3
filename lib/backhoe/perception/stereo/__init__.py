"""Two cameras side by side: which pixels belong together, and how far away they are.

- `block_matching`: disparities by sums of absolute differences
- `points`: points in space from disparities, and how far to trust them
- `loops`: the matcher's loops, written once
- `engine`: the same, compiled
"""

from backhoe.perception.stereo.block_matching import PREFILTERS, block_match, prefiltered
from backhoe.perception.stereo.points import depth, depth_deviation, point_covariance, reproject

__all__ = [
    "PREFILTERS",
    "block_match",
    "depth",
    "depth_deviation",
    "point_covariance",
    "prefiltered",
    "reproject",
]
