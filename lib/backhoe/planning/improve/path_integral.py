"""PI2: the next mean is the average of the tries, each weighed by an exponential of its cost.

Of each batch the cheapest try weighs 1 and the dearest exp(-h), whatever unit the cost has. The
algorithm came from a path integral of stochastic optimal control; for parameters that are kept for
a whole try it comes down to this average.

Source: Theodorou, Buchli and Schaal 2010, table 1, in the form of Stulp and Sigaud 2012, PI2 with
one exploration a try and weights from the cost of the whole try.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics import inputs
from backhoe.planning.improve.practice import Learning, checked, practise

HARDNESS = 10.0
"""How many times e the best of a batch weighs more than the worst: h."""


def pi2_weights(costs: ArrayLike, hardness: float = HARDNESS) -> NDArray:
    """Share of each try in the next mean.

    Args:
        costs: shape (n,), any unit; inf where a try failed.
        hardness: h, above 0 [1].

    Returns:
        Weights, shape (n,) [1]; their sum is 1, failed tries have 0. Alike if all costs are.

    Raises:
        ValueError: another shape, NaN, no finite cost, or h not above 0.
    """
    costs = checked(costs, "costs")
    hardness = inputs.positive(hardness, "hardness")
    done = np.isfinite(costs)
    inputs.whole(int(done.sum()), "tries that did not fail", least=1)
    low, high = costs[done].min(), costs[done].max()
    weights = np.where(done, np.exp(-hardness * (costs - low) / ((high - low) or 1.0)), 0.0)
    return weights / weights.sum()


def pi2(
    cost: Callable[[NDArray], ArrayLike],
    start: ArrayLike,
    spread: ArrayLike,
    *,
    batch: int = 10,
    budget: int = 150,
    rng: np.random.Generator | int = 0,
    hardness: float = HARDNESS,
    decay: float = 0.9,
) -> Learning:
    """Improve parameters by practice, with the weights of PI2.

    Args:
        cost: takes a batch (n, p) in the parameters' own units and gives costs (n,) of any unit.
        start: first mean, shape (p,), own units.
        spread: standard deviation of the tries, shape (p,) or one, own units.
        batch: tries between two updates.
        budget: tries in all.
        rng: a generator, or a seed.
        hardness: as for `pi2_weights`.
        decay: factor of the spread from batch to batch [1].

    Returns:
        The `Learning`.

    Raises:
        ValueError: a wrong shape, numbers out of their bounds, a cost that gives NaN, or no try of
            the first batch that succeeds.
        TypeError: cost is no function.
    """
    hardness = inputs.positive(hardness, "hardness")
    size = inputs.whole(batch, "batch", least=2)

    def update(mean: NDArray, tries: NDArray, costs: NDArray) -> NDArray:
        fresh = slice((len(costs) - 1) // size * size, None)
        if not np.isfinite(costs[fresh]).any():
            return mean
        return pi2_weights(costs[fresh], hardness) @ tries[fresh]

    return practise(cost, start, spread, batch, budget, rng, decay, update)
