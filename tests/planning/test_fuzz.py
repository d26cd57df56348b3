"""Wrong input at every public function of the searches: `fuzz` says what is tried and allowed."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Callable

import numpy as np
import pytest

from backhoe.machine import BACKHOE
from backhoe.planning import search
from fuzz import assert_answers_or_names, assert_complete, method, public

DISCS = np.array([[3.0, 3.0, 1.2], [5.0, 5.5, 1.3]])
BOX = {"lower": np.zeros(2), "upper": np.array([9.0, 8.0])}
ENDS = {"start": np.array([0.5, 0.5]), "goal": np.array([8.5, 7.5])}
RESULTS = "Descent Log NoPath Relief Shortest Timed".split()
"""Made by functions, not by hand, or a form."""
LINKS = {
    link: np.array([[0.5, 0.0, 0.0, 0.2], [1.0, 0.0, 0.0, 0.2]])
    for link in ("boom", "stick", "bucket")
}
BOXES = np.array([[[5.0, 2.0, 0.0], [6.0, 3.0, 1.0]], [[5.0, -3.0, 0.0], [6.0, -2.0, 1.0]]])
POSTURES = np.random.default_rng(11).uniform(BACKHOE.lower, BACKHOE.upper, (3, 4))
WORLD = search.ArmWorld(LINKS, BOXES)
LEVEL = search.LevelWorld(WORLD, -3.0)


def is_free(points):
    return (np.linalg.norm(points[:, None] - DISCS[:, :2], axis=-1) > DISCS[:, 2]).all(axis=1)


def distance(points):
    way = points[:, None] - DISCS[:, :2]
    apart = np.linalg.norm(way, axis=-1)
    near, row = (apart - DISCS[:, 2]).argmin(axis=1), np.arange(len(points))
    return apart[row, near] - DISCS[near, 2], way[row, near] / apart[row, near, None]


def calls() -> dict[str, tuple[Callable, dict]]:
    tree = {**ENDS, "is_free": is_free, **BOX, "resolution": 0.2, "seed": 1, "log": None}
    tree |= {"budget": 60, "time_limit": 0.2}
    grown = {**tree, "step": 1.5, "goal_share": 0.1}
    path = np.array([[0.5, 0.5], [0.5, 7.5], [8.5, 7.5]])
    cells = {"start": np.array([0, 0]), "goal": np.array([5, 6])}
    edges = {"a": [("b", 1.0)], "b": []}
    table = {
        "astar": {
            "occupied": np.zeros((6, 7), bool), **cells, "diagonal": True,
            "spacing": np.array([0.5, 1.0]), "rest": "grid", "log": None,
        },
        "path_length": {"path": path},
        "potential": {
            **ENDS, "distance": distance, "reach": 1.0, "push": 1.0, "step": 0.2, "budget": 200,
        },
        "prm": {**tree, "neighbours": 5},
        "rrt": grown,
        "rrt_connect": {**tree, "step": 1.5},
        "rrt_star": {**grown, "radius": 8.0},
        "shortcut": {
            "path": path, "is_free": is_free, "resolution": 0.2, "tries": 5, "seed": 1,
            "time_limit": 0.2, "log": None,
        },
        "tangent": {**ENDS, "discs": DISCS, "polygons": [np.array([[6, 1], [7, 1], [7, 2.5]])]},
    }  # fmt: skip
    table |= {
        "ArmWorld": {
            "spheres": LINKS, "boxes": BOXES, "balls": np.array([[5.0, 0.0, 1.0, 0.5]] * 2),
            "relief": search.Relief(np.zeros((3, 3)), (0.0, 0.0), 1.0),
            "own": {"undercarriage": BOXES, "swing": BOXES}, "margin": 0.1, "machine": BACKHOE,
        },
        "LevelWorld": {"world": WORLD, "pitch": -3.0},
        "few_spheres": {"spheres": LINKS["boom"], "count": 2},
        "in_time": {
            "path": path, "speed_limit": np.ones(2), "acceleration_limit": np.ones(2), "dt": 0.1,
            "piece": 5.0, "is_free": lambda q: np.ones(len(q), bool),
        },
        "pitch": {"q": POSTURES, "machine": BACKHOE},
        "segment_times": {"path": path, "speed_limit": np.ones(2)},
    }  # fmt: skip
    assert search.best_first("a", "b", edges.__getitem__)[1] == 1.0
    found = {name: (_no_path_is_an_answer(name), given) for name, given in table.items()}
    for world, names, given in (
        (WORLD, "middles clearance is_free", {"q": POSTURES}),
        (LEVEL, "joints is_free", {"p": POSTURES[:, :3]}),
    ):
        for name in names.split():
            found[f"{type(world).__name__}.{name}"] = method(lambda w=world: w, name), given
    return found


def _no_path_is_an_answer(name: str) -> Callable:
    function = getattr(search, name)

    @functools.wraps(function)
    def call(**given: object) -> object:
        with contextlib.suppress(search.NoPath):
            return function(**given)

    return call


TABLE = calls()
SLOW = "astar in_time potential prm rrt rrt_connect rrt_star shortcut".split()
"""Too slow to try each value, and pairs of arguments."""


def test_every_public_search_is_called_with_all_its_arguments():
    inner = {"best_first", "steer"}  # of loops: their arguments are checked by who calls them
    assert_complete(TABLE, public([search], RESULTS) - inner)


@pytest.mark.parametrize("name", sorted(TABLE))
@pytest.mark.timeout(300)
def test_wrong_input_is_answered_or_refused_by_name(name):
    assert_answers_or_names(*TABLE[name], {}, len(name), slow=name in SLOW)
