"""Ask a student's answer and turn whatever comes back into something safe to compare.

`ask` is the only function that touches what a student wrote; it is meant to run inside
`guard.run`. What it hands on are plain copies: arrays of numbers, text, or a description.
"""

from __future__ import annotations

import inspect
import linecache
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from backhoe.exercise import Exercise, source_of

__all__ = [
    "Asked",
    "Blank",
    "Numbers",
    "Odd",
    "Other",
    "Raised",
    "agree",
    "ask",
    "plain",
    "short",
    "show",
]

_MANY = 100_000  # more numbers than any exercise expects


@dataclass(frozen=True)
class Blank:
    """None or an ellipsis: nothing was written yet."""


@dataclass(frozen=True)
class Numbers:
    """Copies of the arrays that were returned: one, or as many as the reference returns."""

    parts: tuple[NDArray, ...]

    @property
    def value(self) -> object:
        values = tuple(part[()] for part in self.parts)
        return values[0] if len(values) == 1 else values


@dataclass(frozen=True)
class Raised:
    """An error: its type's name, and one line with its text and where it happened."""

    kind: str
    text: str


@dataclass(frozen=True)
class Odd:
    """Something that cannot be compared, in words that follow "it returns"."""

    text: str


@dataclass(frozen=True)
class Other:
    """An object that only the exercise's own `compare` can judge."""

    value: object


@dataclass
class Asked:
    """What one answer gave: an outcome and a verdict a case, and what was wrong with asking.

    A verdict is True, False or a diagnosis. `changed` is the name of an argument that the answer
    changed in place.
    """

    outcomes: list = field(default_factory=list)
    verdicts: list = field(default_factory=list)
    changed: str = ""
    misuse: str = ""


def ask(
    answer: object, exercise: Exercise, cases: Sequence[tuple], references: Sequence[object]
) -> Asked:
    """Call `answer` with every case (or read it, if a value is asked for) and judge each outcome.

    Args:
        cases: argument tuples; the answer gets copies.
        references: what the reference gave, an exception where it raised.
    """
    asked = Asked(misuse=_misuse(answer, exercise, cases))
    if _is_blank(answer):
        asked.outcomes.append(Blank())
    if asked.outcomes or asked.misuse:
        return asked
    for case, reference in zip(cases, references, strict=True):
        arguments = tuple(_copy(argument) for argument in case)
        try:
            value = answer(*arguments) if exercise.asks_for_a_function else answer
            outcome = plain(value, reference)
        except (Exception, KeyboardInterrupt, SystemExit, GeneratorExit) as error:
            outcome = _raised(error, answer)
        asked.outcomes.append(outcome)
        asked.verdicts.append(_judge(exercise, outcome, reference, case))
        if not asked.changed:
            asked.changed = _changed(exercise, arguments, case)
        if isinstance(outcome, Raised) and not isinstance(reference, Exception):
            break
    return asked


def plain(value: object, reference: object) -> object:
    """A copy of `value` that is safe to compare with `reference`."""
    if _is_blank(value):
        return Blank()
    if isinstance(reference, str):
        return str.__str__(value).strip() if isinstance(value, str) else _odd(value, "text")
    if isinstance(reference, tuple):
        if not isinstance(value, tuple | list | np.ndarray) or len(value) != len(reference):
            return _odd(value, f"{len(reference)} values")
        parts = [plain(one, other) for one, other in zip(value, reference, strict=True)]
        if all(isinstance(part, Blank) for part in parts):
            return Blank()
        strange = [part for part in parts if not isinstance(part, Numbers)]
        return strange[0] if strange else Numbers(tuple(part.parts[0] for part in parts))
    if isinstance(reference, Exception):
        return Odd(f"{_name(value)}")
    if not _is_numeric(reference):
        return Other(value)
    return _numbers(value, np.asarray(reference))


def agree(one: object, other: object, exercise: Exercise) -> bool:
    """Whether two outcomes are the same within the tolerances of the exercise."""
    if isinstance(one, Numbers) and isinstance(other, Numbers):
        return len(one.parts) == len(other.parts) and all(
            a.shape == b.shape
            and np.allclose(a, b, rtol=exercise.rtol, atol=exercise.atol, equal_nan=True)
            for a, b in zip(one.parts, other.parts, strict=True)
        )
    if isinstance(one, str) and isinstance(other, str):
        return one.casefold() == other.casefold()
    if isinstance(one, Raised) and isinstance(other, Raised):
        return one.kind == other.kind
    return isinstance(one, Odd) and one == other


def show(value: object) -> str:
    """A value in a few characters, on one line."""
    if isinstance(value, str):
        text = repr(value)
    elif _is_numeric(value):
        with np.printoptions(precision=4, suppress=True, threshold=20, edgeitems=2):
            text = np.array2string(np.asarray(value), separator=", ")
    elif isinstance(value, tuple):
        text = f"({', '.join(show(one) for one in value)})"
    else:
        text = _name(value)
    return short(text, 100)


def short(text: str, length: int) -> str:
    """`text` on one line of at most `length` characters."""
    text = " ".join(text[: 4 * length].split())
    return text if len(text) <= length else text[: length - 4] + " ..."


def _misuse(answer: object, exercise: Exercise, cases: Sequence[tuple]) -> str:
    if not exercise.asks_for_a_function:
        if inspect.isroutine(answer) or isinstance(answer, type):
            return "the answer is a value, you passed a function: call it, and pass what it returns"
        return ""
    if not callable(answer):
        return (
            "pass the function itself, with no brackets after its name: "
            f'check("{exercise.number}", my_function); you passed {_name(answer)}'
        )
    try:
        signature = inspect.signature(answer)
    except (TypeError, ValueError):
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


def _is_blank(value: object) -> bool:
    return value is None or value is Ellipsis or value is NotImplemented


def _is_numeric(value: object) -> bool:
    return isinstance(value, int | float | complex | np.number | np.bool_ | np.ndarray | list)


def _numbers(value: object, reference: NDArray) -> Numbers | Odd:
    wanted = "a number" if reference.ndim == 0 else f"an array of shape {reference.shape}"
    try:
        array = np.asarray(value)
        if array.dtype.kind == "O":
            array = array.astype(float)
    except (TypeError, ValueError, OverflowError):
        return _odd(value, wanted)
    if array.dtype.kind not in "biufc":
        return _odd(value, wanted)
    if array.size > _MANY:
        return Odd(f"an array of shape {array.shape} where {wanted} is expected")
    if array.dtype.kind == "c" and reference.dtype.kind != "c":
        if np.any(array.imag):
            return Odd("complex numbers: the root of a negative number?")
        array = array.real
    return Numbers((np.array(array, dtype=complex if array.dtype.kind == "c" else float),))


def _odd(value: object, wanted: str) -> Odd:
    return Odd(f"{_name(value)} where {wanted} {'are' if wanted[-1] == 's' else 'is'} expected")


def _name(value: object) -> str:
    kind = type(value)
    if _is_numeric(value) and kind is not list:
        shape = np.shape(value)
        return f"an array of shape {shape}" if shape else f"the number {np.asarray(value):.4g}"
    known = {str: "text", list: "a list", dict: "a dictionary", bytes: "bytes"}
    if kind is tuple:
        return f"{len(value)} values"
    return known.get(kind, f"an object of type {short(kind.__name__, 30)}")


def _raised(error: BaseException, answer: object) -> Raised:
    kind = type(error).__name__
    if isinstance(error, RecursionError):
        return Raised(kind, f"{kind}: it calls itself without end")
    try:
        text = short(str(error), 100) if error.args[:1] != (None,) else ""
    except Exception:
        text = ""
    where = _line_of(error, answer)
    return Raised(kind, short(kind, 40) + (f": {text}" if text else "") + where)


def _line_of(error: BaseException, answer: object) -> str:
    code = getattr(source_of(answer), "__code__", None)
    file, line, trace = getattr(code, "co_filename", None), None, error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == file:
            line = trace.tb_lineno
        trace = trace.tb_next
    source = linecache.getline(file, line).strip() if line else ""
    return f" (in the line: {short(source, 60)})" if source else ""


def _judge(exercise: Exercise, outcome: object, reference: object, case: tuple) -> bool | str:
    if isinstance(reference, Exception):
        return agree(outcome, _raised(reference, None), exercise)
    judged = exercise.compare and isinstance(outcome, Numbers | Other | str)
    if not judged:
        return agree(outcome, plain(reference, reference), exercise)
    value = outcome if isinstance(outcome, str) else outcome.value
    try:
        verdict = exercise.compare(value, reference, *(_copy(argument) for argument in case))
    except Exception as error:
        return f"what it returns cannot be used: {short(str(error), 150)}"
    if isinstance(verdict, str):
        return short(verdict, 300)
    return verdict is None or bool(verdict)


def _copy(value: object) -> object:
    if isinstance(value, np.ndarray):
        return value.copy()
    if isinstance(value, list | tuple) and type(value) in (list, tuple):
        return type(value)(_copy(one) for one in value)
    return {key: _copy(one) for key, one in value.items()} if type(value) is dict else value


def _changed(exercise: Exercise, arguments: tuple, case: tuple) -> str:
    names = exercise.argument_names(len(case))
    for name, argument, original in zip(names, arguments, case, strict=True):
        if not _same(argument, original):
            return name
    return ""


def _same(one: object, other: object) -> bool:
    if isinstance(other, np.ndarray):
        return one.shape == other.shape and np.array_equal(
            one, other, equal_nan=other.dtype.kind in "fc"
        )
    if type(other) in (list, tuple):
        return len(one) == len(other) and all(map(_same, one, other))
    if type(other) is dict:
        return list(one) == list(other) and all(_same(one[key], other[key]) for key in other)
    return one is other or (type(one) is type(other) and bool(one == other))
