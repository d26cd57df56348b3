"""Skid-steer vehicles: four fixed wheels, or two tracks, that turn by slipping.

- `vehicle`: the numbers, `HUSKY` for one
- `tracked`: the backhoe on its tracks as such a vehicle, `BACKHOE_TRACKS`
- `kinematics`: wheel speeds, twist, pose, centre of rotation
- `identification`: the effective half track and the centre of rotation from logs
- `friction`: Coulomb, smooth and linear laws
- `linear_model`: the linear dynamic model, repaired
- `slipping`: the plane model with friction at each wheel
- `simulation`: many runs at once
- `plant`: one vehicle, step by step, for trackers

Source: D'Angelo 2022, chapter 2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from backhoe.skid_steer.friction import (
    coulomb,
    linear,
    linear_range,
    overestimate,
    slope,
    smooth,
    smooth_sign,
)
from backhoe.skid_steer.kinematics import (
    body_twist,
    constraint,
    contact_velocity,
    icr,
    pose_rate,
    wheel_speeds,
    world_velocity,
)
from backhoe.skid_steer.linear_model import (
    Rates,
    StateSpace,
    control_system,
    fit,
    radius,
    rates,
    ratios,
    state_space,
    steady_state,
    step_response,
)
from backhoe.skid_steer.tracked import tracks_vehicle
from backhoe.skid_steer.vehicle import HUSKY, PROVENANCE, WHEELS, Vehicle, replace

if TYPE_CHECKING:
    BACKHOE_TRACKS: Vehicle

__all__ = [
    "BACKHOE_TRACKS",
    "HUSKY",
    "PROVENANCE",
    "WHEELS",
    "Rates",
    "StateSpace",
    "Vehicle",
    "body_twist",
    "constraint",
    "contact_velocity",
    "control_system",
    "coulomb",
    "fit",
    "icr",
    "linear",
    "linear_range",
    "overestimate",
    "pose_rate",
    "radius",
    "rates",
    "ratios",
    "replace",
    "slope",
    "smooth",
    "smooth_sign",
    "state_space",
    "steady_state",
    "step_response",
    "tracks_vehicle",
    "wheel_speeds",
    "world_velocity",
]


def __getattr__(name: str) -> Vehicle:
    """`BACKHOE_TRACKS` is made on first use: it needs the dynamics of the whole machine."""
    if name == "BACKHOE_TRACKS":
        return tracks_vehicle()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
