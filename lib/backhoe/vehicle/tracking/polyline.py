"""Geometry of polylines: lengths along them, distances to them.

A polyline is an array (n, 2) of points in metres, joined in order by straight segments. Points may
repeat (a segment of length zero is a point) and the line may close or cross itself.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, whole
from backhoe.basics.tiles import for_each_tile

_PAIRS_IN_A_TILE = 2**15


def points_array(points: ArrayLike, name: str) -> NDArray:
    """`points` of a polyline, two or more, as an array of floats (n, 2) [m]; ValueError else."""
    array = _places(points, name)
    if len(array) < 2:
        raise ValueError(f"{name} needs 2 points or more, got {len(array)}")
    return array


def _places(points: ArrayLike, name: str) -> NDArray:
    return numbers(points, name, ("n", 2), meaning="x, y [m] a row")


def arc_length(points: NDArray) -> NDArray:
    """Way along the polyline from its first point to each point.

    Args:
        points: shape (n, 2) [m].

    Returns:
        Shape (n,) [m], the first 0.
    """
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def length(points: ArrayLike) -> float:
    """Length of the polyline through points (n, 2) [m]; 0 for a single point.

    Raises:
        ValueError: points are not finite numbers of shape (n, 2).
    """
    return float(arc_length(_places(points, "points"))[-1])


def subdivide(points: NDArray, spacing: float) -> NDArray:
    """The polyline with points added, evenly on each segment, so that none is farther than
    `spacing` [m] from the next. Every point of `points` (n, 2) [m] stays.
    """
    pieces = np.ceil(np.hypot(*np.diff(points, axis=0).T) / spacing - 1e-9).astype(int)
    starts = np.repeat(np.arange(len(pieces)), np.maximum(pieces, 1))
    first = np.flatnonzero(np.r_[True, np.diff(starts) > 0])
    step = np.arange(len(starts)) - first[starts]
    share = step / np.maximum(pieces, 1)[starts]
    added = points[starts] + share[:, None] * (points[starts + 1] - points[starts])
    return np.vstack([added, points[-1:]])


def distances(actual: ArrayLike, reference: ArrayLike) -> NDArray:
    """Distance of each point to the nearest point of a polyline, its segments included.

    The nearest point of a segment from A to A + D is A + t D with t = (P - A) . D / |D|^2, kept
    within 0 and 1. All segments are tried for each point, in tiles: memory stays at a few MB.

    Args:
        actual: points, shape (N, 2) [m].
        reference: the polyline, shape (M, 2), M >= 2 [m].

    Returns:
        Shape (N,) [m].

    Raises:
        ValueError: not finite numbers of those shapes, no actual point, fewer than two reference
            points.
    """
    actual = _places(actual, "actual")
    reference = points_array(reference, "reference")
    ax, ay = reference[:-1].T
    dx, dy = np.diff(reference, axis=0).T
    squared = dx * dx + dy * dy
    inverse = np.divide(1.0, squared, out=np.zeros_like(squared), where=squared > 1e-300)
    nearest = np.empty(len(actual))

    def work(tile: slice) -> None:
        x, y = actual[tile, 0, None] - ax, actual[tile, 1, None] - ay
        t = x * dx
        t += y * dy
        t *= inverse
        np.clip(t, 0.0, 1.0, out=t)
        x -= t * dx
        y -= t * dy
        nearest[tile] = np.sqrt(np.min(x * x + y * y, axis=1))

    for_each_tile(work, len(actual), max(_PAIRS_IN_A_TILE // len(ax), 1))
    return nearest


def distances_to_samples(actual: ArrayLike, reference: ArrayLike, samples: int) -> NDArray:
    """Distance of each point to the nearest of `samples` points spread evenly along a polyline.

    So D'Angelo 2022 (section 5.2) measures, "oversampling" the path. It is never shorter than
    `distances`, and longer by at most half the spacing of the samples.

    Args:
        actual: points, shape (N, 2) [m].
        reference: the polyline, shape (M, 2), M >= 2 [m].
        samples: number of samples, two or more.

    Returns:
        Shape (N,) [m].

    Raises:
        ValueError: not finite numbers of those shapes, or fewer than two samples.
    """
    actual = _places(actual, "actual")
    reference = points_array(reference, "reference")
    samples, arc = whole(samples, "samples", least=2), arc_length(reference)
    at = np.linspace(0.0, arc[-1], samples)
    px, py = (np.interp(at, arc, axis) for axis in reference.T)
    nearest = np.empty(len(actual))

    def work(tile: slice) -> None:
        x, y = actual[tile, 0, None] - px, actual[tile, 1, None] - py
        nearest[tile] = np.sqrt(np.min(x * x + y * y, axis=1))

    for_each_tile(work, len(actual), max(_PAIRS_IN_A_TILE // samples, 1))
    return nearest
