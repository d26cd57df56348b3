"""Ways around obstacles: on grids, in the plane and for the arm."""

from __future__ import annotations

from backhoe.planning.search.arm_world import ArmWorld, Relief, few_spheres
from backhoe.planning.search.level import LevelWorld, pitch
from backhoe.planning.search.timing import Timed, in_time, segment_times

__all__ = [
    "ArmWorld",
    "LevelWorld",
    "Relief",
    "Timed",
    "few_spheres",
    "in_time",
    "pitch",
    "segment_times",
]
