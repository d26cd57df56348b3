"""The exercises of lesson 07, EKF: their references and the mistakes that they recognise."""

from backhoe.lessons.ekf.exercises.beliefs import BAYES
from backhoe.lessons.ekf.exercises.cycle import CYCLE
from backhoe.lessons.ekf.exercises.honesty import NEES, RMSE
from backhoe.lessons.ekf.exercises.motion import JACOBIAN, NOISE
from backhoe.lessons.ekf.exercises.sensors import GRAVITY
from backhoe.lessons.ekf.exercises.update import UPDATE

__all__ = ["EXERCISES"]

EXERCISES = (BAYES, UPDATE, JACOBIAN, GRAVITY, NEES, NOISE, CYCLE, RMSE)
