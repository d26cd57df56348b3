"""What Mastalli 2013 prints about stereo, section 5.2, as functions."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative, numbers, whole

__all__ = ["prefilter", "sad_footnote_2"]


def prefilter(I_c: ArrayLike, I_mean: ArrayLike, I_cap: float) -> NDArray:
    """Section 5.2.3: min[max(I_c - mean, -I_cap), I_cap].

    Args:
        I_c, I_mean: a pixel and the mean of its window, any shape [grey levels].
        I_cap: limit [grey levels].

    Raises:
        ValueError: no numbers, or a limit below zero.
    """
    I_cap = not_negative(I_cap, "I_cap", "grey levels")
    response = numbers(I_c, "I_c") - numbers(I_mean, "I_mean")
    return np.minimum(np.maximum(response, -I_cap), I_cap)


def sad_footnote_2(I_1: ArrayLike, I_2: ArrayLike, W: tuple[slice, slice], x: int, y: int) -> float:
    """Footnote 2 of section 5.2.3: sum over (i, j) in W of |I_1(i, j) - I_2(x + i, y + j)|.

    The first index is the column there, as x is; x and y are not explained.

    Args:
        I_1, I_2: pictures, shape (rows, columns) [grey levels].
        W: rows and columns of the window.
        x, y: columns and rows further [pixels].

    Returns:
        The sum [grey levels].

    Raises:
        ValueError: no pictures, or a place outside of the second one.
    """
    I_1, I_2 = numbers(I_1, "I_1", ("rows", "columns")), numbers(I_2, "I_2", ("rows", "columns"))
    x, y = whole(x, "x"), whole(y, "y")
    rows, columns = np.mgrid[W]
    low, high = min(rows.min() + y, columns.min() + x), np.array(I_2.shape) - 1
    if low < 0 or rows.max() + y > high[0] or columns.max() + x > high[1]:
        raise ValueError(f"x and y must keep the window inside the picture, got {x} and {y}")
    return float(np.abs(I_1[rows, columns] - I_2[rows + y, columns + x]).sum())
