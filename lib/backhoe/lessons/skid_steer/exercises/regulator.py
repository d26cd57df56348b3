"""Exercise 4.6: a sampled PI whose integral waits while the actuator is at its limit."""

from __future__ import annotations

from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.pid import DigitalPID
from backhoe.lessons.exercise import Exercise


def sampled_pi(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
    """Output of a PI for each sample of the error; its integral waits at the limit."""
    output, integral = [], 0.0
    for e in error:
        if abs(kp * e + integral + ki * dt * e) <= limit:
            integral += ki * dt * e
        output.append(np.clip(kp * e + integral, -limit, limit))
    return np.array(output)


def right_clamping(answer: NDArray, reference: NDArray, *given: object) -> bool | str:
    """An integral that waits a step before the limit or runs right up to it are both right."""
    if np.shape(answer) != np.shape(reference):
        return "one output for each sample of the error is asked"
    error, dt, kp, ki, limit = given
    pi = DigitalPID(kp, ki, 0.0, dt, limits=(-limit, limit))
    upto = np.array([pi(float(e), 0.0) for e in error])
    return any(np.allclose(answer, one, rtol=1e-6, atol=1e-9) for one in (reference, upto))


def _cases(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(12):
        n, dt = int(rng.integers(60, 140)), float(rng.uniform(0.002, 0.02))
        kp, ki = rng.uniform(1.0, 4.0), rng.uniform(20.0, 60.0)
        steps = np.repeat(rng.uniform(-3.0, 3.0, 1 + n // 20), 20)[:n]
        error = steps + 0.3 * rng.normal(size=n)
        cases.append((error, dt, float(kp), float(ki), float(rng.uniform(3.0, 6.0))))
    return cases


def _winds_up(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
    return np.clip(kp * error + ki * dt * np.cumsum(error), -limit, limit)


def _integral_alone(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
    integral = DigitalPID(0.0, ki, 0.0, dt, limits=(-limit, limit))
    return np.clip(kp * error + [integral(float(e), 0.0) for e in error], -limit, limit)


def _a_sample_late(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
    def add(integral: float, e: float) -> float:
        fits = abs(kp * e + integral + ki * dt * e) <= limit
        return integral + ki * dt * e if fits else integral

    return np.clip(kp * error + [*accumulate(error[:-1], add, initial=0.0)], -limit, limit)


SAMPLED_PI = Exercise(
    number="4.6",
    title="A PI that does not wind up",
    reference=sampled_pi,
    oracle="the_integral_read_back",
    cases=_cases,
    compare=right_clamping,
    mistakes={
        "the output is limited, the integral is not: it winds up while the output waits": _winds_up,
        "the output leaves the limits: no battery gives more than its voltage": (
            lambda error, dt, kp, ki, limit: _winds_up(error, dt, kp, ki, np.inf)
        ),
        "the integral grows with each sample, however short: dt is missing": (
            lambda error, dt, *gains: sampled_pi(error, 1.0, *gains)
        ),
        "the integral may fill the whole range by itself: it is P + I that must stay within": (
            _integral_alone
        ),
        "that is (4.6) with its K_p in front of K_i: here ki stands alone": (
            lambda error, dt, kp, ki, limit: sampled_pi(error, dt, kp, kp * ki, limit)
        ),
        "the integral forgets: it must add up over the samples": (
            lambda error, *gains: np.ravel([sampled_pi([e], *gains) for e in error])
        ),
        "the integral comes a sample late: (4.6) adds the present error first": _a_sample_late,
        "that is the P alone: the integral is missing": (
            lambda error, dt, kp, ki, limit: sampled_pi(error, dt, kp, 0.0, limit)
        ),
    },
    hints=(
        "A loop over the error with one number that lasts, the integral; clip what you return.",
        "Add ki dt e to the integral only if kp e + integral + ki dt e then stays in the limits.",
    ),
    tested_on="12 records of errors that drive it into its limits and back",
)
