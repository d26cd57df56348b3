"""The plane model with slip: a rigid body on four wheels, Coulomb friction at each contact.

State: X, Y, theta of the centre of mass in the world, v_x, v_y, omega in the vehicle's own axes,
and the speeds of the four wheels in the order of `WHEELS`; shape (..., 10).

    m (dv_x - v_y omega) = sum F_x            I domega = sum (x_i F_y - y_i F_x)
    m (dv_y + v_x omega) = sum F_y            J dw_i   = tau_i - r F_x - N_i K_x r^2 w_i

The force of a wheel opposes its slip velocity s = `contact_velocity`, with the smooth Coulomb law
(2.10): F = -N (2/pi) arctan(k_s |s|) (mu_x s_x, mu_y s_y)/|s|. So there is one friction for both
directions, and a wheel that slides sideways holds less along its rim. Loads are those of statics.

Nothing here is in the source but its law of friction: its model neglects the lateral forces.
"""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative, numbers
from backhoe.vehicle.skid_steer.kinematics import contact_velocity, world_velocity
from backhoe.vehicle.skid_steer.vehicle import HUSKY, Vehicle


def contact_forces(slip: ArrayLike, vehicle: Vehicle = HUSKY) -> NDArray:
    """Friction forces of the ground on the wheels.

    Args:
        slip: velocity of each contact along and across the wheel, shape (..., 4, 2) [m/s].
        vehicle: its loads, coefficients and k_s.

    Returns:
        Forces along x and y of the vehicle, shape (..., 4, 2) [N].

    Raises:
        ValueError: slip does not end in (4, 2) finite numbers.
    """
    slip = numbers(slip, "slip", (..., 4, 2), meaning="along and across of four wheels")
    speed = np.hypot(slip[..., 0], slip[..., 1])
    at_rest = np.full_like(speed, 2 / pi * vehicle.smoothing)
    share = np.arctan(vehicle.smoothing * speed) * 2 / pi
    grip = vehicle.loads * np.divide(share, speed, out=at_rest, where=speed > 0)
    return -grip[..., None] * slip * [vehicle.friction_longitudinal, vehicle.friction_lateral]


def state_rate(
    state: ArrayLike, torque: ArrayLike, vehicle: Vehicle = HUSKY, *, rotor_inertia: float = 0.0
) -> NDArray:
    """Rate of change of the state: the equations of motion.

    Args:
        state: X, Y, theta, v_x, v_y, omega, wheel speeds, shape (..., 10) [m, m, rad, m/s, m/s,
            rad/s, rad/s].
        torque: of the drives on the wheels, shape (..., 4) [N m].
        vehicle: its numbers.
        rotor_inertia: of what turns with each wheel, seen at the wheel [kg m^2].

    Returns:
        Shape (..., 10) [units of the state per s].

    Raises:
        ValueError: state does not end in 10, or torque in 4 finite numbers.
    """
    state = _state(state)
    torque = numbers(torque, "torque", (..., 4), meaning="torques of wheels")
    velocity, wheels = state[..., 3:6], state[..., 6:]
    force = contact_forces(contact_velocity(velocity, wheels, vehicle), vehicle)
    x, y = vehicle.positions.T
    along, across = force[..., 0], force[..., 1]
    v_x, v_y, omega = np.moveaxis(velocity, -1, 0)
    r, rolling = vehicle.wheel_radius, vehicle.loads * vehicle.rolling
    inertia = vehicle.wheel_inertia + not_negative(rotor_inertia, "rotor_inertia", "kg m^2")
    body = [
        along.sum(-1) / vehicle.mass + v_y * omega,
        across.sum(-1) / vehicle.mass - v_x * omega,
        (x * across - y * along).sum(-1) / vehicle.inertia,
    ]
    spin = torque - r * along - rolling * r**2 * wheels
    return np.concatenate(
        [
            world_velocity(state[..., 2], velocity),
            np.stack(body, axis=-1),
            spin / inertia,
        ],
        axis=-1,
    )


def friction_power(state: ArrayLike, vehicle: Vehicle = HUSKY) -> NDArray:
    """Power of friction at the contacts and of the resistance to rolling [W], never positive.

    Args:
        state: as for `state_rate`, shape (..., 10).
        vehicle: its numbers.

    Returns:
        Shape (...) [W].

    Raises:
        ValueError: state does not end in 10 finite numbers.
    """
    state = _state(state)
    slip = contact_velocity(state[..., 3:6], state[..., 6:], vehicle)
    rolled = vehicle.wheel_radius * state[..., 6:]
    sliding = (contact_forces(slip, vehicle) * slip).sum((-1, -2))
    return sliding - (vehicle.loads * vehicle.rolling * rolled**2).sum(-1)


def turning_half_track(vehicle: Vehicle = HUSKY) -> float:
    """Half track that a vehicle turning in place seems to have, c + (mu_y/mu_x) a^2/c [m].

    Turning steadily without resistance to rolling, the wheels' longitudinal and lateral forces
    balance about the centre: c F_x = a F_y. Both come from one slip vector, so their ratio is
    mu_x s_x / (mu_y s_y), with s_y = a omega: load, k_s and speed drop out.

    Args:
        vehicle: with axles equally far from the centre of mass.

    Returns:
        y_ICR of the wheels, r (omega_R - omega_L)/(2 omega) [m].

    Raises:
        ValueError: front and rear differ: then the forces across do not balance by symmetry; or
            there is no friction along the wheels, and nothing drives the turn.
    """
    if vehicle.friction_longitudinal == 0:
        raise ValueError("turning_half_track needs friction along the wheels, got 0")
    if vehicle.front != vehicle.rear:
        raise ValueError(
            "turning_half_track needs front = rear, got "
            f"{vehicle.front} and {vehicle.rear} m: simulate the turn instead"
        )
    share = vehicle.friction_lateral / vehicle.friction_longitudinal
    return vehicle.half_track + share * vehicle.front**2 / vehicle.half_track


def _state(state: ArrayLike) -> NDArray:
    return numbers(state, "state", (..., 10), meaning="values (pose, velocity, wheel speeds)")
