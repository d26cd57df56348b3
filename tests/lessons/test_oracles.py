"""Every exercise's reference is proved by an oracle of its own, which a small fault must fail.

An exercise names its oracle, a function of `tests/lessons/<lesson>/oracles.py`:

    def name(answer, *arguments): assert ...

`answer` is what the reference gave for the arguments (the exception, where it raised), and the
oracle judges it by another way than the reference's own. Its docstring says which. A reference
that is wrong by 1 % in any of its numbers, or has one of their signs turned, must fail.
"""

from __future__ import annotations

import copy
import importlib.util
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass, replace
from functools import cache
from numbers import Number
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from backhoe.course import catalogue
from backhoe.lessons.exercise import Exercise

EXERCISES = [
    exercise for number in catalogue.written() for exercise in catalogue.lesson(number).values()
]
LEAVES = 12
"""So many numbers of an answer are turned one by one; those of large arrays are drawn at random."""
RETURNS = 4
"""Of a function that was answered, so many numbers of what it returns are turned one by one."""


@cache
def oracles(lesson: str) -> ModuleType:
    path = Path(__file__).parent / lesson / "oracles.py"
    assert path.is_file(), f"lesson {lesson} has no oracles"
    spec = importlib.util.spec_from_file_location(f"oracles_of_{lesson}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def oracle_of(exercise: Exercise) -> Callable[..., None]:
    assert exercise.oracle, f"exercise {exercise.number} names no oracle"
    return getattr(oracles(catalogue.LESSONS[exercise.number.split(".")[0]]), exercise.oracle)


def trials(exercise: Exercise, reference: object = ...) -> list[tuple[object, tuple]]:
    """What the reference gives for fresh random arguments, other ones than the check's."""
    reference = exercise.reference if reference is ... else reference
    if not exercise.asks_for_a_function:
        return [(reference() if callable(reference) else reference, ())]
    found = []
    for arguments in exercise.cases(np.random.default_rng(20261127)):
        try:
            answer = reference(*copy.deepcopy(arguments))
        except ValueError as error:
            answer = error
        found.append((answer, arguments))
    return found


def judge(exercise: Exercise, answers: list[tuple[object, tuple]]) -> None:
    for answer, arguments in answers:
        oracle_of(exercise)(answer, *copy.deepcopy(arguments))


def leaves(answer: object) -> int:
    """How many numbers an answer has; of a function, how many of what it returns are turned."""
    if isinstance(answer, np.ndarray):
        return answer.size
    if isinstance(answer, tuple | list):
        return sum(map(leaves, answer))
    if is_dataclass(answer):
        return sum(leaves(getattr(answer, field.name)) for field in fields(answer))
    return RETURNS if callable(answer) else int(isinstance(answer, Number | str))


def turned(answer: object, at: int | None, factor: float) -> object:
    """The answer with its number `at`, or all of them, multiplied; truth and words are inverted."""
    if callable(answer):
        return lambda *arguments: turned_result(answer(*arguments), at, factor)
    if isinstance(answer, np.ndarray):
        if answer.dtype == bool:
            flat = answer.copy().reshape(-1)
            flat[slice(None) if at is None else at] ^= True
        else:
            flat = answer.astype(np.result_type(answer, float)).reshape(-1)
            flat[slice(None) if at is None else at] *= factor
        return flat.reshape(answer.shape)
    if isinstance(answer, tuple | list):
        parts, before = [], 0
        for part in answer:
            count = leaves(part)
            here = at is None or before <= at < before + count
            parts.append(turned(part, at if at is None else at - before, factor) if here else part)
            before += count
        return type(answer)(*parts) if hasattr(answer, "_fields") else type(answer)(parts)
    if is_dataclass(answer):
        names = [field.name for field in fields(answer)]
        parts = turned([getattr(answer, name) for name in names], at, factor)
        return replace(answer, **dict(zip(names, parts, strict=True)))
    if isinstance(answer, bool | np.bool_):
        return not answer
    if isinstance(answer, str):
        return answer + "?"
    if isinstance(answer, int | np.integer) and abs(factor - 1) < 0.1:
        return answer + 1
    return answer * factor if isinstance(answer, Number) else answer


def turned_result(value: object, at: int | None, factor: float) -> object:
    return turned(value, at if at is None else at % max(leaves(value), 1), factor)


def faults(exercise: Exercise) -> Iterator[tuple[str, list]]:
    """Ways in which the reference could be slightly wrong, with what it would then give."""
    answers = trials(exercise)
    yield "all 1 % too large", with_fault(exercise, answers, None, 1.01)
    largest = max(leaves(answer) for answer, _ in answers)
    which = np.random.default_rng(1).permutation(largest)[:LEAVES]
    for at in sorted(map(int, which)):
        for name, factor in (("1 % too large", 1.01), ("with its sign turned", -1.0)):
            wrong = with_fault(exercise, answers, at, factor)
            if any(differ(one, other) for (one, _), (other, _) in zip(wrong, answers, strict=True)):
                yield f"number {at} {name}", wrong


def with_fault(
    exercise: Exercise, answers: list[tuple[object, tuple]], at: int | None, factor: float
) -> list[tuple[object, tuple]]:
    """What the reference gives with a fault, a larger one where the check takes it for right too.

    A function that was answered may remember its calls: for each fault there is a fresh one.
    """
    if any(callable(answer) for answer, _ in answers):
        answers = trials(exercise)
    for times in (1.0, 2.0, 0.5, 100.0, 0.01):
        wrong = [
            (turned(answer, at, factor * times), given)
            if at is None or at < leaves(answer)
            else (answer, given)
            for answer, given in answers
        ]
        if not taken_for_right(exercise, wrong, answers):
            break
    return wrong


def taken_for_right(exercise: Exercise, wrong: list, answers: list) -> bool:
    """Whether the exercise has many right answers and its check takes these for right too."""
    if exercise.compare is None or any(callable(answer) for answer, _ in answers):
        return False
    for (answer, given), (right, _) in zip(wrong, answers, strict=True):
        try:
            verdict = exercise.compare(answer, right, *copy.deepcopy(given))
        except Exception:
            return False
        if not (verdict is None or verdict is True or isinstance(right, Exception)):
            return False
    return True


def differ(one: object, other: object) -> bool:
    """Whether two answers differ by more than rounding does next to an array's largest number."""
    if isinstance(one, np.ndarray) and one.dtype.kind == "f":
        rounding = 1e-14 * np.abs(other[np.isfinite(other)]).max(initial=0.0)
        return not np.allclose(one, other, rtol=0.0, atol=rounding, equal_nan=True)
    if isinstance(one, np.ndarray):
        return not np.array_equal(one, other)
    if isinstance(one, tuple | list):
        return any(map(differ, one, other))
    return one is not other and one != other and not (one != one and other != other)


@pytest.mark.parametrize("exercise", EXERCISES, ids=lambda exercise: exercise.number)
def test_the_oracle_agrees_with_the_reference_on_fresh_inputs(exercise):
    assert (oracle_of(exercise).__doc__ or "").strip(), "the docstring says what proves it"
    judge(exercise, trials(exercise))


@pytest.mark.parametrize("exercise", EXERCISES, ids=lambda exercise: exercise.number)
def test_the_oracle_fails_a_reference_with_a_small_fault(exercise):
    oracle_of(exercise)
    passed = []
    for name, wrong in faults(exercise):
        try:
            with np.errstate(all="ignore"):
                judge(exercise, wrong)
        except AssertionError:
            continue
        passed.append(name)
    assert not passed, f"exercise {exercise.number} would be called right with {passed}"


@pytest.mark.parametrize("exercise", EXERCISES, ids=lambda exercise: exercise.number)
def test_the_oracle_fails_every_known_mistake(exercise):
    for diagnosis, wrong in exercise.mistakes.items():
        try:
            with np.errstate(all="ignore"):
                judge(exercise, trials(exercise, wrong))
        except Exception:
            continue
        pytest.fail(f"exercise {exercise.number} would be called right with: {diagnosis}")
