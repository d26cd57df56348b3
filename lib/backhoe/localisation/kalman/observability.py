"""What measurements can tell at all: the directions of the state that no measurement ever sees.

Along a direction that is not observable a filter's variance can only grow, whatever its gain.

Reference: Kalman 1960; for a system that varies in time, the same matrix along the run.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers

_ZERO = 1e-9
"""Singular values below this share of the largest count as zero."""


def unobservable(F: ArrayLike, H: ArrayLike) -> NDArray:
    """Orthonormal directions of the initial state that no measurement shows.

    Args:
        F: transition of each step between two measurements, shape (K, n, n), x in its own units.
        H: sensor at each measurement, shape (K+1, m, n).

    Returns:
        Shape (n, r), one direction a column; r = 0 for an observable system.

    Raises:
        ValueError: shapes that do not fit, or numbers that are not finite.
    """
    H = numbers(H, "H", ("K+1", "m", "n"))
    instants, _, n = H.shape
    F = numbers(F, "F", (instants - 1, n, n))
    carried, rows = np.eye(n), [H[0]]
    for k in range(1, instants):
        carried = F[k - 1] @ carried
        rows.append(H[k] @ carried)
    _, values, directions = np.linalg.svd(np.concatenate(rows))
    return directions[int((values > _ZERO * max(values.max(), 1e-300)).sum()) :].T
