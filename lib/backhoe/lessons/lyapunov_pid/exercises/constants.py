"""Exercises 3.4 and 3.5: a constant of the arm, and what the conditions make of constants."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from backhoe.arm import dynamics
from backhoe.arm.lyapunov import gravity_slope
from backhoe.arm.pid import Gains
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.lyapunov_pid.exercises.loop import RADIANS
from backhoe.machine import BACKHOE


def gravity_constant(postures: ArrayLike) -> float:
    """Smallest k_g of (A.13) for these postures, shape (n, 4) [rad]: [N m/rad]."""
    return np.linalg.norm(gravity_slope(postures), 2, axis=(-2, -1)).max()


GRAVITY_CONSTANT = Exercise(
    number="3.4",
    title="how fast gravity can change",
    reference=gravity_constant,
    oracle="stretch_by_differences",
    cases=lambda rng: [(rng.uniform(BACKHOE.lower, BACKHOE.upper, (20, 4)),) for _ in range(20)],
    rtol=1e-4,
    tested_on="20 sets of 20 postures",
    hints=(
        "for neighbours ||dg|| <= k_g ||dq||: by how much can the matrix dg/dq stretch?",
        "np.linalg.norm(dg_dq, 2) of each posture (its largest singular value), then the maximum",
    ),
    mistakes={
        "that is 4 times the largest entry: it holds, but it is not the smallest that does": (
            lambda postures: 4 * np.abs(gravity_slope(postures)).max()
        ),
        "the largest entry is too small: a matrix can stretch a vector by more than that": (
            lambda postures: np.abs(gravity_slope(postures)).max()
        ),
        "eigenvalues of dg/dq can be negative (a raised boom gets lighter): take their size": (
            lambda postures: np.linalg.eigvalsh(gravity_slope(postures)).max()
        ),
        "that is the Frobenius norm, np.linalg.norm without its second argument 2": (
            lambda postures: np.linalg.norm(gravity_slope(postures), axis=(-2, -1)).max()
        ),
        "a bound holds in every posture: the maximum over the postures, not their mean": (
            lambda postures: np.linalg.norm(gravity_slope(postures), 2, axis=(-2, -1)).mean()
        ),
        "that is the least demanding posture's: a bound that holds in all needs the maximum": (
            lambda postures: np.linalg.norm(gravity_slope(postures), 2, axis=(-2, -1)).min()
        ),
        "that is the smallest stretch: of the singular values take the largest": (
            lambda postures: np.linalg.svd(gravity_slope(postures), compute_uv=False).min()
        ),
        "that is the constant of the first posture alone": (
            lambda postures: gravity_constant(postures[:1])
        ),
        "that is the largest gravity torque: k_g bounds how fast it changes": (
            lambda postures: np.linalg.norm(dynamics.gravity_torque(postures), axis=-1).max()
        ),
        "that is per degree: give it per radian": (
            lambda postures: np.radians(gravity_constant(postures))
        ),
        RADIANS: lambda postures: gravity_constant(np.radians(postures)),
    },
)


def certificate(
    gains: Gains, kg: float, kc1: float, lambda_min: float, lambda_max: float
) -> tuple[float, float, float]:
    """Lowest and highest alpha of (3.13), (3.17) [1/s], and the mended bound (3.24) [rad]."""
    lowest = np.max(gains.ki) / (np.min(gains.kp) - kg)
    highest = lambda_min * np.min(gains.kd) / lambda_max**2
    region = (np.min(gains.kd) / lowest - lambda_max) / kc1
    return lowest, highest, region


def _cases(rng: np.random.Generator) -> list[tuple]:
    least, most = ((5e5, 2e4, 2e5), (2e6, 1e5, 1e6))
    return [
        (
            Gains(*rng.uniform(least, most, (4, 3)).T / np.array([[1.0], [1.0], [weaker]])),
            *map(float, rng.uniform((1e5, 4e4, 150, 1e5), (2e5, 7e4, 250, 1.4e5))),
        )
        for weaker in np.repeat([1.0, 60.0], [20, 10])
    ]


def _with(place: int, change: Callable) -> Callable:
    """The certificate with one number made of the right one, the gains and the constants."""

    def wrong(*inputs: object) -> tuple:
        made = list(certificate(*inputs))
        made[place] = change(made[place], *inputs)
        return tuple(made)

    return wrong


CERTIFICATE = Exercise(
    number="3.5",
    title="a certificate from extremes",
    reference=certificate,
    oracle="conditions_become_equations",
    cases=_cases,
    tested_on="30 random sets of gains and constants",
    hints=(
        "np.min(kp) is lambda_min of a diagonal K_p; the third number is W22 = 0 at the lowest "
        "alpha",
        "W22 = lambda_min(K_d) - alpha (lambda_max(M) + k_C1 ||error||), solved for the error",
    ),
    mistakes={
        "the worst counts: the smallest K_p and K_d, the largest K_i": (
            lambda gains, *others: certificate(
                Gains(gains.kp.max(), gains.ki.min(), gains.kd.max()), *others
            )
        ),
        "lambda_min of K_d, not lambda_max: the weakest damper decides": (
            lambda gains, *others: certificate(gains._replace(kd=gains.kd.max()), *others)
        ),
        "lambda_max of K_i, not lambda_min: the strongest integral decides": (
            lambda gains, *others: certificate(gains._replace(ki=gains.ki.min()), *others)
        ),
        "k_g is missing: gravity works against the springs, lambda_min(K_p) - k_g is left": (
            lambda gains, kg, *others: certificate(gains, 0.0, *others)
        ),
        "the highest alpha has lambda_max(M) squared: test the units, alpha is 1/s": (
            _with(1, lambda right, gains, kg, kc1, least, most: right * most)
        ),
        "the highest alpha has K_d: with K_p the units do not fit": (
            _with(1, lambda right, gains, *_: right * gains.kp.min() / gains.kd.min())
        ),
        "that is the sharper bound by Schur; asked is the one with lambda_min(M)/lambda_max(M)": (
            _with(1, lambda right, gains, kg, kc1, least, most: right * most / least)
        ),
        "k_C1 is missing in the third number: kg m^2 over kg m^2 gives radians": (
            _with(2, lambda right, gains, kg, kc1, least, most: right * kc1)
        ),
        "lambda_max(M) is missing in the third number: it is what the damper has to stop": (
            _with(2, lambda right, gains, kg, kc1, least, most: right + most / kc1)
        ),
        "the bound is widest at the lowest alpha: put that one in": (
            _with(2, lambda right, gains, kg, kc1, least, most: (most**2 / least - most) / kc1)
        ),
        "a negative third number says how much is missing: leave it as it is": (
            _with(2, lambda right, *_: max(0.0, right))
        ),
        "the third number in radians, please: then its unit is what the formula gives": (
            _with(2, lambda right, *_: np.degrees(right))
        ),
    },
)
