"""Differences of vectors some of whose components are angles.

An angle is wrapped where two are compared, in a residual; the state itself keeps its turns.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array

__all__ = ["residual", "wrap"]

_TURN = 2 * np.pi


def wrap(angle: ArrayLike) -> NDArray:
    """The same direction within (-pi, pi].

    Args:
        angle: any shape [rad].

    Returns:
        Same shape [rad].

    Raises:
        ValueError: not real numbers.
    """
    angle = real_array(angle, "angle must be numbers in rad")
    return np.pi - np.remainder(np.pi - angle, _TURN)


def residual(a: ArrayLike, b: ArrayLike, angles: Sequence[int] = ()) -> NDArray:
    """a - b with the components `angles` of the last axis wrapped.

    Args:
        a, b: shape (..., n) each; one may have fewer leading axes.
        angles: indices of the components that are angles [rad].

    Returns:
        Shape (..., n).

    Raises:
        ValueError: not real numbers, or an index outside 0 ... n-1.
    """
    difference = np.subtract(real_array(a, "a must be numbers"), real_array(b, "b must be numbers"))
    if len(angles):
        components = indices("angles", angles, difference.shape[-1])
        wrap_components(difference, components)
    return difference


def wrap_components(difference: NDArray, angles: tuple[int, ...]) -> None:
    """Wrap some components of `difference`, shape (..., n), in place."""
    for i in angles:
        angle = difference[..., i]
        difference[..., i] = angle - _TURN * np.ceil(angle / _TURN - 0.5)


def indices(name: str, angles: Sequence[int], n: int) -> tuple[int, ...]:
    """`angles` as a tuple of indices of a vector of n components."""
    try:
        found = tuple(int(i) for i in angles)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} must be indices such as (2,), got {angles!r}") from error
    if any(not 0 <= i < n for i in found):
        raise ValueError(f"{name} must be indices from 0 to {n - 1}, got {angles!r}")
    return found
