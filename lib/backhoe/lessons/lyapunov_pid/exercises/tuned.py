"""Exercise 3.7: gains that pass the proof, the drives, the clock and a surprise."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import lyapunov, pid
from backhoe.lessons import published
from backhoe.lessons.exercise import Exercise
from backhoe.machine import BACKHOE, JOINTS

REGION = 0.5  # error up to which V must fall [rad]
USUAL_ERROR = 0.05  # error at which no drive may be full [rad]
SURPRISE = 54e3  # what a tonne more in the bucket pulls at the boom [N m]
SAG = np.radians(1.0)  # how far it may push the boom [rad]
FORGET = 10.0  # time in which the integral takes a load over [s]


def tuned_gains() -> tuple[NDArray, NDArray, NDArray]:
    """Gains kp, kd, ki, shape (4,) each, that meet the five demands of exercise 3.7."""
    kp = BACKHOE.torque_limit / np.array([0.055, 0.1, 0.1, 0.1])
    ki = kp / 5.0
    heaviest = np.array([1.34e5, 9.9e4, 5.7e3, 5.0e2])  # largest M_jj [kg m^2]
    kd = 1.4 * np.sqrt(kp * heaviest)
    return kp, kd, ki


def judge(answer: tuple, reference: tuple) -> bool | str:
    """Say which of the five demands fails first, with its numbers."""
    gains = [np.asarray(gain, dtype=float) for gain in answer]
    if any(gain.shape != (4,) for gain in gains):
        return "give three rows of four gains: kp, kd, ki, each for swing, boom, stick, bucket"
    if not all(np.isfinite(gain).all() and (gain > 0).all() for gain in gains):
        return "every gain must be positive and finite"
    kp, _, ki = gains
    return _drives(kp) or _surprise(kp) or _forgets(kp, ki) or _clock(*gains) or _proof(*gains)


def _drives(kp: NDArray) -> str:
    share = USUAL_ERROR * kp / BACKHOE.torque_limit
    worst = int(np.argmax(share))
    if share[worst] <= 1 + 1e-9:
        return ""
    return (
        f"drives: at an error of {USUAL_ERROR} rad the {JOINTS[worst]}'s spring alone asks for "
        f"{share[worst]:.3g} times its torque limit: lower its K_p"
    )


def _surprise(kp: NDArray) -> str:
    sag = SURPRISE / kp[1]
    if sag <= SAG * (1 + 1e-9):
        return ""
    return f"surprise: a tonne moves the boom by {np.degrees(sag):.3g} deg: raise its K_p"


def _forgets(kp: NDArray, ki: NDArray) -> str:
    slow = kp / ki
    worst = int(np.argmax(slow))
    if slow[worst] <= FORGET * (1 + 1e-9):
        return ""
    return (
        f"memory: K_p/K_i of the {JOINTS[worst]} is {slow[worst]:.3g} s, so long does it take to "
        "learn a new load: raise its K_i"
    )


def _clock(kp: NDArray, kd: NDArray, ki: NDArray) -> str:
    postures = np.random.default_rng(0).uniform(BACKHOE.lower, BACKHOE.upper, (400, 4))
    radius = lyapunov.sampled_radius(pid.Gains(kp, ki, kd), postures).max()
    if radius < 1:
        return ""
    return f"clock: at 1 kHz a deviation grows {radius:.3g} times a millisecond: lower K_d"


def _proof(kp: NDArray, kd: NDArray, ki: NDArray) -> bool | str:
    judged = lyapunov.check_gains(pid.Gains(kp, ki, kd), route="matrix", error=REGION)
    if judged.holds:
        return True
    failed = judged.failed[0]
    return (
        f"proof: {failed.name}, but {failed.left:.3g} is not {failed.relation} "
        f"{failed.right:.3g} {failed.unit}"
    )


def _printed(name: str) -> tuple[ArrayLike, ArrayLike, ArrayLike]:
    table = published.load(name)
    return table["K_p"], table["K_d"], table["K_i"]


def _by_extremes() -> tuple[NDArray, NDArray, NDArray]:
    kp, ki, kd = lyapunov.tune("scalar").gains
    return kp, kd, ki


def _in_another_order() -> tuple[NDArray, NDArray, NDArray]:
    kp, kd, ki = tuned_gains()
    return kp, ki, kd


def _per_degree() -> tuple[NDArray, ...]:
    return tuple(np.radians(gain) for gain in tuned_gains())


TUNED = Exercise(
    number="3.7",
    title="gains that pass every demand",
    reference=tuned_gains,
    compare=judge,
    tested_on="drives, surprise, memory, clock and proof",
    timeout=30.0,
    hints=(
        "K_p from the drives: torque limit / 0.05 rad is the most, 54 kN m / 1 deg the boom's "
        "least",
        'then lyapunov.tune("matrix", kp=kp, ki=kp / 9, error=0.5) finds K_d; see its .gains.kd',
    ),
    mistakes={
        "those are the gains of (3.33): the boom is too soft, and at 1 kHz the bucket shakes": (
            lambda: _printed("mastalli_2013_eq_333")
        ),
        "those are the gains of Table 3.1: they have no certificate by the matrix route": (
            lambda: _printed("mastalli_2013_table_31")
        ),
        "those are the tour's gains: at 0.05 rad the swing's spring asks for twice its torque": (
            lambda: tuple(np.array(getattr(pid.ARM_GAINS, name)) for name in ("kp", "kd", "ki"))
        ),
        "certified by the thesis's own route, but its integral needs hours to learn a load": (
            _by_extremes
        ),
        "the order is kp, kd, ki: you gave the integral gains second": _in_another_order,
        "those are gains per degree: give them per radian": _per_degree,
    },
)
