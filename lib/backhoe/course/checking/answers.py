"""Ask a student's answer with every case: the only place that runs what a student wrote.

`ask` is meant to run inside `guard.run`.
"""

from __future__ import annotations

import inspect
import linecache
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from backhoe.course.checking.guard import TimeUp
from backhoe.course.checking.outcomes import (
    Blank,
    Numbers,
    Other,
    Raised,
    agree,
    describe,
    is_blank,
    outcome_of,
    plain,
    short,
)
from backhoe.lessons.exercise import Exercise


@dataclass
class Trial:
    """One answer on trial: what it was asked, what is right, what it gave, and the verdicts.

    `cases` are argument tuples; `references` what the reference gave for each, an exception where
    it raised; `outcomes` what the answer gave. A verdict is True, False or a diagnosis. `changed`
    names an argument that the answer changed in place; `misuse` says why it could not be asked;
    `printed` whether it wrote anything.
    """

    exercise: Exercise
    cases: Sequence[tuple]
    references: Sequence[object]
    outcomes: list = field(default_factory=list)
    verdicts: list = field(default_factory=list)
    changed: str = ""
    misuse: str = ""
    printed: bool = False

    @cached_property
    def right(self) -> list[object]:
        """What an answer should have given, in the form of the outcomes."""
        return list(map(outcome_of, self.references, self.references))

    @property
    def wrong(self) -> list[int]:
        """Places of the cases that were not answered rightly."""
        return [place for place, verdict in enumerate(self.verdicts) if verdict is not True]

    def only(self, places: Sequence[int]) -> Trial:
        """The trial restricted to some of its cases."""
        lists = (self.cases, self.references, self.outcomes, self.verdicts)
        return Trial(self.exercise, *([values[place] for place in places] for values in lists))


def prepare(exercise: Exercise) -> Trial:
    """A trial with its cases and what the reference gives."""
    cases = exercise.inputs()
    return Trial(exercise, cases, gives(exercise, exercise.reference, cases))


def gives(exercise: Exercise, function: object, cases: Sequence[tuple]) -> list[object]:
    """What the reference or a known mistake gives for each case, an exception where it raises."""
    if not exercise.asks_for_a_function:
        return [function() if callable(function) else function]
    results: list[object] = []
    for case in cases:
        try:
            results.append(function(*_copy(case)))
        except Exception as error:
            results.append(error)
    return results


def ask(answer: object, trial: Trial) -> Trial:
    """Call `answer` with copies of every case (or read it, if it is a value) and judge it."""
    if is_blank(answer):
        trial.outcomes.append(Blank())
        return trial
    exercise = trial.exercise
    try:
        trial.misuse = _misuse(answer, exercise, trial.cases)
    except Exception as error:
        trial.misuse = f"what you passed cannot be read: {_raised(error, None).text}"
    if trial.misuse:
        return trial
    for case, reference in zip(trial.cases, trial.references, strict=True):
        arguments = _copy(case)
        try:
            value = answer(*arguments) if exercise.asks_for_a_function else answer
            outcome = plain(value, reference)
        except TimeUp:
            raise
        except BaseException as error:
            outcome = _raised(error, answer)
        trial.outcomes.append(outcome)
        trial.verdicts.append(_judge(exercise, outcome, reference, case))
        trial.changed = trial.changed or _changed(exercise, arguments, case)
    trial.printed = getattr(sys.stdout, "printed", False)  # the stream of `guard`
    return trial


def _copy(value: object) -> object:
    if isinstance(value, np.ndarray):
        return value.copy()
    if type(value) in (list, tuple):
        return type(value)(_copy(one) for one in value)
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return type(value)(*map(_copy, value))
    return {key: _copy(one) for key, one in value.items()} if type(value) is dict else value


def _misuse(answer: object, exercise: Exercise, cases: Sequence[tuple]) -> str:
    if not exercise.asks_for_a_function:
        if inspect.isroutine(answer) or isinstance(answer, type):
            return "the answer is a value, you passed a function: call it, and pass what it returns"
        return ""
    if not callable(answer):
        return (
            "pass the function itself, with no brackets after its name: "
            f'check("{exercise.number}", my_function); you passed {describe(answer)}'
        )
    try:
        signature = inspect.signature(answer)
    except TimeUp:
        raise
    except BaseException:
        return ""
    try:
        signature.bind(*cases[0])
    except TypeError:
        names = exercise.argument_names(len(cases[0]))
        return (
            f"the function is called with ({', '.join(names)}), "
            f"but yours takes {short(str(signature), 60)}"
        )
    return ""


def _raised(error: BaseException, answer: object) -> Raised:
    kind = type(error).__name__
    if isinstance(error, RecursionError):
        return Raised(kind, f"{kind}: it calls itself without end")
    try:
        text = short(str(error), 100) if error.args[:1] != (None,) else ""
    except TimeUp:
        raise
    except BaseException:
        text = ""
    where = _line_of(error, answer)
    return Raised(kind, short(kind, 40) + (f": {text}" if text else "") + where)


def _line_of(error: BaseException, answer: object) -> str:
    if not inspect.isfunction(answer):
        return ""
    file, line, trace = answer.__code__.co_filename, None, error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == file:
            line = trace.tb_lineno
        trace = trace.tb_next
    source = linecache.getline(file, line).strip() if line else ""
    return f" (in the line: {short(source, 60)})" if source else ""


def _judge(exercise: Exercise, outcome: object, reference: object, case: tuple) -> bool | str:
    comparable = isinstance(outcome, Numbers | Other | str)
    if not (exercise.compare and comparable) or isinstance(reference, Exception):
        return agree(outcome, outcome_of(reference, reference), exercise)
    value = outcome if isinstance(outcome, str) else outcome.value
    try:
        verdict = exercise.compare(value, reference, *_copy(case))
    except Exception as error:
        return f"what it returns cannot be used: {short(str(error), 150)}"
    if isinstance(verdict, str):
        return short(verdict, 300)
    return verdict is None or bool(verdict)


def _changed(exercise: Exercise, arguments: tuple, case: tuple) -> str:
    names = exercise.argument_names(len(case))
    for name, argument, original in zip(names, arguments, case, strict=True):
        if not _same(argument, original):
            return name
    return ""


def _same(one: object, other: object) -> bool:
    if isinstance(other, np.ndarray):
        return np.shape(one) == other.shape and np.array_equal(
            one, other, equal_nan=other.dtype.kind in "fc"
        )
    if isinstance(other, list | tuple):
        return type(one) is type(other) and len(one) == len(other) and all(map(_same, one, other))
    if type(other) is dict:
        return list(one) == list(other) and all(_same(one[key], other[key]) for key in other)
    return one is other or (type(one) is type(other) and bool(one == other))
