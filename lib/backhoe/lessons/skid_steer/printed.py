"""Formulas of D'Angelo 2022, chapters 2 and 4, exactly as printed. Not for use.

Lesson 04 tests them; those of chapter 2 are wrong: `backhoe.vehicle.skid_steer` has what they
should be.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.vehicle.motor import Load, Motor
from backhoe.vehicle.skid_steer.linear_model import StateSpace
from backhoe.vehicle.skid_steer.vehicle import HUSKY, Vehicle

__all__ = ["moment_213b", "rates_215", "state_space_216", "torque_214", "transfer_41", "x_icr_27"]


def x_icr_27(time: ArrayLike, left: ArrayLike, right: ArrayLike, turn: float) -> float:
    """(int omega_R dt - int omega_L dt)/(2 phi), which (2.7) calls x_ICR.

    Args:
        time: shape (n,) [s].
        left, right: wheel speeds, shape (n,) [rad/s].
        turn: phi [rad].

    Returns:
        A number without unit, meant as m.
    """
    difference = np.asarray(right, float) - np.asarray(left, float)
    return float(np.trapezoid(difference, np.asarray(time, float)) / (2 * turn))


def moment_213b(omega: ArrayLike, vehicle: Vehicle = HUSKY) -> NDArray:
    """m g K_y dtheta c, meant as a moment; K_y in s/m makes it a force [N].

    Args:
        omega: turning speed, shape (...) [rad/s].
        vehicle: its numbers.
    """
    p = vehicle
    return p.mass * p.gravity * p.lateral * np.asarray(omega, float) * p.half_track


def torque_214(
    u: ArrayLike, v: ArrayLike, omega: ArrayLike, vehicle: Vehicle = HUSKY
) -> tuple[NDArray, NDArray]:
    """K_ptau [u_1 -+ c u_2 - (dx -+ c dtheta)], meant as torques tau_L, tau_R [N m].

    Args:
        u: commanded speeds u_1, u_2, shape (..., 2) [m/s, rad/s].
        v, omega: speeds, shape (...) [m/s, rad/s].
        vehicle: its numbers.

    Returns:
        tau_L and tau_R, shape (...) each; K_ptau in N m s/rad makes them N m^2.
    """
    u, c = np.asarray(u, float), vehicle.half_track
    v, omega = np.asarray(v, float), np.asarray(omega, float)
    return (
        vehicle.speed_gain * (u[..., 0] - c * u[..., 1] - (v - c * omega)),
        vehicle.speed_gain * (u[..., 0] + c * u[..., 1] - (v + c * omega)),
    )


def rates_215(vehicle: Vehicle = HUSKY) -> NDArray:
    """2 K_ptau/(m r), g K_x, 2 K_ptau c^2/(I r), m g K_y c/I of (2.15), meant as rates [1/s].

    Args:
        vehicle: its numbers.

    Returns:
        What drives and what drags v, then the same of omega, shape (4,); only g K_x is in 1/s.
    """
    p = vehicle
    return np.array(
        [
            2 * p.speed_gain / (p.mass * p.wheel_radius),
            p.gravity * p.rolling,
            2 * p.speed_gain * p.half_track**2 / (p.inertia * p.wheel_radius),
            p.mass * p.gravity * p.lateral * p.half_track / p.inertia,
        ]
    )


def state_space_216(vehicle: Vehicle = HUSKY) -> StateSpace:
    """The matrices of (2.16), (2.17), with I_r read as I r as in (2.15b).

    Args:
        vehicle: its numbers.

    Returns:
        A, B, C, D for the states x, dx, theta, dtheta and the inputs u_1, u_2.
    """
    push, drag, turn, brake = rates_215(vehicle)
    A, B = np.zeros((4, 4)), np.zeros((4, 2))
    A[0, 1] = A[2, 3] = 1.0
    A[1, 1], A[3, 3] = -push - drag, -turn - brake
    B[1, 0], B[3, 1] = push, turn
    return StateSpace(A, B, np.eye(4), np.zeros((4, 2)))


def transfer_41(s: complex, motor: Motor, load: Load) -> tuple[complex, complex]:
    """G_1(s) and G_2(s): speed of a motor without a gear per voltage, and per torque against it.

    Args:
        s: complex frequency [1/s].
        motor, load: their numbers; J and b of the print are those of rotor and load together.

    Returns:
        [rad/s/V] and [rad/s per N m].
    """
    J, b = motor.inertia + load.inertia, motor.friction + load.friction
    winding = motor.inductance * s + motor.resistance
    below = winding * (J * s + b) + motor.back_emf * motor.torque_constant
    return motor.torque_constant / below, -winding / below
