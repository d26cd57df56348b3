"""Exercise 6.6: from the readings of a counter that wraps round to signed ticks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise


def ticks(counts: NDArray, bits: int) -> NDArray:
    """Ticks from reading to reading of a counter of so many bits, shape (n - 1,)."""
    span = 2**bits
    return (np.diff(counts) + span // 2) % span - span // 2


def _readings(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for bits in (8, 10, 12, 16) * 4:
        steps = rng.integers(-(2 ** (bits - 2)), 2 ** (bits - 2), 40)
        if rng.uniform() < 0.5:
            steps = np.abs(steps) + 1
        counts = (rng.integers(0, 2**bits) + np.cumsum(steps)) % 2**bits
        cases.append((counts, bits))
    return cases


def _modulo(counts: NDArray, bits: int, span: float, shift: float) -> NDArray:
    return (np.diff(counts) + shift) % span - shift


TICKS = Exercise(
    number="6.6",
    title="A counter that wraps round",
    reference=ticks,
    cases=_readings,
    mistakes={
        "when the counter passes its end, it seems to jump back by all of its span": (
            lambda counts, bits: np.diff(counts)
        ),
        "it only ever runs forwards: a small step back reads as nearly a whole span": (
            lambda counts, bits: np.diff(counts) % 2**bits
        ),
        "the sign is lost: backwards counts negative": (
            lambda counts, bits: np.abs(ticks(counts, bits))
        ),
        "one tick is lost at each wrap: a counter of b bits has 2^b readings, 0 included": (
            lambda counts, bits: _modulo(counts, bits, 2**bits - 1, 2 ** (bits - 1))
        ),
        "the span is that of 16 bits each time: use the bits that you are given": (
            lambda counts, bits: _modulo(counts, 16, 2**16, 2**15)
        ),
        "np.unwrap takes these for radians: tell it the period, or scale them first": (
            lambda counts, bits: np.diff(np.unwrap(counts.astype(float)))
        ),
        "these are the ticks since the start: return those from reading to reading": (
            lambda counts, bits: np.cumsum(ticks(counts, bits))
        ),
        "wraps forwards are repaired, wraps backwards are not: a rise may be too large, too": (
            lambda counts, bits: np.where(
                np.diff(counts) < -(2 ** (bits - 1)), np.diff(counts) + 2**bits, np.diff(counts)
            )
        ),
        "steps over the wrap are thrown away: repair them instead": (
            lambda counts, bits: np.where(
                np.abs(np.diff(counts)) > 2 ** (bits - 1), 0, np.diff(counts)
            )
        ),
        "forwards counts positive: newer reading minus older reading": (
            lambda counts, bits: -ticks(counts, bits)
        ),
    },
    hints=(
        "The true step is the plain difference plus or minus a whole number of spans, 2**bits.",
        "Shift by half a span, take the remainder, shift back: (d + span/2) % span - span/2.",
    ),
    tested_on="16 counters of 8 to 16 bits, forwards and backwards over their ends",
)
