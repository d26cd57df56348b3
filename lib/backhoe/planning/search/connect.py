"""RRT-Connect: one tree from the start, one from the goal, each greedy to meet the other.

The loops are in `grow`; `engine` compiles the same text with the arm's own checker.
"""

from __future__ import annotations

from functools import partial
from math import ceil

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import generator
from backhoe.planning.search import grow
from backhoe.planning.search.arm_world import ArmWorld
from backhoe.planning.search.checker import IsFree, Log, NoPath, Problem, path_length

AT_ONCE = 100
"""Samples between two looks at the clock."""


def rrt_connect(
    start: ArrayLike,
    goal: ArrayLike,
    is_free: IsFree,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    step: float | None = None,
    resolution: float | None = None,
    seed: int | np.random.Generator = 0,
    budget: int = 10_000,
    time_limit: float = 10.0,
    log: Log | None = None,
) -> NDArray:
    """A way found by two trees, from the start and from the goal, that grow towards each other.

    Source: Kuffner and LaValle 2000. With `ArmWorld.is_free` all of it is compiled.

    Args:
        start, goal, is_free, lower, upper, step, resolution, seed, budget, time_limit, log: as for
            `rrt`; shapes (D,), in the space's own units.

    Returns:
        Places from start to goal, shape (n, D).

    Raises:
        ValueError, NoPath: as `rrt`.
    """
    arm = getattr(is_free, "__self__", None)
    arm = arm.numbers if isinstance(arm, ArmWorld) and is_free == arm.is_free else None
    if arm is not None:
        from backhoe.planning.search import engine

        engine.compile_now()
        is_free = partial(engine.all_free, arm)
    problem = Problem(start, goal, is_free, lower, upper, step, resolution, budget, time_limit, log)
    checker, rng, D = problem.checker, generator(seed, "seed"), len(problem.start)
    search, world = grow.connect, checker
    if arm is not None:
        search, world, asked = engine.connect, arm, int(arm.asked[0])
    most = ceil(np.linalg.norm(problem.upper - problem.lower) / problem.step) + 2
    trees, before = np.empty((2, AT_ONCE * most, D)), np.full((2, AT_ONCE * most), -1)
    trees[0, 0], trees[1, 0], sizes = problem.start, problem.goal, np.ones(2, np.int64)
    done, met = 0, (-1, -1)
    try:
        while met[0] < 0 and done < problem.budget:
            checker.on_time()
            n = min(AT_ONCE, problem.budget - done)
            samples = problem.lower + (problem.upper - problem.lower) * rng.random((n, D))
            if sizes.max() + n * most > trees.shape[1]:
                trees = np.concatenate([trees, np.empty_like(trees)], axis=1)
                before = np.concatenate([before, np.full_like(before, -1)], axis=1)
            *met, _ = search(
                trees, before, sizes, samples, done % 2, problem.step, checker.resolution, world
            )
            done += n
    finally:
        if arm is not None:
            checker.log.evaluations += int(arm.asked[0]) - asked
        if log is not None:
            _write(log, trees, before, sizes)
    if met[0] < 0:
        raise NoPath(f"no way found with budget {problem.budget}: {sizes.sum()} places reached")
    there, back = _to_root(before[0], met[0])[::-1], _to_root(before[1], met[1])[1:]
    path = np.vstack([trees[0, there], trees[1, back]])
    if log is not None:
        log.best.append((log.evaluations, path_length(path)))
    return path


def _to_root(before: NDArray, node: int) -> list[int]:
    nodes = [int(node)]
    while before[nodes[-1]] >= 0:
        nodes.append(int(before[nodes[-1]]))
    return nodes


def _write(log: Log, trees: NDArray, before: NDArray, sizes: NDArray) -> None:
    a, b = map(int, sizes)
    log.points = np.vstack([trees[0, :a], trees[1, :b]])
    first, second = before[0, :a], before[1, :b]
    log.edges = np.r_[np.c_[first, np.arange(a)][1:], (np.c_[second, np.arange(b)] + a)[1:]]
