"""Two views of one point: the epipolar constraint, and the point from both.

R and t place the left camera's frame in the right one: p_right = R p_left + t. A left point x and
the right one x' of the plane z = 1 then obey x'^T E x = 0 with E = [t]x R (Longuet-Higgins 1981);
for pixels it is F = K'^-T E K^-1. Source: Hartley and Zisserman, Multiple View Geometry (2nd ed.).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import alike, instance, numbers
from backhoe.perception.camera.pinhole import Pinhole


def cross_matrix(t: ArrayLike) -> NDArray:
    """[t]x, shape (3, 3), with [t]x p = t x p; t (3,) of any unit."""
    x, y, z = numbers(t, "t", (3,), meaning="x, y, z")
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def essential_matrix(R: ArrayLike, t: ArrayLike) -> NDArray:
    """E = [t]x R of two views, shape (3, 3) [m], from R (3, 3) [1] and t (3,) [m]."""
    return cross_matrix(t) @ numbers(R, "R", (3, 3), meaning="a rotation")


def fundamental_matrix(left: Pinhole, right: Pinhole, R: ArrayLike, t: ArrayLike) -> NDArray:
    """F = K'^-T E K^-1 of two cameras without distortion, shape (3, 3) of norm 1 [1].

    R (3, 3) [1] and t (3,) [m] as in `essential_matrix`.
    """
    for name, lens in (("left", left), ("right", right)):
        instance(lens, name, Pinhole)
    F = np.linalg.inv(right.K).T @ essential_matrix(R, t) @ np.linalg.inv(left.K)
    return F / np.linalg.norm(F)


def eight_points(left: ArrayLike, right: ArrayLike) -> NDArray:
    """The fundamental matrix of matched pixels, by the normalised eight-point algorithm.

    Source: Hartley 1997, "In defense of the eight-point algorithm".

    Args:
        left, right: the same points in both pictures, shape (n, 2), n at least 8 [pixels].

    Returns:
        F of rank 2, shape (3, 3) of norm 1 [1]: right^T F left = 0.

    Raises:
        ValueError: shapes, fewer than eight points, or points that leave F open, as of one plane.
    """
    left = numbers(left, "left", ("n", 2), meaning="columns and rows [pixels]")
    right = numbers(right, "right", ("n", 2), meaning="columns and rows [pixels]")
    alike(left=left, right=right)
    if len(left) < 8:
        raise ValueError(f"left and right must be at least 8 points, got {len(left)}")
    (x, T), (y, S) = _normalised(left), _normalised(right)
    rows = (y[:, :, None] * x[:, None, :]).reshape(len(x), 9)
    _, sizes, V = np.linalg.svd(np.linalg.qr(rows, "r"))
    if sizes[7] < 1e-9 * sizes[0]:
        raise ValueError("the points leave F open: they lie in one plane, or there are too few")
    U, D, W = np.linalg.svd(V[8].reshape(3, 3))
    F = S.T @ (U * [D[0], D[1], 0.0]) @ W @ T
    return F / np.linalg.norm(F)


def epipolar_lines(F: ArrayLike, pixels: ArrayLike) -> NDArray:
    """Lines a u + b v + c = 0 of the right picture on which left pixels must lie.

    Args:
        F: fundamental matrix, shape (3, 3) [1]; its transpose for the other way.
        pixels: shape (..., 2) [pixels].

    Returns:
        a, b, c with a^2 + b^2 = 1, shape (..., 3): a u + b v + c is a distance [pixels].
    """
    pixels = numbers(pixels, "pixels", (..., 2), meaning="columns and rows [pixels]")
    lines = _homogeneous(pixels) @ numbers(F, "F", (3, 3)).T
    return lines / np.linalg.norm(lines[..., :2], axis=-1, keepdims=True)


def relative_pose(E: ArrayLike, left: ArrayLike, right: ArrayLike) -> tuple[NDArray, NDArray]:
    """Rotation and direction between two views: of the four that E allows, the one with the
    points ahead of both cameras.

    Args:
        E: essential matrix, shape (3, 3), of any scale.
        left, right: matched points of the plane z = 1, shape (n, 2) [1].

    Returns:
        R (3, 3) [1] and t (3,) of length 1 [own unit: E has no scale].

    Raises:
        ValueError: shapes, or no pose has a point ahead of both.
    """
    left, right = (
        numbers(x, name, ("n", 2), meaning="points of the plane z = 1")
        for name, x in (("left", left), ("right", right))
    )
    U, _, V = np.linalg.svd(numbers(E, "E", (3, 3)))
    U, V = U * np.linalg.det(U), V * np.linalg.det(V)
    W = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    poses = [(U @ turn @ V, sign * U[:, 2]) for turn in (W, W.T) for sign in (1, -1)]
    ahead = [_ahead(R, t, triangulate(left, right, R, t)) for R, t in poses]
    if not max(ahead):
        raise ValueError("no pose has the points ahead of both cameras: is E of these points?")
    return poses[int(np.argmax(ahead))]


def triangulate(left: ArrayLike, right: ArrayLike, R: ArrayLike, t: ArrayLike) -> NDArray:
    """Points from two views by the linear method (Hartley and Zisserman, section 12.2).

    Args:
        left, right: the same points, undistorted, in the plane z = 1, shape (..., 2) [1].
        R, t: p_right = R p_left + t, shape (3, 3) [1] and (3,) [m].

    Returns:
        Points in the left camera's frame, shape (..., 3) [m]; NaN where the rays are parallel.

    Raises:
        ValueError: shapes, or values that are not finite.
    """
    left = numbers(left, "left", (..., 2), meaning="coordinates x / z, y / z")
    right = numbers(right, "right", (..., 2), meaning="coordinates x / z, y / z")
    alike(left=left, right=right)
    t = numbers(t, "t", (3,), meaning="x, y, z [m]")
    P = np.c_[numbers(R, "R", (3, 3), meaning="a rotation"), t]
    first = np.eye(3, 4)
    rows = [
        x[..., i : i + 1] * view[2] - view[i]
        for x, view in ((left, first), (right, P))
        for i in (0, 1)
    ]
    _, _, V = np.linalg.svd(np.stack(rows, axis=-2))
    X = V[..., 3, :]
    w = X[..., 3:]
    near = np.abs(w) > 1e-12 * np.linalg.norm(X, axis=-1, keepdims=True) / max(1, np.linalg.norm(t))
    return np.divide(X[..., :3], w, out=np.full(X[..., :3].shape, np.nan), where=near)


def _ahead(R: NDArray, t: NDArray, points: NDArray) -> int:
    return int(((points[:, 2] > 0) & ((points @ R.T + t)[:, 2] > 0)).sum())


def _homogeneous(points: NDArray) -> NDArray:
    return np.concatenate([points, np.ones((*points.shape[:-1], 1))], axis=-1)


def _normalised(pixels: NDArray) -> tuple[NDArray, NDArray]:
    """Homogeneous pixels about their mean, sqrt(2) away on average, and what made them so."""
    middle = pixels.mean(axis=0)
    distance = np.linalg.norm(pixels - middle, axis=1).mean()
    s = np.sqrt(2) / distance if distance > 0 else 1.0
    T = np.array([[s, 0, -s * middle[0]], [0, s, -s * middle[1]], [0, 0, 1]])
    return _homogeneous(pixels) @ T.T, T
