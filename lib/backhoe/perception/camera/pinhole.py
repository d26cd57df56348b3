"""A pinhole camera with a real lens: from points to pixels and from pixels to rays.

The camera's frame has x right, y down and z ahead; a pixel is (column, row) with (0, 0) the middle
of the first. The lens is Brown's (1966), in the order of OpenCV: k1, k2, p1, p2, k3, radial k and
tangential p, on x = X / Z, y = Y / Z and r^2 = x^2 + y^2:

    x_d = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
    y_d = y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import image_size, number, numbers

_NEWTON_STEPS = 30
_CONVERGED = 1e-12


@dataclass(frozen=True)
class Pinhole:
    """The numbers of one camera.

    Attributes:
        K: intrinsic matrix [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], shape (3, 3) [pixels].
        size: width and height of its pictures [pixels].
        distortion: k1, k2, p1, p2, k3, shape (5,) [1]; none by default.

    Raises:
        ValueError: K of another form, a size below 1, or another number of coefficients.
    """

    K: NDArray
    size: tuple[int, int]
    distortion: NDArray = field(default_factory=lambda: np.zeros(5))

    def __post_init__(self) -> None:
        K = numbers(self.K, "K", (3, 3), meaning="an intrinsic matrix [pixels]")
        form = np.array([[K[0, 0], 0, K[0, 2]], [0, K[1, 1], K[1, 2]], [0, 0, 1]])
        if not (K == form).all() or min(K[0, 0], K[1, 1]) <= 0:
            raise ValueError(
                f"K must be [[fx, 0, cx], [0, fy, cy], [0, 0, 1]], fx, fy > 0, got {K.tolist()}"
            )
        size = image_size(self.size)
        meaning = "coefficients k1, k2, p1, p2, k3"
        D = numbers(self.distortion, "distortion", (5,), meaning=meaning)
        for name, value in (("K", K), ("size", size), ("distortion", D)):
            object.__setattr__(self, name, value)

    @classmethod
    def of_view(cls, size: tuple[int, int], field_of_view: float) -> Pinhole:
        """A camera without distortion that sees `field_of_view` from left to right [rad].

        `size` is width and height [pixels]; the optical axis goes through the picture's middle.

        Raises:
            ValueError: a size, or an angle that is not from 1e-6 to below pi.
        """
        angle = number(field_of_view, "field_of_view", "rad", least=1e-6, below=np.pi)
        width, height = image_size(size)
        f = width / 2 / np.tan(angle / 2)
        return cls([[f, 0, (width - 1) / 2], [0, f, (height - 1) / 2], [0, 0, 1]], size)

    def project(self, points: ArrayLike) -> NDArray:
        """Pixels of points in the camera's frame.

        Args:
            points: shape (..., 3) [m].

        Returns:
            Columns and rows, shape (..., 2) [pixels]; NaN for a point that is not ahead.

        Raises:
            ValueError: another shape, or a value that is not finite.
        """
        points = numbers(points, "points", (..., 3), meaning="coordinates x, y, z [m]")
        z = points[..., 2:]
        plane = np.divide(
            points[..., :2], z, out=np.full_like(points[..., :2], np.nan), where=z > 0
        )
        return self.distort(plane) @ self.K[:2, :2] + self.K[:2, 2]

    def distort(self, plane: ArrayLike) -> NDArray:
        """Where the lens puts points of the plane z = 1, both of shape (..., 2) [1]."""
        plane = numbers(plane, "plane", (..., 2), meaning="coordinates x / z, y / z", finite=False)
        return _distorted(plane, self.distortion)

    def undistort(self, pixels: ArrayLike) -> NDArray:
        """Directions of pixels: the inverse of `project`, by Newton's method.

        Args:
            pixels: columns and rows, shape (..., 2) [pixels].

        Returns:
            Points of the plane z = 1, shape (..., 2) [1]; NaN where the lens has no inverse.

        Raises:
            ValueError: another shape, or a value that is not finite.
        """
        pixels = numbers(pixels, "pixels", (..., 2), meaning="columns and rows [pixels]")
        wanted = (pixels - self.K[:2, 2]) / self.K[[0, 1], [0, 1]]
        plane = wanted.copy()
        if not self.distortion.any():
            return plane
        with np.errstate(all="ignore"):
            for _ in range(_NEWTON_STEPS):
                left = wanted - _distorted(plane, self.distortion)
                if np.nanmax(np.abs(left), initial=0) < _CONVERGED:
                    break
                (a, b), (_, c) = _slopes(plane, self.distortion)
                determinant = a * c - b * b
                plane[..., 0] += (c * left[..., 0] - b * left[..., 1]) / determinant
                plane[..., 1] += (a * left[..., 1] - b * left[..., 0]) / determinant
            missed = np.abs(wanted - _distorted(plane, self.distortion)).max(axis=-1)
            (a, b), (_, c) = _slopes(plane, self.distortion)
            found = (missed < 1e-9) & (a > 0) & (a * c > b * b)
        plane[~found] = np.nan
        return plane


def _distorted(plane: NDArray, distortion: NDArray) -> NDArray:
    k1, k2, p1, p2, k3 = distortion
    x, y = plane[..., 0], plane[..., 1]
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return np.stack(
        [
            x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
        ],
        axis=-1,
    )


def _slopes(plane: NDArray, distortion: NDArray) -> tuple[tuple, tuple]:
    """The Jacobian of `_distorted`, which is symmetric: rows ((a, b), (b, c))."""
    k1, k2, p1, p2, k3 = distortion
    x, y = plane[..., 0], plane[..., 1]
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    growth = 2 * (k1 + r2 * (2 * k2 + 3 * r2 * k3))
    a = radial + x * x * growth + 2 * p1 * y + 6 * p2 * x
    b = x * y * growth + 2 * p1 * x + 2 * p2 * y
    c = radial + y * y * growth + 6 * p1 * y + 2 * p2 * x
    return (a, b), (b, c)
