"""Control by linear equations: the velocities that bring the hand where it should be next.

Source: Sasig and Chicaiza 2017, eqs. (1) to (5).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive


def wanted_velocity(
    h: ArrayLike,
    goal: ArrayLike,
    next_goal: ArrayLike,
    W: ArrayLike,
    T: float,
    *,
    fastest: float | None = None,
) -> NDArray:
    """b of J v = b: (h_d(k+1) - W (h_d(k) - h(k)) - h(k)) / T.

    With it e(k+1) = W e(k) for a hand that moves by T J v in a step: Euler's, of a robot that has
    the velocities it was told. A real hand follows a curve in a step, and an error of the order of
    T^2 is left. Source: Sasig and Chicaiza 2017, (4) and (5).

    Args:
        h: the hand, shape (..., m): a point [m], or a point and angles [m, rad].
        goal, next_goal: where it should be now and after the step, shapes (..., m).
        W: share of the error that a step leaves, of each direction or of all, shape (m,) or (), at
            least 0 and below 1; near 0 is quick, near 1 slow, and 0 itself asks for the whole
            error to be gone after one step.
        T: the step [s].
        fastest: speed of the goal above which the path jumps [m/s]; not looked at if None.

    Returns:
        Wanted velocity of the hand, shape (..., m) [m/s, rad/s].

    Raises:
        ValueError: shapes that do not fit, values that are not finite, W outside [0, 1), T or
            fastest not positive, or a goal that jumps; the message names the step.
    """
    h = numbers(h, "h", (..., "m"), meaning="a point [m]")
    goal = numbers(goal, "goal", h.shape, meaning="like h")
    next_goal = numbers(next_goal, "next_goal", h.shape, meaning="like h")
    W, T = numbers(W, "W"), positive(T, "T", "s")
    if W.shape not in ((), h.shape[-1:]):
        raise ValueError(f"W must be one number, or one a direction, got shape {W.shape}")
    if (W < 0).any() or (W >= 1).any():
        worst = W.flat[int(np.argmax(np.abs(W - 0.5)))]
        raise ValueError(
            f"W must be at least 0 and below 1, got {worst}: the error after a step is W times "
            "that before, so it would not shrink, or change its sign each time"
        )
    if fastest is not None:
        _no_jump(next_goal - goal, T * positive(fastest, "fastest", "m/s"))
    return (next_goal - W * (goal - h) - h) / T


def _no_jump(way: NDArray, most: float) -> None:
    """ValueError if a way from goal to goal, shape (..., m) [m], is longer than it may be."""
    lengths = np.linalg.norm(way, axis=-1)
    if (lengths > most).any():
        at = tuple(map(int, np.unravel_index((lengths > most).argmax(), lengths.shape)))
        where = f" in step {at if len(at) > 1 else at[0]}" if at else ""
        raise ValueError(
            f"next_goal must be at most {most:.4g} m from goal, got {lengths[at]:.4g} m{where}: "
            "the path jumps; give it more time, or points between"
        )
