"""The same task with limits that hold: a quadratic programme a step.

Projection into the null space prefers, and cannot forbid. Here the wanted velocity of the hand is
scaled by one number s as far as the limits allow, so the hand slows down and stays on its way:

    minimise (1 - s) + small (|v - v0|^2 + (1 - s)^2)
    subject to  J v = s b,   lower <= v <= upper,   A v <= c,   0 <= s <= 1

The way comes first, since (1 - s) is not squared: s is the largest that the limits allow, and v the
nearest to v0 of all v with it, unless the last share ds of the way would make |v - v0|^2 more than
ds / small larger.

Solved by quadprog (Goldfarb and Idnani 1983).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers, positive, real_numbers
from backhoe.whole_body.linear import DEPENDENT, engine, plain
from backhoe.whole_body.loops import WITHIN

SMALL = 1e-4
"""What (m/s)^2 or (rad/s)^2 away from the preferred velocities cost beside the way that is lost."""

EXACT = 1e-10
"""By how much J v may miss s b [m/s]; dependent rows of J can make it more, and are sorted out."""


@cache
def solver() -> Callable:
    """quadprog's, at the first use: all but limits works where it is not installed."""
    from quadprog import solve_qp

    return solve_qp


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
    weights: ArrayLike | None = None,
    A: ArrayLike | None = None,
    c: ArrayLike | None = None,
    small: float = SMALL,
) -> Limited:
    """Velocities within limits that move the hand along b, as fast as the limits allow.

    J may be singular: if no velocity moves the hand along b, s is 0 and the hand stands.

    Args:
        J: shape (m, n).
        b: wanted velocity of the hand, shape (m,) [m/s].
        lower, upper: bounds of the velocities, shape (n,) [m/s, rad/s]; see `joint_bounds`.
        preferred: v0, shape (n,); zero if None.
        weights: what each velocity costs, as for `minimum_norm`, shape (n,); all alike if None.
        A, c: further limits A v <= c, shapes (k, n) and (k,): `track_rows`, `margin_rows`,
            obstacles.
        small: what being away from v0 costs beside the way, 1e-7 to 1.

    Returns:
        v and s; s = 1 where the limits do not matter.

    Raises:
        ValueError: shapes that do not fit, values that are not finite or above 1e9, lower above
            upper, or limits that exclude each other, or that do not let the hand stand while they
            move a joint; the message names them.
    """
    arrays = [J, b, lower, upper]
    arrays += [one for one in (preferred, weights, A, c) if one is not None]
    if not plain(*arrays) or not _fit(J, b, lower, upper, preferred, weights, A, c):
        given = _checked(J, b, lower, upper, preferred, weights, A, c)
        J, b, lower, upper, preferred, weights, A, c = given
    m, n = J.shape
    v0 = np.zeros(n) if preferred is None else preferred
    weights = _alike(n) if weights is None else weights
    if A is None:
        A, c = np.empty((0, n)), np.empty(0)
    small = SMALL if small is SMALL else number(small, "small", least=1e-7, most=1.0)
    loops, count = engine(), m + 2 * n + 2 + len(A)
    G, a = np.empty((n + 1, n + 1)), np.empty(n + 1)
    C, least = np.empty((n + 1, count)), np.empty(count)
    a[n] = 1.0 + 0.5 / small
    if not loops.programme(J, b, lower, upper, v0, weights, A, c, G, a, C, least):
        _checked(J, b, lower, upper, v0, weights, A, c)
    v = np.empty(n)
    try:
        x = solver()(G, a, C, least, m)[0]
        s, missed = loops.within(J, b, lower, upper, x, v)
    except ValueError:
        missed = np.inf
    if not missed < EXACT:
        x = _sorted_out(G, a, C, least, m)
        s, _ = loops.within(J, b, lower, upper, x, v)
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
    lower, upper = (lowest - q) / T, (highest - q) / T
    return tuple(np.minimum(np.maximum(one, -fastest), fastest) for one in (lower, upper))


@cache
def _alike(n: int) -> NDArray:
    return np.ones(n)


def _sorted_out(G: NDArray, a: NDArray, C: NDArray, least: NDArray, m: int) -> NDArray:
    """The solution with the m equations that depend on each other left out, or what is wrong."""
    _, sizes, rows = np.linalg.svd(C[:, :m].T, full_matrices=False)
    rows = rows[sizes > DEPENDENT * sizes[:1]]
    C, least = np.c_[rows.T, C[:, m:]], np.r_[np.zeros(len(rows)), least[m:]]
    try:
        return solver()(G, a, C.copy(), least, len(rows))[0]
    except ValueError as error:
        if "inconsistent" not in str(error):
            raise
        raise ValueError(_conflict(C, least, len(rows))) from error


def _conflict(C: NDArray, least: NDArray, m: int) -> str:
    """Which limits exclude each other, for the error: without any one of them there is a v."""
    n = len(C) - 1
    names = ["the hand must stay on its way, J v = s b"] * m
    names += [f"velocity {k} must be at least {least[m + k]:.4g}" for k in range(n)]
    names += [f"velocity {k} must be at most {-least[m + n + k]:.4g}" for k in range(n)]
    names += ["s must be at least 0", "s must be at most 1"]
    names += [
        f"row {k} of A must be at most {-most:.4g}" for k, most in enumerate(least[len(names) :])
    ]

    def there_is_one(kept: list[int]) -> bool:
        equations = sum(k < m for k in kept)
        try:
            solver()(np.eye(n + 1), np.zeros(n + 1), C[:, kept], least[kept], equations)
        except ValueError:
            return False
        return True

    kept = list(range(len(least)))
    for group in [list(range(m)), *([k] for k in range(m, len(least)))]:
        without = [k for k in kept if k not in group]
        kept = kept if there_is_one(without) else without
    return "limits exclude each other: " + "; ".join(dict.fromkeys(names[k] for k in kept))


def _fit(J, b, lower, upper, v0, weights, A, c) -> bool:
    """Whether arrays of floats have the shapes that they must have."""
    n = J.shape[-1] if J.ndim == 2 else 0
    if n == 0 or b.shape != J.shape[:1] or not b.size or not lower.shape == upper.shape == (n,):
        return False
    if (v0 is not None and v0.shape != (n,)) or (weights is not None and weights.shape != (n,)):
        return False
    if A is None or c is None:
        return A is c
    return c.ndim == 1 and A.shape == (len(c), n)


def _checked(J, b, lower, upper, v0, weights, A, c) -> tuple[NDArray, ...]:
    """All of them as they must be; ValueError that says what is not."""
    J = numbers(J, "J", ("m", "n"), meaning="a matrix", within=WITHIN)
    m, n = J.shape
    b = numbers(b, "b", (m,), meaning="one value a row of J", within=WITHIN)
    rows = {"lower": lower, "upper": upper, "preferred": v0, "weights": weights}
    default = {"preferred": np.zeros(n), "weights": np.ones(n)}
    for name, row in rows.items():
        row = default.get(name) if row is None else row
        rows[name] = numbers(row, name, (n,), meaning="one value a column of J", within=WITHIN)
    lower, upper, v0, weights = rows.values()
    if (lower > upper).any():
        at = int(np.argmax(lower > upper))
        raise ValueError(
            f"lower must not be above upper, got {lower[at]} and {upper[at]} for velocity {at}"
        )
    if (weights * WITHIN <= 1).any():
        raise ValueError(f"weights must be positive, got {weights.min()}")
    A = np.zeros((0, n)) if A is None else A
    A = real_numbers(A, "A")
    if A.shape != (0, n):
        A = numbers(A, "A", ("k", n), meaning="one row a limit", within=WITHIN)
    c = np.zeros(0) if c is None and not len(A) else c
    c = numbers(c, "c", (len(A),), meaning="one value a row of A", within=WITHIN)
    given = (J, b, lower, upper, v0, weights, A, c)
    return tuple(np.require(one, float, "CAW") for one in given)
