"""The matcher's loops, compiled; a thread each where there are rows enough."""

from __future__ import annotations

from backhoe.basics.engine import compiled
from backhoe.perception.stereo import loops, paths

sobel_response, normalised_response, match_rows, keep_consistent, drop_speckles = compiled(
    loops.sobel_response,
    loops.normalised_response,
    loops.match_rows,
    loops.keep_consistent,
    loops.drop_speckles,
    nogil=True,
)

window_costs, add_paths, cheapest = compiled(
    paths.window_costs, paths.add_paths, paths.cheapest, nogil=True
)
