"""A student's function in the middle of a lesson: used where it works, and a line where not."""

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
        (one_number, "returns a number, not an array of shape (2,)"),
        (not_finite, "returns values that are not finite"),
    ],
)
def test_another_is_replaced_and_one_line_says_why(mine, why, capsys):
    assert working(mine, library, np.ones(2), 2.0) is library
    (line,) = capsys.readouterr().out.splitlines()
    assert line.startswith(f"({mine.__name__} {why}")
    assert line.endswith("; the library's stands in)")


def test_several_values_count_by_their_number(capsys):
    def two(q):
        return q, 1.0

    assert working(lambda q: (q, 2.0), two, 3.0) is not two
    assert working(lambda q: 2.0, two, 3.0) is two
    assert "returns a number, not 2 values" in capsys.readouterr().out


def test_the_trial_leaves_the_arguments_alone():
    q = np.ones(2)
    working(in_place, in_place, q, 2.0)
    np.testing.assert_array_equal(q, 1.0)
