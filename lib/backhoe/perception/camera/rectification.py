"""Undistorted and rectified pictures: a map says where each new pixel is in the old picture.

Rectifying turns both cameras, each by half, until they look the same way, and then until their rows
run along the baseline (Bouguet's method): a point then lies in the same row of both pictures.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import instance, number, numbers, short
from backhoe.basics.named import shown_by_name
from backhoe.perception.camera.pinhole import Pinhole
from backhoe.perception.camera.rotations import rotation, rotation_vector


@shown_by_name
@dataclass(frozen=True)
class Pair:
    """Two cameras: p_right = R p_left + t, R (3, 3) [1], t (3,) [m].

    Raises:
        ValueError: R is no rotation, t is not finite or zero, or the pictures differ in size.
        TypeError: a camera that is none: an uncalibrated pair has no geometry.
    """

    left: Pinhole
    right: Pinhole
    R: NDArray
    t: NDArray

    def __post_init__(self) -> None:
        for name in ("left", "right"):
            instance(getattr(self, name), name, Pinhole, "calibrate the pair first")
        R = numbers(self.R, "R", (3, 3), meaning="a rotation")
        if np.abs(R @ R.T - np.eye(3)).max() > 1e-6 or np.linalg.det(R) < 0:
            raise ValueError(f"R must be a rotation, R R^T = 1 and det R = 1, got {R.tolist()}")
        t = numbers(self.t, "t", (3,), meaning="x, y, z [m]")
        number(float(np.linalg.norm(t)), "length of t", "m", above=0)
        if self.left.size != self.right.size:
            raise ValueError(
                f"left and right must take pictures of one size, got {self.left.size} and "
                f"{self.right.size}"
            )
        object.__setattr__(self, "R", R)
        object.__setattr__(self, "t", t)

    @property
    def baseline(self) -> float:
        """Distance between the cameras [m]."""
        return float(np.linalg.norm(self.t))


@dataclass(frozen=True)
class Rectified:
    """A pair made parallel: both cameras have K; R_left and R_right turn the old frames into the
    new ones, shape (3, 3) each; `baseline` [m]."""

    K: NDArray
    R_left: NDArray
    R_right: NDArray
    baseline: float

    @property
    def Q(self) -> NDArray:
        """(X, Y, Z, W) = Q (column, row, disparity, 1), point (X, Y, Z) / W; (4, 4) [m, 1/m]."""
        f, cx, cy = self.K[0, 0], self.K[0, 2], self.K[1, 2]
        return np.array(
            [[1, 0, 0, -cx], [0, 1, 0, -cy], [0, 0, 0, f], [0, 0, 1 / self.baseline, 0]]
        )


def rectify(pair: Pair) -> Rectified:
    """Make a horizontal pair parallel.

    Args:
        pair: with its right camera to the right of the left one.

    Returns:
        The new geometry; f is the mean of both cameras' fy, and the principal point keeps the
        middle of both pictures' corners in the middle, all as OpenCV's stereoRectify (zero
        disparity, alpha -1), but for its allowance for k1 in f.

    Raises:
        ValueError: the right camera is above, below or left of the left one.
        TypeError: a pair that is none.
    """
    instance(pair, "pair", Pair, "calibrate the pair first")
    half = rotation(rotation_vector(pair.R) / -2)
    t = half @ pair.t
    if not -t[0] > np.abs(t[1:]).max():
        raise ValueError(
            f"the right camera must be to the right of the left one, t about (-baseline, 0, 0), "
            f"got t = {pair.t.tolist()} m"
        )
    e = -t / np.linalg.norm(t)
    axis = np.cross(e, [1.0, 0.0, 0.0])
    sine = np.linalg.norm(axis)
    level = rotation(axis * (np.arctan2(sine, e[0]) / sine if sine > 0 else 1.0))
    R_left, R_right = level @ half.T, level @ half
    f = (pair.left.K[1, 1] + pair.right.K[1, 1]) / 2
    width, height = pair.left.size
    corners = np.array([[0, 0], [width - 1, 0], [0, height - 1], [width - 1, height - 1]], float)
    middles = []
    for camera, R in ((pair.left, R_left), (pair.right, R_right)):
        rays = np.c_[camera.undistort(corners), np.ones(4)] @ R.T
        middles.append((f * rays[:, :2] / rays[:, 2:]).mean(axis=0))
    cx, cy = np.array([width - 1, height - 1]) / 2 - np.mean(middles, axis=0)
    K = np.array([[f, 0, cx], [0, f, cy], [0, 0, 1]])
    return Rectified(K, R_left, R_right, pair.baseline)


def pixel_map(camera: Pinhole, R: ArrayLike | None = None, K: ArrayLike | None = None) -> NDArray:
    """Where each pixel of a new picture, undistorted and turned, is in the camera's picture.

    Args:
        camera: that took the picture.
        R: turns its frame into the new one, shape (3, 3) [1]; None for not at all.
        K: of the new picture, shape (3, 3) [pixels]; None for the camera's own.

    Returns:
        Columns and rows, shape (height, width, 2) [pixels]; NaN behind the camera.

    Raises:
        ValueError: shapes, or a K without inverse.
    """
    instance(camera, "camera", Pinhole)
    R = np.eye(3) if R is None else numbers(R, "R", (3, 3), meaning="a rotation")
    new = Pinhole(camera.K if K is None else K, camera.size)
    width, height = camera.size
    pixels = np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).astype(float)
    plane = new.undistort(pixels)
    return camera.project(np.concatenate([plane, np.ones((height, width, 1))], axis=-1) @ R)


def remap(image: NDArray, where: ArrayLike) -> NDArray:
    """The picture taken at other pixels, linear between the four around.

    Args:
        image: shape (rows, columns) or (rows, columns, 3) of any number type [grey levels].
        where: columns and rows, shape (..., 2) [pixels], such as a `pixel_map`.

    Returns:
        Shape (...) or (..., 3), of the picture's type, whole numbers rounded; 0, or NaN for floats,
        where it does not reach.

    Raises:
        ValueError: other shapes, or no numbers.
    """
    fits = isinstance(image, np.ndarray) and image.dtype.kind in "uif" and image.ndim in (2, 3)
    if not fits or min(image.shape[:2]) < 2:
        raise ValueError(
            f"image must have shape (rows, columns) or (rows, columns, 3), numbers, 2 rows and "
            f"columns or more, got {short(image)}"
        )
    where = numbers(where, "where", (..., 2), meaning="columns and rows [pixels]", finite=False)
    rows, columns = image.shape[:2]
    inside = ((where >= 0) & (where <= [columns - 1, rows - 1])).all(axis=-1)
    u, v = np.moveaxis(np.where(inside[..., None], where, 0.0), -1, 0)
    j, i = np.minimum(u.astype(int), columns - 2), np.minimum(v.astype(int), rows - 2)
    a, b = u - j, v - i
    if image.ndim == 3:
        a, b, inside = a[..., None], b[..., None], inside[..., None]
    upper = (1 - a) * image[i, j] + a * image[i, j + 1]
    lower = (1 - a) * image[i + 1, j] + a * image[i + 1, j + 1]
    value = (1 - b) * upper + b * lower
    if np.issubdtype(image.dtype, np.integer):
        return np.where(inside, np.rint(value), 0).astype(image.dtype)
    return np.where(inside, value, np.nan).astype(image.dtype)
