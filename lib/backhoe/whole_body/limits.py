"""The same task with limits that hold: a quadratic programme a step.

Projection into the null space prefers, and cannot forbid. Here the wanted velocity of the hand is
scaled by one number s as far as the limits allow, so the hand slows down and stays on its way:

    minimise (1 - s)^2 + small |v - v0|^2  subject to  J v = s b,   lower <= v <= upper,  A v <= c

Solved by quadprog (Goldfarb and Idnani 1983).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive

SMALL = 1e-4
"""What (m/s)^2 or (rad/s)^2 away from the preferred velocities cost beside the way that is lost."""


class Limited(NamedTuple):
    """Velocities v (n,) within the limits, and the share s of the wanted velocity, 0 to 1 [1]."""

    v: NDArray
    s: float


def limited_velocity(
    J: ArrayLike,
    b: ArrayLike,
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    preferred: ArrayLike | None = None,
    A: ArrayLike | None = None,
    c: ArrayLike | None = None,
    small: float = SMALL,
) -> Limited:
    """Velocities within limits that move the hand along b, as fast as the limits allow.

    Args:
        J: shape (m, n).
        b: wanted velocity of the hand, shape (m,) [m/s].
        lower, upper: bounds of the velocities, shape (n,) [m/s, rad/s]; see `joint_bounds`.
        preferred: v0, shape (n,); zero if None.
        A, c: further limits A v <= c, shapes (k, n) and (k,): tracks, stability, obstacles.
        small: weight of |v - v0|^2.

    Returns:
        v and s; s = 1 where the limits do not matter.

    Raises:
        ValueError: shapes that do not fit, values that are not finite, lower above upper, or
            limits that exclude each other; the message names them.
    """
    import quadprog

    J = numbers(J, "J", ("m", "n"), meaning="a matrix")
    m, n = J.shape
    b = numbers(b, "b", (m,), meaning="one value a row of J")
    lower = numbers(lower, "lower", (n,), meaning="one value a column of J")
    upper = numbers(upper, "upper", (n,), meaning="one value a column of J")
    if (lower > upper).any():
        at = int(np.argmax(lower > upper))
        raise ValueError(
            f"lower must not be above upper, got {lower[at]} and {upper[at]} for velocity {at}"
        )
    v0 = numbers(np.zeros(n) if preferred is None else preferred, "preferred", (n,))
    small = positive(small, "small")
    A = np.zeros((0, n)) if A is None else numbers(A, "A", ("k", n), meaning="one row a limit")
    c = np.zeros(0) if c is None else numbers(c, "c", (len(A),), meaning="one value a row of A")

    weight = np.diag([*np.full(n, small), 1.0])
    wanted = np.r_[small * v0, 1.0]
    task = np.c_[J, -b]
    box = np.eye(n + 1)
    rows = np.vstack([task, box[:n], -box[:n], box[n:], -box[n:], np.c_[-A, np.zeros(len(A))]])
    bounds = np.r_[np.zeros(m), lower, -upper, 0.0, -1.0, -c]
    try:
        x = quadprog.solve_qp(weight, wanted, rows.T.copy(), bounds, m)[0]
    except ValueError as error:
        if "inconsistent" not in str(error):
            raise
        raise ValueError(_conflict(lower, upper, A, c)) from error
    v, s = np.clip(x[:n], lower, upper), float(np.clip(x[n], 0.0, 1.0))
    return Limited(v, s)


def joint_bounds(
    q: ArrayLike, lowest: ArrayLike, highest: ArrayLike, fastest: ArrayLike, T: float
) -> tuple[NDArray, NDArray]:
    """Bounds of the joints' speeds that keep their angles in range over the next step.

    Args:
        q: angles, shape (n,) [rad].
        lowest, highest: their range, shape (n,) [rad].
        fastest: speed limits, shape (n,), positive [rad/s].
        T: the step [s].

    Returns:
        Lower and upper bounds, shapes (n,) [rad/s]. Beyond its range a joint is sent back as fast
        as it may go, and no faster.

    Raises:
        ValueError: shapes that do not fit, values that are not finite, or bounds out of order.
    """
    q = numbers(q, "q", ("n",), meaning="joint angles")
    lowest = numbers(lowest, "lowest", q.shape, meaning="one angle a joint")
    highest = numbers(highest, "highest", q.shape, meaning="one angle a joint")
    fastest = numbers(fastest, "fastest", q.shape, meaning="one speed a joint")
    if (lowest > highest).any():
        raise ValueError(f"lowest must not be above highest, got {lowest} and {highest}")
    if (fastest <= 0).any():
        raise ValueError(f"fastest must be positive, got {fastest.min()}")
    T = positive(T, "T", "s")
    lower = np.clip((lowest - q) / T, -fastest, fastest)
    return lower, np.clip((highest - q) / T, -fastest, fastest)


def _conflict(lower: NDArray, upper: NDArray, A: NDArray, c: NDArray) -> str:
    """Which limits exclude each other, for the error."""
    least = np.where(A > 0, A * lower, A * upper).sum(axis=1)
    for row in np.flatnonzero(least > c):
        return (
            f"limits exclude each other: row {row} of A allows at most {c[row]:.4g}, but within "
            f"lower and upper it is at least {least[row]:.4g}"
        )
    return (
        "limits exclude each other: no v within lower and upper fulfils all rows of A; leave "
        "some out to find which"
    )
