"""A* on grids, against SciPy's Dijkstra on a graph that is written down edge by edge."""

from itertools import product

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from backhoe.planning.search import Log, NoPath, astar, best_first, path_length


def graph(occupied, size, diagonal):
    """All edges between cells where the block between them is free, as a matrix."""
    number = np.arange(occupied.size).reshape(occupied.shape)
    rows, columns, costs = [], [], []
    for cell in np.argwhere(~occupied):
        for move in product((-1, 0, 1), repeat=occupied.ndim):
            other = cell + move
            if not any(move) or (other < 0).any() or (other >= occupied.shape).any():
                continue
            if not diagonal and np.count_nonzero(move) > 1:
                continue
            low, high = np.minimum(cell, other), np.maximum(cell, other) + 1
            if not occupied[tuple(map(slice, low, high))].any():
                rows.append(number[tuple(cell)])
                columns.append(number[tuple(other)])
                costs.append(np.sqrt(((size * np.array(move)) ** 2).sum()))
    return csr_matrix((costs, (rows, columns)), (occupied.size, occupied.size)), number


@pytest.mark.parametrize("diagonal", [True, False])
@pytest.mark.parametrize(
    ("shape", "size"),
    [((18, 23), 1.0), ((15, 12), (0.5, 1.5)), ((7, 8, 6), (1.0, 2.0, 0.7)), ((3, 4, 3, 4), 0.3)],
)
def test_its_way_is_as_long_as_dijkstras(shape, size, diagonal):
    rng = np.random.default_rng(0)
    size_row = np.broadcast_to(size, (len(shape),))
    for share in (0.0, 0.2, 0.35):
        occupied = rng.random(shape) < share
        start, goal = rng.permutation(np.argwhere(~occupied))[:2]
        edges, number = graph(occupied, size_row, diagonal)
        least = dijkstra(edges, indices=number[tuple(start)])[number[tuple(goal)]]
        for rest in ("grid", "straight", "none"):
            log = Log()
            given = {"diagonal": diagonal, "spacing": size, "rest": rest, "log": log}
            if np.isinf(least):
                with pytest.raises(NoPath, match="no way from start to goal"):
                    astar(occupied, start, goal, **given)
                continue
            way = astar(occupied, start, goal, **given)
            assert way[0].tolist() == start.tolist() and way[-1].tolist() == goal.tolist()
            pairs = number[tuple(way[:-1].T)], number[tuple(way[1:].T)]
            assert np.asarray(edges[pairs]).sum() == pytest.approx(least)
            assert (np.asarray(edges[pairs]) > 0).all()
            assert path_length(way * size_row) == pytest.approx(least)
            assert log.best[0][1] == pytest.approx(least)


def test_a_better_guess_expands_fewer_cells_and_one_that_is_too_long_may_miss_the_shortest():
    grids = np.random.default_rng(1).random((10, 25, 25)) < 0.15
    grids[:, 0, 0] = grids[:, -1, -1] = False
    expanded, lengths = {}, {}
    for rest in ("none", "straight", "grid", "steps"):
        logs = [Log() for _ in grids]
        for occupied, log in zip(grids, logs, strict=True):
            astar(occupied, (0, 0), (24, 24), rest=rest, log=log)
        expanded[rest] = [log.evaluations for log in logs]
        lengths[rest] = [log.best[0][1] for log in logs]
    assert np.all(np.array(expanded["straight"]) <= expanded["none"])
    assert np.mean(expanded["grid"]) < 0.8 * np.mean(expanded["straight"])
    assert lengths["grid"] == pytest.approx(lengths["none"])
    assert lengths["straight"] == pytest.approx(lengths["none"])
    assert np.sum(np.array(lengths["steps"]) > np.array(lengths["none"]) + 1e-9) >= 3


def test_diagonal_steps_cut_no_corner():
    occupied = np.zeros((3, 3), bool)
    occupied[1, 1] = True
    assert path_length(astar(occupied, (0, 1), (1, 0))) == pytest.approx(2.0)
    occupied[0, 1] = True
    occupied[1, 0] = False
    assert astar(occupied, (0, 0), (2, 1)).tolist() == [[0, 0], [1, 0], [2, 0], [2, 1]]


def test_a_guess_may_be_a_function_and_costs_may_be_other_than_lengths():
    occupied = np.zeros((5, 9), bool)
    way = astar(occupied, (0, 0), (4, 8), rest=lambda cell, goal: np.abs(goal - cell).max())
    assert path_length(way) == pytest.approx(4 * 2**0.5 + 4)
    roads = {"a": [("b", 1.0), ("c", 5.0)], "b": [("c", 1.0)], "c": []}
    nodes, cost, before = best_first("a", "c", roads.__getitem__)
    assert nodes == ["a", "b", "c"] and cost == 2.0
    assert before == {"a": None, "b": "a", "c": "b"}


def test_the_log_has_the_tree_of_what_was_expanded():
    log = Log()
    astar(np.zeros((6, 6), bool), (0, 0), (5, 3), log=log, diagonal=False, rest="none")
    assert len(log.points) == log.evaluations == len(log.edges) + 1
    apart = log.points[log.edges[:, 0]] - log.points[log.edges[:, 1]]
    assert (np.abs(apart).sum(axis=1) == 1).all()


@pytest.mark.parametrize(
    ("start", "goal", "said"),
    [
        ((0, 9), (1, 1), "start must be indices within the grid"),
        ((0, 0), (1, -1), "goal must be indices within the grid"),
        ((0.5, 0), (1, 1), "start must be indices"),
        ((0, 0), (2, 2), "goal must be a free cell"),
        ((0, 0, 0), (1, 1), "start must be indices of a cell, shape"),
    ],
)
def test_bad_cells_are_named(start, goal, said):
    occupied = np.zeros((4, 4), bool)
    occupied[2, 2] = True
    with pytest.raises(ValueError, match=said):
        astar(occupied, start, goal)


def test_bad_grids_are_named():
    with pytest.raises(ValueError, match="occupied must end in n truth values"):
        astar(np.zeros((3, 3)), (0, 0), (1, 1))
    with pytest.raises(ValueError, match="spacing must be above 0"):
        astar(np.zeros((3, 3), bool), (0, 0), (1, 1), spacing=0.0)
    with pytest.raises(ValueError, match="rest must be one of"):
        astar(np.zeros((3, 3), bool), (0, 0), (1, 1), rest="best")
