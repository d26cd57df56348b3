"""Exercises 4.5 and 4.7: a motor behind its gearbox in exact steps; gains for a wheel's speed."""

from __future__ import annotations

from math import exp

import numpy as np

from backhoe.lessons.exercise import Exercise
from backhoe.vehicle import motor
from backhoe.vehicle.motor import ROVER
from backhoe.vehicle.skid_steer import HUSKY


def geared_step(speed: float, voltage: float, torque: float, load: float, h: float) -> float:
    """Wheel speed after h, voltage and load torque held: (4.3) with the gearbox [rad/s]."""
    n, R = ROVER.gear, ROVER.resistance
    inertia = n**2 * ROVER.inertia + load
    damping = n**2 * (ROVER.friction + ROVER.torque_constant * ROVER.back_emf / R)
    E = exp(-h * damping / inertia)
    final = (n * ROVER.torque_constant / R * voltage - torque) / damping
    return E * speed + (1 - E) * final


def _steps(rng: np.random.Generator) -> list[tuple]:
    low, high = (-8.0, -24.0, -30.0, 0.02, 0.001), (8.0, 24.0, 30.0, 1.0, 0.05)
    return [tuple(rng.uniform(low, high)) for _ in range(40)]


def _stepped(
    speed: float,
    voltage: float,
    torque: float,
    load: float,
    h: float,
    rotor: float = ROVER.gear**2,
    friction: float = ROVER.gear**2,
    emf: float = ROVER.gear**2,
    drive: float = ROVER.gear,
) -> float:
    """The step with other factors for the rotor's inertia, friction, back-EMF and torque."""
    per_ohm = ROVER.torque_constant / ROVER.resistance
    damping = friction * ROVER.friction + emf * per_ohm * ROVER.back_emf
    E = exp(-h * damping / (rotor * ROVER.inertia + load))
    return E * speed + (1 - E) * (drive * per_ohm * voltage - torque) / damping


def _euler(speed: float, voltage: float, torque: float, load: float, h: float) -> float:
    n, R = ROVER.gear, ROVER.resistance
    damping = n**2 * (ROVER.friction + ROVER.torque_constant * ROVER.back_emf / R)
    push = n * ROVER.torque_constant / R * voltage - torque - damping * speed
    return speed + h * push / (n**2 * ROVER.inertia + load)


_N = ROVER.gear

GEARED = Exercise(
    number="4.5",
    title="A motor behind its gearbox",
    reference=geared_step,
    cases=_steps,
    mistakes={
        "that is forward Euler, right for short steps only: E = exp(-h / tau) is exact": _euler,
        "the gearbox is missing: the wheel feels n times the torque of the rotor": (
            lambda *step: _stepped(*step, rotor=1, friction=1, emf=1, drive=1)
        ),
        "at the wheel the rotor's inertia and losses count n^2 times, not n times": (
            lambda *step: _stepped(*step, rotor=_N, friction=_N, emf=_N)
        ),
        "the inertia is reflected the wrong way: at the wheel the rotor counts n^2 times more": (
            lambda *step: _stepped(*step, rotor=1 / _N**2)
        ),
        "the back-EMF comes from the rotor's speed, n omega, and its torque counts n times too": (
            lambda *step: _stepped(*step, emf=_N)
        ),
        "the rotor's own inertia is missing: seen from the wheel it is n^2 J": (
            lambda *step: _stepped(*step, rotor=0)
        ),
        "the load's inertia has no effect: add it to n^2 J": (
            lambda speed, voltage, torque, load, h: geared_step(speed, voltage, torque, 0.0, h)
        ),
        "the load torque helps: T_d acts against the motion, with a minus": (
            lambda speed, voltage, torque, load, h: geared_step(speed, voltage, -torque, load, h)
        ),
        "the load torque acts at the wheel already: it takes no factor n there": (
            lambda speed, voltage, torque, load, h: geared_step(
                speed, voltage, _N * torque, load, h
            )
        ),
    },
    hints=(
        "Everything at the wheel: torque n K_m / R V, inertia n^2 J + load, losses times n^2.",
        "damping = n^2 (b + K_m K_b / R), tau = inertia / damping, end = (drive - T_d) / damping.",
    ),
    tested_on="40 random steps of 1 to 50 ms with loads from a bare wheel to a heavy robot",
)


_SATURATES, _OVERSHOOTS, _SHORT, _LATE = (
    "the voltage saturates at the very first sample: K_p alone asks for it",
    "it overshoots: less K_i for this K_p, so that the integral comes later",
    "it never comes within 2 % of 1 rad/s: an integral takes the rest away",
    "it settles too late: less than 30 % of the time without control are allowed",
)


def demands(gains: tuple[float, float, float]) -> list[str]:
    """What the source asks of a wheel's speed control and these gains do not do, in words."""
    load = motor.vehicle_load(HUSKY)
    run = motor.control_wheel(ROVER, load, motor.WheelGains(*map(float, gains)), duration=1.5)
    settled = np.abs(run.speed - 1.0) <= 0.02
    last = np.flatnonzero(~settled)[-1] + 1
    allowed = 0.3 * np.log(50) * motor.first_order(ROVER, load).time_constant
    failed = []
    if run.saturated:
        failed.append(_SATURATES)
    if run.speed.max() > 1.001:
        failed.append(_OVERSHOOTS)
    if not settled[-1]:
        failed.append(_SHORT)
    elif run.time[last] > allowed:
        failed.append(_LATE)
    return failed


def wheel_gains() -> tuple[float, float, float]:
    """Gains whose zero cancels the pole of motor and load: one real pole is left, far out."""
    system = motor.first_order(ROVER, motor.vehicle_load(HUSKY))
    closed = 0.2 * system.time_constant
    kp = system.time_constant / (system.gain * closed)
    return kp, kp / system.time_constant, 0.0


def _meets(answer: tuple, reference: tuple) -> bool | str:
    failed = demands(answer)
    return failed[0] if failed else True


GAINS = Exercise(
    number="4.7",
    title="Tune a wheel",
    reference=wheel_gains,
    compare=_meets,
    mistakes={
        (_SATURATES): ((60.0, 100.0, 0.0)),
        (_OVERSHOOTS): ((6.0, 1000.0, 0.0)),
        (_SHORT): ((8.0, 0.0, 0.0)),
        (_LATE): ((1.0, 25.0, 0.0)),
    },
    hints=(
        "Begin with K_p alone until it is fast enough, then add K_i until nothing is left.",
        "A PI has its zero at -K_i / K_p: put it on the motor's pole, K_i = K_p / tau.",
    ),
    tested_on="a step to 1 rad/s of the Husky on all four wheels",
)
