"""The missions: load the truck, or drive a route, with parts that a student can replace.

`run()` digs and loads with the library's parts, `drive()` drives along a path; `run(name=mine)` and
`drive(name=mine)` swap one in. `PARTS` and `DRIVE_PARTS` say what each part takes and gives.
`score` sets a run beside the same run with the library's parts only. This is the one package that
knows all parts.
"""

from backhoe.mission.driving import DriveRun, drive
from backhoe.mission.loading import Run, run
from backhoe.mission.parts import (
    DRIVE_PARTS,
    PARTS,
    Part,
    WayPoint,
    hand_made_plan,
    parts,
    smooth_trajectory,
)
from backhoe.mission.recorded import drive_the_machine
from backhoe.mission.route import default_route
from backhoe.mission.score import DriveScore, Score, score

__all__ = [
    "DRIVE_PARTS",
    "PARTS",
    "DriveRun",
    "DriveScore",
    "Part",
    "Run",
    "Score",
    "WayPoint",
    "default_route",
    "drive",
    "drive_the_machine",
    "hand_made_plan",
    "parts",
    "run",
    "score",
    "smooth_trajectory",
]
