"""The mission: dig, swing and load the truck, with parts that a student can replace.

`run()` drives the simulated machine along way-points with the library's parts; `run(name=mine)`
swaps one in. `PARTS` says what each part takes and gives. `score` sets a run beside the same run
with the library's parts only. This is the one package that knows all parts.
"""

from backhoe.mission.drive import Run, run
from backhoe.mission.parts import PARTS, Part, WayPoint, hand_made_plan, parts, smooth_trajectory
from backhoe.mission.score import Score, score

__all__ = [
    "PARTS",
    "Part",
    "Run",
    "Score",
    "WayPoint",
    "hand_made_plan",
    "parts",
    "run",
    "score",
    "smooth_trajectory",
]
