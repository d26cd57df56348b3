"""The motor's equations: transfer functions, exact sampling, torque and current, simulation.

    L di/dt = V - R i - K_b n w        (n^2 J + J_load) dw/dt = n K_m i - (n^2 b + b_load) w - T_d

Without the inductance, i = (V - K_b n w)/R, that is a system of first order.

Source: D'Angelo 2022, section 4.1.
"""

from __future__ import annotations

from math import exp
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array
from backhoe.vehicle.motor.parameters import Load, Motor

if TYPE_CHECKING:
    import control


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


def transfer_functions(
    motor: Motor, load: Load, *, reduced: bool = False
) -> tuple[control.TransferFunction, control.TransferFunction]:
    """G_1 from voltage and G_2 from a torque against the motion to the wheel's speed.

    Source: D'Angelo 2022, eq. (4.1), with the gearbox.

    Args:
        motor, load: their numbers.
        reduced: neglect the inductance.

    Returns:
        Two systems of python-control with names.
    """
    import control

    n, R = motor.gear, motor.resistance
    L = 0.0 if reduced else motor.inductance
    J = motor.rotor_inertia + load.inertia
    b = n**2 * motor.friction + load.friction
    below = np.polyadd(np.polymul([L, R], [J, b]), n**2 * motor.back_emf * motor.torque_constant)
    below, electric = np.trim_zeros(below, "f"), np.trim_zeros([L, R], "f")
    return (
        control.tf([n * motor.torque_constant], below, name="voltage_to_speed"),
        control.tf(-np.asarray(electric), below, name="torque_to_speed"),
    )


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
    decay = exp(-positive(h, "h") / system.time_constant)
    return Discrete(decay, system.gain * (1 - decay), system.torque_gain * (1 - decay))


def current(motor: Motor, voltage: ArrayLike, speed: ArrayLike) -> NDArray:
    """Current without inductance: what the back-EMF leaves of the voltage, over R.

    Args:
        motor: its numbers.
        voltage: shape (...) [V].
        speed: of the wheel, shape (...) [rad/s].

    Returns:
        Shape (...) [A].

    Raises:
        ValueError: a value is not a finite number.
    """
    voltage, speed = finite(voltage, "voltage"), finite(speed, "speed")
    return (voltage - motor.back_emf * motor.gear * speed) / motor.resistance


def torque(motor: Motor, voltage: ArrayLike, speed: ArrayLike) -> NDArray:
    """Torque of the motor at the wheel, n K_m/R (V - K_b n w), without the rotor's friction.

    Source: D'Angelo 2022, eq. (4.5), with the gearbox.

    Args:
        motor, voltage, speed: as for `current`.

    Returns:
        Shape (...) [N m].

    Raises:
        ValueError: a value is not a finite number.
    """
    return motor.gear * motor.torque_constant * current(motor, voltage, speed)


class MotorRun(NamedTuple):
    """time (n + 1,) [s], speed of the wheel (n + 1,) [rad/s], current (n + 1,) [A] and torque at
    the wheel (n + 1,) [N m]; in the reduced model current and torque jump with the voltage, and
    the last value is with the last voltage."""

    time: NDArray
    speed: NDArray
    current: NDArray
    torque: NDArray


def simulate(
    motor: Motor,
    voltage: ArrayLike,
    h: float,
    load: Load,
    *,
    disturbance: ArrayLike = 0.0,
    full: bool = False,
) -> MotorRun:
    """The motor from rest under voltages held over samples of h; exact at the samples.

    Args:
        motor, load: their numbers.
        voltage: shape (n,) [V].
        h: sample time [s].
        disturbance: torque T_d against the motion, shape (n,) or one for all [N m].
        full: with the inductance, of second order.

    Raises:
        ValueError: voltage is not one row of finite numbers, disturbance does not fit, or h is not
            positive.
    """
    voltage = finite(voltage, "voltage")
    if voltage.ndim != 1 or not voltage.size:
        raise ValueError(f"voltage must be one row, one value a sample, got shape {voltage.shape}")
    disturbance = finite(disturbance, "disturbance")
    if disturbance.shape not in ((), voltage.shape):
        raise ValueError(
            f"disturbance must be one value or {voltage.shape} as voltage, got {disturbance.shape}"
        )
    inputs = np.stack(np.broadcast_arrays(voltage, disturbance), axis=-1)
    A, B = _sampled(motor, load, positive(h, "h"), full)
    states = np.zeros((len(voltage) + 1, len(A)))
    for k, u in enumerate(inputs):
        states[k + 1] = A @ states[k] + B @ u
    speed = states[:, -1]
    held = np.append(voltage, voltage[-1])
    amperes = states[:, 0] if full else current(motor, held, speed)
    time = h * np.arange(len(speed))
    return MotorRun(time, speed, amperes, motor.gear * motor.torque_constant * amperes)


def _sampled(motor: Motor, load: Load, h: float, full: bool) -> tuple[NDArray, NDArray]:
    """Matrices of the sampled system with the states (current, speed) or (speed,)."""
    if not full:
        step = discretise(motor, load, h)
        return np.array([[step.decay]]), np.array([[step.gain, -step.torque_gain]])
    from scipy.linalg import expm

    n, L = motor.gear, motor.inductance
    J = motor.rotor_inertia + load.inertia
    b = n**2 * motor.friction + load.friction
    system = np.zeros((4, 4))
    system[0] = [-motor.resistance / L, -n * motor.back_emf / L, 1 / L, 0.0]
    system[1] = [n * motor.torque_constant / J, -b / J, 0.0, -1 / J]
    stepped = expm(h * system)
    return stepped[:2, :2], stepped[:2, 2:]


def finite(values: ArrayLike, name: str) -> NDArray:
    """Numbers as an array, or a `ValueError` that names them."""
    array = real_array(values, f"{name} must be numbers")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, got {values!r}")
    return array


def positive(value: float, name: str) -> float:
    """One number above 0, or a `ValueError` that names it."""
    if not (np.ndim(value) == 0 and np.isfinite(value) and value > 0):
        raise ValueError(f"{name} must be a positive number, got {value!r}")
    return float(value)
