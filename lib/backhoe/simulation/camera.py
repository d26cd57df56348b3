"""A pinhole camera: from the world to the picture and, with the depth buffer, back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Camera:
    """View and lens matrices (4, 4) as OpenGL has them; a picture of `shape` (rows, columns)."""

    view: NDArray
    lens: NDArray
    shape: tuple[int, int]
    near: float
    far: float

    @classmethod
    def at(
        cls,
        eye: ArrayLike,
        target: ArrayLike,
        field_of_view: float,
        shape: tuple[int, int],
        near: float,
        far: float,
    ) -> Camera:
        """Looking from `eye` to `target`, upright; the field of view is the vertical one [rad]."""
        eye, target = np.asarray(eye, float), np.asarray(target, float)
        back = (eye - target) / np.linalg.norm(eye - target)
        right = np.cross([0.0, 0.0, 1.0], back)
        right /= np.linalg.norm(right)
        view = np.eye(4)
        view[:3, :3] = np.stack([right, np.cross(back, right), back])
        view[:3, 3] = -view[:3, :3] @ eye
        f = 1 / np.tan(field_of_view / 2)
        lens = np.zeros((4, 4))
        lens[0, 0], lens[1, 1] = f * shape[0] / shape[1], f
        lens[2, 2:] = (far + near) / (near - far), 2 * far * near / (near - far)
        lens[3, 2] = -1.0
        return cls(view, lens, shape, near, far)

    def distance(self, depth: NDArray) -> NDArray:
        """Distance along the line of sight [m] from the depth buffer."""
        return self.far * self.near / (self.far - (self.far - self.near) * depth)

    def unproject(self, depth: NDArray) -> NDArray:
        """World points of all pixels, shape (rows, columns, 3) [m]."""
        rows, columns = self.shape
        ahead = self.distance(depth)
        x = ((np.arange(columns) + 0.5) / columns * 2 - 1) / self.lens[0, 0] * ahead
        y = -((np.arange(rows) + 0.5) / rows * 2 - 1)[:, None] / self.lens[1, 1] * ahead
        seen = np.stack([x, y, -ahead], axis=-1) - self.view[:3, 3]
        return seen @ self.view[:3, :3]

    def project(self, points: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Row and column of each point and its distance along the line of sight [m]."""
        rows, columns = self.shape
        seen = points @ self.view[:3, :3].T + self.view[:3, 3]
        ahead = -seen[..., 2]
        column = (seen[..., 0] / ahead * self.lens[0, 0] + 1) / 2 * columns
        row = (1 - seen[..., 1] / ahead * self.lens[1, 1]) / 2 * rows
        return np.floor(row).astype(int), np.floor(column).astype(int), ahead
