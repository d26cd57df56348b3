"""The exercises of lesson 05, path and trajectory tracking."""

from backhoe.exercises.path_tracking.controllers import SCAGLIA
from backhoe.exercises.path_tracking.errors import LIMITS, POSE_ERRORS
from backhoe.exercises.path_tracking.goal import GOAL
from backhoe.exercises.path_tracking.measuring import METRICS, MISSING
from backhoe.exercises.path_tracking.own import OWN
from backhoe.exercises.path_tracking.pursuit import PURSUIT

__all__ = ["EXERCISES"]

EXERCISES = (MISSING, METRICS, POSE_ERRORS, LIMITS, GOAL, SCAGLIA, PURSUIT, OWN)
