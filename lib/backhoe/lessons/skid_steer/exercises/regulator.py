"""Exercise 4.6: a sampled PI whose integral waits while the actuator is at its limit."""

from __future__ import annotations

from collections.abc import Callable
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise


def sampled_pi(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
    """Output of a PI for each sample of the error; its integral waits at the limit."""
    output, integral = [], 0.0
    for e in error:
        if abs(kp * e + integral + ki * dt * e) <= limit:
            integral += ki * dt * e
        output.append(np.clip(kp * e + integral, -limit, limit))
    return np.array(output)


def _up_to_the_limit(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
    """The integral runs right up to the limit and no further, as the library's does."""
    output, integral = [], 0.0
    for e in error:
        more, old = integral + ki * dt * e, integral
        integral = max(min(more, max(old, limit - kp * e)), min(old, -limit - kp * e))
        output.append(np.clip(kp * e + integral, -limit, limit))
    return np.array(output)


def _or_back(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
    """The integral waits at the limit unless the error leads back from it."""
    output, integral = [], 0.0
    for e in error:
        wanted = kp * e + integral + ki * dt * e
        if abs(wanted) <= limit or wanted * e < 0:
            integral += ki * dt * e
        output.append(np.clip(kp * e + integral, -limit, limit))
    return np.array(output)


RULES = {"": sampled_pi, " (though it runs rightly up to the limit)": _up_to_the_limit}
"""Ways to wait at the limit that are right and differ, and what is added to a mistake beside."""


def right_clamping(answer: NDArray, reference: NDArray, *given: object) -> bool | str:
    """An integral that waits a step before the limit or runs right up to it are both right, and
    so is one that waits unless the error leads back."""
    if np.shape(answer) != np.shape(reference):
        return "one output for each sample of the error is asked"
    right = (*RULES.values(), _or_back)
    return any(np.allclose(answer, rule(*given), rtol=1e-6, atol=1e-9) for rule in right)


def _cases(rng: np.random.Generator) -> list[tuple]:
    """Errors that jump, to both sides; the last record stays within its limits, one begins at 0."""
    cases = []
    for k in range(12):
        n, dt = int(rng.integers(60, 140)), float(rng.uniform(0.002, 0.02))
        kp, ki = rng.uniform(1.0, 4.0), rng.uniform(20.0, 60.0)
        steps = np.repeat(rng.uniform(-3.0, 3.0, 1 + n // 20), 20)[:n]
        error = (steps + 0.3 * rng.normal(size=n)) * (np.arange(n) > 5 * (k == 10))
        limit = rng.uniform(3.0, 6.0) if k < 11 else 1e3
        cases.append((error, dt, float(kp), float(ki), float(limit)))
    return cases


def _winds_up(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
    return np.clip(kp * error + ki * dt * np.cumsum(error), -limit, limit)


def _late(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
    """Each output has the integral of the sample before."""

    def add(integral: float, e: float) -> float:
        fits = abs(kp * e + integral + ki * dt * e) <= limit
        return integral + ki * dt * e if fits else integral

    return np.clip(kp * error + [*accumulate(error[:-1], add, initial=0.0)], -limit, limit)


def _alone(clipped: bool) -> Callable[..., NDArray]:
    """An integral that is kept within the limit by itself, by cutting it or by waiting."""

    def outputs(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
        def add(integral: float, e: float) -> float:
            more = integral + ki * dt * e
            kept = np.clip(more, -limit, limit) if clipped else integral
            return more if abs(more) <= limit else kept

        return np.clip(kp * error + [*accumulate(error, add, initial=0.0)][1:], -limit, limit)

    return outputs


def _asks_the_old(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
    def add(integral: float, e: float) -> float:
        return integral + ki * dt * e if abs(kp * e + integral) <= limit else integral

    return np.clip(kp * error + [*accumulate(error, add, initial=0.0)][1:], -limit, limit)


def _waits_above(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
    def add(integral: float, e: float) -> float:
        fits = kp * e + integral + ki * dt * e <= limit
        return integral + ki * dt * e if fits else integral

    return np.clip(kp * error + [*accumulate(error, add, initial=0.0)][1:], -limit, limit)


def _within(low: float, high: float) -> Callable[..., NDArray]:
    """An integral that is cut to shares of the limit by itself."""

    def outputs(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
        def add(integral: float, e: float) -> float:
            return np.clip(integral + ki * dt * e, low * limit, high * limit)

        return np.clip(kp * error + [*accumulate(error, add, initial=0.0)][1:], -limit, limit)

    return outputs


def _unclipped(error: NDArray, dt: float, kp: float, ki: float, limit: float) -> NDArray:
    def add(integral: float, e: float) -> float:
        fits = abs(kp * e + integral + ki * dt * e) <= limit
        return integral + ki * dt * e if fits else integral

    return kp * error + [*accumulate(error, add, initial=0.0)][1:]


def _slips(rule: Callable[..., NDArray]) -> dict[str, Callable[..., NDArray]]:
    """Mistakes that can stand beside any way of waiting."""
    return {
        "the integral grows with each sample, however short: dt is missing": (
            lambda error, dt, *gains: rule(error, 1.0, *gains)
        ),
        "here ki stands alone: no K_p in front of it": (
            lambda error, dt, kp, ki, limit: rule(error, dt, kp, kp * ki, limit)
        ),
        "the integral forgets: it must add up over the samples": (
            lambda error, *gains: np.ravel([rule(np.array([e]), *gains) for e in error])
        ),
        "the integral goes the wrong way: it grows with the error": (
            lambda error, dt, kp, ki, limit: rule(error, dt, kp, -ki, limit)
        ),
        "the output has the wrong sign: kp e + I": lambda *record: -rule(*record),
        "that is the I alone: K_p times the error is missing": (
            lambda error, dt, kp, ki, limit: rule(error, dt, 0.0, ki, limit)
        ),
        "an output may be negative: the motor brakes, or runs backwards": (
            lambda *record: np.abs(rule(*record))
        ),
        "the output has a lower limit too, -limit, and no other": (
            lambda *record: np.maximum(rule(*record), 0.0)
        ),
    }


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
        "the integral may fill the whole range by itself: it is P + I that must stay within": (
            _alone(clipped=True)
        ),
        "the integral waits where it fills the range by itself: it is P + I that must fit": (
            _alone(clipped=False)
        ),
        "it asks whether the old integral fits: the new one may not": _asks_the_old,
        "the integral comes a sample late: add the present error first": _late,
        "that is the P alone: the integral is missing": (
            lambda error, dt, kp, ki, limit: sampled_pi(error, dt, kp, 0.0, limit)
        ),
        "the P leaves the limits beside an integral that waits: clip the sum": (_unclipped),
        "the integral waits at the upper limit only: there is one below, too": _waits_above,
        "the output is cut at the upper limit only, and the integral winds up": (
            lambda error, dt, kp, ki, limit: np.minimum(
                kp * error + ki * dt * np.cumsum(error), limit
            )
        ),
        "the integral is limited by itself to half of the range: it is P + I that must fit": (
            _within(-0.5, 0.5)
        ),
        "the integral may be negative: it unwinds, and the motor brakes": _within(0.0, 1.0),
        **{
            text + beside: slip
            for beside, rule in (RULES | {" (and it winds up)": _winds_up}).items()
            for text, slip in _slips(rule).items()
            if rule is not _winds_up or "forgets" not in text
        },
    },
    hints=(
        "A loop over the error with one number that lasts, the integral; clip what you return.",
        "Add ki dt e to the integral only if kp e + integral + ki dt e then stays in the limits.",
    ),
    tested_on="12 records of errors that drive it into both limits and back",
)
