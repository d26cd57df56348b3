"""Exercise 3.6: what the clock allows."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.dynamics import mass_matrix
from backhoe.arm.lyapunov import effective_inertia
from backhoe.lessons.exercise import Exercise
from backhoe.lessons.lyapunov_pid.exercises.loop import RADIANS
from backhoe.machine import BACKHOE


def clock_limit(q: ArrayLike, kd: ArrayLike, dt: float) -> float:
    """Largest factor on kd for which damping with torques held for dt is stable."""
    rates = np.linalg.eigvals(np.linalg.solve(mass_matrix(q), np.diag(kd)))
    return 2 / (dt * rates.real.max())


def _lightness(q: ArrayLike) -> NDArray:
    return np.linalg.inv(mass_matrix(q))


def _cases(rng: np.random.Generator) -> list[tuple]:
    """Gains as they are usual, and such that each joint in turn may be the first to be too fast."""
    q = rng.uniform(BACKHOE.lower, BACKHOE.upper, (30, 4))
    kd = rng.uniform((5e5, 4e5, 1e5, 2e4), (2e6, 1e6, 8e5, 4e5), (30, 4))
    kd[15:] = effective_inertia(q[15:]) * rng.uniform(100, 2000, (15, 4))
    kd[15:20, 0] *= 20.0
    return list(zip(q, kd, rng.uniform(5e-4, 1e-2, 30).tolist(), strict=True))


CLOCK = Exercise(
    number="3.6",
    title="what the clock allows",
    reference=clock_limit,
    oracle="speed_turns_round_and_keeps_its_size",
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
            lambda q, kd, dt: (2 * np.diag(mass_matrix(q)) / (dt * kd)).min()
        ),
        "nearly: 1/(M^-1)_jj is each joint's effective inertia, but K_d acts on all at once": (
            lambda q, kd, dt: (2 * effective_inertia(q) / (dt * kd)).min()
        ),
        "that is safe but too strict: the lightest motion does not have the largest damper": (
            lambda q, kd, dt: clock_limit(q, np.full(4, kd.max()), dt)
        ),
        "eigvalsh takes M^-1 K_d for symmetric, which it is not: eigvals, or make it symmetric": (
            lambda q, kd, dt: 2 / dt / np.linalg.eigvalsh(_lightness(q) * kd).max()
        ),
        "eigvalsh takes K_d M^-1 for symmetric, which it is not: eigvals, or make it symmetric": (
            lambda q, kd, dt: 2 / dt / np.linalg.eigvalsh(kd[:, None] * _lightness(q)).max()
        ),
        "that is the largest stretch of M^-1 K_d; what grows from step to step is an eigenvalue": (
            lambda q, kd, dt: 2 / dt / np.linalg.norm(_lightness(q) * kd, 2)
        ),
        "that is the last eigenvalue to become unstable, not the first": (
            lambda q, kd, dt: 2 / dt * np.linalg.eigvals(mass_matrix(q) / kd).real.max()
        ),
        "K_d / M, not K_d times M: heavy joints bear more damping": (
            lambda q, kd, dt: 2 / (dt * np.linalg.eigvals(mass_matrix(q) * kd).real.max())
        ),
        "dt is missing: the slower the clock, the less damping it bears": (
            lambda q, kd, dt: dt * clock_limit(q, kd, dt)
        ),
        "that is how far the gains are used up; asked is the factor that is still allowed": (
            lambda q, kd, dt: 1 / clock_limit(q, kd, dt)
        ),
        RADIANS: lambda q, kd, dt: clock_limit(np.radians(q), kd, dt),
    },
)
