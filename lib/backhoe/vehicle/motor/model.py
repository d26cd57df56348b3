"""The motor's equations: gains and time constant, exact sampling, torque.

    L di/dt = V - R i - K_b n w        (n^2 J + J_load) dw/dt = n K_m i - (n^2 b + b_load) w - T_d

Without the inductance, i = (V - K_b n w)/R, that is a system of first order.

Source: D'Angelo 2022, section 4.1.
"""

from __future__ import annotations

from math import exp
from typing import NamedTuple

from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive
from backhoe.vehicle.motor.parameters import Load, Motor


class FirstOrder(NamedTuple):
    """The motor without inductance: tau dw/dt = gain V - torque_gain T_d - w.

    gain [rad/s/V], torque_gain [rad/s per N m], time_constant tau [s].
    """

    gain: float
    torque_gain: float
    time_constant: float


def first_order(motor: Motor, load: Load) -> FirstOrder:
    """Gains and time constant of motor and load when the inductance is neglected.

    Source: D'Angelo 2022, below eq. (4.1), tau = R J/(R b + K_b K_m), with the gearbox.
    """
    damping = motor.damping + load.friction
    inertia = motor.rotor_inertia + load.inertia
    return FirstOrder(motor.torque_per_volt / damping, 1 / damping, inertia / damping)


class Discrete(NamedTuple):
    """w(k+1) = decay w(k) + gain V(k) - torque_gain T_d(k), for values held over a sample."""

    decay: float
    gain: float
    torque_gain: float


def discretise(motor: Motor, load: Load, h: float) -> Discrete:
    """The first-order motor sampled with period h, exactly.

    Source: D'Angelo 2022, eq. (4.3): E = exp(-h/tau) and tau (1 - E) (k_1 V - T_d/J).

    Args:
        motor, load: their numbers.
        h: sample time [s].

    Raises:
        ValueError: h is not positive.
    """
    system = first_order(motor, load)
    decay = exp(-positive(h, "h", "s") / system.time_constant)
    return Discrete(decay, system.gain * (1 - decay), system.torque_gain * (1 - decay))


def torque(motor: Motor, voltage: ArrayLike, speed: ArrayLike) -> NDArray:
    """Torque of the motor at the wheel, n K_m/R (V - K_b n w), without the rotor's friction.

    Source: D'Angelo 2022, eq. (4.5), with the gearbox.

    Args:
        motor: its numbers.
        voltage: shape (...) [V].
        speed: of the wheel, shape (...) [rad/s].

    Returns:
        Shape (...) [N m].

    Raises:
        ValueError: a value is not a finite number.
    """
    voltage, speed = numbers(voltage, "voltage"), numbers(speed, "speed")
    return motor.torque_per_volt * (voltage - motor.back_emf * motor.gear * speed)
