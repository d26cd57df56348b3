"""The size of a symmetric bilinear map, such as (x, y) -> C(q, x) y.

For B(x, y)_k = x^T B_k y with symmetric B_k the largest ||B(x, y)|| over unit x and y is reached at
y = x or y = -x: for a fixed unit z, z^T B(x, y) is a quadratic form whose largest value is an
eigenvalue. It is found from several starts by turns (x from z by an eigenvector, z from x), which
never goes down, and then by Newton's method on the sphere.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["bilinear_norm", "bilinear_value", "by_turns", "unfolded_bound"]

_TURNS = 5
_NEWTON = 6
_STARTS = 3


def bilinear_value(B: NDArray, x: NDArray) -> NDArray:
    """B(x, x), shape (..., m), for B (..., m, n, n) and x (..., n)."""
    Bx = (B @ x[..., None, :, None])[..., 0]
    return (Bx * x[..., None, :]).sum(axis=-1)


def unfolded_bound(B: NDArray) -> NDArray:
    """A bound from above: the spectral norm of B unfolded to a matrix (m, n n), shape (...)."""
    flat = B.reshape(*B.shape[:-2], -1)
    return np.sqrt(np.linalg.eigvalsh(flat @ np.swapaxes(flat, -1, -2))[..., -1])


def bilinear_norm(B: NDArray) -> tuple[NDArray, NDArray]:
    """Largest ||B(x, y)|| over unit x and y.

    Args:
        B: symmetric matrices, shape (..., m, n, n).

    Returns:
        The norm (...) and a unit x (..., n) with ||B(x, x)|| equal to it.
    """
    zero = np.zeros((*B.shape[:-3], *B.shape[-2:]))
    best = np.full(B.shape[:-3], -1.0)
    vector = np.zeros((*B.shape[:-3], B.shape[-1]))
    for start in _starts(B):
        x = _newton(B, by_turns(zero, B, start))
        size = np.linalg.norm(bilinear_value(B, x), axis=-1)
        better = size > best
        best = np.where(better, size, best)
        vector = np.where(better[..., None], x, vector)
    return best, vector


def by_turns(A: NDArray, B: NDArray, z: NDArray) -> NDArray:
    """A unit x that makes |x^T A x| + ||B(x, x)|| large, going uphill from the direction z.

    Args:
        A: symmetric positive semidefinite, shape (..., n, n); B: shape (..., m, n, n).
        z: unit vector to start from, shape (..., m).
    """
    for _ in range(_TURNS):
        bent = A + np.einsum("...k,...kij->...ij", z, B)
        values, vectors = np.linalg.eigh(bent)
        last = B.shape[-1] - 1
        widest = np.where(np.abs(values[..., 0]) > np.abs(values[..., -1]), 0, last)
        x = np.take_along_axis(vectors, widest[..., None, None], axis=-1)[..., 0]
        z = _unit(bilinear_value(B, x))
    return x


def _starts(B: NDArray) -> list[NDArray]:
    """The directions in which B is widest on average, widest first."""
    flat = B.reshape(*B.shape[:-2], -1)
    directions = np.linalg.eigh(flat @ np.swapaxes(flat, -1, -2))[1]
    return [directions[..., -1 - i] for i in range(min(_STARTS, B.shape[-3]))]


def _newton(B: NDArray, x: NDArray) -> NDArray:
    """Maximise ||B(x, x)||^2 / 2 on the sphere, keeping every step that goes uphill."""
    identity = np.eye(x.shape[-1])
    for _ in range(_NEWTON):
        b = bilinear_value(B, x)
        bent = np.einsum("...k,...kij->...ij", b, B)
        Bx = (B @ x[..., None, :, None])[..., 0]
        slope = 2 * (bent @ x[..., None])[..., 0]
        twice = (slope * x).sum(axis=-1)
        flat = identity - x[..., :, None] * x[..., None, :]
        curved = 2 * bent + 4 * np.swapaxes(Bx, -1, -2) @ Bx - twice[..., None, None] * identity
        values, vectors = np.linalg.eigh(flat @ curved @ flat)
        steep = np.maximum(np.abs(values), 1e-9 * np.maximum(twice, 1e-300)[..., None])
        pull = (np.swapaxes(vectors, -1, -2) @ (flat @ slope[..., None]))[..., 0] / steep
        tried = _unit(x + (vectors @ pull[..., None])[..., 0])
        higher = np.linalg.norm(bilinear_value(B, tried), axis=-1) > np.linalg.norm(b, axis=-1)
        x = np.where(higher[..., None], tried, x)
    return x


def _unit(x: NDArray) -> NDArray:
    """x at length 1; a zero becomes the first axis."""
    length = np.linalg.norm(x, axis=-1, keepdims=True)
    first = np.eye(x.shape[-1])[0]
    return np.where(length > 0, x / np.where(length > 0, length, 1.0), first)
