"""Every exercise of every lesson: the reference passes, the stub does not, mistakes are named."""

from __future__ import annotations

import pytest

from backhoe.course import catalogue
from backhoe.course.checking import Check
from backhoe.lessons.exercise import Exercise

EXERCISES = [
    exercise for number in catalogue.written() for exercise in catalogue.lesson(number).values()
]
MISTAKES = [(exercise, diagnosis) for exercise in EXERCISES for diagnosis in exercise.mistakes]


def said(capsys: pytest.CaptureFixture, exercise: Exercise, answer: object) -> str:
    Check(catalogue)(exercise.number, answer)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 1
    return lines[0].removeprefix(f"exercise {exercise.number}: ")


def given(exercise: Exercise, answer: object) -> object:
    """What a student hands in: a function, or the value that one without arguments computes."""
    computed = callable(answer) and not exercise.asks_for_a_function
    return answer() if computed else answer


def untouched(*arguments: object) -> None:
    return None


def unfinished(*arguments: object) -> None:
    raise NotImplementedError


@pytest.mark.parametrize("number", catalogue.written())
def test_a_lesson_has_at_least_five_exercises(number):
    assert len(catalogue.lesson(number)) >= 5


@pytest.mark.parametrize("exercise", EXERCISES, ids=lambda exercise: exercise.number)
class TestExercise:
    def test_the_reference_is_right(self, exercise, capsys):
        line = said(capsys, exercise, given(exercise, exercise.reference))
        assert line.startswith("right")

    def test_a_function_exercise_says_what_it_was_tested_on(self, exercise, capsys):
        if exercise.asks_for_a_function:
            assert exercise.tested_on

    def test_the_stub_is_not_done_yet(self, exercise, capsys):
        stubs = [None, ..., NotImplemented]
        if exercise.asks_for_a_function:
            stubs += [untouched, unfinished, lambda *arguments: ...]
        assert {said(capsys, exercise, stub) for stub in stubs} == {"not done yet"}

    def test_an_error_is_not_right(self, exercise, capsys):
        if exercise.asks_for_a_function:
            line = said(capsys, exercise, lambda *arguments: 1 / 0)
            assert line.startswith("not yet: it stops with ZeroDivisionError")

    def test_four_mistakes_have_their_own_diagnosis_and_two_hints_help(self, exercise):
        assert len(exercise.mistakes) >= 4
        assert len(set(exercise.hints)) == len(exercise.hints) >= 2

    def test_the_solution_reveals_no_mistake(self, exercise, capsys):
        Check(catalogue).solution(exercise.number)
        source = capsys.readouterr().out
        assert source.strip()
        assert not any(diagnosis in source for diagnosis in exercise.mistakes)


@pytest.mark.parametrize(
    ("exercise", "diagnosis"),
    MISTAKES,
    ids=[f"{exercise.number} {diagnosis}" for exercise, diagnosis in MISTAKES],
)
def test_a_known_mistake_gets_its_own_diagnosis(exercise, diagnosis, capsys):
    line = said(capsys, exercise, given(exercise, exercise.mistakes[diagnosis]))
    assert line == f"not yet: {diagnosis}"


def test_a_solution_shows_the_private_functions_that_it_calls(capsys):
    Check(catalogue).solution("6.1")
    shown = capsys.readouterr().out
    assert "def bilinear_sum(" in shown and "def _sum(" in shown
