"""Wrong input where a path is foreseen and improved: `fuzz` says what is tried and allowed."""

from __future__ import annotations

import numpy as np
import pytest

from backhoe.machine import BACKHOE
from backhoe.perception.distance_field import DistanceField
from backhoe.planning import foresight, improve
from backhoe.whole_body import stability
from fuzz import assert_answers_or_names, assert_complete, public

PATH = np.linspace([5.5, -1.0, 1.5, 0.2], [6.0, 1.0, 3.0, -0.4], 5)
FIELD = DistanceField(np.eye(4, dtype=bool)[None].repeat(4, 0), 1.0, (-1.0, -1.0, -1.0))


def calls() -> dict[str, tuple]:
    practice = {
        "cost": lambda tries: (tries**2).sum(axis=1), "start": np.ones(3),
        "spread": np.full(3, 0.5), "batch": 4, "budget": 12, "rng": 1, "decay": 0.9,
    }  # fmt: skip
    costs = np.array([3.0, 1.0, np.inf, 2.0])
    table = {
        foresight.foresee: {
            "path": PATH, "times": np.linspace(0.0, 4.0, 5), "machine": BACKHOE,
            "margin": stability.margin, "field": FIELD,
            "spheres": {"stick": np.array([[0.0, 0.0, 0.0, 0.1]])},
            "least_margin": 0.1, "least_clearance": 0.1,
        },
        foresight.nearest_reachable: {"path": PATH, "machine": BACKHOE},
        improve.pi2: {**practice, "hardness": 10.0},
        improve.power: {**practice, "scale": 1.0, "best": 3},
        improve.pi2_weights: {"costs": costs, "hardness": 10.0},
        improve.power_weights: {"costs": costs, "scale": 2.0},
    }  # fmt: skip
    return {function.__name__: (function, given) for function, given in table.items()}


TABLE = calls()
RESULTS = ["Foresight", "Learning"]
SAID = {"costs": ("tries that",), "cost": ("tries of",)}


def test_every_public_function_is_called_with_all_its_arguments():
    assert_complete(TABLE, public([foresight, improve], RESULTS))


@pytest.mark.parametrize("name", sorted(TABLE))
def test_wrong_input_is_answered_or_refused_by_name(name):
    assert_answers_or_names(*TABLE[name], SAID, len(name))
