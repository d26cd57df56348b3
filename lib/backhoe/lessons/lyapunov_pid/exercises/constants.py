"""Exercises 3.4 and 3.5: a constant of the arm, and what the conditions make of constants."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.lyapunov_pid.exercises.loop import RADIANS
from backhoe.machine import BACKHOE


def gravity_constant(postures: ArrayLike) -> float:
    """Smallest k_g of (A.13) for these postures, shape (n, 4) [rad]: [N m/rad]."""
    slopes = _slopes(postures)
    return np.abs(np.linalg.eigvalsh(slopes)).max()


def _slopes(postures: ArrayLike) -> NDArray:
    """dg/dq by central differences, symmetric, shape (n, 4, 4) [N m/rad]."""
    columns = [
        (dynamics.gravity_torque(postures + d) - dynamics.gravity_torque(postures - d)) / 2e-5
        for d in 1e-5 * np.eye(4)
    ]
    slopes = np.stack(columns, axis=-1)
    return (slopes + np.swapaxes(slopes, -1, -2)) / 2


GRAVITY_CONSTANT = Exercise(
    number="3.4",
    title="how fast gravity can change",
    reference=gravity_constant,
    cases=lambda rng: [(rng.uniform(BACKHOE.lower, BACKHOE.upper, (20, 4)),) for _ in range(20)],
    rtol=1e-4,
    tested_on="20 sets of 20 postures",
    hints=(
        "(A.13) for neighbours: ||dg|| <= k_g ||dq||. By how much can the matrix dg/dq stretch?",
        "np.linalg.norm(dg_dq, 2) of each posture (its largest singular value), then the maximum",
    ),
    mistakes={
        "that is the printed recipe n max|dg_i/dq_j|: it holds, but it is not the smallest": (
            lambda postures: 4 * np.abs(_slopes(postures)).max()
        ),
        "the largest entry is too small: a matrix can stretch a vector by more than that": (
            lambda postures: np.abs(_slopes(postures)).max()
        ),
        "eigenvalues of dg/dq can be negative (a raised boom gets lighter): take their size": (
            lambda postures: np.linalg.eigvalsh(_slopes(postures)).max()
        ),
        "that is the Frobenius norm, np.linalg.norm without its second argument 2": (
            lambda postures: np.linalg.norm(_slopes(postures), axis=(-2, -1)).max()
        ),
        "a bound holds in every posture: the maximum over the postures, not their mean": (
            lambda postures: np.abs(np.linalg.eigvalsh(_slopes(postures))).max(axis=-1).mean()
        ),
        "that is the constant of the first posture alone": (
            lambda postures: gravity_constant(postures[:1])
        ),
        "that is the largest gravity torque, k' of (A.14): k_g bounds how fast it changes": (
            lambda postures: np.linalg.norm(dynamics.gravity_torque(postures), axis=-1).max()
        ),
        "that is per degree: give it per radian": (
            lambda postures: np.radians(gravity_constant(postures))
        ),
        (RADIANS): (lambda postures: gravity_constant(np.radians(postures))),
    },
)


def certificate(
    kp: ArrayLike,
    kd: ArrayLike,
    ki: ArrayLike,
    kg: float,
    kc1: float,
    lambda_min: float,
    lambda_max: float,
) -> tuple[float, float, float]:
    """Lowest and highest alpha of (3.13), (3.17) [1/s], and the mended bound (3.24) [rad]."""
    lowest = np.max(ki) / (np.min(kp) - kg)
    highest = lambda_min * np.min(kd) / lambda_max**2
    region = (np.min(kd) / lowest - lambda_max) / kc1
    return lowest, highest, region


def _cases(rng: np.random.Generator) -> list[tuple]:
    return [
        (
            rng.uniform(5e5, 2e6, 4),
            rng.uniform(2e5, 1e6, 4) / weaker,
            rng.uniform(2e4, 1e5, 4),
            *(float(value) for value in rng.uniform((1e5, 4e4, 150, 1e5), (2e5, 7e4, 250, 1.4e5))),
        )
        for weaker in np.repeat([1.0, 60.0], [20, 10])
    ]


def _with(lowest: object = None, highest: object = None, region: object = None) -> object:
    """The certificate with some of its three numbers replaced by functions of the same inputs."""

    def wrong(*inputs: object) -> tuple:
        right = certificate(*inputs)
        made = (lowest, highest, region)
        return tuple(one(*inputs) if one else value for one, value in zip(made, right, strict=True))

    return wrong


def _bound(kd: float, lowest: float, kc1: float, lambda_max: float) -> float:
    return (kd / lowest - lambda_max) / kc1


def _without_gravity(
    kp: NDArray, kd: NDArray, ki: NDArray, kg: float, *others: float
) -> tuple[float, float, float]:
    return certificate(kp, kd, ki, 0.0, *others)


def _favourable(
    kp: NDArray, kd: NDArray, ki: NDArray, *others: float
) -> tuple[float, float, float]:
    return certificate(kp.max(), kd.max(), ki.min(), *others)


CERTIFICATE = Exercise(
    number="3.5",
    title="a certificate from extremes",
    reference=certificate,
    cases=_cases,
    tested_on="30 random sets of gains and constants",
    hints=(
        "np.min(kp) is lambda_min of a diagonal K_p; the third number is W22 = 0 at the lowest "
        "alpha",
        "W22 = lambda_min(K_d) - alpha (lambda_max(M) + k_C1 ||error||), solved for the error",
    ),
    mistakes={
        "the worst counts: the smallest K_p and K_d, the largest K_i": _favourable,
        "lambda_min of K_d, not lambda_max: the weakest damper decides": (
            lambda kp, kd, ki, *others: certificate(kp, kd.max(), ki, *others)
        ),
        "lambda_max of K_i, not lambda_min: the strongest integral decides": (
            lambda kp, kd, ki, *others: certificate(kp, kd, ki.min(), *others)
        ),
        "k_g is missing: gravity works against the springs, lambda_min(K_p) - k_g is left": (
            _without_gravity
        ),
        "(3.17) has lambda_max(M) squared: test the units, alpha is 1/s": (
            _with(highest=lambda kp, kd, ki, kg, kc1, least, most: least * kd.min() / most)
        ),
        "the upper bound has K_d: K_p there is the slip of (3.23), and the units do not fit": (
            _with(highest=lambda kp, kd, ki, kg, kc1, least, most: least * kp.min() / most**2)
        ),
        "that is the sharper bound of section 8; (3.17) also has lambda_min(M)/lambda_max(M)": (
            _with(highest=lambda kp, kd, ki, kg, kc1, least, most: kd.min() / most)
        ),
        "k_C1 is missing in the third number: kg m^2 over kg m^2 gives radians": (
            _with(
                region=lambda kp, kd, ki, kg, kc1, least, most: (
                    kd.min() * (kp.min() - kg) / ki.max() - most
                )
            )
        ),
        "lambda_max(M) is missing in the third number: the thesis left it out, too": (
            _with(
                region=lambda kp, kd, ki, kg, kc1, least, most: (
                    kd.min() * (kp.min() - kg) / ki.max() / kc1
                )
            )
        ),
        "the bound is widest at the lowest alpha: put that one in": (
            _with(
                region=lambda kp, kd, ki, kg, kc1, least, most: _bound(
                    kd.min(), least * kd.min() / most**2, kc1, most
                )
            )
        ),
        "a negative third number says how much is missing: leave it as it is": (
            lambda *inputs: (*certificate(*inputs)[:2], max(0.0, certificate(*inputs)[2]))
        ),
        "the third number in radians, please: then its unit is what the formula gives": (
            lambda *inputs: (*certificate(*inputs)[:2], np.degrees(certificate(*inputs)[2]))
        ),
    },
)
