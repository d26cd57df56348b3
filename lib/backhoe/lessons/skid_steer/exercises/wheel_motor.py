"""Exercises 4.5 and 4.7: a motor behind its gearbox in exact steps; gains for a wheel's speed."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import exp, log

import numpy as np

from backhoe.lessons.exercise import Exercise
from backhoe.vehicle import motor
from backhoe.vehicle.motor import ROVER, Motor, replace
from backhoe.vehicle.skid_steer import HUSKY


def geared_step(
    speed: float, voltage: float, torque: float, load: float, h: float, motor: Motor = ROVER
) -> float:
    """Wheel speed after h, voltage and load torque held: (4.3) with the gearbox [rad/s]."""
    n, R = motor.gear, motor.resistance
    inertia = n**2 * motor.inertia + load
    damping = n**2 * (motor.friction + motor.torque_constant * motor.back_emf / R)
    E = exp(-h * damping / inertia)
    final = (n * motor.torque_constant / R * voltage - torque) / damping
    return E * speed + (1 - E) * final


def _other(**factors: float) -> Callable[..., float]:
    """The step of a motor of which some numbers are multiplied."""
    numbers = {name: factor * getattr(ROVER, name) for name, factor in factors.items()}
    return partial(geared_step, motor=replace(ROVER, **numbers))


def _euler(speed: float, voltage: float, torque: float, load: float, h: float) -> float:
    push = ROVER.torque_per_volt * voltage - torque - ROVER.damping * speed
    return speed + h * push / (ROVER.rotor_inertia + load)


def _steps(rng: np.random.Generator) -> list[tuple]:
    """Steps at random, both ways round; of a wheel at rest, unpowered, unloaded, of long ones."""
    spread = np.array([8.0, 24.0, 30.0])
    cases = []
    for which in ((1, 1, 1), (0, 1, 1), (1, 0, 1), (1, 1, 0)):
        for _ in range(11):
            given = (spread * rng.uniform(-1, 1, 3) * which).tolist()
            cases.append((*given, *rng.uniform((0.02, 0.001), (1.0, 0.2)).tolist()))
    return cases


_N = ROVER.gear


def _at_the_rotor(start: float = 1.0, end: float = 1.0, load: float = 1.0) -> Callable[..., float]:
    """The step with factors on the speed that comes in, on what goes out, and on the load."""
    return lambda speed, voltage, torque, inertia, h: (
        end * geared_step(start * speed, voltage, torque, load * inertia, h)
    )


GEARED = Exercise(
    number="4.5",
    title="A motor behind its gearbox",
    reference=geared_step,
    oracle="rotor_and_wheel_integrated",
    cases=_steps,
    mistakes={
        "that is forward Euler, right for short steps only: E = exp(-h / tau) is exact": _euler,
        "the gearbox is missing: the wheel feels n times the torque of the rotor": (
            _other(gear=1 / _N)
        ),
        "at the wheel the rotor's inertia and losses count n^2 times, not n times": (
            _other(inertia=1 / _N, friction=1 / _N, back_emf=1 / _N)
        ),
        "the losses count n^2 times, but the rotor's inertia only n times: it does as well": (
            _other(inertia=1 / _N)
        ),
        "the inertia counts n^2 times, but the losses only n times: they do as well": (
            _other(friction=1 / _N, back_emf=1 / _N)
        ),
        "the rotor's inertia is not reflected: at the wheel it counts n^2 times": (
            _other(inertia=_N**-2)
        ),
        "the losses are not reflected: at the wheel they count n^2 times": (
            _other(friction=_N**-2, back_emf=_N**-2)
        ),
        "the load's inertia is multiplied by n^2: at the wheel it counts as it is": (
            _at_the_rotor(load=_N**2)
        ),
        "that is the speed of the rotor: the wheel's is n times slower": _at_the_rotor(end=_N),
        "that is a step of the rotor: what comes in and goes out is the wheel's speed": (
            _at_the_rotor(start=1 / _N, end=_N)
        ),
        "the speed that comes in is the wheel's already, and not the rotor's": (
            _at_the_rotor(start=1 / _N)
        ),
        "the speed that comes in is multiplied by n, what goes out is the wheel's: both, or none": (
            _at_the_rotor(start=_N)
        ),
        "what comes in is divided by n^2 as if it were a load: n once": _at_the_rotor(end=1 / _N),
        "it starts from rest each time: E times the speed that it had": _at_the_rotor(start=0.0),
        "the load torque acts at the wheel already: it is not divided by n there": (
            lambda speed, voltage, torque, *rest: geared_step(speed, voltage, torque / _N, *rest)
        ),
        "the load torque is missing": (
            lambda speed, voltage, torque, *rest: geared_step(speed, voltage, 0.0, *rest)
        ),
        "the motor's torque arrives n times as large at the wheel: n K_m / R for each volt": (
            lambda speed, voltage, *rest: geared_step(speed, voltage / _N, *rest)
        ),
        "the friction of the motor is missing": _other(friction=0.0),
        "the back-EMF is missing: speed makes a voltage against you": _other(back_emf=1e-12),
        "the torque constant enters twice, and the gear once: n K_m / R for each volt": (
            lambda speed, voltage, *rest: geared_step(speed, ROVER.torque_constant * voltage, *rest)
        ),
        "that is where it ends after a long time: after h it is on its way there": (
            lambda speed, voltage, torque, load, h: geared_step(0.0, voltage, torque, load, 1e6)
        ),
        "time runs backwards: E = exp(-h / tau), with a minus": (
            lambda speed, voltage, torque, load, h: geared_step(speed, voltage, torque, load, -h)
        ),
        "the old speed fades, but the new one is there at once: (1 - E) before it": (
            lambda speed, voltage, torque, load, h: (
                geared_step(speed, 0.0, 0.0, load, h) + geared_step(0.0, voltage, torque, load, 1e6)
            )
        ),
        "the inertia is reflected the wrong way: at the wheel the rotor counts n^2 times more": (
            _other(inertia=_N**-4)
        ),
        "the back-EMF comes from the rotor's speed, n omega, and its torque counts n times too": (
            _other(back_emf=1 / _N)
        ),
        "the rotor's own inertia is missing: seen from the wheel it is n^2 J": (
            _other(inertia=1e-12)
        ),
        "the load's inertia has no effect: add it to n^2 J": (
            lambda speed, voltage, torque, load, h: geared_step(speed, voltage, torque, 0.0, h)
        ),
        "the load torque helps: T_d acts against the motion, with a minus": (
            lambda speed, voltage, torque, *rest: geared_step(speed, voltage, -torque, *rest)
        ),
        "the load torque acts at the wheel already: it takes no factor n there": (
            lambda speed, voltage, torque, *rest: geared_step(speed, voltage, _N * torque, *rest)
        ),
    },
    hints=(
        "Everything at the wheel: torque n K_m / R V, inertia n^2 J + load, losses times n^2.",
        "damping = n^2 (b + K_m K_b / R), tau = inertia / damping, end = (drive - T_d) / damping.",
    ),
    tested_on="44 steps of 1 to 200 ms both ways round, also from rest, unpowered and unloaded",
)


_LOAD = motor.vehicle_load(HUSKY)
_SATURATES, _OVERSHOOTS, _SHORT, _LATE = (
    "the voltage saturates at the very first sample: K_p alone asks for it",
    "it overshoots: less K_i for this K_p, so that the integral comes later",
    "it never comes within 2 % of 1 rad/s: an integral takes the rest away",
    "it settles too late: less than 30 % of the time without control are allowed",
)


def demands(gains: tuple[float, float, float]) -> list[str]:
    """What the source asks of a wheel's speed control and these gains do not do, in words."""
    run = motor.control_wheel(ROVER, _LOAD, motor.WheelGains(*map(float, gains)), duration=1.5)
    stays = abs(run.speed[-1] - 1.0) <= 0.02
    allowed = 0.3 * log(50) * motor.first_order(ROVER, _LOAD).time_constant
    late = stays and motor.settling_time(run.time, run.speed, 1.0) > allowed
    failed = {
        _SATURATES: run.saturated,
        _OVERSHOOTS: motor.overshoot(run.speed, 1.0) > 0.001,
        _SHORT: not stays,
        _LATE: late,
    }
    return [demand for demand, fails in failed.items() if fails]


def _meets(answer: tuple, reference: tuple) -> bool | str:
    return next(iter(demands(answer)), True)


GAINS = Exercise(
    number="4.7",
    title="Tune a wheel",
    reference=partial(motor.tune_wheel, ROVER, _LOAD),
    oracle="one_real_pole_is_left",
    compare=_meets,
    mistakes={
        _SATURATES: (60.0, 100.0, 0.0),
        _OVERSHOOTS: (6.0, 1000.0, 0.0),
        _SHORT: (8.0, 0.0, 0.0),
        _LATE: (1.0, 25.0, 0.0),
    },
    hints=(
        "Begin with K_p alone until it is fast enough, then add K_i until nothing is left.",
        "A PI has its zero at -K_i / K_p: put it on the motor's pole, K_i = K_p / tau.",
    ),
    tested_on="a step to 1 rad/s of the Husky on all four wheels",
)
