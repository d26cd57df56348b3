"""Constants that are shown by their name: a default argument reads `machine=BACKHOE` in `help()`.

Without, the signature of every function that takes a machine is 1,500 characters of numbers.
"""

from __future__ import annotations

from typing import TypeVar

__all__ = ["named", "shown_by_name"]

_Any = TypeVar("_Any")
_CONSTANTS: dict[int, tuple[object, str]] = {}  # the object itself, so that its id stays its own


def shown_by_name(cls: type[_Any]) -> type[_Any]:
    """Class decorator: an object that was `named` has its name as its `repr`; others as before."""
    in_full = cls.__repr__

    def __repr__(self: object) -> str:
        return _CONSTANTS[id(self)][1] if id(self) in _CONSTANTS else in_full(self)

    cls.__repr__ = __repr__
    return cls


def named(name: str, constant: _Any) -> _Any:
    """The constant itself, which is shown by this name from now on.

    Args:
        name: as one imports it, such as "BACKHOE".
        constant: of a class that is `shown_by_name`; one object has one name.
    """
    _CONSTANTS[id(constant)] = (constant, name)
    return constant
