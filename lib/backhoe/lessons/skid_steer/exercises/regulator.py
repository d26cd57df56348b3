"""Exercise 4.6: a sampled PI whose integral waits while the actuator is at its limit."""

from __future__ import annotations

from collections.abc import Callable

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


def right_clamping(
    answer: NDArray,
    reference: NDArray,
    error: NDArray,
    dt: float,
    kp: float,
    ki: float,
    limit: float,
) -> bool:
    """An integral that waits a step before the limit or runs right up to it are both right."""
    pi = DigitalPID(kp, ki, 0.0, dt, limits=(-limit, limit))
    upto = np.array([pi(float(e), 0.0) for e in error])
    if np.shape(answer) != np.shape(reference):
        return "one output for each sample of the error is asked"
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


def _pi(
    integrate: Callable[..., float], clip: bool = True
) -> Callable[[NDArray, float, float, float, float], NDArray]:
    """A PI with another way to go on from its integral and the error of a sample."""

    def output(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
        given, integral = [], 0.0
        for e in error:
            integral = integrate(integral, e, dt, kp, ki, limit)
            wanted = kp * e + integral
            given.append(np.clip(wanted, -limit, limit) if clip else wanted)
        return np.array(given)

    return output


def _held(
    integral: float, e: float, change: float, kp: float, limit: float, sign: float = 1.0
) -> float:
    return integral + sign * change if abs(kp * e + integral + change) <= limit else integral


def _a_sample_late(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
    given, integral = [], 0.0
    for e in error:
        given.append(np.clip(kp * e + integral, -limit, limit))
        if abs(kp * e + integral + ki * dt * e) <= limit:
            integral += ki * dt * e
    return np.array(given)


SAMPLED_PI = Exercise(
    number="4.6",
    title="A PI that does not wind up",
    reference=sampled_pi,
    cases=_cases,
    compare=right_clamping,
    mistakes={
        "the output is limited, the integral is not: it winds up while the output waits": (
            _pi(lambda total, e, dt, kp, ki, limit: total + ki * dt * e)
        ),
        "the output leaves the limits: no battery gives more than its voltage": (
            _pi(lambda total, e, dt, kp, ki, limit: total + ki * dt * e, clip=False)
        ),
        "the integral grows with each sample, however short: dt is missing": (
            _pi(lambda total, e, dt, kp, ki, limit: _held(total, e, ki * e, kp, limit))
        ),
        "the integral may fill the whole range by itself: it is P + I that must stay within": (
            _pi(
                lambda total, e, dt, kp, ki, limit: float(
                    np.clip(total + ki * dt * e, -limit, limit)
                )
            )
        ),
        "that is (4.6) with its K_p in front of K_i: here ki stands alone": (
            _pi(lambda total, e, dt, kp, ki, limit: _held(total, e, kp * ki * dt * e, kp, limit))
        ),
        "the integral forgets: it must add up over the samples": (
            _pi(lambda total, e, dt, kp, ki, limit: _held(0.0, e, ki * dt * e, kp, limit))
        ),
        "the integral comes a sample late: (4.6) adds the present error first": _a_sample_late,
        "that is the P alone: the integral is missing": (
            lambda error, dt, kp, ki, limit: np.clip(kp * error, -limit, limit)
        ),
    },
    hints=(
        "A loop over the error with one number that lasts, the integral; clip what you return.",
        "Add ki dt e to the integral only if kp e + integral + ki dt e then stays in the limits.",
    ),
    tested_on="12 records of errors that drive it into its limits and back",
)
