"""The house: every import points down the floors, none goes in a circle, none is hidden."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from backhoe import FLOORS
from backhoe.course.catalogue import LESSONS

PACKAGE = Path(__file__).resolve().parents[1] / "lib" / "backhoe"
ORDER = list(FLOORS)
ENTRANCES = ("backhoe", "backhoe.__main__")
DYNAMIC = {"import_module", "find_spec", "files", "__import__"}


def _name(path: Path) -> str:
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = {_name(path): path for path in sorted(PACKAGE.rglob("*.py"))}


def _targets(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and name of what a module takes from the library, wherever in it the import stands."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"line {node.lineno}: imports name their floor, no dots"
            for alias in node.names:
                whole = f"{node.module}.{alias.name}"
                yield node.lineno, whole if whole in FILES else node.module
        elif isinstance(node, ast.Call) and node.args:
            called = getattr(node.func, "attr", getattr(node.func, "id", ""))
            text = (
                node.args[0].values[0] if isinstance(node.args[0], ast.JoinedStr) else node.args[0]
            )
            if called in DYNAMIC and isinstance(text, ast.Constant) and isinstance(text.value, str):
                yield node.lineno, text.value.rstrip(".")


IMPORTS = {
    name: [
        (line, target)
        for line, target in _targets(ast.parse(path.read_text(encoding="utf-8")))
        if target.split(".")[0] == "backhoe" and target != "backhoe"
    ]
    for name, path in FILES.items()
}


def _room(name: str, depth: int) -> str:
    return ".".join(name.split(".")[:depth])


def _circle(depth: int | None) -> list[str]:
    """A circle between files (depth None) or packages that many names deep; empty without one."""
    graph: dict[str, set[str]] = {}
    for name, imports in IMPORTS.items():
        for _, target in imports:
            ends = [end if depth is None else _room(end, depth) for end in (name, target)]
            if ends[0] != ends[1]:
                graph.setdefault(ends[0], set()).add(ends[1])
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return error.args[1]
    return []


def test_the_library_has_the_floors_and_nothing_beside_them():
    there = {path.name for path in PACKAGE.iterdir() if path.name != "__pycache__"}
    assert there - {"__init__.py", "__main__.py"} <= set(FLOORS)
    empty = [floor for floor in there & set(FLOORS) if not any((PACKAGE / floor).rglob("*.py"))]
    assert not empty, f"{empty} come with their first lesson, not before"


@pytest.mark.parametrize("name", [name for name in FILES if name not in ENTRANCES])
def test_imports_point_down(name):
    floor = name.split(".")[1]
    up = [
        f"line {line}: {target}"
        for line, target in IMPORTS[name]
        if ORDER.index(target.split(".")[1]) > ORDER.index(floor)
    ]
    assert not up, f"{name}, on floor {floor}, reaches up to {up}"


@pytest.mark.parametrize("depth", [2, 3, None], ids=["floors", "rooms", "files"])
def test_imports_go_in_no_circle(depth):
    assert _circle(depth) == []


def test_below_the_wall_nothing_knows_a_lesson_by_its_text():
    """Not even a hint of `backhoe.lessons` in a string that an import could be made of."""
    wall = ORDER.index("lessons")
    for name, path in FILES.items():
        if name in ENTRANCES or ORDER.index(name.split(".")[1]) >= wall:
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                code = len(node.value.split()) == 1
                assert not (code and "backhoe.lessons" in node.value), f"{name}:{node.lineno}"


@pytest.mark.parametrize(
    "package, homes",
    [
        ("pybullet", ("backhoe.simulation", "backhoe.lessons.dynamics.bench")),
        ("matplotlib", ("backhoe.view.plots", "backhoe.lessons")),
    ],
)
def test_a_heavy_package_has_one_home(package, homes):
    for name, path in FILES.items():
        for line, target in _targets(ast.parse(path.read_text(encoding="utf-8"))):
            if target.split(".")[0] == package:
                assert name.startswith(homes), f"{name}:{line} imports {package}"


def test_compiled_loops_are_in_modules_named_engines():
    for name, path in FILES.items():
        for line, target in _targets(ast.parse(path.read_text(encoding="utf-8"))):
            if target.split(".")[0] == "numba":
                assert name.endswith("engine"), f"{name}:{line} imports numba"


def test_every_folder_of_tests_is_a_floor():
    folders = {path.name for path in Path(__file__).parent.iterdir() if path.is_dir()}
    assert folders - {"browser", "mutants", "__pycache__"} <= set(FLOORS)


def test_every_lesson_has_its_notebooks():
    lessons = {path.name for path in (PACKAGE / "lessons").iterdir() if path.is_dir()}
    notebooks = (PACKAGE.parents[1] / "notebooks").rglob("[0-9]*.ipynb")
    chapters = {str(int(path.stem[:2])) for path in notebooks}
    assert lessons - {"__pycache__"} == {LESSONS[chapter] for chapter in chapters}
    assert chapters == set(LESSONS)
