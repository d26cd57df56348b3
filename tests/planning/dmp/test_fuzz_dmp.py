"""Wrong input at every public function of planning.dmp: `fuzz` says what is tried and allowed."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from backhoe.perception.distance_field import DistanceField
from backhoe.planning import dmp
from backhoe.planning.dmp import DMP, Library, Rhythmic
from backhoe.planning.dmp.demonstrations import through
from fuzz import assert_answers_or_names, assert_complete, method, public

T = np.linspace(0, 2, 21)
X = np.column_stack([np.sin(T), T**2, 1 + T])
FIELD = DistanceField(np.eye(4, dtype=bool)[None].repeat(4, 0), 1.0, (-1.0, -1.0, -1.0))
TURN = np.column_stack([np.sin(np.pi * T), np.cos(np.pi * T)])


@cache
def learnt():
    return DMP(kernels=8).learn(X, T)


@cache
def swinging():
    return Rhythmic(kernels=8).learn(TURN, T, 2.0)


def calls() -> dict[str, tuple]:
    spring = {"stiffness": 100.0, "damping": 20.0, "tau": 1.0}
    setting = {"kernels": 8, **spring, "width": 1.2, "smoothing": 0.0}
    start, goal, still = np.zeros(3), np.ones(3), np.zeros(3)
    table = {
        DMP: {
            **setting, "end_phase": 0.01, "spacing": "time", "formulation": "pastor", "fit": "lwr",
            "ridge": 1e-6,
        },
        Rhythmic: setting,
        dmp.Kernels: {"count": 8, "width": 1.0, "spacing": "uniform", "end_phase": 0.01},
        Library: {"primitives": {"reach": learnt()}},
        dmp.motion: {"positions": X, "times": T, "smoothing": 0.5},
        dmp.minimum_jerk: {"u": T / 2},
        dmp.phase: {"t": T, "duration": 2.0, "end_phase": 0.01},
        dmp.phase_rate: {"duration": 2.0, "tau": 1.0, "end_phase": 0.01},
        dmp.step_matrix: {"dt": 0.1, **spring, "integrator": "exact"},
        dmp.step_limit: {**spring, "integrator": "euler"},
        dmp.keep_clear: {
            "dmp": learnt(), "field": FIELD, "clearance": 0.5, "gain": 4.0, "duration": 2.0
        },
        dmp.keep_within: {
            "dmp": learnt(), "lower": -np.ones(3), "upper": np.ones(3), "gain": 4.0, "duration": 2.0
        },
        dmp.sequence: {
            "primitives": [learnt(), learnt()], "goals": [goal, None], "durations": [2.0, None],
            "start": start, "dt": 0.1, "blend": 0.2,
        },
    }  # fmt: skip
    demo = dmp.Demonstration(T, np.c_[X, X[:, 0]])
    table |= {
        through: {"times": np.arange(4.0), "points": demo.positions[:4], "dt": 0.1},
        dmp.demonstration: {"name": "load", "dt": 0.1},
        dmp.recorded: {"demo": demo, "seed": 3, "noise": (0.01,) * 4},
        dmp.repetitions: {"name": "dig", "count": 2, "seed": 3},
    }
    found = {function.__qualname__: (function, given) for function, given in table.items()}
    methods = [
        (lambda: DMP(kernels=8), "learn", {"positions": X, "times": T}),
        (learnt, "with_weights", {"weights": np.zeros((8, 3))}),
        (learnt, "forcing_error", {}),
        (learnt, "spread", {"samples": 5}),
        (
            learnt,
            "rollout",
            {
                "start": start, "goal": goal, "duration": 2.0, "dt": 0.05, "remedy": "affine",
                "velocity": still, "exact_end": True, "integrator": "rk4",
                "coupling": lambda t, x, v: np.zeros(3),
            },
        ),
        (lambda: Rhythmic(8), "learn", {"positions": TURN, "times": T, "period": 2.0}),
        (swinging, "basis", {"angle": T}),
        (
            swinging,
            "rollout",
            {
                "duration": 2.0, "dt": 0.1, "centre": np.zeros(2), "size": 0.5, "period": 1.0,
                "start": np.ones(2), "velocity": np.zeros(2),
            },
        ),
        (
            learnt,
            "forcing",
            {"shown": learnt().shown[0], "basis": learnt().kernels.basis(T / T[-1])},
        ),
        (lambda: Library({"reach": learnt()}), "save", {"folder": "kept"}),
        (lambda: Library({}), "load", {"folder": "kept"}),
        (dmp.Kernels, "basis", {"share": np.linspace(0, 1, 5)}),
    ]  # fmt: skip
    for make, name, given in methods:
        found[f"{type(make()).__name__}.{name}"] = method(make, name), given
    return found


CALLS = calls()
RESULTS = {"Demonstration", "Motion"}
SAID = {"kernels": ("count",), "count": ("kernels",), "coupling": ("coupling",)}


def test_each_public_function_is_tried():
    assert_complete(CALLS, public([dmp], RESULTS) | {"through"})


@pytest.mark.parametrize("name", CALLS)
def test_it_answers_or_names_the_argument(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Library({"reach": learnt()}).save("kept")
    assert_answers_or_names(*CALLS[name], SAID)
