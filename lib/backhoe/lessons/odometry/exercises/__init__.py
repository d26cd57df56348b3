"""The exercises of lesson 06, odometry: their references and the mistakes that they recognise."""

from backhoe.lessons.odometry.exercises.encoder import TICKS
from backhoe.lessons.odometry.exercises.log import LOG
from backhoe.lessons.odometry.exercises.robots import JACOBIAN
from backhoe.lessons.odometry.exercises.square import SQUARES
from backhoe.lessons.odometry.exercises.steps import ARC, TRAPEZOID
from backhoe.lessons.odometry.exercises.sums import ORDER, WAY
from backhoe.lessons.odometry.exercises.tracks import ODOMETRY

__all__ = ["EXERCISES"]

EXERCISES = (WAY, ORDER, JACOBIAN, TRAPEZOID, ARC, TICKS, SQUARES, ODOMETRY, LOG)
