"""Travelling: the control of the tracks' speeds, and a model of its step response.

Source: Mastalli 2013, section 3.5. Two PI loops, one for the forward and one for the turning speed,
share the two tracks: `velocity`. What second-order models say about their steps: `model`. The
machine as a skid-steer vehicle: `as_skid_steer`.
"""

from backhoe.vehicle.travel.as_skid_steer import BACKHOE_TRACKS
from backhoe.vehicle.travel.model import StepModel, TravelModel, model, yaw_inertia
from backhoe.vehicle.travel.posture import POSTURE
from backhoe.vehicle.travel.velocity import GAINS, VelocityPI, limited, tractions

__all__ = [
    "BACKHOE_TRACKS",
    "GAINS",
    "POSTURE",
    "StepModel",
    "TravelModel",
    "VelocityPI",
    "limited",
    "model",
    "tractions",
    "yaw_inertia",
]
