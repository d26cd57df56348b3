"""Differences of vectors some of whose components are angles.

An angle is wrapped where two are compared, in a residual; the state itself keeps its turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import indices, real_numbers

__all__ = ["residual", "wrap"]

_TURN = 2 * np.pi


def wrap(angle: ArrayLike) -> NDArray | float:
    """The same direction within (-pi, pi]; an angle that lies there is returned as it is.

    Args:
        angle: any shape (...) [rad].

    Returns:
        Same shape [rad]; a float for a finite float.

    Raises:
        ValueError: not real numbers.
    """
    if isinstance(angle, float) and abs(angle) < 1e300:
        return angle - _TURN * ceil(angle / _TURN - 0.5)
    angle = real_numbers(angle, "angle", "numbers in rad")
    return angle - _TURN * np.ceil(angle / _TURN - 0.5)


def residual(a: ArrayLike, b: ArrayLike, angles: Sequence[int] = ()) -> NDArray:
    """a - b with the components `angles` of the last axis wrapped.

    Args:
        a, b: shape (..., n) each, in their own units; one may have fewer leading axes.
        angles: indices of the components that are angles [rad].

    Returns:
        Shape (..., n).

    Raises:
        ValueError: not real numbers, or an index outside 0 ... n-1.
    """
    difference = np.subtract(real_numbers(a, "a"), real_numbers(b, "b"))
    if len(angles):
        wrap_components(difference, indices(angles, "angles", difference.shape[-1]))
    return difference


def wrap_components(difference: NDArray, angles: tuple[int, ...]) -> None:
    """Wrap some components of `difference`, shape (..., n) in its own units, in place."""
    for i in angles:
        difference[..., i] = wrap(difference[..., i])
