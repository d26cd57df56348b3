"""Exercises of lesson 11a: a guess for A*, a step of a tree, an honest edge, how RRT* mends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.planning.search import steer

__all__ = ["EXERCISES"]


def longest_guess(cell: NDArray, goal: NDArray) -> float:
    """Least way between two cells of an empty grid with 8 neighbours, in cells."""
    less, more = np.sort(np.abs(np.subtract(goal, cell)))
    return 2**0.5 * less + (more - less)


def _cells(rng: np.random.Generator) -> list[tuple]:
    cases = [tuple(rng.integers(-20, 20, (2, 2))) for _ in range(24)]
    return [*cases, (np.array([3, 4]), np.array([3, 9])), (np.array([5, 2]), np.array([5, 2]))]


def _apart(cell: NDArray, goal: NDArray) -> tuple[float, float]:
    less, more = np.sort(np.abs(np.subtract(goal, cell)))
    return float(less), float(more)


GUESS = Exercise(
    number="11.1",
    title="The longest honest guess",
    reference=longest_guess,
    cases=_cells,
    oracle="steps_counted_one_by_one",
    mistakes={
        "the sum over both axes counts a diagonal as 2: it promises too much, and A* may miss": (
            lambda cell, goal: sum(_apart(cell, goal))
        ),
        "the straight line is honest, and shorter than any way along eight directions": (
            lambda cell, goal: float(np.hypot(*_apart(cell, goal)))
        ),
        "the larger difference alone counts a diagonal as 1: honest, and too short": (
            lambda cell, goal: max(_apart(cell, goal))
        ),
        "the diagonals go along both axes: take their cells away from the larger difference": (
            lambda cell, goal: 2**0.5 * _apart(cell, goal)[0] + _apart(cell, goal)[1]
        ),
        "not all steps are diagonal: only as many as the smaller difference": (
            lambda cell, goal: 2**0.5 * max(_apart(cell, goal))
        ),
        "that is the square of the straight line: far too long": (
            lambda cell, goal: sum(d * d for d in _apart(cell, goal))
        ),
    },
    hints=(
        "Without obstacles: first diagonally until one axis is there, then straight.",
        "less, more = np.sort(np.abs(goal - cell)); a diagonal step costs sqrt(2).",
    ),
    tested_on="26 pairs of cells in all directions",
)


def extend(nodes: NDArray, towards: NDArray, step: float) -> tuple[int, NDArray]:
    """The node that is nearest to a place, and the place at most a step on from it."""
    near = int(((nodes - towards) ** 2).sum(axis=1).argmin())
    return near, steer(nodes[near], towards, step)


def _trees(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(24):
        D = (2, 2, 4)[k % 3]
        nodes = rng.uniform(-5, 5, (int(rng.integers(2, 30)), D))
        towards = rng.uniform(-6, 6, D)
        if k % 4 == 0:
            towards = nodes[rng.integers(len(nodes))] + rng.uniform(-0.1, 0.1, D)
        cases.append((nodes, towards, float(rng.uniform(0.2, 1.5))))
    return cases


def _nearest(nodes: NDArray, towards: NDArray) -> int:
    return int(np.linalg.norm(nodes - towards, axis=1).argmin())


def _always_a_step(nodes: NDArray, towards: NDArray, step: float) -> tuple[int, NDArray]:
    near = _nearest(nodes, towards)
    way = towards - nodes[near]
    return near, nodes[near] + step * way / np.linalg.norm(way)


def _all_the_way(nodes: NDArray, towards: NDArray, step: float) -> tuple[int, NDArray]:
    return _nearest(nodes, towards), towards


def _from_the_last(nodes: NDArray, towards: NDArray, step: float) -> tuple[int, NDArray]:
    return len(nodes) - 1, steer(nodes[-1], towards, step)


def _by_the_axes(nodes: NDArray, towards: NDArray, step: float) -> tuple[int, NDArray]:
    near = int(np.abs(nodes - towards).sum(axis=1).argmin())
    return near, steer(nodes[near], towards, step)


def _share_of_the_way(nodes: NDArray, towards: NDArray, step: float) -> tuple[int, NDArray]:
    near = _nearest(nodes, towards)
    return near, nodes[near] + min(step, 1.0) * (towards - nodes[near])


def _from_the_place(nodes: NDArray, towards: NDArray, step: float) -> tuple[int, NDArray]:
    near = _nearest(nodes, towards)
    return near, steer(towards, nodes[near], step)


EXTEND = Exercise(
    number="11.2",
    title="One step of a tree",
    reference=extend,
    cases=_trees,
    oracle="a_step_on_the_straight_way_from_the_nearest",
    mistakes={
        "a place that is nearer than a step is overshot: then go to the place itself": (
            _always_a_step
        ),
        "the step is forgotten: all the way goes wherever the place is, through anything": (
            _all_the_way
        ),
        "it grows from its last node: a tree grows from its nearest one": _from_the_last,
        "nearest by the sum over the axes: it is the straight distance that counts": _by_the_axes,
        "step is a length, not a share of the way: divide the way by its length": (
            _share_of_the_way
        ),
        "it steps from the place back to the node: the other way round": _from_the_place,
    },
    hints=(
        "np.linalg.norm(nodes - towards, axis=1).argmin() is the nearest node.",
        "If the way is at most a step long: the place. Else nodes[near] + step * way / its length.",
    ),
    tested_on="24 trees in 2 and 4 dimensions, places near and far",
)


def edge_free(a: NDArray, b: NDArray, discs: NDArray, resolution: float) -> bool:
    """Whether places from a to b, no further apart than the resolution, are outside all discs."""
    places = _between(a, b, int(np.ceil(np.linalg.norm(b - a) / resolution)))
    return bool(_gaps(places, discs).min() > 0)


def _between(a: NDArray, b: NDArray, pieces: int) -> NDArray:
    return a + np.linspace(0, 1, max(pieces, 1) + 1)[:, None] * (b - a)


def _gaps(places: NDArray, discs: NDArray) -> NDArray:
    return np.linalg.norm(places[:, None] - discs[:, :2], axis=-1) - discs[:, 2]


def _edges(rng: np.random.Generator) -> list[tuple]:
    """A disc on the edge, beside it, at its ends, along it wider than the resolution."""
    cases = []
    for k in range(48):
        a, resolution = rng.uniform(-5, 5, 2), float(rng.uniform(0.1, 0.4))
        angle, length = rng.uniform(0, 2 * np.pi), rng.uniform(0.5 if k % 8 == 5 else 4, 9)
        along = np.array([np.cos(angle), np.sin(angle)])
        across, b = np.array([-along[1], along[0]]), a + length * along
        r = float(rng.uniform(0.6, 0.9)) * resolution
        at = rng.uniform(0.05, 0.95)
        kinds = {
            0: a + at * length * along,
            1: a + at * length * along + rng.choice([-1, 1]) * (r + 0.05) * across,
            2: b + 0.9 * r * along,
            3: a + at * length * along + 0.2 * r * across,
            4: b + (r + 0.02) * along,
            5: a + 0.5 * length * along + (r + 0.03) * across,
            6: a - 0.9 * r * along,
            7: a + 0.5 * length * along,
        }
        far = rng.uniform(-20, 20, (6, 2))
        far = far[np.abs(far @ across - a @ across) > 2]
        discs = np.vstack([np.c_[far, rng.uniform(0.5, 1.5, len(far))], [*kinds[k % 8], r]])
        cases.append((a, b, rng.permutation(discs), resolution))
    return cases


def _looks(places_of: object, decide: object = lambda gaps, res: gaps.min() > 0) -> object:
    def wrong(a: NDArray, b: NDArray, discs: NDArray, resolution: float) -> bool:
        places = places_of(a, b, resolution)
        return bool(decide(_gaps(places, discs), resolution))

    return wrong


def _right_places(a: NDArray, b: NDArray, resolution: float) -> NDArray:
    return _between(a, b, int(np.ceil(np.linalg.norm(b - a) / resolution)))


def _without_the_end(a: NDArray, b: NDArray, resolution: float) -> NDArray:
    length = np.linalg.norm(b - a)
    return a + np.arange(0, length, resolution)[:, None] / length * (b - a)


EDGE = Exercise(
    number="11.3",
    title="An edge that does not jump",
    reference=edge_free,
    cases=_edges,
    oracle="the_exact_distance_of_a_segment",
    mistakes={
        "only the end is looked at: the edge jumps over whatever is in between": (
            _looks(lambda a, b, resolution: b[None])
        ),
        "only both ends are looked at: the edge jumps over whatever is in between": (
            _looks(lambda a, b, resolution: np.array([a, b]))
        ),
        "both ends and the middle: a long edge still jumps, take as many as its length needs": (
            _looks(lambda a, b, resolution: _between(a, b, 2))
        ),
        "five looks whatever the length: take as many as the length needs": (
            _looks(lambda a, b, resolution: _between(a, b, 4))
        ),
        "the last place is missing: np.arange stops before the end, and b is where it will stand": (
            _looks(_without_the_end)
        ),
        "one free place is not enough: all must be free": (
            _looks(_right_places, lambda gaps, resolution: (gaps > 0).any())
        ),
        "it asks for a gap as large as the resolution: free is what is outside of all discs": (
            _looks(_right_places, lambda gaps, resolution: gaps.min() > resolution)
        ),
        "that is whether something is hit: turn it round": (
            _looks(_right_places, lambda gaps, resolution: gaps.min() <= 0)
        ),
    },
    hints=(
        "n = int(np.ceil(length / resolution)) pieces have n + 1 places: np.linspace(0, 1, n + 1).",
        "places[:, None] - discs[:, :2] has shape (n + 1, m, 2); all distances > all radii.",
    ),
    tested_on="48 edges, long and short, thin obstacles on them, beside them and at both ends",
)


def mend(
    nodes: NDArray, cost: NDArray, new: NDArray, radius: float, free: NDArray
) -> tuple[int, NDArray]:
    """RRT*: the node over which the new place is reached most cheaply, and to which nodes the way
    over the new place is cheaper than theirs, truth values (n,)."""
    apart = np.linalg.norm(nodes - new, axis=1)
    near = free & (apart <= radius)
    parent = int(np.where(near, cost + apart, np.inf).argmin())
    return parent, near & (cost[parent] + apart[parent] + apart < cost)


def _neighbourhoods(rng: np.random.Generator) -> list[tuple]:
    """Costs of trees that are longer than the straight way, as they are after a detour."""
    cases = []
    while len(cases) < 24:
        nodes, new = rng.uniform(-2, 2, (25, 2)), rng.uniform(-1, 1, 2)
        cost = np.linalg.norm(nodes + 2, axis=1) * rng.uniform(1, 1.5, 25) + rng.exponential(
            0.8, 25
        )
        free, radius = rng.random(25) < 0.7, float(rng.uniform(0.9, 1.6))
        apart = np.linalg.norm(nodes - new, axis=1)
        if (free & (apart <= radius)).any():
            cases.append((nodes, cost, new, radius, free))
    return cases


def _mended(**changed: bool) -> object:
    def wrong(
        nodes: NDArray, cost: NDArray, new: NDArray, radius: float, free: NDArray
    ) -> tuple[int, NDArray]:
        apart = np.linalg.norm(nodes - new, axis=1)
        near = (free | changed.get("all_free", False)) & (
            (apart <= radius) | changed.get("everywhere", False)
        )
        total = apart if changed.get("nearest") else cost + apart
        total = cost if changed.get("cheapest") else total
        parent = int(np.where(near, total, np.inf).argmin())
        mine = cost[parent] + (0.0 if changed.get("no_edge") else apart[parent])
        if changed.get("turned"):
            return parent, near & (mine + apart > cost)
        return parent, near & (mine + (0.0 if changed.get("not_on") else apart) < cost)

    return wrong


MEND = Exercise(
    number="11.4",
    title="The mending of RRT*",
    reference=mend,
    cases=_neighbourhoods,
    oracle="each_way_is_added_up",
    mistakes={
        "the nearest node is RRT's choice: least is what its way costs and the edge to here": (
            _mended(nearest=True)
        ),
        "the cheapest node, without the edge from it to here": _mended(cheapest=True),
        "edges that are not free are used": _mended(all_free=True),
        "nodes beyond the radius are asked, too": _mended(everywhere=True),
        "the way to the new place lacks its last edge, from the parent to here": (
            _mended(no_edge=True)
        ),
        "the way over the new place lacks the edge on from it": _mended(not_on=True),
        "those are the nodes to which the new way is longer: turn the comparison": (
            _mended(turned=True)
        ),
    },
    hints=(
        "near = free & (apart <= radius); np.where(near, cost + apart, np.inf).argmin().",
        "The new place costs cost[parent] + apart[parent]; over it, node k costs apart[k] more.",
    ),
    tested_on="24 neighbourhoods with blocked edges",
)

EXERCISES = (GUESS, EXTEND, EDGE, MEND)
"""Exercises of sitting search."""
