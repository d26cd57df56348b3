"""The exercises of lesson 01, kinematics: their references and the mistakes that they recognise."""

from backhoe.exercises.kinematics.inverse import DAMPED, INVERSE
from backhoe.exercises.kinematics.posture import ANGLES, DEPTH, SIDE_VIEW
from backhoe.exercises.kinematics.tracks import TRACKS
from backhoe.exercises.kinematics.velocity import ANGULAR, GRADING

__all__ = ["EXERCISES"]

EXERCISES = (ANGLES, SIDE_VIEW, DEPTH, ANGULAR, GRADING, INVERSE, DAMPED, TRACKS)
