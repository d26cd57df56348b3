"""Travelling: the control of the tracks' speeds, a model of its step response, and the plant.

Source: Mastalli 2013, section 3.5. Two PI loops, one for the forward and one for the turning speed,
share the two tracks: `velocity`. What second-order models say about their steps: `model`. The
machine on its tracks in the simulation, driven by such a controller: `plant`.
"""

from backhoe.travel.model import (
    StepModel,
    TravelModel,
    inertia_for,
    model,
    yaw_inertia,
)
from backhoe.travel.plant import TrackedPlant
from backhoe.travel.posture import POSTURE
from backhoe.travel.velocity import VelocityPI, belt_forces, printed_gains, track_errors

__all__ = [
    "POSTURE",
    "StepModel",
    "TrackedPlant",
    "TravelModel",
    "VelocityPI",
    "belt_forces",
    "inertia_for",
    "model",
    "printed_gains",
    "track_errors",
    "yaw_inertia",
]
