"""Inputs are checked in one place: outside `basics` nothing asks whether a value is a number."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import pytest

from test_floors import FILES

QUESTIONS = {"isfinite", "isnan", "Real", "Integral", "Number", "bool", "bool_"}
"""Whoever asks one of these and raises has a check of its own where `basics.inputs` has one."""

OWN = {
    "backhoe.arm.integrate": ["isfinite"],
    "backhoe.mission.sensing": ["isfinite"],
    "backhoe.perception.octree.tree": ["isfinite"],
}
"""What is asked there is no argument: the state that a step has left, whether a matcher found
anything, what a file holds."""


def _asks(test: ast.AST) -> set[str]:
    names = {getattr(node, "attr", getattr(node, "id", "")) for node in ast.walk(test)}
    return names & QUESTIONS


def _checks(tree: ast.AST) -> Iterator[tuple[int, str]]:
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and any(isinstance(end, ast.Raise) for end in node.body):
            if asked := _asks(node.test):
                yield node.lineno, ", ".join(sorted(asked))


MODULES = [name for name in FILES if not name.startswith("backhoe.basics")]


@pytest.mark.parametrize("name", MODULES)
def test_no_module_has_a_check_of_its_own(name):
    found = list(_checks(ast.parse(FILES[name].read_text(encoding="utf-8"))))
    asked = [what for _, what in found]
    assert asked == OWN.get(name, []), f"{name} checks inputs itself, (line, question): {found}"
