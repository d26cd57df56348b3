"""The list of what the sources print: each verdict has a function and a test that exist."""

import csv
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
with (ROOT / "data" / "sources.csv").open(encoding="utf-8", newline="") as file:
    TABLE = csv.DictReader(file)
    ROWS = list(TABLE)
VERDICTS = {"right", "typo", "wrong", "inconsistent", "not reproducible"}


def test_the_columns_are_the_agreed_ones():
    assert TABLE.fieldnames == ["source", "number", "lesson", "function", "test", "verdict"]


def test_no_item_is_judged_twice():
    items = [(row["source"], row["number"]) for row in ROWS]
    assert len(items) == len(set(items))


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row['source']} {row['number']}")
def test_a_verdict_stands_on_a_function_and_a_test(row):
    assert row["verdict"] in VERDICTS
    assert list((ROOT / "notebooks").glob(f"{row['lesson']}_*.ipynb"))
    module, _, name = row["function"].rpartition(".")
    assert hasattr(import_module(module), name)
    path, _, test = row["test"].partition("::")
    assert f"def {test}(" in (ROOT / path).read_text(encoding="utf-8")
