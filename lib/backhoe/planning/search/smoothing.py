"""Shorter and smoother: straight edges tried between any two places of a path."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import generator, number, numbers, whole
from backhoe.planning.search.checker import FAR, Checker, IsFree, Log, NoPath, path_length


def shortcut(
    path: ArrayLike,
    is_free: IsFree,
    resolution: float,
    *,
    tries: int = 200,
    seed: int | np.random.Generator = 0,
    time_limit: float = 10.0,
    log: Log | None = None,
) -> NDArray:
    """Replace pieces of a path by straight edges where those are free.

    Args:
        path: places, shape (n, D), in the space's own units.
        is_free: places (n, D) to truth values (n,).
        resolution: of the edges' check.
        tries: pairs of random places on the path that are tried.
        seed: of these, or a generator.
        time_limit: [s]; when it is over the path so far is given.
        log: counts the places that were asked about.

    Returns:
        Places from the same start to the same goal, shape (m, D), not longer.

    Raises:
        ValueError: shapes, numbers out of bounds, a checker that raises.
    """
    path = numbers(path, "path", ("n", "D"), meaning="places in a row", within=FAR)
    whole_way = path_length(path)
    number(resolution, "resolution", above=0.0, least=whole_way / 1e6)
    checker = Checker(is_free, resolution, time_limit, log)
    rng, tries = generator(seed, "seed"), whole(tries, "tries", least=0, most=10**7)
    for _ in range(tries):
        lengths = np.r_[0, np.linalg.norm(np.diff(path, axis=0), axis=1).cumsum()]
        first, last = np.sort(rng.uniform(0, lengths[-1], 2))
        i, j = np.searchsorted(lengths, [first, last], side="right") - 1
        if i == j:
            continue
        a, b = (
            path[k] + (at - lengths[k]) / (lengths[k + 1] - lengths[k]) * (path[k + 1] - path[k])
            for k, at in ((i, first), (j, last))
        )
        try:
            if checker.edge(a, b):
                path = np.vstack([path[: i + 1], a, b, path[j + 1 :]])
        except NoPath:
            break
    return path
