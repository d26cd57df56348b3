"""What an answer gave, as something safe to compare: numbers, text, an error or a description.

Whatever a student returns passes through `plain` once; after that only plain copies are touched.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise

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


def plain(value: object, reference: object) -> object:
    """A copy of `value` that is safe to compare with `reference`."""
    if is_blank(value):
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
        return Odd(describe(value))
    if not _is_numeric(reference):
        return Other(value)
    return _numbers(value, np.asarray(reference))


def outcome_of(value: object, reference: object) -> object:
    """What the reference or a known mistake gave or raised, to compare answers with."""
    if isinstance(value, Exception):
        return Raised(type(value).__name__, "")
    return plain(value, reference)


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
    elif _is_numeric(value) and np.ndim(value) == 0:
        text = str(value) if isinstance(value, bool | np.bool_ | int) else f"{value:.4g}"
    elif _is_numeric(value):
        digits = {"float_kind": lambda number: f"{number:.4g}"}
        with np.printoptions(formatter=digits, threshold=20, edgeitems=2):
            text = np.array2string(np.asarray(value), separator=", ")
    elif isinstance(value, tuple):
        text = f"({', '.join(show(one) for one in value)})"
    else:
        text = describe(value)
    return short(text, 100)


def short(text: str, length: int) -> str:
    """`text` on one line of at most `length` characters."""
    text = "".join(letter if letter.isprintable() else " " for letter in text[: 4 * length])
    text = " ".join(text.split())
    return text if len(text) <= length else text[: length - 4] + " ..."


def is_blank(value: object) -> bool:
    """Whether nothing was written yet: None, an ellipsis or NotImplemented."""
    return value is None or value is Ellipsis or value is NotImplemented


def describe(value: object) -> str:
    """What a value is, without its numbers, such as "an array of shape (3,)"."""
    kind = type(value)
    if _is_numeric(value) and kind is not list:
        shape = np.shape(value)
        return f"an array of shape {shape}" if shape else f"the number {np.asarray(value):.4g}"
    known = {str: "text", list: "a list that makes no array", dict: "a dictionary", bytes: "bytes"}
    if kind is tuple:
        return f"{len(value)} values"
    return known.get(kind, f"an object of type {short(kind.__name__, 30)}")


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
    if reference.dtype.kind == "b":
        truth = array.astype(bool)
        return Numbers((truth,)) if np.array_equal(truth, array) else _odd(value, "True or False")
    return Numbers((np.array(array, dtype=complex if array.dtype.kind == "c" else float),))


def _odd(value: object, wanted: str) -> Odd:
    return Odd(f"{describe(value)} where {wanted} {'are' if wanted[-1] == 's' else 'is'} expected")
