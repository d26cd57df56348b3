"""One voxel's log-odds: what a look adds to them, and how many looks change the map's mind.

Log-odds of a probability p are ln(p / (1 - p)): above 0 for occupied rather than free, 0 for an
even chance. In a map a voxel without any look is NaN, unknown. The map itself calls 0 occupied.

Source: Mastalli 2013, section 5.4.2, eqs. (5.2), (5.3), (5.6).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import flag, number, positive, real_numbers, truths

__all__ = ["HIT", "L_MAX", "L_MIN", "MISS", "looks_until", "updated"]

HIT, MISS = 1.39, -0.80
"""What a reflection in a voxel adds, and a ray that passes it, eq. (5.6) [1]."""

L_MIN, L_MAX = -2.0, 3.48
"""Between which the sum is kept, eq. (5.3) [1]."""


def updated(
    log_odds: ArrayLike,
    reflected: ArrayLike,
    *,
    hit: float = HIT,
    miss: float = MISS,
    l_min: float = L_MIN,
    l_max: float = L_MAX,
) -> NDArray:
    """Log-odds of voxels after one look at each, eqs. (5.3), (5.6).

    Args:
        log_odds: before, NaN where unknown, any shape [1].
        reflected: whether a ray was reflected in the voxel, not only passed it; the same shape, or
            one for all.
        hit, miss, l_min, l_max: as for `OccupancyOctree`.

    Returns:
        Log-odds [1], of the same shape.

    Raises:
        ValueError: log-odds that are no numbers, reflected that are no truth values of their
            shape, a hit or l_max that is not above 0, or a miss or l_min that is not below 0.
    """
    before = np.nan_to_num(real_numbers(log_odds, "log_odds"), nan=0.0)
    one = isinstance(reflected, bool | np.bool_)
    reflected = truths(reflected, "reflected", () if one else before.shape)
    hit, miss = positive(hit, "hit"), number(miss, "miss", below=0.0)
    l_min, l_max = number(l_min, "l_min", below=0.0), positive(l_max, "l_max")
    return np.clip(before + np.where(reflected, hit, miss), l_min, l_max)


def looks_until(
    log_odds: ArrayLike, occupied: bool, *, hit: float = HIT, miss: float = MISS
) -> NDArray:
    """How many looks in a row make the map say that voxels are occupied, or that they are free.

    Clamping, eq. (5.3), keeps log_odds between l_min and l_max: the most that it ever takes is
    `looks_until(l_min, True)` or `looks_until(l_max, False)`.

    Args:
        log_odds: what the map says now, NaN where unknown, any shape [1].
        occupied: what each look finds, and the map shall say: a reflection in the voxel, or, if
            False, a ray that passes it.
        hit, miss: what each look adds, eq. (5.6) [1].

    Returns:
        Whole numbers of the shape of log_odds [1]; 0 where the map says so already.

    Raises:
        ValueError: log-odds that are no numbers, a hit that is not above 0, a miss not below 0.
    """
    now = real_numbers(log_odds, "log_odds")
    hit, miss = positive(hit, "hit"), number(miss, "miss", below=0.0)
    if flag(occupied, "occupied"):
        looks = np.where(now < 0, np.ceil(-now / hit), 0)
    else:
        looks = np.where(now >= 0, np.floor(now / -miss) + 1, 0)
    return np.where(np.isnan(now), 1, looks).astype(int)
