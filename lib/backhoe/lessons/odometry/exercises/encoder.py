"""Exercise 6.6: from the readings of a counter that wraps round to signed ticks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise


def ticks(counts: NDArray, bits: int) -> NDArray:
    """Ticks from reading to reading of a counter of so many bits, shape (n - 1,)."""
    span = 2**bits
    return (np.diff(counts) + span // 2) % span - span // 2


def _readings(rng: np.random.Generator) -> list[tuple[NDArray, int]]:
    cases = []
    for bits in (8, 10, 12, 16) * 4:
        steps = rng.integers(-(2 ** (bits - 2)), 2 ** (bits - 2), 40)
        if rng.uniform() < 0.5:
            steps = np.abs(steps) + 1
        counts = (rng.integers(0, 2**bits) + np.cumsum(steps)) % 2**bits
        cases.append((counts, bits))
    return cases


def _of_steps(rule: Callable[[NDArray, int], NDArray]) -> Callable[[NDArray, int], NDArray]:
    """`rule` of the differences between readings and the counter's span."""
    return lambda counts, bits: rule(np.diff(counts), 2**bits)


TICKS = Exercise(
    number="6.6",
    title="A counter that wraps round",
    reference=ticks,
    oracle="unwrapped_by_numpy",
    cases=_readings,
    mistakes={
        "when the counter passes its end, it seems to jump back by all of its span": (
            _of_steps(lambda steps, span: steps)
        ),
        "it only ever runs forwards: a small step back reads as nearly a whole span": (
            _of_steps(np.remainder)
        ),
        "the sign is lost: backwards counts negative": lambda *given: np.abs(ticks(*given)),
        "one tick is lost at each wrap: a counter of b bits has 2^b readings, 0 included": (
            _of_steps(lambda steps, span: (steps + span // 2) % (span - 1) - span // 2)
        ),
        "the span is that of 16 bits each time: use the bits that you are given": (
            lambda counts, bits: ticks(counts, 16)
        ),
        "np.unwrap takes these for radians: tell it the period, or scale them first": (
            lambda counts, bits: np.diff(np.unwrap(counts.astype(float)))
        ),
        "these are the ticks since the start: return those from reading to reading": (
            lambda *given: np.cumsum(ticks(*given))
        ),
        "wraps forwards are repaired, wraps backwards are not: a rise may be too large, too": (
            _of_steps(lambda steps, span: np.where(steps < -span / 2, steps + span, steps))
        ),
        "steps over the wrap are thrown away: repair them instead": (
            _of_steps(lambda steps, span: np.where(np.abs(steps) > span / 2, 0, steps))
        ),
        "the modulus goes on counting downwards: half a span more, and it is signed": (
            _of_steps(lambda steps, span: np.remainder(steps, span) - span)
        ),
        "wraps backwards are repaired, wraps forwards are not: a fall may be too large, too": (
            _of_steps(lambda steps, span: np.where(steps > span / 2, steps - span, steps))
        ),
        "a counter of b bits has 2^b readings, not 2 b": (
            lambda counts, bits: (np.diff(counts) + bits) % (2 * bits) - bits
        ),
        "forwards counts positive: newer reading minus older reading": lambda *given: (
            -ticks(*given)
        ),
    },
    hints=(
        "The true step is the plain difference plus or minus a whole number of spans, 2**bits.",
        "Shift by half a span, take the remainder, shift back: (d + span/2) % span - span/2.",
    ),
    tested_on="16 counters of 8 to 16 bits, forwards and backwards over their ends",
)
