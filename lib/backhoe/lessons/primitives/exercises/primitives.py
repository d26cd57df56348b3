"""Exercises of lesson 10a: the spring and its clock, the force, its weights, real recordings."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.planning.dmp import phase_rate

__all__ = ["EXERCISES"]


def tuning(K: float, tau: float, duration: float, end: float) -> tuple[float, float]:
    """D without overshoot, and alpha of a phase that has fallen to `end` after `duration`."""
    return 2 * K**0.5, phase_rate(duration, tau, end)


def _tunings(rng: np.random.Generator) -> list[tuple]:
    return [
        (10 ** rng.uniform(1, 5), rng.uniform(0.5, 8), rng.uniform(2, 20), rng.uniform(1e-3, 0.1))
        for _ in range(30)
    ]


def _alpha(of: Callable[[float, float, float], float]) -> Callable[..., tuple[float, float]]:
    return lambda K, tau, duration, end: (2 * K**0.5, of(tau, duration, end))


def _damping(of: Callable[[float], float]) -> Callable[..., tuple[float, float]]:
    return lambda K, tau, duration, end: (of(K), phase_rate(duration, tau, end))


TUNING = Exercise(
    number="10.1",
    title="Damping and clock",
    reference=tuning,
    cases=_tunings,
    oracle="roots_meet_and_the_clock_runs_down",
    mistakes={
        "that D is half of it: the roots meet at D^2 = 4 K": _damping(lambda K: K**0.5),
        "2 K is far too stiff a damper: the root of K is missing": _damping(lambda K: 2 * K),
        "the root is of K alone: 2 sqrt(K), not sqrt(2 K)": _damping(lambda K: (2 * K) ** 0.5),
        "the damping ratio is 1, so D itself is not 1": _damping(lambda K: 1.0),
        "alpha runs on tau's clock: multiply by tau": _alpha(lambda tau, T, end: -np.log(end) / T),
        "tau is on the wrong side: alpha / tau is the rate of the phase": _alpha(
            lambda tau, T, end: -np.log(end) / (tau * T)
        ),
        "with this sign the phase grows: alpha is positive": _alpha(
            lambda tau, T, end: np.log(end) * tau / T
        ),
        "the logarithm belongs to e, not to 10": _alpha(
            lambda tau, T, end: -np.log10(end) * tau / T
        ),
        "the phase does not fall on a straight line: it is exp(-alpha t / tau)": _alpha(
            lambda tau, T, end: (1 - end) * tau / T
        ),
    },
    hints=(
        "The spring's roots solve tau^2 p^2 + D tau p + K = 0; without overshoot they are equal.",
        "s(t) = exp(-alpha t / tau): set s(duration) = end and solve for alpha.",
    ),
    tested_on="30 springs and durations",
)


def target(
    x: NDArray, dx: NDArray, ddx: NDArray, s: NDArray, tau: float, K: float, D: float
) -> NDArray:
    """The force that moves the spring as demonstrated, from x[0] to x[-1], shape (n,): (6.8)."""
    v, dv = tau * dx, tau * ddx
    return (tau * dv + D * v) / K - (x[-1] - x) + (x[-1] - x[0]) * s


def _shown(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(20):
        t = np.cumsum(rng.uniform(0.05, 0.3, 40))
        a, b, c, w, p = rng.normal(size=5)
        x, dx, ddx = a + b * t + c * np.sin(w * t + p), b + c * w * np.cos(w * t + p), -c * w * w
        cases.append(
            (
                x,
                dx,
                ddx * np.sin(w * t + p),
                np.exp(-rng.uniform(3, 7) * t / t[-1]),
                rng.uniform(0.5, 6),
                10 ** rng.uniform(0.5, 2.5),
                rng.uniform(3, 30),
            )
        )
    return cases


TARGET = Exercise(
    number="10.2",
    title="The force behind a demonstration",
    reference=target,
    cases=_shown,
    oracle="put_back_into_the_spring",
    mistakes={
        "v is tau dx/dt, and dv/dt is tau times the acceleration: both tau are missing": (
            lambda x, dx, ddx, s, tau, K, D: target(x, dx, ddx / tau, s, tau, K, D / tau)
        ),
        "the acceleration has tau twice: tau dv/dt with v = tau dx/dt": (
            lambda x, dx, ddx, s, tau, K, D: target(x, dx, ddx / tau, s, tau, K, D)
        ),
        "the damper's v is tau dx/dt too: one tau is missing": (
            lambda x, dx, ddx, s, tau, K, D: target(x, dx, ddx, s, tau, K, D / tau)
        ),
        "the force is measured in lengths: divide the first part by K": (
            lambda x, dx, ddx, s, tau, K, D: target(x, dx, ddx, s, tau, 1.0, D)
        ),
        "K divides the first part alone: the others have no K left": (
            lambda x, dx, ddx, s, tau, K, D: (
                (tau**2 * ddx + D * tau * dx - (x[-1] - x) + (x[-1] - x[0]) * s) / K
            )
        ),
        "the damper holds back, so f has to push against it: plus D v": (
            lambda x, dx, ddx, s, tau, K, D: target(x, dx, ddx, s, tau, K, -D)
        ),
        "the sign of (g - x0) s is turned over": (
            lambda x, dx, ddx, s, tau, K, D: (
                target(x, dx, ddx, s, tau, K, D) - 2 * (x[-1] - x[0]) * s
            )
        ),
        "(g - x0) s is missing: without it f does not start at 0": (
            lambda x, dx, ddx, s, tau, K, D: target(x, dx, ddx, s, tau, K, D) - (x[-1] - x[0]) * s
        ),
        "the sign of g - x is turned over": (
            lambda x, dx, ddx, s, tau, K, D: target(x, dx, ddx, s, tau, K, D) + 2 * (x[-1] - x)
        ),
        "the goal is the last position, the start the first": (
            lambda x, dx, ddx, s, tau, K, D: (
                target(x, dx, ddx, s, tau, K, D) + (x[-1] - x[0]) * (1 - 2 * s)
            )
        ),
    },
    hints=(
        "Solve the equation of the spring for f, with v = tau dx/dt put in: tau dv/dt is then "
        "tau^2 times the acceleration.",
        "f = (tau^2 ddx + D tau dx) / K - (g - x) + (g - x0) s, with g = x[-1] and x0 = x[0].",
    ),
    tested_on="20 smooth movements with springs of their own",
)


def weights(s: NDArray, f: NDArray, centres: NDArray, widths: NDArray) -> NDArray:
    """Each kernel's own least squares of f = w s, shape (kernels,)."""
    psi = np.exp(-widths * (s[:, None] - centres) ** 2)
    return (psi * (s * f)[:, None]).sum(axis=0) / (psi * (s * s)[:, None]).sum(axis=0)


def _samples(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(20):
        rate, n = rng.uniform(3, 7), 5 + k % 4
        s = np.exp(-rate * np.sort(np.r_[0, rng.uniform(size=60), 1]))
        centres = np.exp(-rate * np.linspace(0, 1, n))
        apart = -np.diff(centres, append=0.5 * centres[-1])
        cases.append((s, rng.normal(size=62), centres, rng.uniform(0.3, 0.8, n) / apart**2))
    return cases


def _summed(above: Callable, below: Callable) -> Callable[..., NDArray]:
    """Weights as sum(above) / sum(below), of psi and s and f as columns."""

    def answer(s, f, centres, widths):
        psi, s, f = np.exp(-widths * (s[:, None] - centres) ** 2), s[:, None], f[:, None]
        return above(psi, s, f).sum(axis=0) / below(psi, s).sum(axis=0)

    return answer


def _all_together(s: NDArray, f: NDArray, centres: NDArray, widths: NDArray) -> NDArray:
    psi = np.exp(-widths * (s[:, None] - centres) ** 2)
    return np.linalg.lstsq(s[:, None] * psi / psi.sum(axis=1, keepdims=True), f, rcond=None)[0]


WEIGHTS = Exercise(
    number="10.3",
    title="Each kernel for itself",
    reference=weights,
    cases=_samples,
    oracle="least_squares_of_each_kernel_alone",
    mistakes={
        "that is the mean of f around the kernel: the model is w s, so weigh with s above and s^2 "
        "below": _summed(lambda psi, s, f: psi * f, lambda psi, s: psi),
        "that is the mean of f / s around the kernel; the least squares of f = w s weigh with s "
        "once more": _summed(lambda psi, s, f: psi * f / s, lambda psi, s: psi),
        "s^2 below, for the model's square; one s is missing": _summed(
            lambda psi, s, f: psi * s * f, lambda psi, s: psi * s
        ),
        "psi counts once in the squared error, not squared": _summed(
            lambda psi, s, f: psi**2 * s * f, lambda psi, s: psi**2 * s * s
        ),
        "the sum is not divided: sum(psi s^2) is missing below": _summed(
            lambda psi, s, f: psi * s * f, lambda psi, s: np.ones((1, 1))
        ),
        "without psi all kernels learn the same": _summed(
            lambda psi, s, f: s * f + 0 * psi, lambda psi, s: s * s + 0 * psi
        ),
        "that fits all weights together; here each kernel learns for itself": _all_together,
        "the distance is squared in the exponent": (
            lambda s, f, centres, widths: _summed(
                lambda psi, s, f: np.exp(-widths * np.abs(s - centres)) * s * f,
                lambda psi, s: np.exp(-widths * np.abs(s - centres)) * s * s,
            )(s, f, centres, widths)
        ),
        "h is a sharpness, not a width: it multiplies the squared distance": (
            lambda s, f, centres, widths: weights(s, f, centres, 0.5 / widths**2)
        ),
    },
    hints=(
        "Kernel i looks for the w with the least sum over all samples of psi_i (f - w s)^2.",
        "The derivative is 0 where w = sum(psi_i s f) / sum(psi_i s^2).",
    ),
    tested_on="20 random targets with 5 to 8 kernels",
)


def acceleration(times: NDArray, x: NDArray, half: float) -> NDArray:
    """Twice the leading number of the parabola through all samples within `half` of each time."""
    near = [np.abs(times - t) < half for t in times]
    return np.array(
        [2 * np.polyfit(times[k] - t, x[k], 2)[0] for k, t in zip(near, times, strict=True)]
    )


def _recordings(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(12):
        t = np.cumsum(rng.uniform(0.016, 0.151, 60))
        w, start = rng.uniform((0.5, -3.0), (2.0, 3.0))
        cases.append(
            (t + start, np.sin(w * t + start) + 5e-3 * rng.normal(size=60), rng.uniform(0.5, 0.9))
        )
    return cases


def _parabolas(of: Callable[..., float]) -> Callable[..., NDArray]:
    """`of` the times from the middle one, and the positions there, window by window."""

    def answer(times, x, half):
        near = [np.abs(times - t) < half for t in times]
        return np.array([of(times[k] - t, x[k]) for k, t in zip(near, times, strict=True)])

    return answer


def _even(times: NDArray, x: NDArray, half: float) -> NDArray:
    even = np.linspace(times[0], times[-1], len(times))
    return acceleration(even, x, half)


ACCELERATION = Exercise(
    number="10.4",
    title="Repair an acceleration",
    reference=acceleration,
    cases=_recordings,
    oracle="parabolas_by_numpy",
    mistakes={
        "the times are uneven: fit over the times themselves, not over their mean step": _even,
        "those are second differences: three samples alone, so the noise is divided by dt^2": (
            lambda times, x, half: np.gradient(np.gradient(x, times), times)
        ),
        "differences with the mean step: the times are uneven, and the noise is divided by dt^2": (
            lambda times, x, half: np.gradient(np.gradient(x)) / np.diff(times).mean() ** 2
        ),
        "the parabola is a t^2 + b t + c, and its second derivative is 2 a": _parabolas(
            lambda t, x: np.polyfit(t, x, 2)[0]
        ),
        "that is the velocity: the second derivative is asked for": _parabolas(
            lambda t, x: np.polyfit(t, x, 2)[1]
        ),
        "half is the window's half width: samples on both sides count up to `half` away": (
            lambda times, x, half: acceleration(times, x, half / 2)
        ),
        "that is one parabola for the whole recording: a new one for each time": (
            lambda times, x, half: np.full(len(times), 2 * np.polyfit(times, x, 2)[0])
        ),
    },
    hints=(
        "For each time: near = np.abs(times - t) < half; then np.polyfit on those samples.",
        "np.polyfit(times[near] - t, x[near], 2) gives a, b, c of a t^2 + b t + c.",
    ),
    rtol=1e-5,
    atol=1e-6,
    tested_on="12 noisy recordings with uneven times",
)

EXERCISES = (TUNING, TARGET, WEIGHTS, ACCELERATION)
