"""Exercises 3.8 and 3.9: a sampled PID for the four joints that knows its limits, and a filter."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise

Step = Callable[[NDArray, NDArray, NDArray], NDArray]
SAMPLES = 90


def _not_beyond(integral: NDArray, more: NDArray, others: NDArray, limit: NDArray) -> NDArray:
    """The integral with what comes to it, but where that drives an output beyond its limit."""
    wanted = integral + more
    over = (others + wanted > limit) & (wanted > integral)
    under = (others + wanted < -limit) & (wanted < integral)
    return np.where(over | under, integral, wanted)


def digital_pid(kp: NDArray, ki: NDArray, kd: NDArray, dt: float, limit: NDArray) -> Step:
    """A PID for n loops: step(reference, rate, measured) gives the outputs of one sample, (n,)."""
    integral, last = np.zeros(len(kp)), None

    def step(reference: NDArray, rate: NDArray, measured: NDArray) -> NDArray:
        nonlocal integral, last
        error = reference - measured
        speed = rate if last is None else (measured - last) / dt
        others = kp * error + kd * (rate - speed)
        integral = _not_beyond(integral, ki * error * dt, others, limit)
        last = np.array(measured)
        return np.clip(others + integral, -limit, limit)

    return step


def filtered_pid(
    kp: NDArray, ki: NDArray, kd: NDArray, dt: float, limit: NDArray, filter_time: float
) -> Step:
    """The same PID, whose measured speed passes a filter of the first order, time constant [s]."""
    integral, speed, last = np.zeros(len(kp)), np.zeros(len(kp)), None

    def step(reference: NDArray, rate: NDArray, measured: NDArray) -> NDArray:
        nonlocal integral, speed, last
        error, braking = reference - measured, np.zeros(len(kp))
        if last is not None:
            speed = (filter_time * speed + measured - last) / (filter_time + dt)
            braking = kd * (rate - speed)
        others = kp * error + braking
        integral = _not_beyond(integral, ki * error * dt, others, limit)
        last = np.array(measured)
        return np.clip(others + integral, -limit, limit)

    return step


def _out(old: NDArray, new: NDArray, low: NDArray, high: NDArray) -> NDArray:
    return (new > np.maximum(old, high)) | (new < np.minimum(old, low))


def _frozen(old: NDArray, new: NDArray, low: NDArray, high: NDArray) -> NDArray:
    return np.where(_out(old, new, low, high), old, new)


def _cut(old: NDArray, new: NDArray, low: NDArray, high: NDArray) -> NDArray:
    return np.clip(new, np.minimum(old, low), np.maximum(old, high))


def _stuck(old: NDArray, new: NDArray, low: NDArray, high: NDArray) -> NDArray:
    return np.where((new > high) | (new < low), old, new)


def _wrong_side(old: NDArray, new: NDArray, low: NDArray, high: NDArray) -> NDArray:
    return np.where(_out(old, new, low, high), new, _stuck(old, new, low, high))


def _alone(old: NDArray, new: NDArray, low: NDArray, high: NDArray) -> NDArray:
    return np.clip(new, (low - high) / 2, (high - low) / 2)


def _together(old: NDArray, new: NDArray, low: NDArray, high: NDArray) -> NDArray:
    return old if _out(old, new, low, high).any() else new


def _no_filter(speed: NDArray, raw: NDArray, dt: float, time: float) -> NDArray:
    return raw


def _backward(speed: NDArray, raw: NDArray, dt: float, time: float) -> NDArray:
    return (time * speed + dt * raw) / (time + dt)


def _exchanged(speed: NDArray, raw: NDArray, dt: float, time: float) -> NDArray:
    return (dt * speed + time * raw) / (time + dt)


def _forward(speed: NDArray, raw: NDArray, dt: float, time: float) -> NDArray:
    return speed + dt / time * (raw - speed)


def _variant(
    kp: NDArray,
    ki: NDArray,
    kd: NDArray,
    dt: float,
    limit: NDArray,
    filter_time: float = 0.0,
    *,
    rule: Callable[..., NDArray] = _frozen,
    smooth: Callable[..., NDArray] = _backward,
    once: float | None = None,
    divided: bool = True,
    turned: float = 1.0,
    wrong_way: float = 1.0,
    late: bool = False,
    kick: bool = False,
    lags: bool = False,
    kept: float = 1.0,
    moving: float = 1.0,
    last: NDArray | None = None,
    moves_on: bool = True,
    limited: tuple[float, float] = (1.0, 1.0),
) -> Step:
    """The same PID with one thing changed: `rule` takes old and new integral and its bounds."""
    integral = before = speed = slow_rate = np.zeros(len(kp))
    aim = None

    def step(reference: NDArray, rate: NDArray, measured: NDArray) -> NDArray:
        nonlocal integral, before, aim, last, speed, slow_rate
        rate = (reference - aim) / dt if kick and aim is not None else moving * rate
        if lags:
            rate = slow_rate = _backward(slow_rate, rate, dt, filter_time)
        error = wrong_way * (reference - measured)
        braking = np.zeros(len(kp))
        if last is not None:
            raw = (measured - last) / (dt if divided else 1.0)
            speed = smooth(speed, raw, dt, filter_time)
            braking = turned * kd * (rate - speed)
        others = kp * error + braking
        old = kept * integral
        new = old + ki * (dt if once is None else once) * (before if late else error)
        integral = rule(old, new, -limit - others, limit - others)
        before, aim = error, reference
        last = measured if moves_on or last is None else last
        low, high = (side * limit if np.isfinite(side) else side for side in limited)
        return np.clip(others + integral, -low, high)

    return step


WINDS_UP = "the output is limited, but the integral goes on growing meanwhile: it winds up"
SLIPS = {
    "the integral without dt: faster sampling would make it stronger": {"once": 1.0},
    "the measured speed is a difference divided by dt": {"divided": False},
    "the difference of the error kicks when the reference jumps: rate less measured speed": {
        "kick": True
    },
    "the reference moves: K_d times (rate - measured speed), or the joint lags behind": {
        "moving": 0.0
    },
    "the sign of the derivative: a measurement that rises must lower the output": {"turned": -1.0},
    "the sign of the error: it is reference less measured": {"wrong_way": -1.0},
    "the first sample has no sample before it: let its derivative term be zero": {"last": 0.0},
    "the speed comes from the last two samples: remember the new one each time": {
        "moves_on": False
    },
    "the sum goes up to k: the present error belongs to it": {"late": True},
    WINDS_UP: {"rule": lambda old, new, low, high: new},
    "the integral alone is kept within the limit: what counts is the whole output": {
        "rule": _alone
    },
    "the integral stands still whenever the output is at its limit: let it come back in": {
        "rule": _stuck
    },
    "one joint at its limit stops the integrals of all: decide joint by joint": {"rule": _together},
    "clamped on the wrong side: the integral may move inwards, and must not move outwards": {
        "rule": _wrong_side
    },
    "the output must stay within -limit and limit": {"limited": (np.inf, np.inf)},
    "the output is limited above only: -limit counts as well": {"limited": (np.inf, 1.0)},
    "the integral starts from zero at each sample: keep it (nonlocal, or a class)": {"kept": 0.0},
}
FILTER_SLIPS = {
    "the measured speed is not filtered yet": {"smooth": _no_filter},
    "the filter's weights are exchanged: the old speed weighs T_f, the new difference dt": {
        "smooth": _exchanged
    },
    "that is the forward rule, unstable for T_f below dt / 2: T_f + dt stands below": {
        "smooth": _forward
    },
    "the rate needs no filter: only the measured speed has steps, and a filter comes late": {
        "lags": True
    },
}


def _named(slips: dict[str, dict]) -> dict[str, Callable[..., Step]]:
    return {diagnosis: partial(_variant, **slip) for diagnosis, slip in slips.items()}


def _in_turn(slips: dict[str, dict]) -> Iterator[tuple[str, Callable[..., Step]]]:
    """The mistakes beside either integral that the text allows, then beside one that winds up."""
    for rule in (_frozen, _cut, SLIPS[WINDS_UP]["rule"]):
        for diagnosis, slip in slips.items():
            if rule is _frozen or "rule" not in slip:
                yield diagnosis, partial(_variant, **{"rule": rule} | slip)


def same_outputs(answer: Step, reference: Step, *gains: object) -> bool | str:
    """Compare step by step; accept freezing the integral and cutting it to the limit alike."""
    if not callable(answer):
        return "return the function step(reference, rate, measured) itself"
    run = _run(len(gains[0]), gains[3])
    given = _outputs(answer, run)
    if isinstance(given, str):
        return given
    kept, cut = (_outputs(_variant(*gains, rule=rule), run) for rule in (_frozen, _cut))
    if _near(given, kept) or _near(given, cut):
        return True
    slips = SLIPS if len(gains) == 5 else FILTER_SLIPS | SLIPS
    for diagnosis, wrong in _in_turn(slips):
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
    time = np.arange(SAMPLES // 3) * dt
    reference = np.concatenate([a + b * time[:, None] for a, b in zip(jumps, slopes, strict=True)])
    lag = [np.convolve(column, np.full(15, 1 / 15))[: len(column)] for column in reference.T]
    wave = 0.05 * np.sin(np.outer(np.arange(SAMPLES), rng.uniform(0.2, 0.5, loops)))
    return reference, np.repeat(slopes, SAMPLES // 3, axis=0), np.transpose(lag) + 0.3 + wave


def _outputs(step: Step, run: tuple[NDArray, NDArray, NDArray]) -> NDArray | str:
    with np.errstate(over="ignore", invalid="ignore"):
        given = [step(*(values.copy() for values in sample)) for sample in zip(*run, strict=True)]
    wanted = run[0].shape[1:]
    if any(output is None for output in given):
        return "step returns nothing: let it return the torques of the sample"
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
            rng.uniform(8, 24, 4),
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
    timeout=20.0,
    tested_on="6 sets of gains, 90 samples with jumps, ramps and saturation",
    hints=(
        "step must remember two things from sample to sample: the integral and the last angle",
        "try the new integral; where the output would leave its limit because of it, keep the old",
    ),
    mistakes=_named(SLIPS),
)

FILTERED = Exercise(
    number="3.9",
    title="a speed from steps",
    reference=filtered_pid,
    oracle="least_overshoot_with_a_filtered_speed",
    cases=lambda rng: [(*case, 1e-3 * 10 ** rng.uniform(0, 1.7)) for case in _cases(rng)],
    compare=same_outputs,
    timeout=20.0,
    tested_on="6 sets of gains, limits and filter times from 1 to 50 ms",
    hints=(
        "a third thing to remember: the filtered speed, zero before the second sample",
        "speed = (filter_time * speed + measured - last) / (filter_time + dt)",
    ),
    mistakes=_named(FILTER_SLIPS),
)
