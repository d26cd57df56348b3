"""A student's function in the middle of a lesson: used where it works, and a line where not."""

from typing import NamedTuple

import numpy as np
import pytest

from backhoe.lessons.standin import working


def library(q, factor):
    return factor * np.asarray(q)


def halves(q, factor):
    return library(q, factor / 2)


def in_place(q, factor):
    q *= factor
    return q


def stub(q, factor):
    return None


def breaks(q, factor):
    return q[9]


def one_number(q, factor):
    return 3.0


def not_finite(q, factor):
    return np.full(2, np.nan)


def test_a_function_that_answers_in_the_right_form_is_used_and_nothing_is_said(capsys):
    assert working(halves, library, np.ones(2), 2.0) is halves
    assert not capsys.readouterr().out


@pytest.mark.parametrize(
    ("mine", "why"),
    [
        (stub, "is not done yet"),
        (breaks, "stops with IndexError: index 9 is out of bounds"),
        (one_number, "returns a number, not numbers of shape (2,)"),
        (not_finite, "returns values that are not finite"),
    ],
)
def test_another_is_replaced_and_one_line_says_why(mine, why, capsys):
    assert working(mine, library, np.ones(2), 2.0) is library
    (line,) = capsys.readouterr().out.splitlines()
    assert line.startswith(f"({mine.__name__} {why}")
    assert line.endswith("; the library's stands in)")


class Pair(NamedTuple):
    far: float
    near: float


@pytest.mark.parametrize("answer", [(3.0, 1.0), [3.0, 1.0], np.array([3.0, 1.0]), Pair(3.0, 1.0)])
def test_numbers_in_a_tuple_a_list_or_an_array_are_one_form(answer, capsys):
    def mine(q):
        return answer

    assert working(mine, lambda q: Pair(q, 2.0), 3.0) is mine
    assert not capsys.readouterr().out


def test_parts_of_other_shapes_count_one_by_one(capsys):
    def library(q):
        return np.zeros(3), q

    def fits(q):
        return np.ones(3), 0.0

    assert working(fits, library, 3.0) is fits
    assert working(lambda q: 2.0, library, 3.0) is library
    assert "returns a number, not 2 values of the shapes (3,), ()" in capsys.readouterr().out


def test_the_trial_leaves_the_arguments_alone():
    q = np.ones(2)
    working(in_place, in_place, q, 2.0)
    np.testing.assert_array_equal(q, 1.0)
