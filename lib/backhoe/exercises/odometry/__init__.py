"""The exercises of lesson 06, odometry: their references and the mistakes that they recognise."""

from backhoe.exercises.odometry.encoder import TICKS
from backhoe.exercises.odometry.robots import JACOBIAN
from backhoe.exercises.odometry.square import SQUARES
from backhoe.exercises.odometry.steps import ARC, TRAPEZOID
from backhoe.exercises.odometry.sums import ORDER, WAY
from backhoe.exercises.odometry.tracks import ODOMETRY

__all__ = ["EXERCISES"]

EXERCISES = (WAY, ORDER, JACOBIAN, TRAPEZOID, ARC, TICKS, SQUARES, ODOMETRY)
