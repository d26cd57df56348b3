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

from backhoe.vehicle.skid_steer.kinematics import _ending_in, contact_velocity, world_velocity
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
    slip = _ending_in(slip, 2, "slip", "along, across")
    if slip.ndim < 2 or slip.shape[-2] != 4:
        raise ValueError(f"slip must end in (4, 2): four wheels, got shape {slip.shape}")
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
        state: X, Y, theta, v_x, v_y, omega, wheel speeds, shape (..., 10).
        torque: of the drives on the wheels, shape (..., 4) [N m].
        vehicle: its numbers.
        rotor_inertia: of what turns with each wheel, seen at the wheel [kg m^2].

    Returns:
        Shape (..., 10).

    Raises:
        ValueError: state does not end in 10, or torque in 4 finite numbers.
    """
    state = _ending_in(state, 10, "state", "pose, velocity, wheel speeds")
    torque = _ending_in(torque, 4, "torque", "one a wheel")
    velocity, wheels = state[..., 3:6], state[..., 6:]
    force = contact_forces(contact_velocity(velocity, wheels, vehicle), vehicle)
    x, y = vehicle.positions.T
    along, across = force[..., 0], force[..., 1]
    v_x, v_y, omega = np.moveaxis(velocity, -1, 0)
    r, rolling = vehicle.wheel_radius, vehicle.loads * vehicle.rolling
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
            spin / (vehicle.wheel_inertia + rotor_inertia),
        ],
        axis=-1,
    )


def energy(state: ArrayLike, vehicle: Vehicle = HUSKY, *, rotor_inertia: float = 0.0) -> NDArray:
    """Kinetic energy of body, wheels and rotors [J], for states of shape (..., 10).

    Raises:
        ValueError: state does not end in 10 finite numbers.
    """
    state = _ending_in(state, 10, "state", "pose, velocity, wheel speeds")
    spin = vehicle.wheel_inertia + rotor_inertia
    weights = np.r_[vehicle.mass, vehicle.mass, vehicle.inertia, [spin] * 4]
    return (weights * state[..., 3:] ** 2).sum(-1) / 2


def friction_power(state: ArrayLike, vehicle: Vehicle = HUSKY) -> NDArray:
    """Power of friction at the contacts and of the resistance to rolling [W], never positive.

    Args:
        state: shape (..., 10).
        vehicle: its numbers.

    Returns:
        Shape (...) [W].

    Raises:
        ValueError: state does not end in 10 finite numbers.
    """
    state = _ending_in(state, 10, "state", "pose, velocity, wheel speeds")
    slip = contact_velocity(state[..., 3:6], state[..., 6:], vehicle)
    rolled = vehicle.wheel_radius * state[..., 6:]
    sliding = (contact_forces(slip, vehicle) * slip).sum((-1, -2))
    return sliding - (vehicle.loads * vehicle.rolling * rolled**2).sum(-1)


def turning_half_track(vehicle: Vehicle = HUSKY) -> float:
    """Half track that a vehicle turning in place seems to have, c + (mu_y/mu_x) a b/c [m].

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
    return vehicle.half_track + share * vehicle.front * vehicle.rear / vehicle.half_track


def turning_moment(vehicle: Vehicle = HUSKY) -> float:
    """Largest moment of lateral friction against turning in place, mu_y sum N_i |x_i| [N m]."""
    return vehicle.friction_lateral * float(vehicle.loads @ np.abs(vehicle.positions[:, 0]))


def advance(
    state: ArrayLike,
    drive: ArrayLike,
    dt: float,
    vehicle: Vehicle = HUSKY,
    *,
    damping: ArrayLike = 0.0,
    rotor_inertia: ArrayLike = 0.0,
    tolerance: float = 1e-5,
) -> NDArray:
    """The state a time dt later, with the wheels driven by torques drive - damping * speed.

    This is a constant torque (damping 0), a motor at a constant voltage, or proportional speed
    control with a constant reference. Integrated by a Rosenbrock method of third order with steps
    that it chooses itself (`kernels`): the slip of a wheel dies out within about a millisecond.

    Args:
        state: shape (10,).
        drive: shape (4,) [N m].
        dt: time to go on [s].
        vehicle: its numbers.
        damping: shape (4,) or one for all [N m s/rad].
        rotor_inertia: of what turns with each wheel, seen at the wheel, (4,) or one [kg m^2].
        tolerance: error of a step in m, rad, m/s and rad/s, relative to 1 plus the value.

    Returns:
        The new state, shape (10,).

    Raises:
        ValueError: a shape is wrong, a value not finite, dt or tolerance not positive, or damping
            or rotor_inertia negative.
    """
    from backhoe.vehicle.skid_steer import kernels

    state = _ending_in(state, 10, "state", "pose, velocity, wheel speeds").copy()
    drive = _ending_in(drive, 4, "drive", "one a wheel")
    if state.ndim != 1 or drive.ndim != 1:
        raise ValueError(f"advance takes one state and one drive, got {state.shape}, {drive.shape}")
    for name, value in (("dt", dt), ("tolerance", tolerance)):
        if not (np.ndim(value) == 0 and np.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be a positive number, got {value!r}")
    record = kernels.record([vehicle], damping, rotor_inertia)
    kernels.advance(state, drive, record[0], float(dt), np.full(1, dt), tolerance, kernels.room())
    return state
