"""Exercise 3.7: gains that pass the proof, the drives, the clock and a surprise."""

from __future__ import annotations

from functools import cache

import numpy as np

from backhoe.arm import lyapunov
from backhoe.arm.pid import ARM_GAINS, Gains
from backhoe.lessons import published
from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE, JOINTS

REGION = 0.5  # error up to which V must fall [rad]
USUAL_ERROR = 0.05  # error at which no drive may be full [rad]
SURPRISE = 54e3  # what a tonne more in the bucket, 5.5 m out, pulls at the boom [N m]
SAG = np.radians(1.0)  # how far it may push the boom [rad]
FORGET = 10.0  # time in which the integral takes a load over [s]
PERIOD = 0.01  # in which the joint state arrives [s]
ROUNDING = 1 + 1e-9


@cache
def tuned_gains() -> Gains:
    """Gains, shape (4,) each, that meet the five demands of exercise 3.7."""
    kp = BACKHOE.torque_limit / np.array([0.055, 0.12, 0.2, 0.2])
    return lyapunov.tune("matrix", kp=kp, ki=kp / 9, error=REGION, damping=0.5).gains


def shown_gains() -> Gains:
    """The gains that lesson 03b tunes, shape (4,) each: a bus of 100 Hz is too slow for them."""
    kp = BACKHOE.torque_limit / np.array([0.05, 0.1, 0.1, 0.1])
    ki = 0.4 * (kp - lyapunov.constants().kg)
    return lyapunov.tune("matrix", kp=kp, ki=ki, error=REGION).gains


def judge(answer: tuple, reference: tuple) -> bool | str:
    """Say which of the five demands fails first, with its numbers."""
    gains = Gains(*(np.asarray(gain, dtype=float) for gain in answer))
    if any(gain.shape != (4,) for gain in gains):
        return "give three rows of four gains: kp, ki, kd, each for swing, boom, stick, bucket"
    if not all(np.isfinite(gain).all() and (gain > 0).all() for gain in gains):
        return "every gain must be positive and finite"
    full, slow = USUAL_ERROR * gains.kp / BACKHOE.torque_limit, gains.kp / gains.ki
    if full.max() > ROUNDING:
        return (
            f"drives: at an error of {USUAL_ERROR} rad the {JOINTS[full.argmax()]}'s spring alone "
            f"asks for {full.max():.3g} times its torque limit: lower its K_p"
        )
    sag = SURPRISE / gains.kp[1]
    if sag > SAG * ROUNDING:
        return f"surprise: a tonne moves the boom by {np.degrees(sag):.3g} deg: raise its K_p"
    if slow.max() > FORGET * ROUNDING:
        return (
            f"memory: K_p/K_i of the {JOINTS[slow.argmax()]} is {slow.max():.3g} s, so long does "
            "it take to learn a new load: raise its K_i"
        )
    postures = np.random.default_rng(0).uniform(BACKHOE.lower, BACKHOE.upper, (400, 4))
    radius = lyapunov.sampled_radius(gains, postures, dt=PERIOD).max()
    if radius >= 1:
        return f"clock: at 100 Hz a deviation grows {radius:.3g} times a sample: lower K_d"
    for failed in lyapunov.check_gains(gains, route="matrix", error=REGION).failed:
        return (
            f"proof: {failed.name}, but {failed.left:.3g} is not {failed.relation} "
            f"{failed.right:.3g} {failed.unit}"
        )
    return True


def _printed(name: str) -> Gains:
    table = published.load(name)
    return Gains(table["K_p"], table["K_i"], table["K_d"])


TUNED = Exercise(
    number="3.7",
    title="gains that pass every demand",
    reference=tuned_gains,
    oracle="demands_in_random_states",
    compare=judge,
    tested_on="drives, surprise, memory, clock and proof",
    timeout=30.0,
    hints=(
        "K_p from the drives: torque limit / 0.05 rad is the most, 54 kN m / 1 deg the boom's "
        "least",
        'then lyapunov.tune("matrix", kp=kp, ki=kp / 9, error=0.5, damping=0.5), a soft bucket',
    ),
    mistakes={
        "those are the gains of 03b: at 100 Hz their bucket is damped too fast": shown_gains,
        "those are the thesis's gains: the boom is too soft, and at 100 Hz the bucket shakes": (
            lambda: _printed("mastalli_2013_eq_333")
        ),
        "those are the gains of the thesis's table: they have no certificate by the matrix route": (
            lambda: _printed("mastalli_2013_table_31")
        ),
        "those are the tour's gains: at 0.05 rad the swing's spring asks for twice its torque": (
            ARM_GAINS
        ),
        "certified by the scalar route, but its integral needs up to hours to learn a load": (
            lambda: lyapunov.tune("scalar").gains
        ),
        "the order is kp, ki, kd: you gave the damping second": (
            lambda: tuple(tuned_gains()[k] for k in (0, 2, 1))
        ),
        "those are gains per degree: give them per radian": (
            lambda: tuple(np.radians(tuned_gains()))
        ),
    },
)
