"""Calling a student's part: with copies, answers checked, errors that name the part."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import real_array
from backhoe.mission.parts import DRIVE_PARTS, PARTS

_CALLS = {name: part.call for name, part in (PARTS | DRIVE_PARTS).items()}


def checked_part(name: str, part: object) -> None:
    """Refuse what is no part.

    Raises:
        TypeError: a class where one of its objects is wanted, or something that cannot be called.
    """
    if isinstance(part, type):
        raise TypeError(f"{name} is the class {part.__name__}: make one, {part.__name__}(...)")
    if not callable(part):
        raise TypeError(f"{name} must be a function: {_CALLS[name]}, got {part!r}")


def asked(name: str, part: Callable, *arguments: object) -> object:
    """What a student's part returns for copies of the arguments; its errors name the part."""
    copies = [value.copy() if isinstance(value, np.ndarray) else value for value in arguments]
    try:
        return part(*copies)
    except (TypeError, ValueError) as error:
        kind = TypeError if isinstance(error, TypeError) else ValueError
        raise kind(f"your {name} failed: {error}. It is {_CALLS[name]}") from error
    except Exception as error:
        error.add_note(f"This happened in your {name}. It is {_CALLS[name]}")
        raise


def numbers(name: str, what: str, value: object, shape: tuple[int, ...]) -> NDArray:
    """What a student's part gave, if it is finite numbers of that shape.

    Raises:
        ValueError: it is not; the message says `what` it is and gives the part's call.
    """
    call = _CALLS[name]
    value = real_array(value, f"{what} must be numbers, it is {call}")
    if value.shape != shape:
        raise ValueError(f"{what} must return shape {shape}, got {value.shape}. It is {call}")
    if not np.isfinite(value).all():
        bad = value[~np.isfinite(value)][0]
        raise ValueError(f"{what} returned a value that is not finite: {bad}")
    return value
