"""Each verdict on a printed item flips when the printed form takes the place of the right one."""

from collections import Counter
from importlib import import_module

import pytest

import contract

ROWS = contract.rows()
ONCE = [row for row in ROWS if "again" not in row]


def each(rows):
    name = "{0[source]} {0[number]}".format
    return pytest.mark.parametrize("row", rows, ids=[name(row) for row in rows])


def test_no_item_is_judged_twice():
    assert max(Counter((row["source"], row["number"]) for row in ROWS).values()) == 1


@each(ROWS)
def test_a_row_says_all_that_its_verdict_stands_on(row):
    assert row["verdict"] in contract.VERDICTS
    assert all(row[column] for column in ("right", "printed", "property"))
    assert len(row["oracle"].split()) >= 2
    assert bool(row["misprint"]) == (row["verdict"] == "right")


@each(ONCE)
def test_the_right_form_has_the_property(row):
    contract.form(row, "property")(contract.form(row, "right"))


@each(ONCE)
def test_the_printed_form_has_the_property_where_it_is_right_and_nowhere_else(row):
    assert contract.holds(row, "printed") == (row["verdict"] == "right")


@each([row for row in ONCE if row["verdict"] == "right"])
def test_a_misprint_in_the_place_of_a_right_form_is_noticed(row):
    assert not contract.holds(row, "misprint")


@each([row for row in ONCE if row["right"].startswith("backhoe.")])
def test_the_oracle_does_not_ask_the_form_that_it_judges(row, monkeypatch):
    right = contract.form(row, "right")
    module, _, name = row["right"].rpartition(".")

    def asked(*_, **__):
        raise RuntimeError(f"the oracle of {row['number']} calls {name} itself")

    monkeypatch.setattr(import_module(module), name, asked)
    contract.form(row, "property")(right)


def test_each_row_is_decided_by_itself():
    decides = [(r["lesson"], r["property"], r["printed"], r["misprint"]) for r in ONCE]
    assert max(Counter(decides).values()) == 1
    misprints = [(r["lesson"], r["property"], r["misprint"]) for r in ONCE if r["misprint"]]
    assert max(Counter(misprints).values()) == 1


@pytest.mark.parametrize("lesson", sorted({row["lesson"] for row in ROWS}))
def test_no_property_is_without_a_row(lesson):
    module = contract.verdicts(lesson)
    named = {row[c] for row in ROWS if row["lesson"] == lesson for c in contract.COLUMNS}
    public = {
        name
        for name, value in vars(module).items()
        if getattr(value, "__module__", None) == module.__name__ and not name.startswith("_")
    }
    assert public <= named, public - named
