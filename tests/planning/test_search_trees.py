"""Planners that sample: their ways are looked at far more closely than they looked themselves."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.sparse.csgraph import dijkstra

from backhoe.planning import search
from backhoe.planning.search import (
    Log,
    NoPath,
    path_length,
    potential,
    prm,
    rrt,
    rrt_connect,
    rrt_star,
    shortcut,
)
from backhoe.planning.search import checker as checking

PLANNERS = [prm, rrt, rrt_connect, rrt_star]
LOWER, UPPER = np.zeros(2), np.array([10.0, 8.0])
DISCS = np.array([[3.0, 3.0, 1.2], [5.0, 5.5, 1.3], [7.0, 2.5, 1.3], [2.0, 6.5, 0.8]])
START, GOAL = np.array([0.5, 0.5]), np.array([9.5, 7.5])


def distance(points):
    """To the nearest disc, and the way out."""
    way = points[:, None] - DISCS[:, :2]
    apart = np.maximum(np.linalg.norm(way, axis=-1), 1e-12)
    k = (apart - DISCS[:, 2]).argmin(axis=1)
    rows = np.arange(len(points))
    return (apart - DISCS[:, 2])[rows, k], way[rows, k] / apart[rows, k, None]


def is_free(points):
    return distance(points)[0] > 0


def closely(path):
    """Least distance along a path, looked at every millimetre."""
    return min(
        distance(a + np.linspace(0, 1, 2 + int(1000 * np.linalg.norm(b - a)))[:, None] * (b - a))[
            0
        ].min()
        for a, b in pairwise(path)
    )


@pytest.mark.parametrize("planner", PLANNERS)
def test_ways_are_free_and_join_start_and_goal(planner):
    for seed in range(3):
        log = Log()
        more = {} if planner is prm else {"step": 0.6}
        given = {"resolution": 0.02, "seed": seed, "budget": 400, "log": log, **more}
        path = planner(START, GOAL, is_free, LOWER, UPPER, **given)
        assert (path[0] == START).all() and (path[-1] == GOAL).all()
        assert closely(path) > -(0.02**2) / 8 / 0.8  # the sagitta of the smallest disc
        assert (path >= LOWER).all() and (path <= UPPER).all()
        assert (np.diff(path, axis=0) != 0).any(axis=1).all()
        assert planner is prm or np.linalg.norm(np.diff(path, axis=0), axis=1).max() <= 0.6 + 1e-9
        evaluations, length = log.best[-1]
        assert length == pytest.approx(path_length(path))
        assert evaluations == log.evaluations or planner is rrt_star
        assert path_length(path) > np.linalg.norm(GOAL - START)
        same = planner(START, GOAL, is_free, LOWER, UPPER, **{**given, "log": None})
        assert (same == path).all()


@pytest.mark.parametrize("planner", PLANNERS)
def test_the_log_has_trees_whose_edges_are_free(planner):
    log = Log()
    planner(START, GOAL, is_free, LOWER, UPPER, resolution=0.02, budget=200, log=log)
    assert log.edges.max() < len(log.points)
    for i, j in log.edges:
        assert closely(log.points[[i, j]]) > -1e-4
    if planner is not prm:
        assert len(log.edges) == len(log.points) - (2 if planner is rrt_connect else 1)


def test_a_roadmaps_way_is_the_shortest_in_it():
    for seed in range(3):
        log = Log()
        path = prm(START, GOAL, is_free, LOWER, UPPER, seed=seed, budget=150, log=log)
        lengths = np.zeros((len(log.points),) * 2)
        i, j = log.edges.T
        lengths[i, j] = np.linalg.norm(log.points[i] - log.points[j], axis=1)
        least = dijkstra(lengths, directed=False, indices=0)[1]
        assert path_length(path) == pytest.approx(least)


def test_rrt_star_gets_shorter_and_its_costs_are_its_ways():
    runs = []
    for seed in range(4):
        log = Log()
        path = rrt_star(
            START, GOAL, is_free, LOWER, UPPER, step=1.0, seed=seed, budget=800, log=log
        )
        lengths = [length for _, length in log.best]
        assert (np.diff(lengths) < 0).all()
        assert lengths[-1] == pytest.approx(path_length(path))
        runs.append((lengths[0], lengths[-1]))
    first, last = np.mean(runs, axis=0)
    assert last < 0.95 * first


class Given(np.random.Generator):
    """Random places that are known."""

    def __init__(self, places):
        super().__init__(np.random.PCG64(0))
        self.places = iter(places)

    def random(self):
        return 1.0

    def uniform(self, lower, upper):
        return np.array(next(self.places))


def test_rrt_star_joins_a_place_where_its_whole_way_is_shortest():
    """The place before the last is neither the nearest nor the one with the shortest way itself."""
    places = [[1.4, 0.5], [0.55, 1.3], [1.5, 1.2], [1.6, 1.2]]
    log = Log()
    with pytest.raises(NoPath):
        given = {"step": 1.0, "radius": 100.0, "seed": Given(places), "budget": 4, "log": log}
        rrt_star(START, GOAL, lambda q: np.ones(len(q), bool), LOWER, UPPER, **given)
    np.testing.assert_array_equal(log.points[1:], places)
    assert log.edges.tolist() == [[0, 1], [0, 2], [1, 3], [1, 4]]


def test_more_neighbours_and_more_samples_make_rrt_stars_ways_shorter():
    def mean(**given):
        return np.mean(
            [
                path_length(rrt_star(START, GOAL, is_free, LOWER, UPPER, step=1.0, seed=s, **given))
                for s in range(3)
            ]
        )

    tree = mean(budget=400, radius=1e-6)
    assert mean(budget=400) < 0.92 * tree
    assert mean(budget=400) < mean(budget=150)


def test_the_least_radius_is_karamans_and_frazzolis():
    """In the plane 2 sqrt(3 area / 2 pi), by hand."""
    radius = 2 * (1.5 * 80.0 / np.pi) ** 0.5
    given = {"seed": 3, "budget": 300, "step": 4.0}
    path = rrt_star(START, GOAL, is_free, LOWER, UPPER, **given)
    assert (rrt_star(START, GOAL, is_free, LOWER, UPPER, radius=radius, **given) == path).all()
    other = rrt_star(START, GOAL, is_free, LOWER, UPPER, radius=0.7 * radius, **given)
    assert other.shape != path.shape or not (other == path).all()


def test_connects_second_tree_goes_straight_to_the_place_that_the_first_reached():
    for seed in range(5):
        log = Log()
        given = {"step": 0.5, "seed": seed, "log": log}
        path = rrt_connect(START, GOAL, lambda q: np.ones(len(q), bool), LOWER, UPPER, **given)
        assert np.linalg.norm(path[1] - START) == pytest.approx(0.5)
        way = GOAL - path[1]
        off = (path[1:] - path[1]) @ [-way[1], way[0]]
        np.testing.assert_allclose(off, 0, atol=1e-9)
        assert len(log.points) == len(path) + 1  # where they met is in both


def test_connect_needs_fewer_evaluations_than_a_single_tree():
    def asked(planner):
        total = 0
        for seed in range(10):
            log = Log()
            planner(START, GOAL, is_free, LOWER, UPPER, step=0.5, seed=seed, log=log)
            total += log.evaluations
        return total

    assert asked(rrt_connect) < 0.6 * asked(rrt)


def test_shortcuts_are_free_and_shorten():
    for seed in range(5):
        path = rrt(START, GOAL, is_free, LOWER, UPPER, step=0.5, seed=seed)
        log = Log()
        short = shortcut(path, is_free, 0.02, seed=seed, log=log)
        assert (short[0] == START).all() and (short[-1] == GOAL).all()
        assert path_length(short) < 0.95 * path_length(path)
        assert closely(short) > -1e-4 and log.evaluations > 100
    straight = np.array([START, [4.0, 0.5], [9.0, 0.5]])
    assert path_length(shortcut(straight, is_free, 0.1)) == pytest.approx(path_length(straight))
    assert (shortcut([START, START], is_free, 0.1) == START).all()


def test_a_potential_field_falls_and_ends_where_its_slope_does():
    """At the goal, or where pull and push are equal: told by the potential's own differences."""
    ends = set()
    for start, goal in ((START, GOAL), (START, [0.5, 7.5]), ([3.0, 0.2], [3.0, 5.0])):
        for push in (0.3, 1.0):
            descent = potential(start, goal, distance, push=push)
            ends.add(descent.end)
            assert (np.diff(descent.values) < 0).all()
            assert closely(descent.path) > 0
            assert np.linalg.norm(np.diff(descent.path, axis=0), axis=1).max() <= 0.05 + 1e-12
            d = distance(descent.path)[0]
            pushed = push * np.maximum(1 / d - 1, 0) ** 2
            value = (np.sum((descent.path - goal) ** 2, axis=1) + pushed) / 2
            np.testing.assert_allclose(descent.values, value)
            left = np.linalg.norm(descent.path[-1] - goal)
            assert left < 0.05 if descent.end == "goal" else left > 0.1
    assert ends == {"goal", "minimum"}


def test_a_goal_behind_a_disc_is_a_trap_by_symmetry():
    """On the line through the disc's middle, pull and push are opposite: it stops in between."""
    end = potential([3.0, 0.2], [3.0, 5.0], distance, reach=1.0, step=0.02)
    assert end.end == "minimum"
    x, y = end.path[-1]
    gap = 3.0 - 1.2 - y
    assert x == pytest.approx(3.0)
    assert 5.0 - y == pytest.approx((1 / gap - 1) / gap**2, rel=1e-3)


def test_a_budget_ends_a_descent():
    descent = potential(START, GOAL, distance, budget=10)
    assert descent.end == "budget" and len(descent.path) == 11
    assert descent.evaluations >= 12


class Clock:
    """Time that only the checker takes."""

    def __init__(self, monkeypatch, cost):
        self.now, self.cost, self.most = 100.0, cost, 0
        monkeypatch.setattr(checking, "perf_counter", lambda: self.now)

    def is_free(self, points):
        self.now += self.cost * len(points)
        self.most = max(self.most, len(points))
        return is_free(points)


@pytest.mark.parametrize("cost", [0.004, 0.3])
@pytest.mark.parametrize("planner", PLANNERS)
def test_the_time_limit_is_kept_with_a_slow_checker(planner, cost, monkeypatch):
    clock = Clock(monkeypatch, cost)
    try:
        planner(START, GOAL, clock.is_free, LOWER, UPPER, resolution=1e-3, time_limit=2.0)
    except NoPath as error:
        assert "within time_limit, 2 s" in str(error)
    assert 101.5 < clock.now <= 102.0 + 1.01 * cost
    assert clock.most <= 2.0 / cost


def test_a_smoother_and_rrt_star_give_what_they_have_when_the_time_is_over(monkeypatch):
    clock = Clock(monkeypatch, 0.001)
    path = rrt_star(START, GOAL, clock.is_free, LOWER, UPPER, budget=10**6, time_limit=10.0)
    assert (path[-1] == GOAL).all()
    assert clock.now == pytest.approx(110.0, abs=0.01)
    clock.now, clock.cost = 100.0, 0.5
    assert (shortcut(path, clock.is_free, 0.01, time_limit=1.0)[-1] == GOAL).all()
    assert clock.now <= 101.6


@pytest.mark.parametrize("planner", PLANNERS)
def test_where_there_is_no_way_there_is_no_path(planner):
    def walled(points):
        return np.abs(points[:, 0] - 5.0) > 0.5

    with pytest.raises(NoPath, match="no way"):
        planner(START, GOAL, walled, LOWER, UPPER, budget=300)


@pytest.mark.parametrize("planner", PLANNERS)
@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"start": [3.0, 3.0]}, r"start must be free, \[3. 3.\] is in collision"),
        ({"goal": [5.0, 5.5]}, "goal must be free"),
        ({"goal": [11.0, 5.5]}, "goal must be between lower and upper"),
        ({"lower": [0.0, 9.0]}, "lower must be below upper"),
        ({"start": [1.0, 2.0, 3.0]}, "goal must be as start, shape"),
        ({"start": [np.nan, 2.0]}, "start must be finite"),
        ({"budget": 0}, "budget must be one whole number at least 1"),
        ({"time_limit": 0}, "time_limit must be one number above 0"),
        ({"resolution": -1}, "resolution must be one number above 0 and at least"),
        ({"is_free": lambda points: 1 / 0}, "is_free must answer, it raised ZeroDivisionError"),
        (
            {"is_free": lambda points: np.ones(len(points))},
            "the answer of is_free must be truth values",
        ),
        ({"is_free": lambda points: True}, "the answer of is_free must be truth values"),
    ],
)
def test_bad_input_is_named(planner, changed, said):
    given = {"start": START, "goal": GOAL, "is_free": is_free, "lower": LOWER, "upper": UPPER}
    with pytest.raises(ValueError, match=said):
        planner(**{**given, **changed})


@pytest.mark.parametrize("planner", PLANNERS)
def test_a_checker_that_raises_later_is_named(planner):
    def moody(points):
        if (points[:, 0] > 4).any() and not (points == GOAL).all():
            raise KeyError("truck")
        return is_free(points)

    with pytest.raises(ValueError, match="is_free must answer, it raised KeyError: 'truck'"):
        planner(START, GOAL, moody, LOWER, UPPER)


def test_a_checker_cannot_spoil_the_planners_places():
    def rude(points):
        free = is_free(points)
        points[:] = 0
        return free

    path = rrt(START, GOAL, rude, LOWER, UPPER, seed=2)
    assert (path == rrt(START, GOAL, is_free, LOWER, UPPER, seed=2)).all()


@pytest.mark.parametrize("D", [1, 3, 6])
def test_they_work_in_other_dimensions(D):
    lower, upper = -np.ones(D), np.ones(D)
    for planner in PLANNERS:
        path = planner(0.9 * lower, 0.9 * upper, lambda p: p[:, 0] > -2, lower, upper, budget=500)
        assert path.shape[1] == D and path_length(path) >= 1.8 * D**0.5 - 1e-9


def test_steering_goes_on_by_a_step_at_most():
    assert search.steer(np.zeros(2), np.array([3.0, 4.0]), 1.0) == pytest.approx([0.6, 0.8])
    near = np.array([0.3, 0.4])
    assert (search.steer(np.zeros(2), near, 1.0) == near).all()


def test_an_edge_is_looked_at_to_its_end_and_not_at_its_start():
    """The start is known to be free; what is at the end counts."""
    seen = []

    def all_but_the_end(points):
        seen.extend(points[:, 0].tolist())
        return points[:, 0] < 0.95

    checker = checking.Checker(all_but_the_end, 0.1, 1.0)
    assert not checker.edge(np.zeros(1), np.ones(1))
    assert min(seen) > 0.05 and max(seen) == 1.0
    assert np.diff(sorted(set(seen))).max() <= 0.1 + 1e-12
    assert checker.edge(np.zeros(1), np.full(1, 0.9))
