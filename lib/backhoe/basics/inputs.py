"""Real numbers that a caller hands over, as arrays of floats.

NumPy alone would drop an imaginary part, read text as numbers and count days as metres.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["real_array"]

_FLOAT = np.dtype(float)
_KINDS = "fiubO"
"""Floats, integers, truth values, and Python's own numbers."""


def real_array(values: ArrayLike, complaint: str) -> NDArray:
    """`values` as an array of floats.

    Args:
        values: numbers in any nesting of sequences, any shape.
        complaint: what the error says before the values, such as "q must be numbers".

    Returns:
        The same numbers and shape, not copied when they are an array of floats already.

    Raises:
        ValueError: something else than real numbers, or rows of different lengths.
    """
    try:
        array = np.asarray(values)
        if array.dtype is _FLOAT:
            return array
        if array.dtype.kind in _KINDS and not (array.dtype.kind == "O" and _has_text(array)):
            return array.astype(float, copy=False)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"{complaint}, got {values!r}") from error
    raise ValueError(f"{complaint}, got {values!r}")


def _has_text(array: NDArray) -> bool:
    return any(isinstance(value, str | bytes) for value in array.flat)
