"""The exercises of lessons 05a to 05c, path and trajectory tracking."""

from backhoe.lessons.path_tracking.exercises.controllers import SCAGLIA
from backhoe.lessons.path_tracking.exercises.errors import LIMITS, POSE_ERRORS
from backhoe.lessons.path_tracking.exercises.gain import GAIN
from backhoe.lessons.path_tracking.exercises.goal import GOAL
from backhoe.lessons.path_tracking.exercises.measuring import METRICS, MISSING
from backhoe.lessons.path_tracking.exercises.own import OWN
from backhoe.lessons.path_tracking.exercises.pursuit import PURSUIT

__all__ = ["EXERCISES"]

EXERCISES = (MISSING, METRICS, POSE_ERRORS, LIMITS, GOAL, SCAGLIA, PURSUIT, OWN, GAIN)
