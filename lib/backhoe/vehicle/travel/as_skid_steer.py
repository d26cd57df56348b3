"""The backhoe on its tracks as a skid-steer vehicle, so that both go through the same models.

A track presses evenly on the ground along its length L. Four contact points at L/4 before and
behind the middle turn as heavily: both give the moment mu m g L/4. Linear laws of friction agree
with Coulomb's at the speeds of full drive.
"""

from __future__ import annotations

from backhoe.basics.named import named
from backhoe.machine import BACKHOE
from backhoe.vehicle.skid_steer.vehicle import Vehicle
from backhoe.vehicle.travel.model import yaw_inertia

_TRACKS = BACKHOE.tracks
_LEVER, _RADIUS = _TRACKS.length / 4, _TRACKS.sprocket_radius
_TURN_RATE = _TRACKS.max_speed / (_TRACKS.gauge / 2)

_RESPONSE_TIME = 0.2
"""Time in which the belts' speed control answers [s]: ours."""

BACKHOE_TRACKS = named(
    "BACKHOE_TRACKS",
    Vehicle(
        mass=BACKHOE.mass,
        inertia=yaw_inertia()[0],
        wheel_radius=_RADIUS,
        half_track=_TRACKS.gauge / 2,
        front=_LEVER,
        rear=_LEVER,
        wheel_mass=_TRACKS.belt_mass / 2,
        wheel_inertia=_TRACKS.belt_mass / 2 * _RADIUS**2,
        wheel_width=_TRACKS.shoe_width,
        body_length=_TRACKS.length,
        body_width=_TRACKS.gauge - _TRACKS.shoe_width,
        body_height=_TRACKS.height,
        clearance=_TRACKS.height / 2,
        friction_longitudinal=_TRACKS.friction_longitudinal,
        friction_lateral=_TRACKS.friction_lateral,
        smoothing=100.0,  # ours [s/m]: half of the friction at 1 cm/s of slip
        rolling=_TRACKS.rolling_resistance / _TRACKS.max_speed,
        lateral=_TRACKS.friction_lateral / (_LEVER * _TURN_RATE),
        speed_gain=BACKHOE.mass * _RADIUS**2 / (4 * _RESPONSE_TIME),
        gravity=BACKHOE.gravity,
    ),
)
"""The machine with its arm in `POSTURE`: a wheel stands for half a track, and the centre of mass
is taken in the middle of the tracks (hypothesis 2)."""
