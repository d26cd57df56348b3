"""Exercise 3.8: a sampled PID for the four joints, with limits that it knows."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise

Step = Callable[[NDArray, NDArray, NDArray], NDArray]


def digital_pid(kp: NDArray, ki: NDArray, kd: NDArray, dt: float, limit: NDArray) -> Step:
    """A PID for n loops: step(reference, rate, measured) gives the outputs of one sample, (n,)."""
    integral, last = np.zeros(len(kp)), None

    def step(reference: NDArray, rate: NDArray, measured: NDArray) -> NDArray:
        nonlocal integral, last
        error = reference - measured
        speed = rate if last is None else (measured - last) / dt
        others = kp * error + kd * (rate - speed)
        wanted = integral + ki * error * dt
        over = (others + wanted > limit) & (wanted > integral)
        under = (others + wanted < -limit) & (wanted < integral)
        integral = np.where(over | under, integral, wanted)
        last = np.array(measured)
        return np.clip(others + integral, -limit, limit)

    return step


def _variant(
    kp: NDArray,
    ki: NDArray,
    kd: NDArray,
    dt: float,
    limit: NDArray,
    *,
    kick: bool = False,
    start: str = "known",
    late: bool = False,
    sum_step: float | None = None,
    rate_step: float | None = None,
    reference_rate: float = 1.0,
    rule: str = "inwards",
    limited: bool = True,
    forgets: bool = False,
) -> Step:
    """The same PID with one thing changed; `rule` says when a loop at its limit may integrate."""
    sum_step, rate_step = sum_step or dt, rate_step or dt
    integral, before, last, error_before = np.zeros(len(kp)), np.zeros(len(kp)), None, None

    def step(reference: NDArray, rate: NDArray, measured: NDArray) -> NDArray:
        nonlocal integral, before, last, error_before
        error = reference - measured
        if kick:
            change = 0 * error if error_before is None else (error - error_before) / rate_step
        elif last is None:
            change = reference_rate * rate - (rate if start == "known" else measured / rate_step)
            change = change if reference_rate else 0 * rate
        else:
            change = reference_rate * rate - (measured - last) / rate_step
        others = kp * error + kd * change
        old = 0 * integral if forgets else integral
        new = old + ki * sum_step * (before if late else error)
        highest, lowest = limit - others, -limit - others
        outwards = ((new > highest) & (new > old)) | ((new < lowest) & (new < old))
        saturated = (new > highest) | (new < lowest)
        if rule == "cut":
            integral = np.minimum(new, np.maximum(old, highest))
            integral = np.maximum(integral, np.minimum(old, lowest))
        else:
            kept = {"inwards": outwards, "saturated": saturated, "outwards": saturated & ~outwards}
            integral = np.where(kept.get(rule, False), old, new)
        before, last, error_before = error, np.array(measured), error
        free = others + integral
        return np.clip(free, -limit, limit) if limited else free

    return step


_cutting = partial(_variant, rule="cut")


def _other_sign(kp: NDArray, ki: NDArray, kd: NDArray, dt: float, limit: NDArray) -> Step:
    return digital_pid(kp, ki, -kd, dt, limit)


MISTAKES = {
    "the integral without dt: faster sampling would make it stronger": (
        partial(_variant, sum_step=1.0)
    ),
    "the measured speed is a difference divided by dt": partial(_variant, rate_step=1.0),
    "the difference of the error kicks when the reference jumps: rate less measured speed": (
        partial(_variant, kick=True)
    ),
    "the reference moves: K_d times (rate - measured speed), or the joint lags behind": (
        partial(_variant, reference_rate=0.0)
    ),
    "the sign of the derivative: a measurement that rises must lower the output": _other_sign,
    "the first sample has no sample before it: let its derivative term be zero": (
        partial(_variant, start="zero")
    ),
    "the sum in (3.28) goes up to k: the present error belongs to it": (
        partial(_variant, late=True)
    ),
    "the output is limited, but the integral goes on growing meanwhile: it winds up": (
        partial(_variant, rule="always")
    ),
    "the integral stands still whenever the output is at its limit: let it come back in": (
        partial(_variant, rule="saturated")
    ),
    "clamped on the wrong side: the integral may move inwards, and must not move outwards": (
        partial(_variant, rule="outwards")
    ),
    "the output must stay within -limit and limit": (
        partial(_variant, rule="always", limited=False)
    ),
    "the integral starts from zero at each sample: keep it (nonlocal, or a class)": (
        partial(_variant, forgets=True)
    ),
}


def same_outputs(answer: Step, reference: Step, *gains: object) -> bool | str:
    """Compare step by step; accept freezing the integral and cutting it to the limit alike."""
    if not callable(answer):
        return "my_pid must return a function step(reference, rate, measured)"
    run = _run(len(gains[0]), gains[3])
    given = _outputs(answer, run)
    if isinstance(given, str):
        return given
    kept, cut = (_outputs(right(*gains), run) for right in (digital_pid, _cutting))
    if _near(given, kept) or _near(given, cut):
        return True
    for diagnosis, wrong in MISTAKES.items():
        if _near(given, _outputs(wrong(*gains), run)):
            return diagnosis
    if _near(np.clip(given, -gains[4], gains[4]), given):
        sample = max(_first_difference(given, right) for right in (kept, cut))
        return f"the outputs of sample {sample}, counted from 0, differ, and are right before it"
    return "the output must stay within -limit and limit, and something else differs"


def _run(loops: int, dt: float) -> tuple[NDArray, NDArray, NDArray]:
    """Reference with jumps and ramps, its rate, and a measurement that follows, (n, loops)."""
    rng = np.random.default_rng([3, 8, round(1e6 * dt)])
    size = (3, loops)
    jumps = rng.uniform(0.5, 1.0, size) * np.array([[1.0], [-1.0], [1.0]])
    slopes = rng.uniform(-0.5, 0.5, size)
    time = np.arange(40) * dt
    reference = np.concatenate([a + b * time[:, None] for a, b in zip(jumps, slopes, strict=True)])
    lag = [np.convolve(column, np.full(15, 1 / 15))[: len(column)] for column in reference.T]
    wave = 0.05 * np.sin(np.outer(np.arange(120), rng.uniform(0.2, 0.5, loops)))
    return reference, np.repeat(slopes, 40, axis=0), np.transpose(lag) + 0.3 + wave


def _outputs(step: Step, run: tuple[NDArray, NDArray, NDArray]) -> NDArray | str:
    given = [step(*(values.copy() for values in sample)) for sample in zip(*run, strict=True)]
    wanted = run[0].shape[1:]
    if any(np.shape(output) != wanted for output in given):
        return f"step must return one output for each loop, shape {wanted}, got {given[0]!r}"
    return np.array(given, dtype=float)


def _first_difference(one: NDArray, other: NDArray) -> int:
    """The first sample in which outputs (n, loops) differ; `_near` says that there is one."""
    return int(np.argmax(~np.isclose(one, other, rtol=1e-7, atol=1e-6).all(axis=1)))


def _near(one: NDArray, other: NDArray) -> bool:
    return np.allclose(one, other, rtol=1e-7, atol=1e-6)


def _cases(rng: np.random.Generator) -> list[tuple]:
    return [
        (
            *rng.uniform((20, 300, 1), (60, 900, 4), (4, 3)).T,
            float(rng.uniform(0.005, 0.02)),
            rng.uniform(20, 45, 4),
        )
        for _ in range(6)
    ]


DIGITAL = Exercise(
    number="3.8",
    title="a digital PID that knows its limits",
    reference=digital_pid,
    cases=_cases,
    compare=same_outputs,
    tested_on="6 sets of gains, 120 samples with jumps, ramps and saturation",
    hints=(
        "step must remember two things from sample to sample: the integral and the last angle",
        "try the new integral; where the output would leave its limit because of it, keep the old",
    ),
    mistakes=MISTAKES,
)
