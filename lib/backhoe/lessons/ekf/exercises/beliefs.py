"""Exercise 7.1: one step of a Bayes filter over finitely many places."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise


def bayes(belief: NDArray, transition: NDArray, likelihood: NDArray) -> NDArray:
    """Belief after a move and a measurement, shape (n,): (4.7) with its marginals."""
    moved = transition @ belief
    joint = likelihood * moved
    return joint / joint.sum()


def _cases(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for n in rng.integers(3, 9, 30):
        belief, transition = rng.uniform(0.05, 1.0, n), rng.uniform(0.05, 1.0, (n, n))
        belief, transition = belief / belief.sum(), transition / transition.sum(axis=0)
        cases.append((belief, transition, rng.uniform(0.05, 1.0, n)))
    return cases


def _normalised(joint: NDArray) -> NDArray:
    return joint / joint.sum()


BAYES = Exercise(
    number="7.1",
    title="One step of a Bayes filter",
    reference=bayes,
    cases=_cases,
    mistakes={
        "the transition is transposed: row i, column j is from j to i": (
            lambda belief, transition, likelihood: bayes(belief, transition.T, likelihood)
        ),
        "it does not sum to 1: the evidence P(z_k | z_1:k-1) is missing": (
            lambda belief, transition, likelihood: likelihood * (transition @ belief)
        ),
        "the measurement comes before the move: it was taken at the new place": (
            lambda belief, transition, likelihood: transition @ _normalised(likelihood * belief)
        ),
        "the machine has not moved: carry the belief through the transition first": (
            lambda belief, transition, likelihood: _normalised(likelihood * belief)
        ),
        "that is the prediction alone: the likelihood is not used": (
            lambda belief, transition, likelihood: transition @ belief
        ),
        "that forgets all that was known before: multiply by the predicted belief": (
            lambda belief, transition, likelihood: _normalised(likelihood)
        ),
        "likelihood and prediction are added: (4.4) multiplies them": (
            lambda belief, transition, likelihood: _normalised(likelihood + transition @ belief)
        ),
        "it is divided by the largest value: divide by the sum": (
            lambda belief, transition, likelihood: (
                likelihood * (transition @ belief) / (likelihood * (transition @ belief)).max()
            )
        ),
    },
    hints=(
        "Predict: for each place, the sum over all places that the machine may have come from.",
        "transition @ belief, times likelihood element by element, divided by the sum of that.",
    ),
    tested_on="30 random beliefs of three to eight places",
)
