"""The league table: the best score of each name, best first, in a file of this machine."""

import json

import pytest

from backhoe.course.league import FILE, league

BUILT_IN = {"library": 1.0, "highest": 0.7}


def test_nothing_is_entered_and_nothing_written_without_a_name(tmp_path):
    (tmp_path / FILE).write_text(json.dumps({"Ada": {"score": 9.0, "date": "2026-01-01"}}))
    table = league(BUILT_IN, folder=tmp_path)
    assert [line.split()[1] for line in table.splitlines()] == ["library", "highest"]


def test_the_best_score_of_each_name_counts(tmp_path):
    for score in (0.8, 1.2, 0.9):
        table = league(BUILT_IN, "Ada", score, tmp_path)
    table = league(BUILT_IN, "Ben", 0.75, tmp_path)
    assert [line.split() for line in table.splitlines()] == [
        ["1.", "Ada", "1.20"],
        ["2.", "library", "1.00"],
        ["3.", "Ben", "0.75"],
        ["4.", "highest", "0.70"],
    ]


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"Ada": 3}', '{"Ada": {"score": "x"}}'])
def test_a_file_that_cannot_be_read_counts_as_empty(tmp_path, content):
    (tmp_path / FILE).write_text(content)
    assert len(league(BUILT_IN, "Ben", 2.0, tmp_path).splitlines()) == 3


def test_a_name_is_text_and_a_score_a_number(tmp_path):
    with pytest.raises(TypeError, match="name"):
        league(BUILT_IN, 3, 1.0, tmp_path)
    with pytest.raises(ValueError, match="score"):
        league(BUILT_IN, "Ada", float("nan"), tmp_path)
