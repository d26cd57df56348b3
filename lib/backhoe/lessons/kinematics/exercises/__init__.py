"""The exercises of lesson 01, kinematics: their references and the mistakes that they recognise."""

from backhoe.lessons.kinematics.exercises.inverse import INVERSE
from backhoe.lessons.kinematics.exercises.iteration import DAMPED, SOLVER
from backhoe.lessons.kinematics.exercises.posture import ANGLES, DEPTH, SIDE_VIEW
from backhoe.lessons.kinematics.exercises.tracks import TRACKS
from backhoe.lessons.kinematics.exercises.velocity import ANGULAR, GRADING

__all__ = ["EXERCISES"]

EXERCISES = (ANGLES, SIDE_VIEW, DEPTH, ANGULAR, GRADING, INVERSE, DAMPED, TRACKS, SOLVER)
