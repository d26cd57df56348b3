"""The verdict contract: what `data/sources.csv` says of an item is tried on the item itself.

A row names the form that the course holds to be right, the form that the source prints, an oracle
from outside the library and the property that decides. A property is a function in the lesson's
`verdicts.py` that takes a form and fails, by an `assert`, where the form lacks it.
"""

from __future__ import annotations

import csv
import re
from functools import cache
from importlib import import_module, util
from pathlib import Path

from backhoe.course.catalogue import LESSONS
from backhoe.lessons import published

ROOT = Path(__file__).resolve().parents[1]
COLUMNS = "source number lesson verdict right printed misprint oracle property".split()
VERDICTS = {"right", "typo", "wrong", "inconsistent", "not reproducible"}
AGAIN = re.compile(r"printed again: (.+)")
DATA = re.compile(r"data/published/(\w+)\.toml::(.+)")


def rows() -> list[dict[str, str]]:
    """Every row of `data/sources.csv`; one that is printed again takes over what it repeats."""
    with (ROOT / "data" / "sources.csv").open(encoding="utf-8", newline="") as file:
        table = csv.DictReader(file)
        assert table.fieldnames == COLUMNS
        every = list(table)
    by_item = {(row["source"], row["number"]): row for row in every}
    for row in every:
        if match := AGAIN.fullmatch(row["printed"]):
            first = by_item[row["source"], match[1]]
            row["again"] = match[1]
            assert row["verdict"] == first["verdict"], f"{row['number']} repeats {match[1]}"
            for column in COLUMNS[4:]:
                assert not row[column] or column == "printed"
                row[column] = first[column]
    return every


@cache
def verdicts(lesson: str):
    """The module of a lesson's properties, such as `tests/lessons/kinematics/verdicts.py`."""
    path = ROOT / "tests" / "lessons" / LESSONS[str(int(lesson))] / "verdicts.py"
    spec = util.spec_from_file_location(f"verdicts_{lesson}", path)
    module = util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def form(row: dict[str, str], column: str):
    """What a row names: in the library by its dotted name, in published data by its keys, else
    in the lesson's `verdicts.py`."""
    name = row[column]
    if match := DATA.fullmatch(name):
        found = published.load(match[1])
        for key in match[2].split("."):
            found = found[int(key) if key.isdigit() else key]
        return found
    if name.startswith("backhoe."):
        module, _, attribute = name.rpartition(".")
        return getattr(import_module(module), attribute)
    return getattr(verdicts(row["lesson"]), name)


def holds(row: dict[str, str], column: str) -> bool:
    """Whether the form in a column has the row's property."""
    try:
        form(row, "property")(form(row, column))
    except AssertionError:
        return False
    return True
