"""The whole mission alone: look, choose, dig, load, until the truck is full.

- `choice`: where to dig; `heaps`: how much soil a choice brings
"""

from backhoe.mission.autonomy.choice import (
    DIRECTIONS,
    REACHES,
    Strip,
    best_strip,
    cut_depth,
    cycle_time,
    edge,
    edge_height,
    expected_fill,
    highest_strip,
    polar,
    random_strip,
    side_load,
    stroke,
)
from backhoe.mission.autonomy.heaps import Loads, heap_site, job, seen

__all__ = [
    "DIRECTIONS",
    "REACHES",
    "Loads",
    "Strip",
    "best_strip",
    "cut_depth",
    "cycle_time",
    "edge",
    "edge_height",
    "expected_fill",
    "heap_site",
    "highest_strip",
    "job",
    "polar",
    "random_strip",
    "seen",
    "side_load",
    "stroke",
]
