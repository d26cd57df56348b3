"""Wrong input at every public function of the searches: `fuzz` says what is tried and allowed."""

from __future__ import annotations

import contextlib
import functools
from collections.abc import Callable

import numpy as np
import pytest

from backhoe.planning import search
from fuzz import assert_answers_or_names, assert_complete, public

DISCS = np.array([[3.0, 3.0, 1.2], [5.0, 5.5, 1.3]])
BOX = {"lower": np.zeros(2), "upper": np.array([9.0, 8.0])}
ENDS = {"start": np.array([0.5, 0.5]), "goal": np.array([8.5, 7.5])}
RESULTS = "Descent Log NoPath Relief Shortest".split()
"""Made by functions, not by hand; and the arm's world and what belongs to it, which has its own."""
OTHERS = "ArmWorld LevelWorld Timed few_spheres in_time pitch segment_times".split()


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
    assert search.best_first("a", "b", edges.__getitem__)[1] == 1.0
    return {name: (_no_path_is_an_answer(name), given) for name, given in table.items()}


def _no_path_is_an_answer(name: str) -> Callable:
    function = getattr(search, name)

    @functools.wraps(function)
    def call(**given: object) -> object:
        with contextlib.suppress(search.NoPath):
            return function(**given)

    return call


TABLE = calls()


def test_every_public_search_is_called_with_all_its_arguments():
    inner = {"best_first", "steer"}  # of loops: their arguments are checked by who calls them
    names = {
        name for name in public([search], RESULTS) if name.split(".")[0] not in {*OTHERS, *inner}
    }
    assert_complete(TABLE, names)


@pytest.mark.parametrize("name", sorted(TABLE))
@pytest.mark.timeout(300)
def test_wrong_input_is_answered_or_refused_by_name(name):
    assert_answers_or_names(*TABLE[name], {}, len(name), slow=name != "tangent")
