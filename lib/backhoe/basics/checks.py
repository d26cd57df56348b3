"""What odometry asks of numbers handed to it, in one wording."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array

__all__ = ["chosen", "ending_in", "finite", "instants", "positive", "steps"]


def finite(values: ArrayLike, name: str) -> NDArray:
    """`values` as an array of finite floats; ValueError with `name` otherwise."""
    array = real_array(values, f"{name} must be numbers")
    if not np.isfinite(array).all():
        where = tuple(map(int, np.argwhere(~np.isfinite(array))[0]))
        at = f" at index {where}" if where else ""
        raise ValueError(f"{name} must be finite, got {array[where]}{at}")
    return array


def ending_in(values: ArrayLike, count: int, name: str, meaning: str) -> NDArray:
    """Finite numbers whose last axis has `count` of them; ValueError otherwise."""
    array = finite(values, name)
    if array.ndim == 0 or array.shape[-1] != count:
        raise ValueError(f"{name} must end in {count} values ({meaning}), got shape {array.shape}")
    return array


def positive(value: float, name: str, unit: str) -> float:
    """One finite number above 0; ValueError otherwise."""
    number = finite(value, f"{name} [{unit}]")
    if number.ndim or number <= 0:
        raise ValueError(f"{name} must be one number above 0 [{unit}], got {value!r}")
    return float(number)


def steps(dt: ArrayLike, count: int) -> NDArray:
    """dt as a number or `count` numbers above 0 [s]; ValueError otherwise."""
    dt = finite(dt, "dt")
    if dt.shape not in ((), (count,)):
        raise ValueError(
            f"dt must be one time or one for each of {count} intervals, got shape {dt.shape}"
        )
    if (dt <= 0).any():
        raise ValueError(f"dt must be above 0 s, got {dt.min()}: do the times run backwards?")
    return dt


def instants(t: ArrayLike) -> NDArray:
    """Rising times in a row of two or more [s]; ValueError otherwise."""
    t = finite(t, "t")
    if t.ndim != 1 or len(t) < 2:
        raise ValueError(f"t must be a row of 2 or more times, got shape {t.shape}")
    falls = np.flatnonzero(np.diff(t) <= 0)
    if len(falls):
        k = int(falls[0])
        raise ValueError(f"t must rise: {t[k]} s at index {k} is followed by {t[k + 1]} s")
    return t


def chosen(value: str, choices: tuple[str, ...], name: str) -> str:
    """`value` if it is among the choices; ValueError that lists them otherwise."""
    if not isinstance(value, str) or value not in choices:
        raise ValueError(f"{name} must be one of {', '.join(choices)}, got {value!r}")
    return value
