"""The gate itself: what it calls killed, what survives, and what is no verdict but an error."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import pytest

from backhoe import FLOORS
from mutants import gate

LIBRARY = "from math import pi\n\n\ndef area(r):\n    return pi * r**2  # of a circle\n"
TESTS = """
import pytest
from backhoe.circle import area

@pytest.fixture
def one():
    if area(1) < 3:
        raise RuntimeError("no circle")
    return area(1)

def test_area():
    assert 3.1 < area(1) < 3.2

def test_fixture(one):
    pass

def test_nothing():
    area(2)
"""
HALF = gate.Mutant(
    file="circle.py",
    kind="factor",
    wrong="half the area",
    old="return pi * r**2",
    new="return pi * r**2 / 2",
    tests=("test_circle.py::test_area",),
)


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """A repository of one module and one file of tests."""
    folder = tmp_path_factory.mktemp("repository")
    for name, text in {"lib/backhoe/circle.py": LIBRARY, "tests/test_circle.py": TESTS}.items():
        path = folder / name
        path.parent.mkdir(parents=True)
        path.write_text(text, encoding="utf-8")
    (folder / "lib" / "backhoe" / "__init__.py").write_text("", encoding="utf-8")
    return folder


def test_each_entry_fits_the_library_and_names_tests_that_are_there():
    chosen = gate.mutants()
    for mutant in chosen:
        gate.faulty(mutant, gate.ROOT / "lib" / "backhoe")
        assert mutant.kind in gate.KINDS and mutant.tests and mutant.wrong
        for test in mutant.tests:
            file, *names = test.split("::")
            text = (gate.ROOT / "tests" / file).read_text(encoding="utf-8")
            assert all(name.split("[")[0] in text for name in names), test
    assert len({(mutant.file, mutant.old, mutant.new) for mutant in chosen}) == len(chosen)


def test_every_floor_has_mutants_and_every_kind_of_fault_is_among_them():
    chosen = gate.mutants()
    there = {path.name for path in (gate.ROOT / "lib" / "backhoe").iterdir() if path.is_dir()}
    assert {mutant.file.split("/")[0] for mutant in chosen} == there & set(FLOORS)
    kinds = Counter(mutant.kind for mutant in chosen)
    assert min(kinds[kind] for kind in gate.KINDS) >= 4
    assert len(chosen) >= 70


def test_a_fault_is_killed_a_harmless_one_survives_and_the_rest_is_an_error(root):
    def like(**changes):
        return replace(HALF, **changes)

    wanted = {
        HALF: ("killed", "test_area"),
        like(old="of a circle", new="of a disc"): ("survived", "test_area"),
        like(tests=("test_circle.py::test_nothing",)): ("survived", "test_nothing"),
        like(old="return tau"): ("error", "0 times in circle.py"),
        like(old="r", new="s"): ("error", "times in circle.py"),
        like(file="sphere.py"): ("error", "0 times in sphere.py"),
        like(new="return return"): ("error", "no Python"),
        like(old="from math import pi", new="from math import pie"): ("error", "cannot import"),
        like(new="return pie * r**2"): ("error", "NameError"),
        like(tests=("test_circle.py::test_fixture",)): ("error", "no circle"),
        like(new="import os; os._exit(3)"): ("error", "crashed"),
    }
    said = []
    found = gate.judge(list(wanted), root=root, say=said.append)
    assert len(said) == len(wanted)
    for mutant, (outcome, by) in wanted.items():
        assert found[mutant].outcome == outcome, mutant
        assert by in found[mutant].by
    assert (root / "lib" / "backhoe" / "circle.py").read_text(encoding="utf-8") == LIBRARY


@pytest.mark.parametrize("test", ["test_circle.py::test_gone", "test_gone.py"])
def test_without_sound_tests_there_is_no_verdict(root, test):
    with pytest.raises(ValueError, match=r"without any mutant: .*test_gone"):
        gate.judge([replace(HALF, tests=(test,))], root=root)


def test_engines_that_reach_a_file_are_found_through_what_they_import():
    package = gate.ROOT / "lib" / "backhoe"
    assert gate._engines_that_reach(package, "localisation/kalman/smoother.py") == []
    own = gate._engines_that_reach(package, "localisation/kalman/engine.py")
    assert own == ["localisation/kalman/engine.py"]
    terms = gate._engines_that_reach(package, "arm/dynamics/terms.py")
    assert {"arm/dynamics/engine.py", "arm/closed_loop/step_engine.py"} < set(terms)
