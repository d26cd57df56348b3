"""When to be where: a path without times becomes a movement that no joint is too slow for.

The path is cut into pieces that take the same time if the busiest joint goes at its limit. The
cuts are the control points of a uniform cubic B-spline q(s), which rounds the corners. Along it the
arm goes as fast as its joints can. With the speed v = ds/dt, q' and q'' along the path,

    |q'| v <= speed limit,    |q''| v^2 + |q'| |dv/dt| <= acceleration limit,

and v^2 at rest at both ends: one sweep forwards, in which it rises as fast as the second line
allows, and one backwards. Source: Bobrow, Dubowsky and Gibson 1985, with a bound in place of each
joint's own sign, so that the answer is a little slow and never too fast.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from math import ceil
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import function, number, numbers, positive, truths
from backhoe.planning.search.checker import FAR, answer_of

HALVINGS = 8
"""How often pieces are halved to keep a rounded corner free."""

MOST_PIECES = 10_000
"""More of them would take minutes."""

MOST_SAMPLES = 10_000_000
"""More of them would not fit into the memory."""

LEAST_LIMIT, MOST_LIMIT = 1e-6, 1e6
"""Of speeds and accelerations [rad/s, rad/s^2]."""

LOOKS = 40
"""Places of each piece where the limits are looked at."""


class Timed(NamedTuple):
    """A movement: `times` (m,) [s], `q` (m, D) and speeds `dq` (m, D), evenly sampled."""

    times: NDArray
    q: NDArray
    dq: NDArray


def segment_times(path: ArrayLike, speed_limit: ArrayLike) -> NDArray:
    """Least time from each point of a path to the next, straight: the busiest joint decides.

    Args:
        path: shape (n, D), n at least 2 [rad].
        speed_limit: shape (D,), above 0 [rad/s].

    Returns:
        Shape (n - 1,) [s].

    Raises:
        ValueError: another shape, a value that is not finite, a limit that is not above 0.
    """
    path = _path(path)
    speed_limit = _limits(speed_limit, "speed_limit", path.shape[1])
    return (np.abs(np.diff(path, axis=0)) / speed_limit).max(axis=1)


def in_time(
    path: ArrayLike,
    speed_limit: ArrayLike,
    acceleration_limit: ArrayLike,
    *,
    dt: float = 0.01,
    piece: float = 1.0,
    is_free: Callable[[NDArray], NDArray] | None = None,
) -> Timed:
    """A movement along a path from rest to rest, within speeds and accelerations.

    Args:
        path: shape (n, D), n at least 2 [rad].
        speed_limit, acceleration_limit: of each joint, shape (D,), above 0 [rad/s, rad/s^2].
        dt: sampling time, nearly [s].
        piece: longest time between two control points at full speed [s]; shorter pieces round the
            corners less, and the movement brakes there more.
        is_free: tells of points (k, D) whether they are free, shape (k,). Pieces are halved until
            all samples are.

    Returns:
        The movement; a path without any way is one sample.

    Raises:
        ValueError: another shape, a value that is not finite, a limit, dt or piece not above 0; or
            no rounding is free, since the path itself is not.
    """
    path = _path(path)
    speed_limit = _limits(speed_limit, "speed_limit", path.shape[1])
    most = _limits(acceleration_limit, "acceleration_limit", path.shape[1])
    dt, piece = positive(dt, "dt", "s"), positive(piece, "piece", "s")
    if is_free is not None:
        function(is_free, "is_free", "is_free(points (k, D)) -> truth values (k,)")
    reached = np.r_[0.0, np.cumsum(segment_times(path, speed_limit))]
    if reached[-1] == 0.0:
        return Timed(np.zeros(1), path[:1], np.zeros_like(path[:1]))
    new = np.r_[True, np.diff(reached) > 0]
    path, reached = path[new], reached[new]
    for _ in range(HALVINGS + 1):
        if reached[-1] > MOST_PIECES * piece:
            raise ValueError(
                f"piece must leave at most {MOST_PIECES} pieces of {reached[-1]:.3g} s, "
                f"got {piece:.3g} s"
            )
        cuts = np.linspace(0.0, reached[-1], ceil(reached[-1] / piece) + 1)
        inner = np.stack([np.interp(cuts, reached, joint) for joint in path.T], axis=1)
        ends = 2 * inner[[0, -1]] - inner[[1, -2]]
        movement = _as_fast(np.vstack([ends[:1], inner, ends[1:]]), speed_limit, most, dt)
        if is_free is None or _all_free(is_free, movement.q):
            return movement
        piece /= 2
    raise ValueError("path must be free, and with some room at its corners: no rounding of it is")


def _as_fast(points: NDArray, speed: NDArray, most: NDArray, dt: float) -> Timed:
    """The spline of these control points, from rest to rest, as fast as the limits allow."""
    s = np.linspace(0.0, len(points) - 3, (len(points) - 3) * LOOKS + 1)
    q, slope, bend = (np.abs(part) if k else part for k, part in enumerate(_spline(points, s)))
    slope = np.maximum(slope, 1e-12)
    square = np.minimum((speed / slope) ** 2, most / np.maximum(bend, 1e-12)).min(axis=1)
    square[[0, -1]] = 0.0
    for order in (np.arange(len(s)), np.arange(len(s))[::-1]):
        for here, after in pairwise(order):
            rise = ((most - bend[here] * square[here]) / slope[here]).min()
            square[after] = min(square[after], square[here] + 2 * s[1] * max(rise, 0.0))
    v = np.sqrt(square)
    at = np.r_[0.0, np.cumsum(2 * s[1] / (v[1:] + v[:-1]))]
    if at[-1] > MOST_SAMPLES * dt:
        raise ValueError(
            f"dt must leave at most {MOST_SAMPLES} samples of {at[-1]:.3g} s, got {dt:.3g} s"
        )
    times = np.linspace(0.0, at[-1], max(round(at[-1] / dt), 1) + 1)
    k = np.clip(np.searchsorted(at, times, "right") - 1, 0, len(s) - 2)
    gain = (square[k + 1] - square[k]) / (2 * s[1])
    since = times - at[k]
    place = np.clip(s[k] + v[k] * since + gain * since**2 / 2, s[k], s[k + 1])
    q, slope, _ = _spline(points, place)
    dq = slope * (v[k] + gain * since)[:, None]
    pace = np.abs(np.diff(dq, axis=0)) / (times[1] * most)
    late = max((np.abs(dq) / speed).max(), np.sqrt(pace.max()), 1.0)  # between two looks
    return Timed(times * late, q, dq / late)


def _spline(points: NDArray, s: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """The uniform cubic B-spline at s, its slope and its bend, each of shape (len(s), D)."""
    first = np.minimum(s.astype(int), len(points) - 4)
    u = (s - first)[:, None]
    weights = (
        ((1 - u) ** 3, 3 * u**3 - 6 * u**2 + 4, -3 * u**3 + 3 * u**2 + 3 * u + 1, u**3),
        (-3 * (1 - u) ** 2, 9 * u**2 - 12 * u, -9 * u**2 + 6 * u + 3, 3 * u**2),
        (6 * (1 - u), 18 * u - 12, -18 * u + 6, 6 * u),
    )
    near = [points[first + k] for k in range(4)]
    return tuple(sum(w * p for w, p in zip(row, near, strict=True)) / 6 for row in weights)


def _all_free(is_free: Callable, q: NDArray) -> bool:
    answer = answer_of(is_free, "is_free", q.copy())
    return bool(truths(answer, "the answer of is_free", (len(q),)).all())


def _path(path: ArrayLike) -> NDArray:
    path = numbers(path, "path", ("n", "D"), meaning="one point a row", within=FAR)
    if len(path) < 2:
        raise ValueError(f"path must have 2 or more points, got {len(path)}")
    return path


def _limits(values: ArrayLike, name: str, joints: int) -> NDArray:
    values = numbers(values, name, (joints,), meaning="one a joint")
    number(values.min(), f"the least {name}", least=LEAST_LIMIT)
    number(values.max(), f"the largest {name}", most=MOST_LIMIT)
    return values
