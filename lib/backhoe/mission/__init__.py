"""The missions: load the truck, drive, look around or grade, with parts a student can replace.

`run()` digs and loads with the library's parts, `lift()` carries a load, `drive()` drives along a
path, `obey()` is given hard orders, `hold()` an unknown load and a rock, `survey()` keeps a map of
the work, `grade()` draws a slope; `run(name=mine)` swaps a part in, and so on. `PARTS`,
`LIFT_PARTS`, `DRIVE_PARTS`, `SURVEY_PARTS` and `GRADE_PARTS` say what each part takes and gives.
`score` sets a run beside the same run with the library's parts only. This is the one package that
knows all parts.
"""

from backhoe.mission.design import SlopeDesign, TrenchDesign
from backhoe.mission.driving import DriveRun, drive
from backhoe.mission.grading import GradingRun, grade
from backhoe.mission.holding import HoldRun, HoldScore, hold
from backhoe.mission.lifting import LiftRun, LiftScore, lift
from backhoe.mission.loading import Run, run
from backhoe.mission.orders import OrderRun, OrderScore, obey
from backhoe.mission.parts import (
    DRIVE_PARTS,
    GRADE_PARTS,
    LIFT_PARTS,
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
from backhoe.mission.surface import SurfaceScore
from backhoe.mission.surveying import SurveyRun, survey

__all__ = [
    "DRIVE_PARTS",
    "GRADE_PARTS",
    "LIFT_PARTS",
    "PARTS",
    "SURVEY_PARTS",
    "DriveRun",
    "DriveScore",
    "GradingRun",
    "HoldRun",
    "HoldScore",
    "LiftRun",
    "LiftScore",
    "OrderRun",
    "OrderScore",
    "Part",
    "Run",
    "Score",
    "SlopeDesign",
    "SurfaceScore",
    "SurveyRun",
    "SurveyScore",
    "TrenchDesign",
    "WayPoint",
    "default_route",
    "drive",
    "drive_the_machine",
    "grade",
    "hand_made_plan",
    "hold",
    "lift",
    "obey",
    "parts",
    "run",
    "score",
    "smooth_trajectory",
    "survey",
]
