"""Trees that grow into free space at random: RRT, and RRT*, which keeps mending its ways."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import generator, number, positive
from backhoe.planning.search.checker import IsFree, Log, NoPath, Problem, path_length


class Tree:
    """Places in a row, each with the one before it: `points` (n, D), `before` (n,)."""

    def __init__(self, root: NDArray, most: int) -> None:
        self._points, self._before = np.empty((most + 1, len(root))), np.full(most + 1, -1)
        self._points[0], self.n = root, 1

    @property
    def points(self) -> NDArray:
        return self._points[: self.n]

    @property
    def before(self) -> NDArray:
        return self._before[: self.n]

    def add(self, point: NDArray, before: int) -> int:
        self._points[self.n], self._before[self.n] = point, before
        self.n += 1
        return self.n - 1

    def nearest(self, point: NDArray) -> int:
        return int(((self.points - point) ** 2).sum(axis=1).argmin())

    def way(self, node: int) -> NDArray:
        """From the root to a node, shape (n, D)."""
        nodes = [node]
        while self.before[nodes[-1]] >= 0:
            nodes.append(self.before[nodes[-1]])
        return self.points[nodes[::-1]]

    def write(self, log: Log) -> None:
        log.points = self.points.copy()
        log.edges = np.column_stack([self.before, np.arange(self.n)])[1:]


def steer(start: NDArray, towards: NDArray, step: float) -> NDArray:
    """The place on the straight way from one place, shape (D,), to another, at most a step on, in
    the space's own units."""
    way = towards - start
    distance = float(np.linalg.norm(way))
    return towards.copy() if distance <= step else start + step / distance * way


def rrt(
    start: ArrayLike,
    goal: ArrayLike,
    is_free: IsFree,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    step: float | None = None,
    resolution: float | None = None,
    goal_share: float = 0.05,
    seed: int | np.random.Generator = 0,
    budget: int = 10_000,
    time_limit: float = 10.0,
    log: Log | None = None,
) -> NDArray:
    """A way found by a tree that grows from the start towards random places.

    Source: LaValle 1998.

    Args:
        start, goal: shape (D,), in the space's own units.
        is_free: places (n, D) to truth values (n,).
        lower, upper: bounds, shape (D,).
        step: longest edge; None for a tenth of the bounds' diagonal.
        resolution: of the edges' check; None for a hundredth of it.
        goal_share: how often the goal is the random place [1].
        seed: of the samples, or a generator.
        budget: samples at most.
        time_limit: [s].
        log: is filled.

    Returns:
        Places from start to goal, shape (n, D).

    Raises:
        ValueError: bad inputs, a start or goal in collision, a checker that raises.
        NoPath: none with these samples, or in this time.
    """
    problem = Problem(start, goal, is_free, lower, upper, step, resolution, budget, time_limit, log)
    share = number(goal_share, "goal_share", least=0.0, below=1.0)
    checker, rng = problem.checker, generator(seed, "seed")
    tree = Tree(problem.start, problem.budget + 1)
    try:
        for _ in range(problem.budget):
            towards = problem.goal
            if rng.random() >= share:
                towards = rng.uniform(problem.lower, problem.upper)
            near = tree.nearest(towards)
            new = steer(tree.points[near], towards, problem.step)
            if not checker.edge(tree.points[near], new):
                continue
            node = tree.add(new, near)
            if (new != problem.goal).any():
                far = np.linalg.norm(problem.goal - new) > problem.step
                if far or not checker.edge(new, problem.goal):
                    continue
                node = tree.add(problem.goal, node)
            way = tree.way(node)
            checker.log.best.append((checker.log.evaluations, path_length(way)))
            return way
    finally:
        tree.write(checker.log)
    raise NoPath(f"no way found with budget {problem.budget}: {tree.n} places reached")


def rrt_star(
    start: ArrayLike,
    goal: ArrayLike,
    is_free: IsFree,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    step: float | None = None,
    resolution: float | None = None,
    radius: float | None = None,
    goal_share: float = 0.05,
    seed: int | np.random.Generator = 0,
    budget: int = 2000,
    time_limit: float = 10.0,
    log: Log | None = None,
) -> NDArray:
    """The best way of a tree that uses all its budget to shorten what it found.

    Each new place joins the tree where its way from the start is shortest, and becomes the place
    before each neighbour whose way it shortens. With more samples the length goes to the least.
    Source: Karaman and Frazzoli 2011.

    Args:
        start, goal, is_free, lower, upper, step, resolution, goal_share, seed: as for `rrt`.
        radius: factor of the neighbourhood, in the space's own units: neighbours are those within
            radius (log n / n)^(1/D), and within a step; None for the least with which the proof
            of convergence holds in an empty box.
        budget: samples.
        time_limit: [s]; when it is over, the best way so far is given.
        log: is filled; `best` has each shorter way as it was found.

    Returns:
        Places from start to goal, shape (n, D).

    Raises:
        ValueError, NoPath: as `rrt`.
    """
    problem = Problem(start, goal, is_free, lower, upper, step, resolution, budget, time_limit, log)
    share = number(goal_share, "goal_share", least=0.0, below=1.0)
    checker, rng, D = problem.checker, generator(seed, "seed"), len(problem.start)
    ball = math.pi ** (D / 2) / math.gamma(D / 2 + 1)
    volume = float(np.prod(problem.upper - problem.lower))
    least = 2 * ((1 + 1 / D) * volume / ball) ** (1 / D)
    factor = least if radius is None else positive(radius, "radius")
    tree, cost = Tree(problem.start, problem.budget), np.zeros(problem.budget + 1)
    after, doors, best = [[]], [], math.inf
    try:
        for _ in range(problem.budget):
            towards = problem.goal
            if rng.random() >= share:
                towards = rng.uniform(problem.lower, problem.upper)
            near = tree.nearest(towards)
            new = steer(tree.points[near], towards, problem.step)
            if (new == tree.points[near]).all() or not checker.edge(tree.points[near], new):
                continue
            apart = np.linalg.norm(tree.points - new, axis=1)
            within = min(problem.step, factor * (math.log(tree.n + 1) / (tree.n + 1)) ** (1 / D))
            around = np.flatnonzero(apart <= within)
            total = cost[around] + apart[around]
            parent = near
            for k in np.argsort(total, kind="stable"):
                if total[k] >= cost[near] + apart[near]:
                    break
                if checker.edge(tree.points[around[k]], new):
                    parent = int(around[k])
                    break
            node = tree.add(new, parent)
            cost[node] = cost[parent] + apart[parent]
            after.append([])
            after[parent].append(node)
            for k in map(int, around):
                shorter = cost[node] + apart[k]
                if shorter < cost[k] - 1e-12 and checker.edge(new, tree.points[k]):
                    after[tree.before[k]].remove(k)
                    after[node].append(k)
                    tree.before[k] = node
                    _lower(cost, after, k, cost[k] - shorter)
            to_goal = float(np.linalg.norm(problem.goal - new))
            if to_goal <= problem.step and checker.edge(new, problem.goal):
                doors.append((node, to_goal))
            found = min((cost[k] + d for k, d in doors), default=math.inf)
            if found < best:
                best = found
                checker.log.best.append((checker.log.evaluations, float(best)))
    except NoPath:
        if not doors:
            raise
    finally:
        tree.write(checker.log)
    if not doors:
        raise NoPath(f"no way found with budget {problem.budget}: {tree.n} places reached")
    node, _ = min(doors, key=lambda door: cost[door[0]] + door[1])
    way = tree.way(node)
    return way if (way[-1] == problem.goal).all() else np.vstack([way, problem.goal])


def _lower(cost: NDArray, after: list[list[int]], node: int, by: float) -> None:
    """The way to a node is shorter by so much: so are all ways through it."""
    queue = [node]
    while queue:
        one = queue.pop()
        cost[one] -= by
        queue += after[one]
