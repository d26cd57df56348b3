"""PoWER: rewards, as if they were probabilities, weigh the best tries made so far.

Its update is the maximisation step of expectation maximisation: if the reward of a try were the
probability of having done well, this average would be the most likely mean. So the reward must be
positive: here exp(-cost / scale). Old tries stay useful, if only the best of all are taken.

Source: Kober and Peters 2009, algorithm 1, with one exploration a try.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics import inputs
from backhoe.planning.improve.practice import Learning, checked, practise

BEST = 5
"""Tries that an update averages, the best of all so far."""


def power_weights(costs: ArrayLike, scale: float) -> NDArray:
    """Share of each try in the next mean: its reward exp(-cost / scale) over the sum of all.

    Args:
        costs: shape (n,), any unit; inf where a try failed.
        scale: difference in cost that makes a reward e times as large, above 0, the costs' unit.

    Returns:
        Weights, shape (n,) [1]; their sum is 1, failed tries have 0.

    Raises:
        ValueError: another shape, NaN, no finite cost, or a scale not above 0.
    """
    costs = checked(costs, "costs")
    scale = inputs.positive(scale, "scale")
    low = inputs.number(costs.min(), "the least of costs")
    rewards = np.exp(-(costs - low) / scale)
    return rewards / rewards.sum()


def power(
    cost: Callable[[NDArray], ArrayLike],
    start: ArrayLike,
    spread: ArrayLike,
    *,
    batch: int = 10,
    budget: int = 150,
    rng: np.random.Generator | int = 0,
    scale: float | None = None,
    best: int = BEST,
    decay: float = 0.9,
) -> Learning:
    """Improve parameters by practice, with the weights of PoWER.

    Args:
        cost: takes a batch (n, p) in the parameters' own units and gives costs (n,) of any unit.
        start: first mean, shape (p,), own units.
        spread: standard deviation of the tries, shape (p,) or one, own units.
        batch: tries between two updates.
        budget: tries in all.
        rng: a generator, or a seed.
        scale: as for `power_weights`; by default the standard deviation of the costs of the first
            batch, so that the cost's unit does not matter.
        best: how many of all tries so far an update averages.
        decay: factor of the spread from batch to batch [1].

    Returns:
        The `Learning`.

    Raises:
        ValueError: a wrong shape, numbers out of their bounds, a cost that gives NaN, or no try of
            the first batch that succeeds.
        TypeError: cost is no function.
    """
    size, best = inputs.whole(batch, "batch", least=2), inputs.whole(best, "best", least=1)
    if scale is not None:
        scale = inputs.positive(scale, "scale")

    def update(mean: NDArray, tries: NDArray, costs: NDArray) -> NDArray:
        first = costs[:size]
        unit = scale or float(first[np.isfinite(first)].std()) or 1.0
        chosen = np.argsort(costs, kind="stable")[:best]
        return power_weights(costs[chosen], unit) @ tries[chosen]

    return practise(cost, start, spread, batch, budget, rng, decay, update)
