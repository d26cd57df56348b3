"""The exercises of lesson 07, EKF: their references and the mistakes that they recognise."""

from backhoe.exercises.kalman.beliefs import BAYES
from backhoe.exercises.kalman.cycle import CYCLE
from backhoe.exercises.kalman.honesty import NEES, RMSE
from backhoe.exercises.kalman.motion import JACOBIAN, NOISE
from backhoe.exercises.kalman.sensors import GRAVITY
from backhoe.exercises.kalman.update import UPDATE

__all__ = ["EXERCISES"]

EXERCISES = (BAYES, UPDATE, JACOBIAN, GRAVITY, NEES, NOISE, CYCLE, RMSE)
