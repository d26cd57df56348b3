"""More velocities than equations: the least of them, and those that change nothing.

Source: Sasig and Chicaiza 2017, design of the controller.
"""

from __future__ import annotations

from functools import cache
from math import inf
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive

DEPENDENT = 1e-10
"""A singular value below this share of the largest counts as 0 [1]."""

_FLOAT = np.dtype(float)


@cache
def engine() -> ModuleType:
    """The compiled loops; Numba takes half a second to load, so at the first use."""
    from backhoe.whole_body import engine

    return engine


def minimum_norm(
    J: ArrayLike,
    b: ArrayLike,
    preferred: ArrayLike | None = None,
    *,
    weights: ArrayLike | None = None,
    damping: ArrayLike = 0.0,
) -> NDArray:
    """Of all v with J v = b the least, or the one nearest to a preferred one.

    v = v0 + J^T (J J^T)^-1 (b - J v0), which is J^+ b + (I - J^+ J) v0: the particular solution and
    the homogeneous one in one step. Source: Sasig and Chicaiza 2017, v_c.

    Args:
        J: m equations for n > m velocities, shape (..., m, n), in any units.
        b: what J v should be, shape (..., m).
        preferred: v0, shape (..., n); zero if None.
        weights: what each velocity costs, shape (n,), positive: the sum of w (v - v0)^2 is least;
            all alike if None. They also make metres and radians comparable.
        damping: lambda of J J^T + lambda^2 I, one for all or shape (...), in the units of J; above
            0, J v misses b near a singularity, and the velocities stay bounded. See
            `damping_near_singularity`.

    Returns:
        v, shape (..., n), in the units of b over those of J.

    Raises:
        ValueError: shapes that do not fit, values that are not finite, weights that are not
            positive, or rows of J that depend on each other while damping is 0.
    """
    ready = weights is None and _ready(J, b, preferred, damping)
    given = (J, b, preferred, damping) if ready else _checked(J, b, preferred, damping)
    J, b, v0, damping = given
    m, n = J.shape[-2:]
    leading = J.shape[:-2]
    v, count = np.empty((*leading, n)), J.size // (m * n)
    v0 = np.zeros(v.shape) if v0 is None else v0
    if weights is not None:
        scale = scale_of(weights, n)
        J, v0 = J / scale, v0 * scale
    damp = np.empty(count)
    damp[...] = damping if ready else damping.reshape(-1)
    flat = J.reshape(count, m, n), b.reshape(count, m), v0.reshape(count, n), damp
    wrong = engine().solve(*flat, v.reshape(count, n), np.empty((m, m)), np.empty(m))
    if wrong >= 0:
        _checked(*given)
        raise ValueError(_why(flat[0][wrong], np.unravel_index(wrong, leading)))
    return v if weights is None else v / scale


def null_projector(J: ArrayLike) -> NDArray:
    """I - J^+ J, which takes from any v what moves the hand.

    Args:
        J: shape (..., m, n), in its own units; its rows may depend on each other.

    Returns:
        N with J N = 0, N N = N and N = N^T, shape (..., n, n).

    Raises:
        ValueError: J is not a matrix, or a value is not finite.
    """
    J = matrices(J)
    *_, sizes, along = np.linalg.svd(J, full_matrices=False)
    along = along * (sizes > DEPENDENT * sizes[..., :1])[..., None]
    return np.eye(J.shape[-1]) - np.swapaxes(along, -1, -2) @ along


def damping_near_singularity(J: ArrayLike, threshold: float, largest: float) -> NDArray:
    """Damping that is 0 where all singular values of J are above a threshold, and grows below it.

    lambda^2 = (1 - (s / threshold)^2) largest^2 for the smallest singular value s. With it no
    velocity of `minimum_norm` is above |b| max(1 / threshold, 1 / largest).
    Source: Chiaverini, Siciliano and Egeland 1994.

    Args:
        J: shape (..., m, n), in its own units.
        threshold: of the smallest singular value, in the units of J.
        largest: damping where a direction is lost, in the units of J.

    Returns:
        lambda, shape (...), in the units of J.

    Raises:
        ValueError: J is not a matrix, has more rows than columns, or a value is not finite;
            threshold or largest is not positive.
    """
    J = matrices(J)
    threshold, largest = positive(threshold, "threshold"), positive(largest, "largest")
    least = np.linalg.svd(J, compute_uv=False)[..., -1]
    return largest * np.sqrt(np.maximum(1 - (least / threshold) ** 2, 0.0))


def _ready(J: object, b: object, v0: object, damping: object) -> bool:
    """Whether the arrays can go into the compiled loop as they are, which tells NaN by itself."""
    if not (plain(J, b) if v0 is None else plain(J, b, v0)) or J.ndim < 2:
        return False
    if b.shape != J.shape[:-1] or not 1 <= J.shape[-2] <= J.shape[-1]:
        return False
    fits = v0 is None or (v0.shape[:-1] == b.shape[:-1] and v0.shape[-1:] == J.shape[-1:])
    return fits and type(damping) is float and 0.0 <= damping < inf


def _checked(
    J: ArrayLike, b: ArrayLike, v0: ArrayLike | None, damping: ArrayLike
) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    J = matrices(J)
    *leading, m, n = J.shape
    b = numbers(b, "b", (*leading, m), meaning=f"one value for each of the {m} rows of J")
    v0 = np.zeros((*leading, n)) if v0 is None else v0
    v0 = numbers(v0, "preferred", (*leading, n), meaning=f"one value a column of J, {n}")
    damping = numbers(damping, "damping")
    if damping.shape not in ((), tuple(leading)):
        raise ValueError(f"damping must be one number or one a matrix, got shape {damping.shape}")
    if (damping < 0).any():
        raise ValueError(f"damping must be 0 or more, got {damping.min():g}")
    return *(np.require(one, requirements="CAW") for one in (J, b, v0)), damping


def _why(J: NDArray, at: tuple) -> str:
    """Why there is no v for this J, for the error."""
    where = f" at {tuple(map(int, at))}" if at else ""
    largest = np.abs(J).max()
    sizes = np.linalg.svd(J / max(largest, 1e-300), compute_uv=False)
    if 1e-100 < largest < 1e100 and sizes[-1] < 1e-6 * sizes[0]:
        return (
            f"the {len(J)} rows of J must not depend on each other, but they do{where}: the hand "
            "cannot move in every direction there; leave the singularity, or give (more) damping"
        )
    return f"J, b and preferred must be of a size that can be squared, they are not{where}"


def plain(*arrays: object) -> bool:
    """Whether they can go into a compiled loop as they are: floats in a row, to read and write."""
    for array in arrays:
        if type(array) is not np.ndarray or array.dtype is not _FLOAT or not array.flags.carray:
            return False
    return True


def matrices(J: ArrayLike) -> NDArray:
    """J checked: shape (..., m, n), in its own units.

    Raises:
        ValueError: no matrix, more rows than columns, or a value is not finite.
    """
    J = numbers(J, "J", (..., "m", "n"), meaning="a matrix")
    if J.shape[-2] > J.shape[-1]:
        raise ValueError(
            f"J must not have more equations (rows) than velocities (columns), got {J.shape[-2:]}"
        )
    return J


def scale_of(weights: ArrayLike, n: int) -> NDArray:
    """Roots of n weights, shape (n,), by which the columns of J are divided.

    Raises:
        ValueError: another shape, or weights that are not positive.
    """
    weights = numbers(weights, "weights", (n,), meaning="one weight a column of J")
    if (weights <= 0).any():
        raise ValueError(f"weights must be positive, got {weights.min()}")
    return np.sqrt(weights)
