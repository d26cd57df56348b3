"""Control of a wheel's speed: what is asked of it, gains that do it, the loop run.

Source: D'Angelo 2022, section 4.2: no overshoot, settling at least 70 % faster than without
control, no saturation for a step to 1 rad/s.
"""

from __future__ import annotations

from math import exp, log
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.pid import DigitalPID
from backhoe.basics.inputs import alike, number, numbers, positive
from backhoe.vehicle.motor.model import discretise, first_order
from backhoe.vehicle.motor.parameters import Load, Motor

WHEEL_PERIOD = 0.001
"""Sample time of the wheels' speed control [s]: the source's simulator runs at 1 kHz."""


class WheelGains(NamedTuple):
    """Gains of a wheel's speed control: kp [V s/rad], ki [V/rad], kd [V s^2/rad]."""

    kp: float
    ki: float
    kd: float = 0.0


def tune_wheel(
    motor: Motor, load: Load, dt: float = WHEEL_PERIOD, faster: float = 0.75
) -> WheelGains:
    """Gains of a PI whose zero cancels the motor's pole: one real pole is left, no overshoot.

    The sampled motor is gain/(z - E), the PI with the integral of backward differences is
    ((kp + ki dt) z - kp)/(z - 1). With kp/(kp + ki dt) = E the loop is an integrator, and closed it
    has the pole 1 - (kp + ki dt) gain, which is put where it settles in (1 - faster) of the time.

    Args:
        motor, load: what is controlled.
        dt: sample time of the controller [s].
        faster: share of the open loop's settling time to be saved, between 0 and 1; the source
            asks for 0.7.

    Returns:
        kp, ki, and kd = 0: a first-order motor has nothing for a derivative to do.

    Raises:
        ValueError: faster is not between 0 and 1, dt is not positive, or dt is too long to settle
            so fast.
    """
    faster = number(faster, "faster", above=0.0, below=1.0)
    tau = first_order(motor, load).time_constant
    wanted = (1 - faster) * tau * log(50)
    if positive(dt, "dt", "s") > wanted:
        raise ValueError(
            f"settling in {1e3 * wanted:.3g} ms needs a shorter sample time than {1e3 * dt:.3g} ms"
        )
    step = discretise(motor, load, dt)
    first_voltage = (1 - exp(-dt / ((1 - faster) * tau))) / step.gain
    return WheelGains(first_voltage * step.decay, first_voltage * (1 - step.decay) / dt)


def wheel_pid(
    motor: Motor, gains: WheelGains, dt: float = WHEEL_PERIOD, wheels: int | None = None
) -> DigitalPID:
    """The digital PID of one wheel, or of a number of them, within the motor's voltage.

    Args:
        motor: its rated voltage is the limit.
        gains: as from `tune_wheel`.
        dt: sample time [s].
        wheels: None for one with plain floats, or how many.

    Raises:
        ValueError: gains are not kp, ki, kd, or one that `DigitalPID` refuses.
    """
    gains = numbers(gains, "gains", (3,), meaning="kp, ki, kd as from tune_wheel").tolist()
    loops = gains if wheels is None else [np.full(wheels, gain) for gain in gains]
    return DigitalPID(*loops, dt, limits=(-motor.voltage, motor.voltage))


class WheelRun(NamedTuple):
    """time (n + 1,) [s], speed (n + 1,) [rad/s], voltage (n,) [V]; whether it came to its limit."""

    time: NDArray
    speed: NDArray
    voltage: NDArray
    saturated: bool


def control_wheel(
    motor: Motor,
    load: Load,
    gains: WheelGains,
    reference: float = 1.0,
    *,
    duration: float = 0.3,
    dt: float = WHEEL_PERIOD,
) -> WheelRun:
    """Step response of a wheel with its speed controlled, from rest.

    Args:
        motor, load: what is controlled.
        gains: of the PID.
        reference: speed of the wheel [rad/s].
        duration: time to simulate [s].
        dt: sample time [s].

    Raises:
        ValueError: reference is not a finite number, or duration or dt is not positive.
    """
    reference = number(reference, "reference", "rad/s")
    pid, step = wheel_pid(motor, gains, dt), discretise(motor, load, dt)
    samples = round(positive(duration, "duration", "s") / dt)
    speed, voltage = np.zeros(samples + 1), np.empty(samples)
    for k in range(samples):
        voltage[k] = pid(reference, float(speed[k]))
        speed[k + 1] = step.decay * speed[k] + step.gain * voltage[k]
    saturated = bool((np.abs(voltage) >= motor.voltage).any())
    return WheelRun(dt * np.arange(samples + 1), speed, voltage, saturated)


def settling_time(
    time: ArrayLike, response: ArrayLike, final: float | None = None, band: float = 0.02
) -> float:
    """Time from the first sample until the response stays within a band about its final value.

    Args:
        time: shape (n,) [s].
        response: shape (n,), of any unit.
        final: what it settles on, in that unit; its last value unless told.
        band: half width as a share of the final value.

    Returns:
        Time [s]; 0 if it never leaves the band.

    Raises:
        ValueError: time and response are not two rows of one length, final is 0, or the response
            ends outside the band.
    """
    time, response = numbers(time, "time", ("n",)), numbers(response, "response", ("n",))
    alike(time=time, response=response)
    final = number(response[-1] if final is None else final, "final")
    if final == 0:
        raise ValueError("final must not be 0: the band is a share of it")
    outside = np.abs(response - final) > band * abs(final)
    if outside[-1]:
        raise ValueError(
            f"the response ends at {response[-1]:.4g}, outside the band about {final:.4g}: "
            "simulate longer, or say what it settles on"
        )
    last = np.flatnonzero(outside)
    return float(time[last[-1] + 1] - time[0]) if last.size else 0.0


def overshoot(response: ArrayLike, final: float) -> float:
    """How far a response to a positive step exceeds its final value, as a share of that; 0 if not.

    Args:
        response: shape (n,), in the units of `final`.
        final: what it settles on.

    Raises:
        ValueError: a value is not finite, or final is not positive.
    """
    peak = numbers(response, "response", ("n",)).max()
    return max(float(peak) / positive(final, "final") - 1, 0.0)
