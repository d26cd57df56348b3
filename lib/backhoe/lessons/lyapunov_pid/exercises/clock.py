"""Exercise 3.6: what the clock allows."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from backhoe.arm import dynamics
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.lyapunov_pid.exercises.loop import RADIANS
from backhoe.machine import BACKHOE


def clock_limit(q: ArrayLike, kd: ArrayLike, dt: float) -> float:
    """Largest factor on kd for which damping with torques held for dt is stable."""
    rates = np.linalg.eigvals(np.linalg.solve(dynamics.mass_matrix(q), np.diag(kd)))
    return 2 / (dt * rates.real.max())


def _cases(rng: np.random.Generator) -> list[tuple]:
    return [
        (
            rng.uniform(BACKHOE.lower, BACKHOE.upper),
            rng.uniform((5e5, 4e5, 1e5, 2e4), (2e6, 1e6, 8e5, 4e5)),
            float(rng.uniform(5e-4, 1e-2)),
        )
        for _ in range(30)
    ]


def _diagonal(q: ArrayLike, kd: ArrayLike, dt: float) -> float:
    return (2 * np.diag(dynamics.mass_matrix(q)) / (dt * kd)).min()


def _apart(q: ArrayLike, kd: ArrayLike, dt: float) -> float:
    effective = 1 / np.diag(np.linalg.inv(dynamics.mass_matrix(q)))
    return (2 * effective / (dt * kd)).min()


def _extremes(q: ArrayLike, kd: ArrayLike, dt: float) -> float:
    return 2 * np.linalg.eigvalsh(dynamics.mass_matrix(q))[0] / (dt * np.max(kd))


def _slowest(q: ArrayLike, kd: ArrayLike, dt: float) -> float:
    rates = np.linalg.eigvals(np.linalg.solve(dynamics.mass_matrix(q), np.diag(kd)))
    return 2 / (dt * rates.real.min())


CLOCK = Exercise(
    number="3.6",
    title="what the clock allows",
    reference=clock_limit,
    cases=_cases,
    tested_on="30 random postures, gains and sampling times",
    hints=(
        "the eigenvalues of I - dt M^-1 K_d lie between -1 and 1: which one leaves first?",
        "with s K_d they are 1 - s dt lambda: solve s dt lambda_max(M^-1 K_d) = 2 for s",
    ),
    mistakes={
        "that is where the speed stops in one step; it is stable up to an eigenvalue of -1": (
            lambda q, kd, dt: clock_limit(q, kd, dt) / 2
        ),
        "the joints do not move apart: the diagonal of M is too heavy for the bucket alone": (
            _diagonal
        ),
        "nearly: 1/(M^-1)_jj is each joint's effective inertia, but K_d acts on all at once": (
            _apart
        ),
        "that is safe but too strict: the lightest motion does not have the largest damper": (
            _extremes
        ),
        "that is the last eigenvalue to become unstable, not the first": _slowest,
        "K_d / M, not K_d times M: heavy joints bear more damping": (
            lambda q, kd, dt: (
                2 / (dt * np.linalg.eigvals(dynamics.mass_matrix(q) @ np.diag(kd)).real.max())
            )
        ),
        "dt is missing: the slower the clock, the less damping it bears": (
            lambda q, kd, dt: dt * clock_limit(q, kd, dt)
        ),
        "that is how far the gains are used up; asked is the factor that is still allowed": (
            lambda q, kd, dt: 1 / clock_limit(q, kd, dt)
        ),
        (RADIANS): (lambda q, kd, dt: clock_limit(np.radians(q), kd, dt)),
    },
)
