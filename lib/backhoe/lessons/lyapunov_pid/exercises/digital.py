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


def _frozen(old: NDArray, new: NDArray, low: NDArray, high: NDArray) -> NDArray:
    return np.where((new > np.maximum(old, high)) | (new < np.minimum(old, low)), old, new)


def _cut(old: NDArray, new: NDArray, low: NDArray, high: NDArray) -> NDArray:
    return np.clip(new, np.minimum(old, low), np.maximum(old, high))


def _stuck(old: NDArray, new: NDArray, low: NDArray, high: NDArray) -> NDArray:
    return np.where((new > high) | (new < low), old, new)


def _wrong_side(old: NDArray, new: NDArray, low: NDArray, high: NDArray) -> NDArray:
    return np.where(new == _frozen(old, new, low, high), _stuck(old, new, low, high), new)


def _variant(
    kp: NDArray,
    ki: NDArray,
    kd: NDArray,
    dt: float,
    limit: NDArray,
    *,
    rule: Callable[..., NDArray] = _frozen,
    late: bool = False,
    kick: bool = False,
    kept: float = 1.0,
    moving: float = 1.0,
    last: NDArray | None = None,
) -> Step:
    """The same PID with one thing changed: `rule` takes old and new integral and its bounds."""
    integral = before = np.zeros(len(kp))
    aim = None

    def step(reference: NDArray, rate: NDArray, measured: NDArray) -> NDArray:
        nonlocal integral, before, aim, last
        rate = (reference - aim) / dt if kick and aim is not None else moving * rate
        error = reference - measured
        speed = rate if last is None else (measured - last) / dt
        others = kp * error + kd * (rate - speed)
        old = kept * integral
        new = old + ki * dt * (before if late else error)
        integral = rule(old, new, -limit - others, limit - others)
        before, aim, last = error, reference, measured
        return np.clip(others + integral, -limit, limit)

    return step


MISTAKES = {
    "the integral without dt: faster sampling would make it stronger": (
        lambda kp, ki, kd, dt, limit: digital_pid(kp, ki / dt, kd, dt, limit)
    ),
    "the measured speed is a difference divided by dt": (
        lambda kp, ki, kd, dt, limit: _variant(kp, ki, kd * dt, dt, limit, moving=1 / dt)
    ),
    "the difference of the error kicks when the reference jumps: rate less measured speed": (
        partial(_variant, kick=True)
    ),
    "the reference moves: K_d times (rate - measured speed), or the joint lags behind": (
        partial(_variant, moving=0.0)
    ),
    "the sign of the derivative: a measurement that rises must lower the output": (
        lambda kp, ki, kd, dt, limit: digital_pid(kp, ki, -kd, dt, limit)
    ),
    "the first sample has no sample before it: let its derivative term be zero": (
        partial(_variant, last=0.0)
    ),
    "the sum in (3.28) goes up to k: the present error belongs to it": partial(_variant, late=True),
    "the output is limited, but the integral goes on growing meanwhile: it winds up": (
        partial(_variant, rule=lambda old, new, low, high: new)
    ),
    "the integral stands still whenever the output is at its limit: let it come back in": (
        partial(_variant, rule=_stuck)
    ),
    "clamped on the wrong side: the integral may move inwards, and must not move outwards": (
        partial(_variant, rule=_wrong_side)
    ),
    "the output must stay within -limit and limit": (
        lambda kp, ki, kd, dt, limit: digital_pid(kp, ki, kd, dt, np.inf)
    ),
    "the integral starts from zero at each sample: keep it (nonlocal, or a class)": (
        partial(_variant, kept=0.0)
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
    kept, cut = (_outputs(_variant(*gains, rule=rule), run) for rule in (_frozen, _cut))
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
    oracle="least_overshoot_of_two_integrals",
    cases=_cases,
    compare=same_outputs,
    tested_on="6 sets of gains, 120 samples with jumps, ramps and saturation",
    hints=(
        "step must remember two things from sample to sample: the integral and the last angle",
        "try the new integral; where the output would leave its limit because of it, keep the old",
    ),
    mistakes=MISTAKES,
)
