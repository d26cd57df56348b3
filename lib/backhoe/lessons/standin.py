"""A student's function in the middle of a lesson, or the library's where it does not work yet."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy

import numpy as np

__all__ = ["working"]


def working(mine: Callable, library: Callable, *given: object) -> Callable:
    """`mine` if it answers `given` as `library` does in form, else `library`, and a line says why.

    Args:
        mine: a student's function, perhaps not done yet.
        library: what stands in for it, a function of the same arguments.
        given: arguments to try both with, of any unit; each is asked with a copy.

    Returns:
        The function to go on with. Right or wrong is not asked here: `check` says that.
    """
    name = getattr(mine, "__name__", "your function")
    wanted = _form(library(*deepcopy(given)))
    try:
        answer = mine(*deepcopy(given))
        found = _form(answer)
    except Exception as error:
        why = f"stops with {type(error).__name__}: {error}"
    else:
        if answer is None:
            why = "is not done yet"
        elif found != wanted:
            why = f"returns {_told(found)}, not {_told(wanted)}"
        elif not _finite(answer):
            why = "returns values that are not finite"
        else:
            return mine
    print(f"({name} {why}; the library's stands in)")
    return library


def _form(answer: object) -> tuple:
    """Shape of a number, an array or numbers in a tuple or list; else that of each part."""
    try:
        return np.shape(answer)
    except ValueError:
        return tuple(map(np.shape, answer))


def _finite(answer: object) -> bool:
    parts = answer if isinstance(answer, tuple | list) else (answer,)
    arrays = [np.asarray(part) for part in parts]
    return all(one.dtype.kind not in "fc" or np.isfinite(one).all() for one in arrays)


def _told(form: tuple) -> str:
    if form and isinstance(form[0], tuple):
        return f"{len(form)} values of the shapes {', '.join(map(str, form))}"
    return f"numbers of shape {form}" if form else "a number"
