"""Ways around obstacles: on grids, in the plane and for the arm.

- `grid`: A*; `potential`: a field's slope; `tangent`: the exact shortest way in the plane
- `roadmap`, `trees`, `connect`: PRM, RRT and RRT*, RRT-Connect; `smoothing`: shortcuts
- `checker`: what they ask, with a time limit; `arm_world`: the arm among obstacles; `engine`
  compiles RRT-Connect for it from `grow` and `arm_loops`
"""

from __future__ import annotations

from backhoe.planning.search.arm_world import ArmWorld, Relief, few_spheres
from backhoe.planning.search.checker import Log, NoPath, path_length
from backhoe.planning.search.connect import rrt_connect
from backhoe.planning.search.grid import astar, best_first
from backhoe.planning.search.level import LevelWorld, pitch
from backhoe.planning.search.potential import Descent, potential
from backhoe.planning.search.roadmap import prm
from backhoe.planning.search.smoothing import shortcut
from backhoe.planning.search.tangent import Shortest, tangent
from backhoe.planning.search.timing import Timed, in_time, segment_times
from backhoe.planning.search.trees import rrt, rrt_star, steer

__all__ = [
    "ArmWorld",
    "Descent",
    "LevelWorld",
    "Log",
    "NoPath",
    "Relief",
    "Shortest",
    "Timed",
    "astar",
    "best_first",
    "few_spheres",
    "in_time",
    "path_length",
    "pitch",
    "potential",
    "prm",
    "rrt",
    "rrt_connect",
    "rrt_star",
    "segment_times",
    "shortcut",
    "steer",
    "tangent",
]
