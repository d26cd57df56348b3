"""The linear dynamic model of a skid-steer vehicle with proportional control of its wheel speeds.

Newton's law along x and about z, with linear friction and four driven wheels, two a side:

    m dv/dt     = (2 tau_L + 2 tau_R) / r - m g K_x v
    I domega/dt = (2 tau_R - 2 tau_L) c / r - m g K_y a b omega
    tau         = K_ptau (omega_ref - omega_wheel),   omega_wheel = (v -+ c omega) / r

Friction of a wheel at longitudinal distance x slides sideways at x omega and turns with the lever
x: so K_y stands with the square of a length, a b for axles at a and -b under the loads of statics.
Torque over r is a force, wheel speed is speed over r: so K_ptau stands with 1/r^2.

Source: D'Angelo 2022, eqs. (2.12) to (2.17). Printed are one lever for two in (2.13b), no 1/r in
(2.14), and so 1/r for 1/r^2 and 2 wheels for 4 in (2.15), (2.16).
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers
from backhoe.vehicle.skid_steer.vehicle import HUSKY, Vehicle


class Rates(NamedTuple):
    """The four rates [1/s] that make up the model: what drives and what drags v and omega."""

    drive_v: float
    drag_v: float
    drive_omega: float
    drag_omega: float


class StateSpace(NamedTuple):
    """Matrices of dx/dt = A x + B u, y = C x + D u, shapes (4, 4), (4, 2), (4, 4), (4, 2)."""

    A: NDArray
    B: NDArray
    C: NDArray
    D: NDArray


def rates(vehicle: Vehicle = HUSKY) -> Rates:
    """The rates of the model, dv/dt = drive_v (v_ref - v) - drag_v v, and alike for omega.

    Source: D'Angelo 2022, eq. (2.15), repaired.

    Returns:
        4 K_ptau/(m r^2), g K_x, 4 K_ptau c^2/(I r^2), m g K_y a b/I [1/s].
    """
    p = vehicle
    push = 4 * p.speed_gain / p.wheel_radius**2
    return Rates(
        push / p.mass,
        p.gravity * p.rolling,
        push * p.half_track**2 / p.inertia,
        p.mass * p.gravity * p.lateral * p.front * p.rear / p.inertia,
    )


def state_space(vehicle: Vehicle = HUSKY) -> StateSpace:
    """The model in state-space form: two systems that do not touch each other.

    Source: D'Angelo 2022, eqs. (2.16) repaired, (2.17).

    Returns:
        A, B, C, D for the states x, v_x, theta, omega and the inputs v_ref, omega_ref.
    """
    k = rates(vehicle)
    A, B = np.zeros((4, 4)), np.zeros((4, 2))
    A[0, 1] = A[2, 3] = 1.0
    A[1, 1], A[3, 3] = -(k.drive_v + k.drag_v), -(k.drive_omega + k.drag_omega)
    B[1, 0], B[3, 1] = k.drive_v, k.drive_omega
    return StateSpace(A, B, np.eye(4), np.zeros((4, 2)))


def steady_state(v_ref: ArrayLike, omega_ref: ArrayLike, vehicle: Vehicle = HUSKY) -> NDArray:
    """Where the speeds settle: proportional control leaves an error.

    Args:
        v_ref, omega_ref: commanded speeds, shape (...) [m/s, rad/s].
        vehicle: its numbers.

    Returns:
        v_x and omega, shape (..., 2) [m/s, rad/s].

    Raises:
        ValueError: a command is not a finite number.
    """
    k = rates(vehicle)
    v_ref, omega_ref = numbers(v_ref, "v_ref"), numbers(omega_ref, "omega_ref")
    v = v_ref * k.drive_v / (k.drive_v + k.drag_v)
    omega = omega_ref * k.drive_omega / (k.drive_omega + k.drag_omega)
    return np.stack(np.broadcast_arrays(v, omega), axis=-1)


def radius(v_ref: float, omega_ref: float, vehicle: Vehicle = HUSKY) -> float:
    """Radius of the circle that the vehicle settles on [m].

    Raises:
        ValueError: a command is not a finite number, or omega_ref is 0.
    """
    if omega_ref == 0:
        raise ValueError("omega_ref = 0 gives a straight line, which has no radius")
    v, omega = steady_state(v_ref, omega_ref, vehicle)
    return float(abs(v / omega))


def step_response(
    t: ArrayLike, v_ref: float, omega_ref: float, vehicle: Vehicle = HUSKY
) -> NDArray:
    """Response from rest to constant commands, in closed form.

    Args:
        t: times since the step, shape (...) [s], 0 or later.
        v_ref, omega_ref: commanded speeds [m/s, rad/s].
        vehicle: its numbers.

    Returns:
        x, v_x, theta, omega, shape (..., 4) [m, m/s, rad, rad/s].

    Raises:
        ValueError: a value is not a finite number, or a time is negative.
    """
    t = numbers(t, "t")
    if (t < 0).any():
        raise ValueError(f"t must not be negative: the step is at t = 0, got {t.min()} s")
    k, (v, omega) = rates(vehicle), steady_state(v_ref, omega_ref, vehicle)
    columns = []
    for final, rate in ((v, k.drive_v + k.drag_v), (omega, k.drive_omega + k.drag_omega)):
        risen = -np.expm1(-rate * t)
        columns += [final * (t - risen / rate), final * risen]
    return np.stack(columns, axis=-1)


def fit(
    error_v: float, error_omega: float, v_ref: float, omega_ref: float, vehicle: Vehicle = HUSKY
) -> Vehicle:
    """The vehicle with K_x and K_y such that it settles with the given errors at its K_ptau.

    Steady errors tell drag over drive for v and omega, nothing more: mass, inertia, radius and gain
    enter both alike.

    Args:
        error_v, error_omega: commanded less settled speed [m/s, rad/s].
        v_ref, omega_ref: commanded speeds [m/s, rad/s].
        vehicle: all its other numbers stay.

    Returns:
        The vehicle with its `rolling` and `lateral` replaced.

    Raises:
        ValueError: an error is not between 0 and its command.
    """
    k, p = rates(vehicle), vehicle
    lever = p.mass * p.gravity * p.front * p.rear / p.inertia
    return replace(
        vehicle,
        rolling=_drag_over_drive(error_v, v_ref, "error_v") * k.drive_v / p.gravity,
        lateral=_drag_over_drive(error_omega, omega_ref, "error_omega") * k.drive_omega / lever,
    )


def _drag_over_drive(error: float, command: float, name: str) -> float:
    error, command = number(error, name), number(command, f"the command of {name}")
    if command == 0 or not 0 <= error / command < 1:
        raise ValueError(f"{name} must lie between 0 and its command, got {error} of {command}")
    return error / (command - error)
