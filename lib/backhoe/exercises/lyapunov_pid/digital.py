"""Exercise 3.8: a sampled PID with a limit that it knows."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.check import Exercise, Mistake


def digital_pid(
    reference: ArrayLike,
    measured: ArrayLike,
    kp: float,
    ki: float,
    kd: float,
    dt: float,
    limit: float,
) -> NDArray:
    """Outputs of a PID, one for each sample, within +-limit and without wind-up, shape (n,)."""
    outputs, integral, last = [], 0.0, measured[0]
    for r, y in zip(reference, measured, strict=True):
        others = kp * (r - y) - kd * (y - last) / dt
        new = integral + ki * (r - y) * dt
        if new > integral:
            integral = min(new, max(integral, limit - others))
        else:
            integral = max(new, min(integral, -limit - others))
        outputs.append(min(max(others + integral, -limit), limit))
        last = y
    return np.array(outputs)


def _loop(
    reference: ArrayLike,
    measured: ArrayLike,
    kp: float,
    ki: float,
    kd: float,
    dt: float,
    limit: float,
    *,
    of_error: bool = False,
    first: float | None = None,
    late: bool = False,
    step: float | None = None,
    rate_step: float | None = None,
    rule: str = "inwards",
    limited: bool = True,
) -> NDArray:
    """The same PID with one thing changed; `rule` says when a saturated output may integrate."""
    step, rate_step = dt if step is None else step, dt if rate_step is None else rate_step
    outputs, integral, error_before, last = [], 0.0, 0.0, None
    for r, y in zip(reference, measured, strict=True):
        error = r - y
        watched = error if of_error else -y
        if last is None:
            last = watched if first is None else first
        others = kp * error + kd * (watched - last) / rate_step
        new = integral + ki * step * (error_before if late else error)
        free = others + new
        outwards = (free > limit and new > integral) or (free < -limit and new < integral)
        saturated = abs(free) > limit
        may = {
            "inwards": not outwards,
            "always": True,
            "unless saturated": not saturated,
            "outwards": not saturated or outwards,
        }[rule]
        integral = new if may else integral
        free = others + integral
        outputs.append(min(max(free, -limit), limit) if limited else free)
        last, error_before = watched, error
    return np.array(outputs)


def _freezing(*inputs: object) -> NDArray:
    return _loop(*inputs)


def either(answer: ArrayLike, reference: NDArray, *inputs: object) -> bool | str:
    """Accept dynamic clamping and conditional integration alike."""
    if np.shape(answer) != reference.shape:
        return f"return one output for each sample: shape {reference.shape}, got {np.shape(answer)}"
    limit = inputs[-1]
    if np.max(np.abs(answer)) > limit * (1 + 1e-9):
        return "some outputs are beyond the limit"
    if np.allclose(answer, reference, rtol=1e-7, atol=1e-6):
        return True
    if np.allclose(answer, _freezing(*inputs), rtol=1e-7, atol=1e-6):
        return True
    sample = int(np.argmax(~np.isclose(answer, reference, rtol=1e-7, atol=1e-6)))
    return f"right up to sample {sample}, counted from 0; there the terms differ"


def _runs(rng: np.random.Generator) -> list[tuple]:
    """Steps of the reference that saturate the output on one side and then on the other."""
    runs = []
    for _ in range(12):
        dt = float(rng.uniform(0.005, 0.02))
        jumps = np.repeat(rng.uniform(-1.0, 1.0, 3) + np.array([0.6, -1.2, 0.5]), 40)
        lag = np.convolve(jumps, np.full(15, 1 / 15))[: len(jumps)]
        measured = lag + 0.3 + 0.05 * np.sin(np.arange(len(jumps)) * rng.uniform(0.2, 0.5))
        kp, ki, kd = (float(gain) for gain in rng.uniform((20, 300, 1), (60, 900, 4)))
        runs.append((jumps, measured, kp, ki, kd, dt, float(rng.uniform(20, 45))))
    return runs


DIGITAL = Exercise(
    number="3.8",
    title="a digital PID that knows its limit",
    reference=digital_pid,
    cases=_runs,
    compare=either,
    tested_on="12 runs with steps and saturation",
    hints=(
        "keep three things from sample to sample: the integral, the last measurement, the outputs",
        "try the new integral; if the output would leave the limit because of it, keep the old one",
    ),
    mistakes=(
        Mistake(
            "no dt in the sum",
            lambda *inputs: _loop(*inputs, step=1.0),
            "the integral without dt: faster sampling would make it stronger",
        ),
        Mistake(
            "no dt in the rate",
            lambda *inputs: _loop(*inputs, rate_step=1.0),
            "the derivative is a difference divided by dt",
        ),
        Mistake(
            "kick",
            lambda *inputs: _loop(*inputs, of_error=True),
            "the derivative of the error kicks when the reference jumps: take that of -measured",
        ),
        Mistake(
            "sign of the derivative",
            lambda reference, measured, kp, ki, kd, dt, limit: _loop(
                reference, measured, kp, ki, -kd, dt, limit
            ),
            "the sign of the derivative: a measurement that rises must lower the output",
        ),
        Mistake(
            "first sample",
            lambda *inputs: _loop(*inputs, first=0.0),
            "the first sample has no sample before it: its derivative is zero",
        ),
        Mistake(
            "late integral",
            lambda *inputs: _loop(*inputs, late=True),
            "the sum in (3.28) goes up to k: the present error belongs to it",
        ),
        Mistake(
            "no anti-windup",
            lambda *inputs: _loop(*inputs, rule="always"),
            "the output is limited, but the integral goes on growing meanwhile: it winds up",
        ),
        Mistake(
            "frozen",
            lambda *inputs: _loop(*inputs, rule="unless saturated"),
            "the integral stands still whenever the output is at its limit: let it come back in",
        ),
        Mistake(
            "wrong side",
            lambda *inputs: _loop(*inputs, rule="outwards"),
            "clamped on the wrong side: the integral may move inwards, and must not move outwards",
        ),
        Mistake(
            "no limit",
            lambda *inputs: _loop(*inputs, rule="always", limited=False),
            "the output must stay within +-limit",
        ),
    ),
)
