"""From disparities to points in space, and how far to trust them.

The frame is the left rectified camera's: x right, y down, z ahead. With the focal length f [pixels]
and the baseline B [m], depth is z = f B / d, so an error of the disparity d counts with the square
of the depth: dz = z^2 / (f B) dd. A pixel without a disparity, or with one that is not above zero
(infinitely far, or behind the cameras), never becomes a point.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive


def reproject(disparity: ArrayLike, Q: ArrayLike) -> tuple[NDArray, NDArray]:
    """Points of all pixels that have a disparity.

    Args:
        disparity: shape (rows, columns) [pixels]; NaN, infinite or not positive where none.
        Q: of the rectified pair, shape (4, 4): (X, Y, Z, W) = Q (column, row, disparity, 1), the
            point is (X, Y, Z) / W [m, pixels].

    Returns:
        Points (n, 3) [m] and their rows and columns (n, 2) [pixels], row by row.

    Raises:
        ValueError: another shape, or Q is not finite.
    """
    disparity = numbers(disparity, "disparity", ("rows", "columns"), finite=False)
    Q = numbers(Q, "Q", (4, 4), meaning="the matrix of a rectified pair")
    pixels = np.argwhere(np.isfinite(disparity) & (disparity > 0))
    d = disparity[pixels[:, 0], pixels[:, 1]]
    X = np.stack([pixels[:, 1], pixels[:, 0], d, np.ones_like(d)], axis=-1) @ Q.T
    with np.errstate(divide="ignore", invalid="ignore"):
        points = X[:, :3] / X[:, 3:]
    ahead = np.isfinite(points).all(axis=1) & (points[:, 2] > 0)
    return points[ahead], pixels[ahead]


def depth(disparity: ArrayLike, focal: float, baseline: float) -> NDArray:
    """Depth f B / d of disparities of any shape [pixels]: the same shape [m]; NaN where none.

    Args:
        disparity: any shape [pixels].
        focal: focal length of the rectified pair [pixels].
        baseline: between the cameras [m].

    Raises:
        ValueError: no numbers, or a length that is not positive.
    """
    d = numbers(disparity, "disparity", finite=False)
    fB = positive(focal, "focal", "pixels") * positive(baseline, "baseline", "m")
    return np.divide(fB, d, out=np.full(d.shape, np.nan), where=np.isfinite(d) & (d > 0))


def depth_deviation(
    z: ArrayLike, focal: float, baseline: float, disparity_deviation: float
) -> NDArray:
    """Standard deviation of a depth, z^2 / (f B) times that of the disparity, shape of z [m].

    Args:
        z: depths, any shape [m].
        focal, baseline: as for `depth`.
        disparity_deviation: standard deviation of a disparity [pixels].

    Raises:
        ValueError: no numbers, or one of the others is not positive.
    """
    fB = positive(focal, "focal", "pixels") * positive(baseline, "baseline", "m")
    sigma = positive(disparity_deviation, "disparity_deviation", "pixels")
    return numbers(z, "z") ** 2 / fB * sigma


def point_covariance(
    points: ArrayLike,
    focal: float,
    baseline: float,
    *,
    disparity_deviation: float = 0.25,
    pixel_deviation: float = 0.25,
) -> NDArray:
    """Covariance of stereo points to first order: an ellipsoid that lies along the ray.

    A disparity moves the point along the line from the left camera, p dz / z; the pixel moves it
    across, z / f.

    Args:
        points: in the left camera's frame, shape (..., 3) [m], in front of it.
        focal, baseline: as for `depth`.
        disparity_deviation, pixel_deviation: standard deviations of the disparity and of where the
            left window lies, in each direction [pixels].

    Returns:
        Covariances, shape (..., 3, 3) [m^2].

    Raises:
        ValueError: another shape, a point that is not in front, or a number that is not positive.
    """
    p = numbers(points, "points", (..., 3), meaning="coordinates x, y, z [m]")
    if (p[..., 2] <= 0).any():
        raise ValueError(f"points must lie in front of the camera, got z = {p[..., 2].min()} m")
    along = depth_deviation(p[..., 2], focal, baseline, disparity_deviation)
    across = positive(pixel_deviation, "pixel_deviation", "pixels") * p[..., 2] / focal
    ray = p / p[..., 2:] * along[..., None]
    sideways = across[..., None, None] ** 2 * np.diag([1.0, 1.0, 0.0])
    return ray[..., :, None] * ray[..., None, :] + sideways
