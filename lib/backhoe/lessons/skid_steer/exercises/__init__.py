"""The exercises of lessons 04a to 04c: their references and the mistakes that they recognise."""

from backhoe.lessons.skid_steer.exercises.model import RATES
from backhoe.lessons.skid_steer.exercises.regulator import SAMPLED_PI
from backhoe.lessons.skid_steer.exercises.tracks import LIMITED, TRACTIONS
from backhoe.lessons.skid_steer.exercises.wheel_motor import GAINS, GEARED
from backhoe.lessons.skid_steer.exercises.wheels import HALF_TRACK, SIDE_SLIP, WHEELS

__all__ = ["EXERCISES"]

EXERCISES = (WHEELS, SIDE_SLIP, HALF_TRACK, RATES, GEARED, SAMPLED_PI, GAINS, TRACTIONS, LIMITED)
