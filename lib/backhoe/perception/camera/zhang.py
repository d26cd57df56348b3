"""The closed form of a calibration: a flat board's homographies, and the camera that they allow.

Without distortion, and only as good as linear equations are: where the least squares of
`calibration` start. Source: Zhang 2000, "A flexible new technique for camera calibration".
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import alike, numbers, short
from backhoe.perception.camera.rotations import nearest_rotation, rotation_vector

FARTHEST = 1e6
"""Of a corner on its board [m], or in its picture [pixels]."""

_FLAT_VIEWS = 1e-7
"""The equations are singular when their two least singular values are so small together."""


def homography(plane: ArrayLike, pixels: ArrayLike) -> NDArray:
    """H with pixels = H plane, both homogeneous, by the normalised linear method.

    Args:
        plane: points of a plane in its own axes, shape (n, 2), n at least 4 [m].
        pixels: where they are seen without distortion, shape (n, 2) [pixels].

    Returns:
        Shape (3, 3) of any scale; its columns are K (r1, r2, t) of the plane's pose.

    Raises:
        ValueError: shapes, or fewer than four points.
    """
    plane = numbers(plane, "plane", ("n", 2), meaning="x, y of a plane [m]")
    pixels = numbers(pixels, "pixels", ("n", 2), meaning="columns and rows [pixels]")
    alike(plane=plane, pixels=pixels)
    if len(plane) < 4:
        raise ValueError(f"plane and pixels must be at least 4 points, got {len(plane)}")
    for name, points in (("plane", plane), ("pixels", pixels)):
        if np.abs(points).max() > FARTHEST or np.ptp(points, axis=0).max() < 1e-9:
            raise ValueError(
                f"{name} must be points apart from each other, within {FARTHEST:g}, got "
                f"{short(points)}"
            )
    (x, T), (y, S) = (_normalised(points) for points in (plane, pixels))
    none = np.zeros_like(x)
    rows = np.vstack([np.c_[x, none, -y[:, :1] * x], np.c_[none, x, -y[:, 1:2] * x]])
    H = np.linalg.svd(np.linalg.qr(rows, "r"))[2][8].reshape(3, 3)
    return np.linalg.solve(S, H @ T)


def intrinsic_matrix(H: NDArray, size: tuple[int, int]) -> NDArray:
    """K without skew from homographies: h1, h2 of each are orthonormal under B = K^-T K^-1.

    A strong lens and few views can leave B without a root; the principal point is then taken to be
    the picture's middle, which leaves two unknowns.

    Args:
        H: of each view, shape (views, 3, 3) of any scale.
        size: width and height of the pictures [pixels].

    Returns:
        K, shape (3, 3) [pixels].

    Raises:
        ValueError: views that do not tilt the board differently.
    """
    middle, half = (np.array(size) - 1) / 2, sum(size) / 2
    to_pixels = np.array([[half, 0, middle[0]], [0, half, middle[1]], [0, 0, 1]])
    H = np.linalg.solve(to_pixels, H)
    H = H / np.linalg.norm(H, axis=(1, 2), keepdims=True)
    rows = np.vstack([_products(H, 0, 1), _products(H, 0, 0) - _products(H, 1, 1)])
    _, sizes, V = np.linalg.svd(np.linalg.qr(rows, "r"))
    if sizes[3] > _FLAT_VIEWS * sizes[0]:
        A, C, D, E, F = V[4] * np.sign(V[4][0])
        if not (A > 0 and C > 0 and F > D * D / A + E * E / C):
            (A, C), D, E, F = np.linalg.lstsq(rows[:, :2], -rows[:, 4])[0], 0.0, 0.0, 1.0
        if A > 0 and C > 0:
            f = np.sqrt((F - D * D / A - E * E / C) / np.array([A, C]))
            return to_pixels @ [[f[0], 0, -D / A], [0, f[1], -E / C], [0, 0, 1]]
    raise ValueError(
        "image_points leave the camera open: tilt the board differently from view to view"
    )


def board_poses(board: NDArray, seen: NDArray, K: NDArray) -> NDArray:
    """The board's pose in each view, rotation vector and position, (views, 6) [rad, m]."""
    poses = []
    for view in seen:
        h = np.linalg.solve(K, homography(board[:, :2], view))
        h *= np.sign(h[2, 2]) * 2 / (np.linalg.norm(h[:, 0]) + np.linalg.norm(h[:, 1]))
        R = nearest_rotation(np.stack([h[:, 0], h[:, 1], np.cross(h[:, 0], h[:, 1])], axis=-1))
        poses.append(np.r_[rotation_vector(R), h[:, 2]])
    return np.array(poses)


def _normalised(points: NDArray) -> tuple[NDArray, NDArray]:
    middle, scale = points.mean(axis=0), points.std()
    T = np.array([[1, 0, -middle[0]], [0, 1, -middle[1]], [0, 0, scale]]) / scale
    return np.c_[points, np.ones(len(points))] @ T.T, T


def _products(H: NDArray, i: int, j: int) -> NDArray:
    """What h_i^T B h_j has of B's entries 11, 22, 13, 23 and 33, shape (views, 5)."""
    a, b = H[:, :, i].T, H[:, :, j].T
    mixed = [a[k] * b[2] + a[2] * b[k] for k in (0, 1)]
    return np.stack([a[0] * b[0], a[1] * b[1], *mixed, a[2] * b[2]], axis=-1)
