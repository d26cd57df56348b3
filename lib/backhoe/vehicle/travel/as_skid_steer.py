"""The backhoe on its tracks as a skid-steer vehicle, so that both go through the same models.

A track presses evenly on the ground along its length L. Four contact points at L/4 before and
behind the middle turn as heavily: both give the moment mu m g L/4. Linear laws of friction agree
with Coulomb's at the speeds of full drive.
"""

from __future__ import annotations

from functools import cache

from backhoe.machine import BACKHOE, Machine
from backhoe.vehicle.skid_steer.vehicle import Vehicle
from backhoe.vehicle.travel.model import yaw_inertia

RESPONSE_TIME = 0.2
"""Time in which the belts' speed control answers [s]: ours."""

SMOOTHING = 100.0
"""k_s of the ground under the shoes [s/m]: ours, half of the friction at 1 cm/s of slip."""


@cache
def tracks_vehicle(machine: Machine = BACKHOE) -> Vehicle:
    """A tracked machine as a vehicle, with the arm in the posture in which it travels.

    Args:
        machine: all numbers come from it; wheels stand for half a track each.

    Returns:
        The vehicle; its centre of mass is taken in the middle of the tracks (hypothesis 2).
    """
    tracks = machine.tracks
    lever, r = tracks.length / 4, tracks.sprocket_radius
    turning_speed = tracks.max_speed / (tracks.gauge / 2)
    inertia, _ = yaw_inertia(machine=machine)
    return Vehicle(
        mass=machine.mass,
        inertia=inertia,
        wheel_radius=r,
        half_track=tracks.gauge / 2,
        front=lever,
        rear=lever,
        wheel_mass=tracks.belt_mass / 2,
        wheel_inertia=tracks.belt_mass / 2 * r**2,
        wheel_width=tracks.shoe_width,
        body_length=tracks.length,
        body_width=tracks.gauge - tracks.shoe_width,
        body_height=tracks.height,
        clearance=tracks.height / 2,
        friction_longitudinal=tracks.friction_longitudinal,
        friction_lateral=tracks.friction_lateral,
        smoothing=SMOOTHING,
        rolling=tracks.rolling_resistance / tracks.max_speed,
        lateral=tracks.friction_lateral / (lever * turning_speed),
        speed_gain=machine.mass * r**2 / (4 * RESPONSE_TIME),
        gravity=machine.gravity,
    )


BACKHOE_TRACKS = tracks_vehicle()
