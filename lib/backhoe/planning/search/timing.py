"""When to be where: a path without times becomes a movement that no joint is too slow for.

The path is cut into pieces that take the same time if the busiest joint goes at its limit. The
cuts are the control points of a uniform cubic B-spline, each end three times. Its speed is a mean of
differences of neighbours, its acceleration one of second differences: the largest of these
decide how long a piece must last, and speed and acceleration are within their limits everywhere,
not only where one looks. It starts and ends at rest, and rounds the corners; how much, the length
of the pieces decides. Source of the bounds: de Boor, A Practical Guide to Splines, chapter IX.
"""

from __future__ import annotations

from collections.abc import Callable
from math import ceil
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import function, number, numbers, positive

HALVINGS = 8
"""How often pieces are halved to keep a rounded corner free."""


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
        dt: sampling time [s].
        piece: longest time between two control points at full speed [s]; shorter pieces round the
            corners less, and the movement is slower.
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
        cuts = np.linspace(0.0, reached[-1], ceil(reached[-1] / piece) + 1)
        inner = np.stack([np.interp(cuts, reached, joint) for joint in path.T], axis=1)
        points = np.concatenate([inner[[0, 0]], inner, inner[[-1, -1]]])
        bends = np.abs(np.diff(points, 2, axis=0)) / most
        movement = _spline(points, max(cuts[1], np.sqrt(bends.max())), dt)
        if is_free is None or np.all(is_free(movement.q)):
            return movement
        piece /= 2
    raise ValueError("path must be free, and with some room at its corners: no rounding of it is")


def _spline(points: NDArray, step: float, dt: float) -> Timed:
    """The uniform cubic B-spline with a step of time between control points [s]."""
    end = step * (len(points) - 3)
    times = np.linspace(0.0, end, max(round(end / dt), 1) + 1)
    first = np.minimum((times / step).astype(int), len(points) - 4)
    u = (times / step - first)[:, None]
    weights = (1 - u) ** 3, 3 * u**3 - 6 * u**2 + 4, -3 * u**3 + 3 * u**2 + 3 * u + 1, u**3
    rates = -3 * (1 - u) ** 2, 9 * u**2 - 12 * u, -9 * u**2 + 6 * u + 3, 3 * u**2
    near = [points[first + k] for k in range(4)]
    q = sum(w * p for w, p in zip(weights, near, strict=True)) / 6
    dq = sum(w * p for w, p in zip(rates, near, strict=True)) / (6 * step)
    return Timed(times, q, dq)


def _path(path: ArrayLike) -> NDArray:
    path = numbers(path, "path", ("n", "D"), meaning="one point a row")
    if len(path) < 2:
        raise ValueError(f"path must have 2 or more points, got {len(path)}")
    return path


def _limits(values: ArrayLike, name: str, joints: int) -> NDArray:
    values = numbers(values, name, (joints,), meaning="one a joint")
    number(values.min(), f"the least {name}", above=0.0)
    return values
