"""Recognise what a wrong array has in common with the right one: a sign, a factor, an order.

Arrays have one case along the first axis. `near(one, other)` says elementwise what is equal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from math import pi

import numpy as np
from numpy.typing import NDArray

_NUMBERS = {f"{number:g}": number for number in (2, 3, 4, 1000, 100, 60, 3.6, 9.81)} | {"pi": pi}
_FACTORS = {
    **_NUMBERS,
    **{f"1/{name}": 1 / number for name, number in _NUMBERS.items()},
    "2 pi": 2 * pi,
    "1/(2 pi)": 1 / (2 * pi),
    "180/pi (degrees where radians are expected?)": 180 / pi,
    "pi/180 (radians where degrees are expected?)": pi / 180,
    "the root of 2": 2**0.5,
    "1/root of 2": 0.5**0.5,
    "1e6": 1e6,
    "1e-6": 1e-6,
}
_OFFSETS = {"pi/2": pi / 2, "pi": pi, "2 pi": 2 * pi, "90": 90.0, "180": 180.0, "360": 360.0}


def overall(one: NDArray, other: NDArray, near: Callable) -> str | None:
    """What is odd about all numbers alike: sign, transposition, factor, offset."""
    if near(-one, other).all():
        return "the sign is wrong everywhere"
    square = one.ndim > 2 and one.shape[-1] == one.shape[-2]
    if square and near(np.swapaxes(one, -1, -2), other).all():
        return "the matrix is transposed"
    if not one.any():
        return "it returns only zeros"
    if near(one, np.abs(other)).all():
        return "it is never negative where it should be: is there an abs too many?"
    if other.dtype.kind == "f" and near(one, np.maximum(other, 0)).all():
        return "it is zero where it should be negative"
    if _whole(one) and any(
        near(one, whole(other)).all() for whole in (np.trunc, np.floor, np.rint)
    ):
        return "the numbers are whole: a division by //, a rounding, or an array of integers?"
    if one.shape[0] > 1 and near(one, one[0]).all() and not near(other, other[0]).all():
        return "it returns the same for every input"
    return _scaled(one, other, near) or _shifted(one, other, near)


def in_pieces(one: NDArray, other: NDArray, near: Callable) -> str | None:
    """What is odd about single components: their order, or which of them are wrong."""
    if one.ndim == 1:
        return None
    for axis, name in _axes(one):
        order = _order(np.moveaxis(one, axis, 1), np.moveaxis(other, axis, 1), near)
        if order:
            return f"the {name} are in the order {', '.join(map(str, order))}"
    wrong = ~near(one, other).all(axis=0)
    if wrong.all():
        return None
    why = overall(one[:, wrong], other[:, wrong], near)
    if not why and 2 * wrong.sum() > wrong.size:
        return None
    told = f"{_which(wrong)} wrong, the others are right"
    return f"{told}; there, {why}" if why else told


def _whole(one: NDArray) -> bool:
    return one.dtype.kind == "f" and bool(np.isfinite(one).all()) and not np.any(one % 1)


def _scaled(one: NDArray, other: NDArray, near: Callable) -> str | None:
    factor = float(np.vdot(other, one).real / np.vdot(other, other).real)
    if not np.isfinite(factor) or factor == 0:
        return None
    name = min(_FACTORS, key=lambda known: abs(np.log(abs(factor) / _FACTORS[known])))
    if near(one, np.copysign(_FACTORS[name], factor) * other).all():
        return f"it is off by the factor {'-' if factor < 0 else ''}{name}"
    if _varies(other, near) and near(one, factor * other).all():
        if abs(factor - 1) < 0.02:
            return f"it is off by {100 * abs(factor - 1):.2g} % everywhere: is a number rounded?"
        return f"it is off by the constant factor {factor:.4g}"
    return None


def _shifted(one: NDArray, other: NDArray, near: Callable) -> str | None:
    turns = (one - other) / (2 * pi)
    could_be_angles = not near(other + pi, other).any()
    if one.size > 1 and could_be_angles and near(turns, np.round(turns)).all():
        if np.ptp(turns) > 0.5:
            return "angles are off by whole turns: wrap them"
    offset = float(np.mean(one - other).real)
    if not near(one - offset, other).all():
        return None
    for name, known in _OFFSETS.items():
        if np.isclose(abs(offset), known):
            return f"it is {name} too {'large' if offset > 0 else 'small'}"
    if not _varies(other, near):
        return None
    size = "large" if offset > 0 else "small"
    return f"it is too {size} by the same {abs(offset):.4g} everywhere"


def _varies(other: NDArray, near: Callable) -> bool:
    return other.size > 1 and not near(other, other.flat[0]).all()


def _axes(one: NDArray) -> Iterator[tuple[int, str]]:
    if one.ndim == 2:
        yield 1, "components"
    elif one.ndim == 3:
        yield 1, "rows"
        yield 2, "columns"


def _order(one: NDArray, other: NDArray, near: Callable) -> list[int] | None:
    """Which components of `other` those of `one` are, if all are there."""
    size, order = one.shape[1], []
    if not 2 <= size <= 12:
        return None
    for i in range(size):
        places = [j for j in range(size) if near(one[:, j], other[:, i]).all() and j not in order]
        if not places:
            return None
        order.append(i if i in places else places[0])
    return [order.index(i) for i in range(size)]


def _which(wrong: NDArray) -> str:
    if wrong.ndim == 2:
        for axis, name in ((1, "row"), (0, "column")):
            lines = np.flatnonzero(wrong.any(axis=axis))
            if len(lines) < wrong.shape[1 - axis] and np.take(wrong, lines, 1 - axis).all():
                return _counted(name, name + "s", map(str, lines))
    entries = ["[" + ", ".join(map(str, place)) + "]" for place in np.argwhere(wrong)]
    return _counted("entry", "entries", entries)


def _counted(one: str, several: str, places: Iterable[str]) -> str:
    places = list(places)
    if len(places) > 6:
        return f"{len(places)} {several} are"
    name, verb = (one, "is") if len(places) == 1 else (several, "are")
    return f"{name} {', '.join(places)} (counted from 0) {verb}"
