"""The size of a symmetric bilinear map, such as (x, y) -> C(q, x) y.

For B(x, y)_k = x^T B_k y with symmetric B_k the largest ||B(x, y)|| over unit x and y is reached at
y = x or y = -x: for a fixed unit z, z^T B(x, y) is a quadratic form whose largest value is an
eigenvalue. It is found from several starts by turns (x from z by an eigenvector, z from x), which
never goes down, and then by Newton's method on the sphere.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

_TURNS = 5
_NEWTON = 6
_STARTS = 2


def bilinear_value(B: NDArray, x: NDArray) -> NDArray:
    """B(x, x), shape (..., m), for B (..., m, n, n) and x (..., n)."""
    Bx = (B @ x[..., None, :, None])[..., 0]
    return (Bx * x[..., None, :]).sum(axis=-1)


def unfolded_bound(B: NDArray) -> NDArray:
    """A bound from above: the spectral norm of B unfolded to a matrix (m, n n), shape (...)."""
    flat = B.reshape(*B.shape[:-2], B.shape[-2] * B.shape[-1])
    return np.sqrt(np.linalg.eigvalsh(flat @ np.swapaxes(flat, -1, -2))[..., -1])


def bilinear_norm(B: NDArray) -> tuple[NDArray, NDArray]:
    """Largest ||B(x, y)|| over unit x and y.

    Args:
        B: symmetric matrices, shape (..., m, n, n).

    Returns:
        The norm (...) and a unit x (..., n) with ||B(x, x)|| equal to it.
    """
    return _best_of_starts(
        lambda start: _newton(B, by_turns(np.zeros(B.shape[-2:]), B, start)[1]), B
    )


def widest(A: NDArray, B: NDArray) -> tuple[NDArray, NDArray]:
    """About the largest x^T A x + ||B(x, x)|| over unit x; `by_turns` improves it.

    Args:
        A: symmetric positive semidefinite, shape (..., n, n); B: symmetric, shape (..., m, n, n).

    Returns:
        The value (...) and the unit x (..., n) that has it.
    """
    return _best_of_starts(lambda start: by_turns(A, B, start), B)


def by_turns(A: NDArray, B: NDArray, x: NDArray, turns: int = _TURNS) -> tuple[NDArray, NDArray]:
    """Go uphill on x^T A x + ||B(x, x)||, never down.

    Args:
        A, B: as for `widest`.
        x: unit vectors to start from, shape (..., n).
        turns: number of steps.

    Returns:
        The value (...) and the unit x (..., n).
    """
    last = B.shape[-1] - 1
    b = bilinear_value(B, x)
    for _ in range(turns):
        bent = A + np.einsum("...k,...kij->...ij", _unit(b), B)
        values, vectors = np.linalg.eigh(bent)
        place = np.where(np.abs(values[..., 0]) > np.abs(values[..., -1]), 0, last)
        x = np.take_along_axis(vectors, place[..., None, None], axis=-1)[..., 0]
        b = bilinear_value(B, x)
    steady = ((A @ x[..., None])[..., 0] * x).sum(axis=-1)
    return steady + np.linalg.norm(b, axis=-1), x


def _best_of_starts(climb: Callable, B: NDArray) -> tuple[NDArray, NDArray]:
    best, vector = np.full(B.shape[:-3], -1.0), np.zeros((*B.shape[:-3], B.shape[-1]))
    for start in _starts(B):
        size, x = climb(start)
        better = size > best
        best = np.where(better, size, best)
        vector = np.where(better[..., None], x, vector)
    return best, vector


def _starts(B: NDArray) -> list[NDArray]:
    """Unit x that suit the directions z in which B is widest on average, widest first."""
    flat = B.reshape(*B.shape[:-2], B.shape[-2] * B.shape[-1])
    directions = np.linalg.eigh(flat @ np.swapaxes(flat, -1, -2))[1]
    starts = []
    for i in range(min(_STARTS, B.shape[-3])):
        bent = np.einsum("...k,...kij->...ij", directions[..., -1 - i], B)
        values, vectors = np.linalg.eigh(bent)
        place = np.argmax(np.abs(values), axis=-1)
        starts.append(np.take_along_axis(vectors, place[..., None, None], axis=-1)[..., 0])
    return starts


def _newton(B: NDArray, x: NDArray) -> tuple[NDArray, NDArray]:
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
    return np.linalg.norm(bilinear_value(B, x), axis=-1), x


def _unit(x: NDArray) -> NDArray:
    """x at length 1; a zero becomes the first axis."""
    length = np.linalg.norm(x, axis=-1, keepdims=True)
    first = np.eye(x.shape[-1])[0]
    return np.where(length > 0, x / np.where(length > 0, length, 1.0), first)
