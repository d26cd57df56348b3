"""Two cameras side by side: which pixels belong together, and how far away they are.

- `block_matching`: disparities by sums of absolute differences
- `semi_global`: the same with neighbours that are listened to
- `points`: points in space from disparities, and how far to trust them
- `loops`, `paths`: the matchers' loops, written once
- `engine`: the same, compiled
"""

from backhoe.perception.stereo.block_matching import PREFILTERS, block_match, prefiltered
from backhoe.perception.stereo.points import depth, depth_deviation, point_covariance, reproject
from backhoe.perception.stereo.semi_global import semi_global_match

__all__ = [
    "PREFILTERS",
    "block_match",
    "depth",
    "depth_deviation",
    "point_covariance",
    "prefiltered",
    "reproject",
    "semi_global_match",
]
