"""A*: the cheapest way through a graph, best guess first; and on grids of any dimension."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from heapq import heappop, heappush
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice, flag, instance, number, numbers, truths
from backhoe.planning.search.checker import Log, NoPath, answer_of

RULES = ("grid", "straight", "steps", "none")


def best_first(
    start: Hashable,
    goal: Hashable,
    neighbours: Callable[[Hashable], Iterable[tuple[Hashable, float]]],
    rest: Callable[[Hashable], float] | None = None,
) -> tuple[list, float, dict]:
    """The cheapest way in a graph, if `rest` never says more than the way from a node really costs.

    Source: Hart, Nilsson and Raphael 1968; with rest 0 it is Dijkstra's.

    Args:
        start, goal: nodes.
        neighbours: the nodes one edge away from a node, and what the edge costs, not below 0.
        rest: a guess of the cost from a node to the goal; 0 if None.

    Returns:
        The nodes of the way, its cost, and of each node that was expanded the one before it.

    Raises:
        NoPath: all that can be reached was reached, and the goal was not.
    """
    rest = rest or (lambda node: 0.0)
    cost, before, expanded = {start: 0.0}, {start: None}, {}
    queue = [(rest(start), 0, start, 0.0)]
    pushed = 0
    while queue:
        _, _, node, known = heappop(queue)
        if known > cost[node]:
            continue  # a cheaper way to it came later and was worked on earlier
        expanded[node] = before[node]
        if node == goal:
            way = [node]
            while before[way[-1]] is not None:
                way.append(before[way[-1]])
            return way[::-1], known, expanded
        for other, edge in neighbours(node):
            new = known + edge
            if new < cost.get(other, np.inf):
                cost[other], before[other] = new, node
                pushed += 1
                heappush(queue, (new + rest(other), -pushed, other, new))
    raise NoPath(f"no way from start to goal: {len(expanded)} places can be reached, all were")


def astar(
    occupied: ArrayLike,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    diagonal: bool = True,
    spacing: ArrayLike = 1.0,
    rest: str | Callable[[NDArray, NDArray], float] = "grid",
    log: Log | None = None,
) -> NDArray:
    """The shortest way through the free cells of a grid.

    Args:
        occupied: truth values, of any number D of axes.
        start, goal: indices of cells, shape (D,).
        diagonal: whether a step may change several indices (8 neighbours in the plane), and then
            cuts no occupied corner; otherwise one (4).
        spacing: edges of a cell, shape () or (D,), in any unit.
        rest: guess of the way that is left: "grid", what it is without obstacles; "straight", the
            straight line; "steps", the sum over the axes, too much where diagonals are allowed;
            "none"; or a function of two cells, shape (D,) each. The way is the shortest if the
            guess is never too long.
        log: is filled: cells that were expanded, and from where.

    Returns:
        Cells from start to goal, shape (n, D), indices; `spacing * cells` has its length.

    Raises:
        ValueError: shapes, a start or goal outside, not whole or occupied.
        NoPath: the goal cannot be reached.
    """
    grid = truths(occupied, "occupied", (..., "n"))
    D = grid.ndim
    size = numbers(spacing, "spacing", within=1e9)
    size = np.full(D, size) if size.shape == () else numbers(size, "spacing", (D,))
    if (size <= 0).any():
        raise ValueError(f"spacing must be above 0, got {spacing}")
    first, last = _cell(start, "start", grid), _cell(goal, "goal", grid)
    log = Log() if log is None else instance(log, "log", Log)
    moves = [m for m in product((-1, 0, 1), repeat=D) if any(m)]
    if not flag(diagonal, "diagonal"):
        moves = [m for m in moves if np.abs(m).sum() == 1]
    moves = [(m, _passed(m), float(np.linalg.norm(size * m))) for m in moves]
    free, sides = ~np.pad(grid, 1, constant_values=True), range(D)

    def neighbours(cell: tuple) -> Iterable[tuple[tuple, float]]:
        for move, passed, way in moves:
            if all(free[tuple([cell[i] + p[i] + 1 for i in sides])] for p in passed):
                yield tuple([cell[i] + move[i] for i in sides]), way

    guess = _guess(rest, diagonal, last, size)
    try:
        cells, way, expanded = best_first(first, last, neighbours, guess)
    except NoPath as error:
        raise NoPath(f"{error}, from {first} to {last}") from None
    order = {cell: k for k, cell in enumerate(expanded)}
    log.points = np.array(list(expanded))
    log.edges = np.array([(order[b], k) for k, b in enumerate(expanded.values()) if b in order])
    log.evaluations, log.best = len(expanded), [(len(expanded), way)]
    return np.array(cells)


def _cell(given: ArrayLike, name: str, grid: NDArray) -> tuple:
    cell = numbers(given, name, (grid.ndim,), meaning="indices of a cell", within=1e9)
    if (cell != np.floor(cell)).any() or (cell < 0).any() or (cell >= grid.shape).any():
        raise ValueError(f"{name} must be indices within the grid {grid.shape}, got {given}")
    cell = tuple(map(int, cell))
    if grid[cell]:
        raise ValueError(f"{name} must be a free cell, {cell} is occupied")
    return cell


def _passed(move: tuple) -> list[tuple]:
    """All cells of the block that a move crosses, but the one where it starts; the end first."""
    block = product(*[(m, 0) if m else (0,) for m in move])
    return [cell for cell in block if any(cell)]


def _guess(rest: object, diagonal: bool, goal: tuple, size: NDArray) -> Callable[[tuple], float]:
    if callable(rest):
        return lambda cell: number(
            answer_of(rest, "rest", np.array(cell), np.array(goal)), "the guess of rest"
        )
    choice(rest, "rest", RULES)
    if rest == "none":
        return lambda cell: 0.0
    if rest == "straight":
        return lambda cell: float(np.linalg.norm(size * np.subtract(cell, goal)))
    if rest == "steps" or not diagonal:
        return lambda cell: float((size * np.abs(np.subtract(cell, goal))).sum())

    def of_the_grid(cell: tuple) -> float:
        """All axes go on together until the nearest is there, then the others, and so on."""
        steps = np.abs(np.subtract(cell, goal))
        total, done = 0.0, 0
        for steps_here in sorted(set(steps[steps > 0].tolist())):
            together = size[steps >= steps_here]
            total += (steps_here - done) * float(np.linalg.norm(together))
            done = steps_here
        return total

    return of_the_grid
