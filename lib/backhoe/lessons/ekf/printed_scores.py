"""Algorithm 2 of Mastalli 2013 as printed, but for what keeps it from running. Not for use.

Lesson 07 tests it; `backhoe.localisation.fusion.rmse` has what it should be. (4.24) to (4.27) as
printed are in `backhoe.lessons.ekf.printed`.
"""

from __future__ import annotations

from math import ceil, inf, sqrt

import numpy as np
from numpy.typing import ArrayLike

__all__ = ["rmse_algorithm_2"]


def rmse_algorithm_2(
    t_x: ArrayLike,
    t_y: ArrayLike,
    x: ArrayLike,
    x_e: ArrayLike,
    t_s: float,
    initial: float = inf,
) -> float:
    """Root mean square error of one signal, both read at the sample nearest to i t_s.

    As printed, the errors e_x and e_y are compared before they have a value (here they begin at
    `initial`; with 0 nothing is ever nearer), the inner loops begin one element past the end
    (here at the last one), ceil + 1 terms are summed and divided by ceil, and nothing is wrapped.

    Args:
        t_x, x: of the signal, shape (n,) each [s, its unit].
        t_y, x_e: of the estimate, shape (m,) each.
        t_s: of the grid [s].
        initial: what e_x and e_y hold at first [s].

    Returns:
        The error in the signal's unit.
    """
    t_x, t_y = np.asarray(t_x, float), np.asarray(t_y, float)
    x, x_e = np.asarray(x, float), np.asarray(x_e, float)
    terms = ceil(t_x[-1] / t_s)
    x_s, x_e_s = np.zeros(terms + 1), np.zeros(terms + 1)
    e_x, e_y = np.full(terms + 1, initial), np.full(terms + 1, initial)
    total = 0.0
    for i in range(terms + 1):
        for j in range(len(t_x) - 1, -1, -1):
            if abs(t_x[j] - i * t_s) < e_x[i]:
                e_x[i] = abs(t_x[j] - i * t_s)
                x_s[i] = x[j]
        for j in range(len(t_y) - 1, -1, -1):
            if abs(t_y[j] - i * t_s) < e_y[i]:
                e_y[i] = abs(t_y[j] - i * t_s)
                x_e_s[i] = x_e[j]
        total += (x_s[i] - x_e_s[i]) ** 2
    return sqrt(total / terms)
