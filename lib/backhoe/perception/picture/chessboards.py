"""Pictures of a chessboard in many poses: what a camera is calibrated with.

A sensor's pixel gathers light over its area. So a pixel at an edge of a square or of the board is
the mean over `fine` x `fine` rays: with one ray a pixel, edges would be stairs.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import instance, numbers, picture, pose, positive, whole
from backhoe.perception.camera import Pinhole

BLACK, WHITE, GREY = 30.0, 220.0, 110
"""Of the squares, of the squares and the margin, and of what is behind the board [grey levels]."""


def chessboard_pictures(
    camera: Pinhole,
    poses: ArrayLike,
    columns: int,
    rows: int,
    square: float,
    behind: NDArray | None = None,
    fine: int = 3,
) -> NDArray:
    """A board of known size as a camera sees it; the lens's distortion included.

    Args:
        camera: its lens and size.
        poses: of the board in the camera's frame, shape (views, 4, 4) [m]; the board's frame is
            that of `camera.chessboard`: its first inner corner, x along the columns, y along the
            rows. The square before the first corner is black.
        columns, rows: of inner corners; around them is a whole square more, then a white margin of
            one square.
        square: side of a square [m].
        behind: picture without the board, shape (height, width), uint8; grey for None.
        fine: rays along each side of a pixel at an edge.

    Returns:
        Shape (views, height, width), uint8 [grey levels].

    Raises:
        ValueError: shapes, a number out of range, or a picture behind of another size.
        TypeError: a camera that is none.
    """
    from scipy.ndimage import maximum_filter, minimum_filter

    width, height = instance(camera, "camera", Pinhole).size
    poses = pose(numbers(poses, "poses", ("views", 4, 4), meaning="poses of the board"), "poses")
    edge_on = np.abs(np.einsum("vi,vi->v", poses[:, :3, 2], poses[:, :3, 3])) < 1e-9
    if edge_on.any():
        raise ValueError(f"poses must show the board's face, view {edge_on.argmax()} its edge")
    columns, rows = whole(columns, "columns", least=2), whole(rows, "rows", least=2)
    square, fine = positive(square, "square", "m"), whole(fine, "fine", least=1, most=16)
    if behind is None:
        behind = np.full((height, width), GREY, dtype=np.uint8)
    if picture(behind, "behind").shape != (height, width):
        raise ValueError(f"behind must be {width} x {height} pixels, got shape {behind.shape}")
    pixels = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).astype(float)
    ray = camera.undistort(pixels)
    across, down = np.gradient(ray, axis=1), np.gradient(ray, axis=0)
    step = (np.arange(fine) + 0.5) / fine - 0.5
    parts = [(a, b) for a in step for b in step]
    pictures = []
    for T in poses:
        kind = _kind(ray, T, columns, rows, square)
        rim = maximum_filter(kind, 3) != minimum_filter(kind, 3)
        light = np.choose(kind, [behind, WHITE, BLACK])
        there, right, below = ray[rim], across[rim], down[rim]
        planes = [there + a * right + b * below for a, b in parts]
        kinds = np.array([_kind(plane, T, columns, rows, square) for plane in planes])
        light[rim] = np.choose(kinds, [behind[rim], WHITE, BLACK]).mean(axis=0)
        pictures.append(np.rint(light))
    return np.array(pictures).astype(np.uint8)


def _kind(ray: NDArray, T: NDArray, columns: int, rows: int, square: float) -> NDArray:
    """What rays (..., 2) meet: 0 nothing, 1 the board where it is white, 2 where it is black.

    Where they meet it is the inverse of the homography of its pose, here in squares.
    """
    H = np.linalg.inv(T[:3, [0, 1, 3]] * [square, square, 1.0])
    X = ray @ H[:, :2].T + H[:, 2]
    ahead = X[..., 2:] > 0
    place = np.divide(X[..., :2], X[..., 2:], out=np.full_like(ray, np.nan), where=ahead)
    on = ((place > -2) & (place < [columns + 1, rows + 1])).all(axis=-1)
    ruled = ((place > -1) & (place < [columns, rows])).all(axis=-1)
    squares = np.floor(np.where(ruled[..., None], place, 0.0)).sum(axis=-1)
    return on.astype(int) + (ruled & (squares % 2 == 0))
