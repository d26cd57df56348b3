"""What measurements can tell at all: the directions of the state that no measurement ever sees.

Along a direction that is not observable a filter's variance can only grow, whatever its gain.

Reference: Kalman 1960; for a system that varies in time, the same matrix along the run.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array
from backhoe.localisation.kalman.arguments import finite


def observability_matrix(F: ArrayLike, H: ArrayLike, steps: int | None = None) -> NDArray:
    """H_0; H_1 F_0; H_2 F_1 F_0; ... one under another: what the initial state shows.

    Args:
        F: transition of each step, shape (K, n, n), or one for all, (n, n).
        H: sensor at each instant, shape (K+1, m, n) or (K, m, n), or one for all, (m, n).
        steps: how many instants, if F and H are both constant; n by default.

    Returns:
        Shape (instants * m, n).

    Raises:
        ValueError: shapes that do not fit, or numbers that are not finite.
    """
    F, H = real_array(F, "F must be numbers"), real_array(H, "H must be numbers")
    n = F.shape[-1] if F.ndim else 0
    if F.ndim not in (2, 3) or F.shape[-2] != n or H.ndim not in (2, 3) or H.shape[-1] != n:
        raise ValueError(
            "F and H must have shapes (n, n) or (K, n, n) and (m, n) or (K, m, n), got "
            f"{F.shape} and {H.shape}"
        )
    F, H = finite(F, F.shape, "F"), finite(H, H.shape, "H")
    count = _instants(F, H, n if steps is None else steps)
    carried, rows = np.eye(n), []
    for k in range(count):
        rows.append((H[k] if H.ndim == 3 else H) @ carried)
        if k + 1 < count:
            carried = (F[k] if F.ndim == 3 else F) @ carried
    return np.concatenate(rows)


def unobservable(
    F: ArrayLike, H: ArrayLike, steps: int | None = None, *, tolerance: float = 1e-9
) -> NDArray:
    """Orthonormal directions of the initial state that no measurement shows.

    Args:
        F, H, steps: as for `observability_matrix`.
        tolerance: singular values below this share of the largest count as zero.

    Returns:
        Shape (n, r), one direction a column; r = 0 for an observable system.

    Raises:
        ValueError: as for `observability_matrix`.
    """
    _, values, directions = np.linalg.svd(observability_matrix(F, H, steps))
    rank = int((values > tolerance * max(values.max(), 1e-300)).sum())
    return directions[rank:].T


def _instants(F: NDArray, H: NDArray, steps: int) -> int:
    if H.ndim == 3:
        if F.ndim == 3 and len(H) not in (len(F), len(F) + 1):
            raise ValueError(f"F and H must be of as many steps, got {len(F)} and {len(H)}")
        return len(H)
    return len(F) + 1 if F.ndim == 3 else steps
