"""A velocity in one axis, summed: rectangles and trapezoids.

Source: PUCP guide 2024, eqs. (1) to (5). With x(0) in front, which (1) leaves out: the integral
alone is the way, not the position.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers
from backhoe.localisation.odometry.dead_reckoning import intervals


def euler_sum(t: ArrayLike, v: ArrayLike, x0: ArrayLike = 0.0) -> NDArray:
    """x_k = x_{k-1} + v_k delta_k: rectangles as high as their right edge, order 1.

    Source: PUCP (2); (3) for steps of one length.

    Args:
        t: instants, rising, shape (N+1,) [s].
        v: speed at them, shape (..., N+1) [m/s]; v[0] does not count.
        x0: position at t[0], one or shape (...) [m].

    Returns:
        Positions at the instants, shape (..., N+1) [m].

    Raises:
        ValueError: t does not rise, shapes that do not fit, a value that is not finite.
    """
    return _sum(t, v, x0, "right")


def bilinear_sum(t: ArrayLike, v: ArrayLike, x0: ArrayLike = 0.0) -> NDArray:
    """x_k = x_{k-1} + (v_k + v_{k-1}) delta_k / 2: trapezoids, order 2.

    Source: PUCP (4); (5) for steps of one length.

    Args: as for `euler_sum`; v[0] counts.

    Returns:
        Positions at the instants, shape (..., N+1) [m].

    Raises:
        ValueError: as for `euler_sum`.
    """
    return _sum(t, v, x0, "trapezoid")


def _sum(t: ArrayLike, v: ArrayLike, x0: ArrayLike, rule: str) -> NDArray:
    dt, held = intervals(t, v, rule)
    x0 = numbers(x0, "x0")
    if x0.shape not in ((), held.shape[:-1]):
        raise ValueError(f"x0 must be one position or {held.shape[:-1]} of them, got {x0.shape}")
    x = np.zeros((*held.shape[:-1], len(dt) + 1))
    np.cumsum(held * dt, axis=-1, out=x[..., 1:])
    return x + x0[..., None]
