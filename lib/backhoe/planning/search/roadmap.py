"""A probabilistic roadmap: free places at random, near ones joined, the shortest way along them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import generator, whole
from backhoe.planning.search.checker import IsFree, Log, NoPath, Problem
from backhoe.planning.search.grid import best_first


def prm(
    start: ArrayLike,
    goal: ArrayLike,
    is_free: IsFree,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    resolution: float | None = None,
    neighbours: int = 12,
    seed: int | np.random.Generator = 0,
    budget: int = 500,
    time_limit: float = 10.0,
    log: Log | None = None,
) -> NDArray:
    """A way along a roadmap.

    Source: Kavraki, Svestka, Latombe and Overmars 1996.

    Args:
        start, goal: shape (D,), in the space's own units.
        is_free: places (n, D) to truth values (n,).
        lower, upper: bounds, shape (D,).
        resolution: of the edges' check; None for a hundredth of the bounds' diagonal.
        neighbours: each place is joined to so many of the nearest ones.
        seed: of the samples, or a generator.
        budget: number of samples, free or not.
        time_limit: [s].
        log: is filled.

    Returns:
        Places from start to goal, shape (n, D).

    Raises:
        ValueError: bad inputs, a start or goal in collision, a checker that raises.
        NoPath: start and goal are not joined, or the time is over.
    """
    problem = Problem(start, goal, is_free, lower, upper, None, resolution, budget, time_limit, log)
    checker, rng = problem.checker, generator(seed, "seed")
    neighbours = whole(neighbours, "neighbours", least=1)
    samples = rng.uniform(problem.lower, problem.upper, (problem.budget, len(problem.start)))
    nodes = np.vstack([problem.start, problem.goal, samples[checker.free(samples)]])
    pairs = set()
    for k, node in enumerate(nodes):
        checker.on_time()
        apart = np.linalg.norm(nodes - node, axis=1)
        apart[k] = np.inf
        near = np.argsort(apart, kind="stable")[: min(neighbours, len(nodes) - 1)]
        pairs |= {(min(k, j), max(k, j)) for j in map(int, near)}
    pairs = np.array(sorted(pairs))
    pairs = pairs[checker.edges(nodes[pairs[:, 0]], nodes[pairs[:, 1]])]
    joined = {k: [] for k in range(len(nodes))}
    for (i, j), way in zip(
        pairs.tolist(), np.linalg.norm(nodes[pairs[:, 0]] - nodes[pairs[:, 1]], axis=1), strict=True
    ):
        joined[i].append((j, way))
        joined[j].append((i, way))
    checker.log.points, checker.log.edges = nodes, pairs
    try:
        way, length, _ = best_first(
            0, 1, joined.__getitem__, lambda k: float(np.linalg.norm(nodes[k] - problem.goal))
        )
    except NoPath:
        raise NoPath(f"no way in a roadmap of {len(nodes)} places: more samples may help") from None
    checker.log.best.append((checker.log.evaluations, float(length)))
    return nodes[way]
