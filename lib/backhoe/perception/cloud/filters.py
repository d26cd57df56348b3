"""Masks of the points to keep: what is no shadow, and not alone."""

from __future__ import annotations

from math import pi, radians

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative, number, numbers, positive, real_numbers, whole

FARTHEST = 1e9
"""Coordinates that a tree of points is made of [m]."""


def incidence(points: ArrayLike, origin: ArrayLike) -> NDArray:
    """Angle at each point between its ray back to the sensor and the line to the next point.

    A surface that faces the sensor gives about pi / 2; a line along the ray, as a shadow, 0 or pi.
    Source: Mastalli 2013, section 5.3.1.

    Args:
        points: of one scan or several, in the order of the beams, shape (..., n, 3) [m]; NaN where
            nothing came back.
        origin: of the laser, shape (3,) [m]; of each scan where it moves, (..., 3).

    Returns:
        Shape (..., n - 1), from 0 to pi [rad]; NaN beside a beam without a point.

    Raises:
        ValueError: other shapes, infinite values, fewer than two points.
    """
    points = real_numbers(points, "points")
    if points.ndim < 2 or points.shape[-1] != 3 or points.shape[-2] < 2:
        raise ValueError(f"points must be two or more in a scan, (..., n, 3), got {points.shape}")
    if np.isinf(points).any():
        raise ValueError("points must be finite, or NaN where nothing came back, got an infinity")
    origin = numbers(origin, "origin", (..., 3), meaning="a point [m]")
    if origin.shape not in ((3,), (*points.shape[:-2], 3)):
        raise ValueError(
            f"origin must be one point or one for each scan, {(*points.shape[:-2], 3)}, got shape "
            f"{origin.shape}"
        )
    back = origin[..., None, :] - points[..., :-1, :]
    along = np.diff(points, axis=-2)
    across = np.linalg.norm(np.cross(back, along), axis=-1)
    return np.arctan2(across, np.sum(back * along, axis=-1))


def shadow_filter(
    points: ArrayLike,
    origin: ArrayLike,
    *,
    least: float = radians(10),
    most: float = radians(170),
    neighbours: int = 1,
) -> NDArray:
    """Which points of a scan are no shadows, the false points between a thing and what is behind.

    Where `incidence` is out of bounds, points on both sides are left out. Its source tries 10 to 70
    degrees, which throws away what faces the laser, then takes 10 to 170; it gives no number of
    neighbours. Source: Mastalli 2013, section 5.3.1, Fig. 5.7.

    Args:
        points, origin: as for `incidence`, shapes (..., n, 3), (3,) or (..., 3) [m].
        least, most: angles that are accepted [rad].
        neighbours: points on each side of the gap that go; 1 for its two ends.

    Returns:
        True for a point to keep, shape (..., n); False where nothing came back.

    Raises:
        ValueError: as `incidence`; angles out of order or range, fewer than one neighbour.
    """
    angles = incidence(points, origin)
    least = number(least, "least", "rad", least=0.0, most=pi)
    most = number(most, "most", "rad", above=least, most=pi)
    neighbours = whole(neighbours, "neighbours", least=1)
    keep = ~np.isnan(real_numbers(points, "points")).any(axis=-1)
    sharp = (angles < least) | (angles > most)
    count = keep.shape[-1]
    neighbours = min(neighbours, count)
    for step in range(1 - neighbours, min(neighbours + 1, count)):
        gone = sharp[..., max(-step, 0) : min(count - step, count - 1)]
        first = max(step, 0)
        keep[..., first : first + gone.shape[-1]] &= ~gone
    return keep


def statistical_outliers(points: ArrayLike, neighbours: int, multiplier: float) -> NDArray:
    """Which points are about as near to their neighbours as is usual in the cloud.

    A point's mean distance to its nearest others is compared with the mean over the cloud and its
    standard deviation (n - 1). PCL's `StatisticalOutlierRemoval`; Open3D counts the point itself as
    a neighbour, so ask it for one more.

    Args:
        points: shape (n, 3) [m].
        neighbours: others that are looked at, 1 or more.
        multiplier: standard deviations above the mean that are accepted [1].

    Returns:
        True for a point to keep, shape (n,) [1].

    Raises:
        ValueError: not finite, another shape, not more points than neighbours, or a
            negative multiplier.
    """
    from scipy.spatial import cKDTree

    points = numbers(points, "points", ("n", 3), meaning="coordinates [m]", within=FARTHEST)
    neighbours = whole(neighbours, "neighbours", least=1)
    multiplier = not_negative(multiplier, "multiplier")
    if len(points) <= neighbours:
        raise ValueError(f"points must be more than {neighbours} neighbours, got {len(points)}")
    distances, _ = cKDTree(points).query(points, neighbours + 1)
    mean = distances[:, 1:].mean(axis=1)
    return mean <= mean.mean() + multiplier * mean.std(ddof=1)


def radius_outliers(points: ArrayLike, radius: float, neighbours: int) -> NDArray:
    """Which points have enough others near them. PCL's `RadiusOutlierRemoval`.

    Args:
        points: shape (n, 3) [m].
        radius: how far a neighbour may be [m].
        neighbours: others that a point must have, 1 or more.

    Returns:
        True for a point to keep, shape (n,) [1].

    Raises:
        ValueError: not finite, another shape, a radius that is not above 0.
    """
    from scipy.spatial import cKDTree

    points = numbers(points, "points", ("n", 3), meaning="coordinates [m]", within=FARTHEST)
    radius, neighbours = positive(radius, "radius", "m"), whole(neighbours, "neighbours", least=1)
    return cKDTree(points).query_ball_point(points, radius, return_length=True) > neighbours
