"""The missions: load the truck, drive a route, or look around, with parts a student can replace.

`run()` digs and loads with the library's parts, `drive()` drives along a path, `survey()` keeps a
map of the work; `run(name=mine)` swaps one in, and so on. `PARTS`, `DRIVE_PARTS` and `SURVEY_PARTS`
say what each part takes and gives. `score` sets a run beside the same run with the library's parts
only. This is the one package that knows all parts.
"""

from backhoe.mission.driving import DriveRun, drive
from backhoe.mission.loading import Run, run
from backhoe.mission.parts import (
    DRIVE_PARTS,
    PARTS,
    SURVEY_PARTS,
    Part,
    WayPoint,
    hand_made_plan,
    parts,
    smooth_trajectory,
)
from backhoe.mission.recorded import drive_the_machine
from backhoe.mission.route import default_route
from backhoe.mission.score import DriveScore, Score, SurveyScore, score
from backhoe.mission.surveying import SurveyRun, survey

__all__ = [
    "DRIVE_PARTS",
    "PARTS",
    "SURVEY_PARTS",
    "DriveRun",
    "DriveScore",
    "Part",
    "Run",
    "Score",
    "SurveyRun",
    "SurveyScore",
    "WayPoint",
    "default_route",
    "drive",
    "drive_the_machine",
    "hand_made_plan",
    "parts",
    "run",
    "score",
    "smooth_trajectory",
    "survey",
]
