"""Calling a student's parts: with copies, answers checked, errors that name the part and its call.

What stands for the library's own estimator in place of a part is LIBRARY. MAKERS may be classes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import choice, function, numbers
from backhoe.mission.parts import (
    AUTONOMY_PARTS,
    DRIVE_PARTS,
    GRADE_PARTS,
    LIFT_PARTS,
    PARTS,
    SURVEY_PARTS,
    Part,
)

LIBRARY = "library"
ESTIMATORS = ("odometry", "localisation")
MAKERS = ("map", "terrain")
_TABLES = AUTONOMY_PARTS | PARTS | LIFT_PARTS | DRIVE_PARTS | SURVEY_PARTS | GRADE_PARTS
_CALLS = {name: part.call for name, part in _TABLES.items()}


def given_parts(
    table: Mapping[str, Part], unknown: Mapping[str, object], **offered: object
) -> dict[str, Callable | str]:
    """The parts that are not None, by name; an estimator may be LIBRARY.

    Args:
        table: `PARTS`, `DRIVE_PARTS` or `SURVEY_PARTS`.
        unknown: what was given under other names.
        offered: a part or None by name.

    Raises:
        TypeError: an unknown part, a class where one of its objects is wanted, or something that
            cannot be called.
        ValueError: text that is not LIBRARY.
    """
    if unknown:
        raise TypeError(f"unknown part {next(iter(unknown))!r}: the parts are {', '.join(table)}")
    given = {name: part for name, part in offered.items() if part is not None}
    for name, part in given.items():
        if isinstance(part, str) and name in ESTIMATORS:
            choice(part, f"{name}, if it is no function,", (LIBRARY,))
        elif name not in MAKERS or not isinstance(part, type):
            function(part, name, _CALLS[name])
    return given


def reset(part: object) -> None:
    """Let a part that lasts start afresh, if it has a `reset()`."""
    if callable(getattr(part, "reset", None)):
        part.reset()


def call_part(
    name: str, part: Callable, *arguments: object, shape: tuple[int, ...] | None = None
) -> object:
    """What a part returns for copies of the arguments; its errors name it and give its call.

    Args:
        name: of the part in its table.
        part: a student's.
        arguments: arrays of any shape and of any unit are copied.
        shape: that the answer must have, as an array of finite numbers of any unit, which is a
            copy; None for an answer of any kind, returned as it is.

    Raises:
        TypeError, ValueError: the part did, or its answer is something else than `shape` says.
    """
    copies = [value.copy() if isinstance(value, np.ndarray) else value for value in arguments]
    try:
        answer = part(*copies)
        return answer if shape is None else _array(answer, shape)
    except (TypeError, ValueError) as error:
        kind = TypeError if isinstance(error, TypeError) else ValueError
        raise kind(f"your {name} failed: {error}. It is {_CALLS[name]}") from error
    except Exception as error:
        error.add_note(f"This happened in your {name}. It is {_CALLS[name]}")
        raise


def _array(answer: object, shape: tuple[int, ...]) -> NDArray:
    return numbers(answer, "its answer", shape).copy()
