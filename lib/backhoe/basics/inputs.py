"""The one door for inputs: what public functions accept, and what they say when they do not.

Every check takes the value first and its name second, returns the value in one normal form and
raises a ValueError (TypeError for `instance` and `function`) that says what was expected, what came
and, where it helps, what to do. NumPy alone would read text and truth values as numbers, drop an
imaginary part and broadcast what does not fit.

    q = numbers(q, "q", (..., 4), meaning="joints (swing, boom, stick, bucket)")
    dt = positive(dt, "dt", "s")
    rule = choice(rule, "rule", RULES)
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from math import inf, isfinite, nan
from numbers import Integral, Real
from reprlib import Repr

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "alike",
    "choice",
    "covariance",
    "flag",
    "function",
    "generator",
    "image_size",
    "indices",
    "instance",
    "instances",
    "not_negative",
    "number",
    "numbers",
    "picture",
    "pose",
    "positive",
    "real_numbers",
    "steps",
    "times",
    "whole",
]

MOST_PIXELS = 1 << 15
"""Along a side of a picture."""

_FLOAT = np.dtype(float)
_SYMMETRY = 1e-9
_NO_NUMBERS = (str, bytes, bool, np.bool_)
_SHORT = Repr()
_SHORT.maxother = _SHORT.maxstring = _SHORT.maxlong = 60


def real_numbers(values: ArrayLike, name: str, meaning: str = "numbers") -> NDArray:
    """`values` as an array of floats, finite or not, not copied when it is one already.

    Args:
        values: real numbers in any nesting of sequences, any shape, any unit.
        name: what the error calls them.
        meaning: what the error says that they must be.

    Raises:
        ValueError: text, truth values, complex numbers, dates, masked values, other objects, or
            rows of different lengths.
    """
    if type(values) is np.ndarray and (values.dtype is _FLOAT or values.dtype == _FLOAT):
        return values
    try:
        if not _masked(values) and not _no_number(values):
            array = np.asarray(values)
            if array.dtype.kind in "fiu":
                return array.astype(float, copy=False)
            if array.dtype.kind == "O" and not any(map(_no_number, array.flat)):
                return array.astype(float)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{name} must be {meaning}, got {short(values)}") from error
    raise ValueError(f"{name} must be {meaning}, got {short(values)}")


def numbers(
    values: ArrayLike,
    name: str,
    shape: tuple | None = None,
    *,
    meaning: str = "",
    finite: bool = True,
    within: float = inf,
) -> NDArray:
    """`values` as an array of floats, finite and of a given shape.

    Args:
        values: real numbers in any nesting of sequences, of any unit.
        name: what the error calls them.
        shape: wanted: whole numbers, a letter such as "n" for one free length of 1 or more, and
            `...` in front for any leading axes; None for any shape.
        meaning: what the numbers are, for the error, such as "joints (swing, boom, stick, bucket)".
        finite: whether NaN and infinities are refused.
        within: largest magnitude that is accepted, of the values' unit.

    Returns:
        The array; `values` itself when it is an array of floats.

    Raises:
        ValueError: not real numbers, another shape, or a value that is not finite or too large.
    """
    array = real_numbers(values, name)
    if shape is not None and array.shape != shape and not _fits(array.shape, shape):
        raise ValueError(f"{name} must {_wanted(shape, meaning)}, got shape {array.shape}")
    if finite and not np.isfinite(array).all():
        where = tuple(map(int, np.argwhere(~np.isfinite(array))[0]))
        at = f" at index {where if len(where) > 1 else where[0]}" if where else ""
        raise ValueError(f"{name} must be finite, got {array[where]}{at}")
    if within < inf and array.size and np.abs(array).max() > within:
        raise ValueError(f"{name} must be within {within:g}, got {np.abs(array).max():g}")
    return array


def truths(values: ArrayLike, name: str, shape: tuple) -> NDArray:
    """`values` as an array of truth values (no unit) of a shape, said as for `numbers`.

    Raises:
        ValueError: numbers, text or other objects, or another shape.
    """
    try:
        array = np.asarray(values)
    except ValueError:  # rows of different lengths
        array = np.array(None)
    if array.dtype != bool or not _fits(array.shape, shape):
        given = f"{array.dtype}, shape {array.shape}" if array.dtype != object else short(values)
        raise ValueError(f"{name} must {_wanted(shape, 'truth values')}, got {given}")
    return array


def picture(value: NDArray, name: str) -> NDArray:
    """A grey picture, shape (rows, columns) of uint8 [grey levels], black 0, white 255.

    Raises:
        ValueError: another shape or type; the error says how to make one.
    """
    if not isinstance(value, np.ndarray) or value.dtype != np.uint8 or value.ndim != 2:
        given = f"shape {value.shape}, {value.dtype}" if hasattr(value, "dtype") else short(value)
        raise ValueError(
            f"{name} must be a grey picture, uint8 of shape (rows, columns), got {given}: "
            f"average the colours, scale to 0..255, use astype(np.uint8)"
        )
    if not value.size:
        raise ValueError(f"{name} must have a pixel, got shape {value.shape}")
    return np.ascontiguousarray(value)


def number(
    value: float,
    name: str,
    unit: str = "",
    *,
    above: float = -inf,
    least: float = -inf,
    below: float = inf,
    most: float = inf,
    finite: bool = True,
) -> float:
    """One real number within bounds, as a float.

    Args:
        value: the number, of any unit.
        name, unit: what the error calls it and its unit.
        above, least, below, most: bounds, outside (above, below) or at (least, most) which it is
            refused, in the unit.
        finite: whether infinities are refused; NaN always is.

    Raises:
        ValueError: no real number, NaN, or one out of bounds.
    """
    given = _one_number(value)
    too_low = given < least or (given <= above and above > -inf)
    too_high = given > most or (given >= below and below < inf)
    if given != given or too_low or too_high or (finite and not isfinite(given)):
        limits = {"above": above, "at least": least, "below": below, "at most": most}
        bounds = [f"{word} {limit:g}" for word, limit in limits.items() if isfinite(limit)]
        kind = "number" if bounds else "finite number"
        wanted = " ".join([f"one {kind}", *_and(bounds), *([f"[{unit}]"] if unit else [])])
        raise ValueError(f"{name} must be {wanted}, got {short(value)}")
    return given


def positive(value: float, name: str, unit: str = "") -> float:
    """One finite number above 0 of any unit, as a float; ValueError otherwise."""
    return number(value, name, unit, above=0.0)


def not_negative(value: float, name: str, unit: str = "") -> float:
    """One finite number of 0 or more of any unit, as a float; ValueError otherwise."""
    return number(value, name, unit, least=0.0)


def whole(value: int, name: str, *, least: int | None = None, most: int | None = None) -> int:
    """One whole number within bounds, as an int.

    Raises:
        ValueError: no whole number (a float without fraction is none), or one out of bounds.
    """
    given = value.item() if isinstance(value, np.ndarray) and value.ndim == 0 else value
    fits = isinstance(given, Integral) and not isinstance(given, bool)
    if not fits or (least is not None and given < least) or (most is not None and given > most):
        bounds = [] if least is None else [f"at least {least}"]
        bounds += [] if most is None else [f"at most {most}"]
        wanted = " ".join(["one whole number", *_and(bounds)])
        raise ValueError(f"{name} must be {wanted}, got {short(value)}")
    return int(given)


def choice(value: object, name: str, choices: Collection) -> object:
    """`value` if it is among the choices; ValueError that lists them otherwise."""
    try:
        known = not isinstance(value, np.ndarray) and value in choices
    except TypeError:
        known = False
    if not known:
        listed = ", ".join(c if isinstance(c, str) else repr(c) for c in choices)
        raise ValueError(f"{name} must be one of {listed}, got {short(value)}")
    return value


def times(t: ArrayLike, name: str = "t", *, least: int = 2) -> NDArray:
    """Rising times in a row, shape (n,) [s], n at least `least`; ValueError otherwise."""
    t = numbers(t, name, ("n",), meaning="times in a row [s]")
    if len(t) < least:
        raise ValueError(f"{name} must be a row of {least} or more times, got {len(t)}")
    falls = np.flatnonzero(np.diff(t) <= 0)
    if len(falls):
        k = int(falls[0])
        raise ValueError(f"{name} must rise: {t[k]} s at index {k} is followed by {t[k + 1]} s")
    return t


def steps(dt: ArrayLike, count: int, name: str = "dt") -> NDArray:
    """A time step above 0, shape (), or one for each of `count` intervals, shape (count,) [s].

    Raises:
        ValueError: another shape, or a step that is not a finite number above 0.
    """
    dt = numbers(dt, name)
    if dt.shape not in ((), (count,)):
        raise ValueError(
            f"{name} must be one time or one for each of {count} intervals, got shape {dt.shape}"
        )
    if (dt <= 0).any():
        raise ValueError(f"{name} must be above 0 s, got {dt.min()}: do the times run backwards?")
    return dt


def flag(value: bool, name: str) -> bool:
    """True or False as a bool; ValueError for anything else."""
    if not isinstance(value, (bool, np.bool_)):
        raise ValueError(f"{name} must be True or False, got {short(value)}")
    return bool(value)


def image_size(value: tuple[int, int], name: str = "size") -> tuple[int, int]:
    """Width and height of a picture, two whole numbers of 1 or more [pixels]; ValueError if not."""
    sides = numbers(value, name, (2,), meaning="width, height [pixels]")
    if (sides < 1).any() or (sides != np.floor(sides)).any() or (sides > MOST_PIXELS).any():
        raise ValueError(
            f"{name} must be width and height, whole numbers from 1 to {MOST_PIXELS} [pixels], "
            f"got {short(value)}"
        )
    return int(sides[0]), int(sides[1])


def pose(value: ArrayLike, name: str) -> NDArray:
    """A pose, shape (4, 4) or (..., 4, 4): a rotation [1], a translation [m], and 0, 0, 0, 1.

    Raises:
        ValueError: another shape, not finite, or no rigid motion.
    """
    T = numbers(value, name, (..., 4, 4), meaning="a pose")
    R = T[..., :3, :3]
    small = np.abs(R).max(initial=0.0) < 2
    rigid = small and np.abs(R @ np.swapaxes(R, -1, -2) - np.eye(3)).max(initial=0.0) < 1e-6
    if not rigid or (np.linalg.det(R) < 0).any() or (T[..., 3, :] != [0, 0, 0, 1]).any():
        raise ValueError(
            f"{name} must be rigid, a rotation R with R R^T = 1 and det R = 1, and a translation, "
            f"last row 0, 0, 0, 1, got {short(T)}"
        )
    return T


def alike(**arrays: NDArray) -> None:
    """ValueError, with their names and shapes, unless all arrays have the same shape (any unit)."""
    shapes = [array.shape for array in arrays.values()]
    if len(set(shapes)) > 1:
        raise ValueError(
            f"{' and '.join(arrays)} must be alike, got shapes {', '.join(map(str, shapes))}"
        )


def covariance(
    value: ArrayLike, name: str, n: int, *, definite: bool = False, runs: int | None = None
) -> NDArray:
    """A covariance, shape (n, n), or with `runs` also (runs, n, n) [products of its own units].

    Args:
        value: symmetric to 1e-9 of its largest entry; a number will do for n = 1.
        name: what the error calls it.
        n: number of components.
        definite: whether a zero eigenvalue is refused too.
        runs: how many runs may have one each.

    Returns:
        A copy, made symmetric.

    Raises:
        ValueError: another shape, not finite, not symmetric, or with a negative eigenvalue.
    """
    value = np.array(numbers(value, name, finite=False))
    if value.ndim == 0 and n == 1:
        value = value.reshape(1, 1)
    if value.shape != (n, n) and (runs is None or value.shape != (runs, n, n)):
        more = "" if runs is None else f" or ({runs}, {n}, {n})"
        raise ValueError(
            f"{name} must be a covariance of shape ({n}, {n}){more}, got shape {value.shape}"
        )
    value = np.array(numbers(value, name))
    scale = np.abs(value).max()
    transposed = np.swapaxes(value, -1, -2)
    if np.abs(value - transposed).max() > _SYMMETRY * scale:
        raise ValueError(
            f"{name} must be symmetric, {name} - {name}.T reaches "
            f"{np.abs(value - transposed).max():.2g}"
        )
    value = (value + transposed) / 2
    lowest = np.linalg.eigvalsh(value).min()
    if lowest < -_SYMMETRY * scale or (definite and lowest <= 0):
        kind = "positive definite" if definite else "positive semidefinite"
        raise ValueError(f"{name} must be {kind}, its lowest eigenvalue is {lowest:.3g}")
    return value


def indices(values: Sequence[int], name: str, n: int) -> tuple[int, ...]:
    """`values` as a tuple of indices of a vector of n components; ValueError otherwise."""
    try:
        found = tuple(whole(i, name) for i in values)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} must be indices such as (2,), got {short(values)}") from error
    if any(not 0 <= i < n for i in found):
        raise ValueError(f"{name} must be indices from 0 to {n - 1}, got {short(values)}")
    return found


def generator(rng: object, name: str = "rng") -> np.random.Generator:
    """`rng` if it is a Generator, else one made from a whole number of 0 or more, the seed."""
    if isinstance(rng, np.random.Generator):
        return rng
    try:
        return np.random.default_rng(whole(rng, name, least=0))
    except ValueError as error:
        raise ValueError(
            f"{name} must be a seed of 0 or more or a numpy Generator, got {short(rng)}"
        ) from error


def instance(value: object, name: str, kind: type | tuple[type, ...], advice: str = "") -> object:
    """`value` if it is of that kind; TypeError, with the advice, otherwise."""
    if not isinstance(value, kind):
        kinds = kind if isinstance(kind, tuple) else (kind,)
        listed = " or ".join(one.__name__ for one in kinds)
        more = f": {advice}" if advice else ""
        raise TypeError(f"{name} must be a {listed}, got {type(value).__name__}{more}")
    return value


def instances(values: Sequence, name: str, kind: type, advice: str = "") -> list:
    """`values`, a list or tuple, as a list if all are of that kind; TypeError, with the advice, if
    not."""
    if not isinstance(values, (list, tuple)):
        raise TypeError(
            f"{name} must be a list or tuple of {kind.__name__}, got {type(values).__name__}"
        )
    return [instance(one, f"{name}[{k}]", kind, advice) for k, one in enumerate(values)]


def function(value: object, name: str, form: str) -> object:
    """`value` if it can be called and is no class; TypeError that shows the form otherwise."""
    if isinstance(value, type) or not callable(value):
        made = f", got a class: make one, {value.__name__}(...)" if isinstance(value, type) else ""
        raise TypeError(f"{name} must be a function or an object to call: {form}{made}")
    return value


def short(value: object) -> str:
    """`value` for an error's text, at most about 60 characters."""
    if isinstance(value, np.ndarray) and value.size > 6:
        return f"an array of shape {value.shape}, {value.dtype}"
    try:
        text = _SHORT.repr(value)
    except Exception:
        text = f"a {type(value).__name__}"
    return text if len(text) <= 120 else text[:117] + "..."


def _one_number(value: object) -> float:
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, Real):
        return nan
    try:
        return float(value)
    except OverflowError:
        return inf if value > 0 else -inf


def _and(bounds: list[str]) -> list[str]:
    return [" and ".join(bounds)] if bounds else []


def _masked(values: object) -> bool:
    return bool(np.any(getattr(values, "mask", False)))


def _no_number(value: object) -> bool:
    """Whether there is text or a truth value in it, which NumPy would read as numbers."""
    if isinstance(value, (list, tuple)):
        return any(map(_no_number, value))
    return value is None or isinstance(value, _NO_NUMBERS)


def _fits(found: tuple[int, ...], wanted: tuple) -> bool:
    if wanted and wanted[0] is ...:
        if len(wanted) == 2 and not isinstance(wanted[1], str):
            return bool(found) and found[-1] == wanted[1]
        wanted = wanted[1:]
        found = found[max(len(found) - len(wanted), 0) :]
    if len(found) != len(wanted):
        return False
    pairs = zip(found, wanted, strict=True)
    return all(one >= 1 if isinstance(size, str) else one == size for one, size in pairs)


def _wanted(shape: tuple, meaning: str) -> str:
    if len(shape) == 2 and shape[0] is ...:
        return f"end in {shape[1]} {meaning or 'values'}"
    sizes = ", ".join("..." if size is ... else str(size) for size in shape)
    what = f"be {meaning}, " if meaning else "have "
    return f"{what}shape ({sizes}{',' if len(shape) == 1 else ''})"
