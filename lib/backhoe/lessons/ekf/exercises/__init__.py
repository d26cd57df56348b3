"""The exercises of lesson 07, EKF: their references and the mistakes that they recognise."""

from backhoe.lessons.ekf.exercises.beliefs import BAYES, UPDATE
from backhoe.lessons.ekf.exercises.motion import CYCLE, JACOBIAN, NOISE
from backhoe.lessons.ekf.exercises.scores import NEES, NIS, RMSE
from backhoe.lessons.ekf.exercises.sensors import GRAVITY

__all__ = ["EXERCISES"]

EXERCISES = (BAYES, UPDATE, JACOBIAN, GRAVITY, NEES, NOISE, CYCLE, RMSE, NIS)
