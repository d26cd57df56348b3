"""Better ways to a new goal than (6.4) takes: maps of the path, a shift in time, an exact end.

Each moves the spring's far end, so that the primitive stays one spring that can be pushed aside.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.basics import inputs
from backhoe.planning.dmp.phase import minimum_jerk

REMEDIES = ("none", "scaled", "affine", "minimum_jerk")
Coupling = Callable[[float, NDArray, NDArray], NDArray]
_NONE = 1e-9


def displacement(start: NDArray, goal: NDArray, who: str) -> NDArray:
    """goal - start, shape (d,) [unit]; ValueError, which says who divides by it, if 0 somewhere."""
    way = goal - start
    if (np.abs(way) < _NONE).any():
        k = int(np.abs(way).argmin())
        raise ValueError(
            f"{who} divides by the demonstrated displacement, which is 0 in dimension {k}: "
            'take formulation "pastor" with remedy "none", "affine" or "minimum_jerk"'
        )
    return way


def moved(
    learnt: NDArray,
    share: NDArray,
    old: NDArray,
    new: NDArray,
    remedy: str,
    lags: tuple[float, float],
    duration: float,
) -> tuple[NDArray, NDArray]:
    """The far end on its way from a new start to a new goal.

    Args:
        learnt: its places as learnt, shape (m, d) [unit].
        share: shares of the duration, shape (m,) [1].
        old, new: start and goal, as learnt and wanted, shapes (2, d) [unit].
        remedy: "scaled", "affine" or "minimum_jerk".
        lags: D tau / K and tau^2 / K, by which the spring follows later [s, s^2].
        duration: of the learnt movement [s].

    Returns:
        Places, shape (m, d) [unit], and A of x' = A x + b, shape (d, d) [1].
    """
    (start, goal), d = old, old.shape[1]
    shifts = new - old
    if remedy == "minimum_jerk":
        m, slope, curve = minimum_jerk(share[:, None])
        ahead = m + lags[0] * slope / duration + lags[1] * curve / duration**2
        return learnt + shifts[0] + (shifts[1] - shifts[0]) * ahead, np.eye(d)
    grows = shifts[1] - shifts[0]
    if remedy == "scaled":
        A = np.diag(1 + grows / displacement(start, goal, 'remedy "scaled"'))
    else:
        A = np.eye(d) + np.outer(grows, _progress(start, goal, np.ptp(learnt, axis=0)))
    return new[0] + (learnt - start) @ A.T, A


def _progress(start: NDArray, goal: NDArray, sizes: NDArray) -> NDArray:
    """p with p @ (x - start) = 0 at the start, 1 at the goal; dimensions weigh by their sizes, so
    that metres and radians may stand side by side, shape (d,) [1/unit]."""
    scaled = (goal - start) / np.where(sizes > 0, sizes, 1.0) ** 2
    length = scaled @ (goal - start)
    if length < _NONE:
        raise ValueError(
            'remedy "affine" needs a demonstration that ends elsewhere than it began: '
            'take "minimum_jerk"'
        )
    return scaled / length


def integrate(
    u: NDArray,
    x: NDArray,
    v: NDArray,
    M: NDArray,
    t: NDArray,
    coupling: Coupling,
    compliance: float,
) -> tuple[NDArray, NDArray]:
    """As `spring.follow`, with a further acceleration, asked for once a step and held in it.

    Args:
        u: places of the far end, shape (m, d) [unit].
        x, v: at first, shapes (d,) [unit, unit/s].
        M: of `step_matrix`, shape (2, 4).
        t: times, shape (m,) [s].
        coupling: function (t, x, v) -> acceleration, shape (d,) [unit/s^2].
        compliance: tau^2 / K, the place for an acceleration [s^2].

    Returns:
        Positions and velocities, shapes (m, d).
    """
    inputs.function(coupling, "coupling", "coupling(t, x, v) -> acceleration of each dimension")
    xs, vs = np.empty(u.shape), np.empty(u.shape)
    xs[0], vs[0] = x, v
    for k in range(len(u) - 1):
        try:
            push = coupling(float(t[k]), xs[k].copy(), vs[k].copy())
        except TypeError as error:
            raise TypeError(f"coupling must take t, x and v: {error}") from error
        aside = compliance * inputs.numbers(push, "coupling(t, x, v)", x.shape)
        xs[k + 1], vs[k + 1] = M @ [xs[k], vs[k], u[k] + aside, u[k + 1] + aside]
    return xs, vs


def end_exactly(
    x: NDArray, v: NDArray, share: NDArray, duration: float, goal: NDArray, speed: NDArray
) -> tuple[NDArray, NDArray]:
    """The movement, shapes (m, d), bent so that it ends at the goal (d,) with the speed (d,).

    The place that is missed is spread over the duration by minimum jerk, the speed over its last
    tenth, so that place, speed and acceleration at the start are what they were.
    """
    m, slope, _ = minimum_jerk(share[:, None])
    far, slow, last = goal - x[-1], speed - v[-1], 0.1 * duration
    u = np.maximum(1 - (1 - share[:, None]) / 0.1, 0.0)
    q, bend = u**3 * (u - 1) * (4 - 3 * u), u**2 * (28 * u - 12 - 15 * u**2)
    return x + far * m + slow * last * q, v + far * slope / duration + slow * bend
