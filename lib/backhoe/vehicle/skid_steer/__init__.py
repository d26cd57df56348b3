"""Skid-steer vehicles: four fixed wheels, or two tracks, that turn by slipping.

- `vehicle`: the numbers, `HUSKY` for one
- `kinematics`: wheel speeds, twist, pose, centre of rotation
- `identification`: the effective half track and the centre of rotation from logs
- `friction`: Coulomb, smooth and linear laws
- `linear_model`: the linear dynamic model, repaired
- `slipping`: the plane model with friction at each wheel; `engine`: the same compiled
- `wheel_control`: proportional, or motors with PIDs; `no_slip`: the models without slip
- `runs`: many runs at once, with every model
- `plant`: one vehicle, step by step, for trackers

Source: D'Angelo 2022, chapter 2.
"""

from __future__ import annotations

from dataclasses import replace

from backhoe.vehicle.skid_steer.friction import (
    coulomb,
    linear,
    linear_range,
    overestimate,
    slope,
    smooth,
    smooth_sign,
)
from backhoe.vehicle.skid_steer.identification import Identification, effective_half_track, identify
from backhoe.vehicle.skid_steer.kinematics import (
    body_twist,
    contact_velocity,
    pose_rate,
    wheel_speeds,
    world_velocity,
)
from backhoe.vehicle.skid_steer.linear_model import (
    Rates,
    StateSpace,
    fit,
    radius,
    rates,
    state_space,
    steady_state,
    step_response,
)
from backhoe.vehicle.skid_steer.plant import SkidSteerPlant
from backhoe.vehicle.skid_steer.runs import Runs, simulate
from backhoe.vehicle.skid_steer.slipping import (
    contact_forces,
    friction_power,
    state_rate,
    turning_half_track,
)
from backhoe.vehicle.skid_steer.vehicle import HUSKY, PROVENANCE, WHEELS, Vehicle

__all__ = [
    "HUSKY",
    "PROVENANCE",
    "WHEELS",
    "Identification",
    "Rates",
    "Runs",
    "SkidSteerPlant",
    "StateSpace",
    "Vehicle",
    "body_twist",
    "contact_forces",
    "contact_velocity",
    "coulomb",
    "effective_half_track",
    "fit",
    "friction_power",
    "identify",
    "linear",
    "linear_range",
    "overestimate",
    "pose_rate",
    "radius",
    "rates",
    "replace",
    "simulate",
    "slope",
    "smooth",
    "smooth_sign",
    "state_rate",
    "state_space",
    "steady_state",
    "step_response",
    "turning_half_track",
    "wheel_speeds",
    "world_velocity",
]
