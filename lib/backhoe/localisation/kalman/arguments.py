"""What the filters accept, checked at their boundary and named in the error."""

from __future__ import annotations

from math import isfinite

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array

_FLOAT = np.dtype(float)
_SYMMETRY = 1e-9


def plain(value: ArrayLike, shape: tuple[int, ...], name: str) -> NDArray:
    """`value` as a contiguous writable array of floats of exactly `shape`."""
    if type(value) is np.ndarray and value.dtype is _FLOAT and value.shape == shape:
        return value if value.flags.carray else np.array(value, order="C")
    value = real_array(value, f"{name} must be numbers")
    if value.ndim == 0 and shape == (1,):
        value = value.reshape(1)
    if value.shape != shape:
        raise ValueError(f"{name} must have shape {shape}, got shape {value.shape}")
    return np.array(value, order="C")


def finite(value: ArrayLike, shape: tuple[int, ...], name: str) -> NDArray:
    """As `plain`, with every number finite; always a copy."""
    value = np.array(plain(value, shape, name))
    if not np.isfinite(value).all():
        raise ValueError(f"{name} must be finite, got {value.tolist()}")
    return value


def exactly(value: ArrayLike, name: str, meaning: str) -> NDArray:
    """A vector of finite numbers, shape (n,), n at least 1; always a copy."""
    value = np.array(real_array(value, f"{name} must be {meaning}"))
    if value.ndim != 1 or value.size == 0:
        raise ValueError(f"{name} must be {meaning}, shape (n,), got shape {value.shape}")
    return finite(value, value.shape, name)


def covariance(
    value: ArrayLike, n: int, name: str, *, definite: bool = False, runs: int | None = None
) -> NDArray:
    """A covariance, shape (n, n), or with `runs` also (runs, n, n); a number will do for n = 1.

    Raises:
        ValueError: another shape, not finite, not symmetric, or with a negative eigenvalue
            (`definite`: one that is not positive).
    """
    value = np.array(real_array(value, f"{name} must be numbers"))
    if value.ndim == 0 and n == 1:
        value = value.reshape(1, 1)
    if value.shape != (n, n) and (runs is None or value.shape != (runs, n, n)):
        more = "" if runs is None else f" or ({runs}, {n}, {n})"
        raise ValueError(
            f"{name} must be a covariance of shape ({n}, {n}){more}, got shape {value.shape}"
        )
    value = finite(value, value.shape, name)
    scale = np.abs(value).max()
    transposed = np.swapaxes(value, -1, -2)
    if np.abs(value - transposed).max() > _SYMMETRY * scale:
        raise ValueError(
            f"{name} must be symmetric, {name} - {name}.T reaches "
            f"{np.abs(value - transposed).max():.3g}: is it a covariance?"
        )
    value = (value + transposed) / 2
    least = np.linalg.eigvalsh(value).min()
    if definite and not least > 0:
        raise ValueError(f"{name} must be positive definite, its least eigenvalue is {least:.3g}")
    if least < -_SYMMETRY * scale:
        raise ValueError(
            f"{name} must not have negative eigenvalues (variances), the least is {least:.3g}"
        )
    return value


def duration(dt: float) -> float:
    """dt, positive and finite [s]."""
    if type(dt) is not float:
        number = real_array(dt, "dt must be a time in s")
        if number.ndim:
            raise ValueError(f"dt must be one time in s, got shape {number.shape}")
        dt = float(number)
    if not (dt > 0 and isfinite(dt)):
        raise ValueError(f"dt must be positive and finite, in s, got {dt}")
    return dt


def probability(value: float) -> float:
    """A probability between 0 and 1, both left out."""
    number = real_array(value, "probability must be a number")
    if number.ndim or not 0 < number < 1:
        raise ValueError(f"probability must be between 0 and 1, such as 0.95, got {value!r}")
    return float(number)
