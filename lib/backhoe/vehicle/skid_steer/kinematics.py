"""Kinematics of a skid-steer vehicle: wheel speeds, body velocities, the centre of rotation.

Axes of the vehicle: x forward, y left; heading theta from the world's x axis, anticlockwise. Sides
are always in the order left, right. The wheels roll without longitudinal slip here; what lateral
slip does is `slipping`.

Source: D'Angelo 2022, section 2.2, eqs. (2.1) to (2.6).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers, positive
from backhoe.basics.se2 import sides_of_twist, twist_of_sides
from backhoe.vehicle.skid_steer.vehicle import HUSKY, Vehicle


def wheel_speeds(
    twist: ArrayLike, vehicle: Vehicle = HUSKY, *, half_track: float | None = None
) -> NDArray:
    """Speeds of the wheels that give a twist, if no wheel slips along its rim.

    Source: D'Angelo 2022, eq. (2.2).

    Args:
        twist: forward and turning speed v_x, omega_z, shape (..., 2) [m/s, rad/s].
        vehicle: its wheel radius and half track count.
        half_track: used for c instead of the vehicle's own: the effective half track that
            `identify` finds makes up for slip [m].

    Returns:
        Speeds of the left and right wheels, shape (..., 2) [rad/s].

    Raises:
        ValueError: twist does not end in 2 finite numbers, or half_track is not positive.
    """
    twist = numbers(twist, "twist", (..., 2), meaning="values (v_x, omega_z)")
    gauge = 2 * half_track_of(vehicle, half_track)
    sides = sides_of_twist(twist[..., 0], twist[..., 1], gauge)
    return np.stack(sides, axis=-1) / vehicle.wheel_radius


def body_twist(
    left: ArrayLike,
    right: ArrayLike,
    vehicle: Vehicle = HUSKY,
    *,
    half_track: float | None = None,
) -> NDArray:
    """Forward and turning speed from wheel speeds: the inverse of `wheel_speeds`.

    Source: D'Angelo 2022, eq. (2.3).

    Args:
        left, right: speeds of the wheels of each side, shape (...) [rad/s].
        vehicle, half_track: as for `wheel_speeds`.

    Returns:
        v_x and omega_z, shape (..., 2) [m/s, rad/s].

    Raises:
        ValueError: left and right differ in shape, a value is not a finite number, or half_track
            is not positive.
    """
    r, gauge = vehicle.wheel_radius, 2 * half_track_of(vehicle, half_track)
    left, right = r * numbers(left, "left"), r * numbers(right, "right")
    return np.stack(twist_of_sides(left, right, gauge), axis=-1)


def world_velocity(theta: ArrayLike, velocity: ArrayLike) -> NDArray:
    """Velocity in the world from the vehicle's own: a rotation by the heading.

    Source: D'Angelo 2022, eq. (2.1).

    Args:
        theta: heading, shape (...) [rad].
        velocity: v_x, v_y, omega_z, shape (..., 3) [m/s, m/s, rad/s].

    Returns:
        dX, dY, dtheta, shape (..., 3) [m/s, m/s, rad/s].

    Raises:
        ValueError: velocity does not end in 3 finite numbers, or theta is not finite.
    """
    theta, velocity = numbers(theta, "theta"), _velocity(velocity)
    v_x, v_y, omega = velocity[..., 0], velocity[..., 1], velocity[..., 2]
    cos, sin = np.cos(theta), np.sin(theta)
    return np.stack(
        np.broadcast_arrays(cos * v_x - sin * v_y, sin * v_x + cos * v_y, omega), axis=-1
    )


def pose_rate(theta: ArrayLike, twist: ArrayLike, x_icr: float = 0.0) -> NDArray:
    """How fast the pose changes, with the lateral speed that the constraint (2.5) gives.

    Source: D'Angelo 2022, eq. (2.6); with x_icr = 0 it is the differential drive of (2.4).

    Args:
        theta: heading, shape (...) [rad].
        twist: forward and turning speed, shape (..., 2) [m/s, rad/s].
        x_icr: longitudinal coordinate of the centre of rotation [m].

    Returns:
        dX, dY, dtheta, shape (..., 3) [m/s, m/s, rad/s].

    Raises:
        ValueError: twist does not end in 2 finite numbers, or theta or x_icr is not finite.
    """
    twist = numbers(twist, "twist", (..., 2), meaning="values (v_x, omega_z)")
    lateral = -number(x_icr, "x_icr", "m") * twist[..., 1]
    return world_velocity(theta, np.stack([twist[..., 0], lateral, twist[..., 1]], axis=-1))


def contact_velocity(
    velocity: ArrayLike, wheels: ArrayLike | None = None, vehicle: Vehicle = HUSKY
) -> NDArray:
    """Velocity of each wheel's contact point over the ground: its slip, along and across.

    A wheel at (x_i, y_i) moves with (v_x - omega_z y_i, v_y + omega_z x_i); what touches the ground
    runs backwards by r omega_i. So even with v_y = 0, that is x_ICR = 0, a wheel of the front axle
    slides sideways with a omega_z.

    Args:
        velocity: v_x, v_y, omega_z of the body, shape (..., 3) [m/s, m/s, rad/s].
        wheels: speeds of the wheels in the order of `WHEELS`, shape (..., 4) [rad/s], or None for
            wheels that roll without slip along their rim.
        vehicle: where its wheels are.

    Returns:
        Slip velocities, shape (..., 4, 2) [m/s].

    Raises:
        ValueError: velocity does not end in 3, or wheels in 4 finite numbers.
    """
    velocity = _velocity(velocity)
    x, y = vehicle.positions.T
    v_x, v_y, omega = (velocity[..., i, None] for i in range(3))
    along, across = v_x - omega * y, v_y + omega * x
    if wheels is None:
        along = np.zeros_like(along)
    else:
        wheels = numbers(wheels, "wheels", (..., 4), meaning="speeds of wheels")
        along = along - vehicle.wheel_radius * wheels
    return np.stack(np.broadcast_arrays(along, across), axis=-1)


def half_track_of(vehicle: Vehicle, half_track: float | None) -> float:
    """The half track given, or the vehicle's own if there is none [m]."""
    return vehicle.half_track if half_track is None else positive(half_track, "half_track", "m")


def _velocity(velocity: ArrayLike) -> NDArray:
    return numbers(velocity, "velocity", (..., 3), meaning="values (v_x, v_y, omega_z)")
