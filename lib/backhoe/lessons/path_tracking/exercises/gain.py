"""Exercise 5.9: the same gain at another sample time."""

from __future__ import annotations

from math import exp

import numpy as np

from backhoe.lessons.exercise import Exercise


def gain_at(k: float, T0: float, new_T0: float) -> float:
    """Gain that leaves, at samples of new_T0 [s], what k leaves in the same time at T0 [s]."""
    return 1 - (1 - k) ** (new_T0 / T0)


def _cases(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(30):
        periods = rng.uniform(0.01, 0.05) * rng.integers(1, 9, 2)
        cases.append((float(rng.uniform(0.05, 0.95)), *periods.tolist()))
    ends = [(0.0, 0.1, 0.2), (1.0, 0.1, 0.3), (0.4, 0.2, 0.2), (0.4, 0.2, 0.05), (0.9, 0.05, 0.4)]
    return cases + ends


GAIN = Exercise(
    number="5.9",
    title="The same gain at another sample time",
    reference=gain_at,
    oracle="the_same_is_left_after_many_samples",
    cases=_cases,
    mistakes={
        "that is the old gain: with shorter samples it takes its share more often": (
            lambda k, T0, new_T0: k
        ),
        "in proportion to the sample it is right for small gains only: multiply what is left": (
            lambda k, T0, new_T0: k * new_T0 / T0
        ),
        "in proportion, and cut at 1: multiply what is left, sample after sample": (
            lambda k, T0, new_T0: min(1.0, k * new_T0 / T0)
        ),
        "upside down: a shorter sample needs a smaller gain": lambda k, T0, new_T0: k * T0 / new_T0,
        "the exponent is upside down: a second has 1 / T0 samples": (
            lambda k, T0, new_T0: gain_at(k, new_T0, T0)
        ),
        "that is the share that is left: the gain is 1 minus it": (
            lambda k, T0, new_T0: (1 - k) ** (new_T0 / T0)
        ),
        "a power of k is what has gone: take the power of what is left, 1 - k": (
            lambda k, T0, new_T0: k ** (new_T0 / T0)
        ),
        "that multiplies what is left by the ratio: it is left over and over, a power": (
            lambda k, T0, new_T0: 1 - (1 - k) * new_T0 / T0
        ),
        "that is how much has gone after a second: which gain does as much with new_T0?": (
            lambda k, T0, new_T0: 1 - (1 - k) ** (1 / T0)
        ),
        "1 minus a power of k: take the power of what is left, 1 - k": (
            lambda k, T0, new_T0: 1 - k ** (new_T0 / T0)
        ),
        "that is the gain for each second: of a gain at new_T0 is asked": (
            lambda k, T0, new_T0: k / T0
        ),
        "the exponent is a ratio of the sample times, not their difference": (
            lambda k, T0, new_T0: 1 - (1 - k) ** (new_T0 - T0)
        ),
        "exp(-k) is near to 1 - k for small gains only: take 1 - k itself": (
            lambda k, T0, new_T0: 1 - exp(-k * new_T0 / T0)
        ),
    },
    hints=(
        "What is left after a second: 1 - k multiplied by itself once a sample, 1 / T0 times.",
        "(1 - k')^(1/T0') = (1 - k)^(1/T0): raise both sides to the power T0'.",
    ),
    tested_on="35 gains and pairs of sample times",
)
