"""Rotations as vectors: the axis times the angle (Rodrigues)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers


def rotation(vector: ArrayLike) -> NDArray:
    """Rotation matrices (..., 3, 3) [1] of axes times angles (..., 3) [rad]."""
    v = numbers(vector, "vector", (..., 3), meaning="coordinates, axis times angle [rad]")
    angle = np.linalg.norm(v, axis=-1)[..., None, None]
    x, y, z, none = v[..., 0], v[..., 1], v[..., 2], np.zeros(v.shape[:-1])
    V = np.stack([none, -z, y, z, none, -x, -y, x, none], axis=-1).reshape(*v.shape[:-1], 3, 3)
    return np.eye(3) + np.sinc(angle / np.pi) * V + np.sinc(angle / 2 / np.pi) ** 2 / 2 * V @ V


def rotation_vector(R: ArrayLike) -> NDArray:
    """Axis times angle (3,) [rad], up to pi long, of one rotation matrix (3, 3) [1]."""
    R = numbers(R, "R", (3, 3), meaning="a rotation")
    s = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
    sine, cosine = np.linalg.norm(s), (np.trace(R) - 1) / 2
    angle = np.arctan2(sine, cosine)
    if sine > 1e-6:
        return s * (angle / sine)
    if cosine > 0:
        return s
    squares = (R + R.T) / 4 + np.eye(3) / 2
    axis = squares[np.argmax(np.diag(squares))]
    return axis * (angle / np.linalg.norm(axis)) * (1.0 if axis @ s >= 0 else -1.0)


def nearest_rotation(M: NDArray) -> NDArray:
    """The rotation nearest to M, (3, 3) of any unit, with det 1."""
    U, _, V = np.linalg.svd(M)
    return U @ np.diag([1.0, 1.0, np.linalg.det(U @ V)]) @ V
