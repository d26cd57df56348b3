"""The exercises of lesson 04, skid-steer: their references and the mistakes that they recognise."""

from backhoe.exercises.skid_steer.model import RATES
from backhoe.exercises.skid_steer.regulator import SAMPLED_PI
from backhoe.exercises.skid_steer.tracks import TRACTIONS
from backhoe.exercises.skid_steer.wheel_motor import GAINS, GEARED
from backhoe.exercises.skid_steer.wheels import HALF_TRACK, SIDE_SLIP, WHEELS

__all__ = ["EXERCISES"]

EXERCISES = (WHEELS, SIDE_SLIP, HALF_TRACK, RATES, GEARED, SAMPLED_PI, GAINS, TRACTIONS)
