"""Calibration from pictures of a flat board, each corner of which is known.

From the closed form of `zhang` SciPy's least squares brings the distance between the corners seen
and projected to its minimum over everything, distortion included.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import alike, image_size, numbers, positive, whole
from backhoe.perception.camera.pinhole import Pinhole
from backhoe.perception.camera.rectification import Pair
from backhoe.perception.camera.rotations import nearest_rotation, rotation, rotation_vector
from backhoe.perception.camera.zhang import board_poses, homography, intrinsic_matrix

_FARTHEST = 1e6
"""Corner of a board from its origin [m]."""

_TRIES = 100
"""Of least squares, which a good set of pictures ends within 30."""

_STEP = 1e-6
"""Of central differences, a share of what they vary."""


@dataclass(frozen=True)
class Calibration:
    """One camera and where the board stood.

    Attributes:
        camera: with its distortion.
        rotations, positions: the board in the camera's frame, one a view, p = R board + t,
            shape (m, 3, 3) [1] and (m, 3) [m].
        rms: root of the mean squared distance between corners seen and projected [pixels].
        deviations: standard deviations of fx, fy, cx, cy [pixels] and k1, k2, p1, p2, k3 [1], from
            the residuals, shape (9,).
    """

    camera: Pinhole
    rotations: NDArray
    positions: NDArray
    rms: float
    deviations: NDArray


def calibrate(
    object_points: ArrayLike, image_points: ArrayLike, size: tuple[int, int]
) -> Calibration:
    """A camera's intrinsic matrix and distortion from several views of a flat board.

    Args:
        object_points: the board's corners, z = 0 all, shape (n, 3) [m].
        image_points: their pixels, the same corner at the same place, shape (views, n, 2) [pixels].
        size: width and height of the pictures [pixels].

    Returns:
        The camera, the board's poses, and how well they fit.

    Raises:
        ValueError: shapes, a board that is not flat, fewer than three views or four corners, a
            corner outside of its picture, or views that do not tilt the board differently.
    """
    board = _board(object_points)
    seen = _views(image_points, "image_points", board, size)
    try:
        K = intrinsic_matrix(np.stack([homography(board[:, :2], view) for view in seen]), size)
        guess = board_poses(board, seen, K)
    except np.linalg.LinAlgError as error:
        raise ValueError(
            "object_points and image_points leave the camera open: corners must not fall together"
        ) from error
    start = np.r_[K[0, 0], K[1, 1], K[0, 2], K[1, 2], np.zeros(5), guess.ravel()]

    def errors(x: NDArray) -> NDArray:
        pixels = _projected(x[:9], _placed(board, x[9:].reshape(-1, 6)))
        return (pixels - seen).reshape(len(seen), -1)

    x, residuals, P = _least_squares(errors, start, 9)
    poses = x[9:].reshape(-1, 6)
    return Calibration(
        _camera(x[:9], size),
        rotation(poses[:, :3]),
        poses[:, 3:],
        _rms(residuals),
        np.sqrt(np.diag(P)[:9]),
    )


def calibrate_pair(
    object_points: ArrayLike,
    left_points: ArrayLike,
    right_points: ArrayLike,
    size: tuple[int, int],
) -> tuple[Pair, float]:
    """Two cameras that look at the same board: each alone, then how they stand to each other.

    Args:
        object_points, size: as for `calibrate`.
        left_points, right_points: pixels of the same views in both, (views, n, 2) [pixels].

    Returns:
        The pair, and the root of the mean squared distance of all corners [pixels].

    Raises:
        ValueError: as for `calibrate`, or the two differ in their number of views.
    """
    board = _board(object_points)
    left = _views(left_points, "left_points", board, size)
    right = _views(right_points, "right_points", board, size)
    alike(left_points=left, right_points=right)
    one, other = (calibrate(board, points, size) for points in (left, right))
    between = other.rotations @ np.swapaxes(one.rotations, 1, 2)
    R = nearest_rotation(between.sum(axis=0))
    t = np.median(other.positions - one.positions @ R.T, axis=0)
    poses = [
        np.r_[rotation_vector(R), t] for R, t in zip(one.rotations, one.positions, strict=True)
    ]
    numbers_of = [_numbers(found.camera) for found in (one, other)]

    def errors(x: NDArray) -> NDArray:
        points = _placed(board, x[6:].reshape(-1, 6))
        turned = points @ rotation(x[:3]).T + x[3:6]
        both = _projected(numbers_of[0], points) - left, _projected(numbers_of[1], turned) - right
        return np.concatenate(both, axis=1).reshape(len(left), -1)

    x, residuals, _ = _least_squares(errors, np.r_[rotation_vector(R), t, np.ravel(poses)], 6)
    return Pair(one.camera, other.camera, rotation(x[:3]), x[3:6]), _rms(residuals)


def chessboard(columns: int, rows: int, square: float) -> NDArray:
    """Inner corners of a chessboard by rows, shape (rows * columns, 3), a `square` apart [m]."""
    columns = whole(columns, "columns", least=2, most=1000)
    rows = whole(rows, "rows", least=2, most=1000)
    i, j = np.divmod(np.arange(rows * columns), columns)
    return np.stack([j, i, 0 * i], axis=-1) * positive(square, "square", "m")


def _board(points: ArrayLike) -> NDArray:
    board = numbers(
        points, "object_points", ("n", 3), meaning="corners x, y, z [m]", within=_FARTHEST
    )
    if board[:, 2].any():
        raise ValueError("object_points must lie in the plane z = 0: a flat board's own frame")
    if len(board) < 4 or np.linalg.matrix_rank(board[:, :2] - board[0, :2]) < 2:
        raise ValueError(
            f"object_points must be 4 corners or more, not in a line, got {len(board)}"
        )
    return board


def _views(points: ArrayLike, name: str, board: NDArray, size: tuple[int, int]) -> NDArray:
    width, height = image_size(size)
    listed = points if isinstance(points, list | tuple) else ()
    if lost := [view for view, found in enumerate(listed) if found is None]:
        raise ValueError(f"{name}: no board in view {lost[0]}: leave out views without a whole one")
    meaning = f"pixels of {len(board)} corners in each view"
    seen = numbers(points, name, ("views", len(board), 2), meaning=meaning)
    together = np.ptp(seen, axis=1).max(axis=1) < 1e-9
    if together.any():
        raise ValueError(
            f"{name}: all corners of view {together.argmax()} fall together, got {seen}"
        )
    if len(seen) < 3:
        raise ValueError(f"{name} must have 3 views or more, got {len(seen)}")
    outside = ((seen < -0.5) | (seen > [width - 0.5, height - 0.5])).any(axis=-1)
    if outside.any():
        view, corner = np.argwhere(outside)[0].tolist()
        raise ValueError(
            f"{name}: in view {view} corner {corner} at {seen[view, corner].tolist()} is outside "
            f"of a picture of {width} x {height}: leave out views that show a part of the board"
        )
    return seen


def _placed(board: NDArray, poses: NDArray) -> NDArray:
    """Corners in the camera's frame, (views, n, 3) [m]."""
    return board @ np.swapaxes(rotation(poses[:, :3]), 1, 2) + poses[:, None, 3:]


def _numbers(camera: Pinhole) -> NDArray:
    K = camera.K
    return np.r_[K[0, 0], K[1, 1], K[0, 2], K[1, 2], camera.distortion]


def _camera(x: NDArray, size: tuple[int, int]) -> Pinhole:
    return Pinhole([[x[0], 0, x[2]], [0, x[1], x[3]], [0, 0, 1]], size, x[4:])


def _projected(x: NDArray, points: NDArray) -> NDArray:
    plane = points[..., :2] / points[..., 2:]
    return Pinhole(np.eye(3), (1, 1), x[4:9]).distort(plane) * x[:2] + x[2:4]


def _least_squares(
    errors: Callable[[NDArray], NDArray], start: NDArray, shared: int
) -> tuple[NDArray, NDArray, NDArray]:
    """The minimum from `start`, the errors there, and the covariance of what was found.

    `errors` gives a row a view; the first `shared` numbers count in all, then six in each one's.
    A view's pose moves no other's corners, so one central difference serves a number of all poses.
    """
    from scipy.optimize import least_squares

    views, each = errors(start).shape

    def slope(x: NDArray, at: NDArray) -> NDArray:
        step = np.zeros_like(x)
        step[at] = _STEP * np.maximum(np.abs(x[at]), 1.0)
        change = (errors(x + step) - errors(x - step)) / 2
        return change / (step[at] if len(at) == 1 else step[at][:, None])

    def jacobian(x: NDArray) -> NDArray:
        J = np.zeros((views, each, len(x)))
        for i in range(shared):
            J[:, :, i] = slope(x, np.array([i]))
        for i in range(6):
            at = shared + i + 6 * np.arange(views)
            J[np.arange(views), :, at] = slope(x, at)
        return J.reshape(-1, len(x))

    found = least_squares(
        lambda x: errors(x).ravel(),
        start,
        jacobian,
        method="lm",
        x_scale="jac",
        xtol=1e-12,
        ftol=1e-12,
        max_nfev=_TRIES,
    )
    if found.status == 0:
        raise ValueError(
            f"object_points and image_points must be of one board: no camera fits after {_TRIES} "
            f"tries, the corners still {_rms(found.fun):.3g} pixels apart"
        )
    J, scale = found.jac, np.linalg.norm(found.jac, axis=0)
    left = max(J.shape[0] - J.shape[1], 1)
    P = np.linalg.inv((J / scale).T @ (J / scale)) / np.outer(scale, scale)
    return found.x, found.fun, P * (2 * found.cost / left)


def _rms(residuals: NDArray) -> float:
    return float(np.sqrt(2 * np.mean(residuals**2)))
