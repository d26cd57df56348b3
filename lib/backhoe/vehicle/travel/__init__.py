"""Travelling: the control of the tracks' speeds, a model of its step response, and the plant.

Source: Mastalli 2013, section 3.5. Two PI loops, one for the forward and one for the turning speed,
share the two tracks: `velocity`. What second-order models say about their steps: `model`. The
machine on its tracks in the simulation, driven by such a controller: `plant`.
"""

from backhoe.vehicle.travel.as_skid_steer import BACKHOE_TRACKS, tracks_vehicle
from backhoe.vehicle.travel.model import StepModel, TravelModel, inertia_for, model, yaw_inertia
from backhoe.vehicle.travel.posture import POSTURE
from backhoe.vehicle.travel.velocity import GAINS, VelocityPI, belt_forces, track_errors

__all__ = [
    "BACKHOE_TRACKS",
    "GAINS",
    "POSTURE",
    "StepModel",
    "TravelModel",
    "VelocityPI",
    "belt_forces",
    "inertia_for",
    "model",
    "track_errors",
    "tracks_vehicle",
    "yaw_inertia",
]
