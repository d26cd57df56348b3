"""Practice: trying in batches around what one has, keeping count, and what came of it.

A cost takes a whole batch of tries, shape (n, p), and gives the cost of each, (n,): digs can then
be simulated side by side. Infinity says that a try failed; it counts as a try and teaches nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics import inputs

MOST_TRIES = 1_000_000
"""More of them would not end."""

COST = "cost(tries (n, p)) -> costs (n,)"


@dataclass(frozen=True, eq=False)
class Learning:
    """What practice brought, try by try.

    Attributes:
        tries: parameters in the order in which they were tried, shape (n, p), the cost's own units;
            the first is the start.
        costs: of the tries, shape (n,), of the cost's own unit; inf where one failed.
        parameters: the best of all tries, shape (p,), own units.
        mean: where the search stands at its end, shape (p,), own units.
    """

    tries: NDArray
    costs: NDArray
    mean: NDArray

    @property
    def parameters(self) -> NDArray:
        """The best of all tries, shape (p,), own units."""
        return self.tries[self.costs.argmin()]

    @property
    def cost(self) -> float:
        """Of the best try."""
        return float(self.costs.min())

    @property
    def curve(self) -> NDArray:
        """Cost of the best try so far, after each try, shape (n,), of the cost's own unit."""
        return np.minimum.accumulate(self.costs)

    @property
    def gain(self) -> float:
        """By which share the best try is cheaper than the start [1]."""
        return float(1.0 - self.cost / self.costs[0])

    def __str__(self) -> str:
        return f"cost {self.costs[0]:.3g} to {self.cost:.3g} in {len(self.costs)} tries"


def practise(
    cost: Callable[[NDArray], ArrayLike],
    start: ArrayLike,
    spread: ArrayLike,
    batch: int,
    budget: int,
    rng: np.random.Generator | int,
    decay: float,
    update: Callable[[NDArray, NDArray, NDArray], NDArray],
) -> Learning:
    """Batches of tries around a mean, which an update moves after each batch.

    Args:
        cost: of a batch (n, p), own units.
        start: parameters, shape (p,), own units; tried first.
        spread: standard deviation of the exploration, shape (p,) or one for all, own units.
        batch: tries at a time.
        budget: tries in all; the last batch takes what is left.
        rng: a generator, or a seed.
        decay: factor of the spread from batch to batch [1].
        update: the mean (p,), all tries (m, p) and costs (m,) so far -> the next mean (p,).

    Returns:
        The `Learning`. The same seed gives the same.

    Raises:
        ValueError: a wrong shape, numbers out of their bounds, or a cost that is NaN or not one
            number for each try; a start that fails.
        TypeError: cost is no function.
    """
    inputs.function(cost, "cost", COST)
    mean = inputs.numbers(start, "start", ("p",), meaning="parameters")
    spread = inputs.numbers(spread, "spread")
    if spread.shape not in ((), mean.shape) or not (spread > 0).all():
        raise ValueError(f"spread must be above 0, one or {len(mean)} in a row, got {spread}")
    batch, budget = inputs.whole(batch, "batch", least=2), inputs.whole(budget, "budget", least=2)
    inputs.whole(budget, "budget", most=MOST_TRIES)
    decay = inputs.number(decay, "decay", above=0.0, most=1.0)
    rng = inputs.generator(rng)
    tries, costs = np.empty((0, len(mean))), np.empty(0)
    while len(costs) < budget:
        count = min(batch, budget - len(costs))
        fresh = mean + spread * rng.standard_normal((count, len(mean)))
        if not len(costs):
            fresh[0] = mean
        tries = np.concatenate([tries, fresh])
        costs = np.concatenate([costs, checked(cost(fresh), "what cost gives", count)])
        inputs.whole(int(np.isfinite(costs).sum()), "tries of the first batch that work", least=1)
        mean = update(mean, tries, costs)
        spread = spread * decay
    return Learning(tries, costs, mean)


def checked(costs: ArrayLike, name: str, count: int | str = "n") -> NDArray:
    """Costs, one finite number or inf for each try, shape (count,), any unit; else ValueError."""
    costs = inputs.numbers(costs, name, (count,), finite=False)
    inputs.numbers(np.where(costs == np.inf, 0.0, costs), f"{name} (inf: a failed try)")
    return costs
