"""The inner corners of a chessboard in a picture, to a few hundredths of a pixel.

Around a corner the picture is a saddle: bright, dark, bright, dark. The strongest saddles are
joined to a grid, neighbour by neighbour, which also says where a corner should be and is none. Then
each corner moves to where all edges around it point (Foerstner and Guelch 1987): an edge through
the corner c has its gradient g across it, so g^T (p - c) = 0 at each pixel p of its surroundings.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import picture, whole
from backhoe.perception.camera.rectification import remap

_SMOOTH = 1.5
"""Standard deviation of the blur in which saddles are sought [pixels]."""

_CANDIDATES = 6
"""Saddles that are looked at, for each corner wanted."""

_RING, _SAMPLES = 5.0, 32
"""Radius of the circle on which bright and dark must alternate [pixels]; places on it."""

_NEAR = 0.3
"""How far a corner may be from where its neighbours expect it, in squares."""

_SEEDS = 20

_ROUNDS = 15


def find_corners(image: NDArray, columns: int, rows: int) -> NDArray | None:
    """Inner corners of a chessboard, in the order of `chessboard`.

    The first corner is the one whose outermost square is black; rows run on clockwise from its
    columns. Squares must be about 12 pixels wide or wider.

    Args:
        image: grey, shape (height, width), uint8.
        columns, rows: of inner corners, 3 or more, one even and one odd: other boards look the
            same upside down.

    Returns:
        Columns and rows, shape (rows * columns, 2) [pixels]; None where not each of the corners is
        seen, as of a board that is half out of view or hidden, and for a board with more of them.

    Raises:
        ValueError: no grey picture, or a board that looks the same upside down.
    """
    image = picture(image, "image")
    columns, rows = whole(columns, "columns", least=3), whole(rows, "rows", least=3)
    if (columns + rows) % 2 == 0:
        raise ValueError(
            f"columns and rows must be one even, one odd, or the board looks the same upside down, "
            f"got {columns} and {rows}"
        )
    light = image.astype(float)
    points, arms = _saddles(light, _CANDIDATES * columns * rows)
    tried: set[int] = set()
    for seed in range(min(len(points), _SEEDS)):
        if seed in tried:
            continue
        places = _grown(points, arms, seed)
        tried |= set(places.values())
        grid = _board(light, points, places, columns, rows)
        if grid is not None:
            return _refined(light, grid)
    return None


def _saddles(light: NDArray, most: int) -> tuple[NDArray, NDArray]:
    """The strongest saddles, (n, 2) [pixels], and the directions of both edges, (n, 2, 2) [1]."""
    from scipy.ndimage import gaussian_filter, maximum_filter

    xx, xy, yy = (gaussian_filter(light, _SMOOTH, order) for order in ((0, 2), (1, 1), (2, 0)))
    strength = xy * xy - xx * yy
    peak = (strength == maximum_filter(strength, 7)) & (strength > 0)
    at = np.argwhere(peak)[:, ::-1]
    at = at[np.argsort(-strength[peak], kind="stable")[:most]].astype(float)
    turn = 2 * np.pi * np.arange(_SAMPLES) / _SAMPLES
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    ring = remap(gaussian_filter(light, 1.0), at[:, None] + _RING * circle)
    ring = ring - ring.mean(axis=1, keepdims=True)
    changes = np.sign(ring) != np.sign(np.roll(ring, -1, axis=1))
    whole_ring = np.isfinite(ring).all(axis=1) & (changes.sum(axis=1) == 4)
    opposite = (ring * np.roll(ring, _SAMPLES // 2, axis=1)).sum(axis=1)
    whole_ring &= opposite > 0.5 * (ring * ring).sum(axis=1)
    edges = turn[np.nonzero(changes[whole_ring])[1].reshape(-1, 4)] + np.pi / _SAMPLES
    lines = np.angle(np.exp(2j * edges[:, :2]) + np.exp(2j * edges[:, 2:])) / 2
    return at[whole_ring], np.stack([np.cos(lines), np.sin(lines)], axis=-1)


def _grown(points: NDArray, arms: NDArray, seed: int) -> dict[tuple[int, int], int]:
    """Place in the grid -> number of the saddle, from a first one on to all that fit."""
    steps = {}
    for k in (0, 1):
        away = points - points[seed]
        along, across = away @ arms[seed, k], np.abs(_turn(arms[seed, k], away))
        row = (np.abs(along) > _RING) & (across < 0.2 * np.abs(along))
        if not row.any():
            return {(0, 0): seed}
        nearest = np.flatnonzero(row)[np.argmin(np.abs(along[row]))]
        steps[k] = away[nearest] * np.sign(along[nearest])
    places, used = {(0, 0): seed}, {seed}
    waiting = [((0, 0), steps[0], steps[1])]
    for at, *step in waiting:
        here = points[places[at]]
        for k, sign in ((0, 1), (0, -1), (1, 1), (1, -1)):
            place = (at[0] + sign * (k == 0), at[1] + sign * (k == 1))
            wanted = here + sign * step[k]
            distance = np.linalg.norm(points - wanted, axis=1)
            found = int(np.argmin(distance))
            near = distance[found] < _NEAR * np.linalg.norm(step[k])
            if place in places or found in used or not near:
                continue
            places[place] = found
            used.add(found)
            new = list(step)
            new[k] = sign * (points[found] - here)
            waiting.append((place, *new))
    return places


def _board(
    light: NDArray, points: NDArray, places: dict, columns: int, rows: int
) -> NDArray | None:
    """The grid in the board's order, (rows, columns, 2) [pixels], if there is just one such board.

    A saddle beside the board that happens to fit is left out; of a larger board several parts fit.
    """
    index = np.array(list(places))
    index -= index.min(axis=0)
    number = np.full(index.max(axis=0) + 1, -1)
    number[index[:, 0], index[:, 1]] = list(places.values())
    fit = [
        one[i : i + rows, j : j + columns]
        for one in (number, number.T)
        for i in range(one.shape[0] - rows + 1)
        for j in range(one.shape[1] - columns + 1)
        if (one[i : i + rows, j : j + columns] >= 0).all()
    ]
    if len(fit) != 1:
        return None
    grid = points[fit[0]]
    if _turn(grid[0, -1] - grid[0, 0], grid[-1, 0] - grid[0, 0]) < 0:
        grid = grid[::-1]
    squares = (grid[1:, 1:] + grid[:-1, :-1] + grid[1:, :-1] + grid[:-1, 1:]) / 4
    black = np.add.outer(np.arange(rows - 1), np.arange(columns - 1)) % 2 == 0
    level = remap(light, squares)
    return grid if level[black].mean() < level[~black].mean() else grid[::-1, ::-1]


def _refined(light: NDArray, grid: NDArray) -> NDArray | None:
    """Each corner where the edges around it meet, (n, 2) [pixels]; None where one runs away."""
    from scipy.ndimage import gaussian_filter

    slopes = np.stack([gaussian_filter(light, 1.0, order) for order in ((0, 1), (1, 0))], axis=-1)
    sides = np.minimum(
        np.linalg.norm(np.diff(grid, axis=0), axis=-1).min(),
        np.linalg.norm(np.diff(grid, axis=1), axis=-1).min(),
    )
    reach = np.clip(0.3 * sides, 3.0, 9.0)
    offset = np.stack(np.meshgrid(*[np.linspace(-reach, reach, 13)] * 2), axis=-1).reshape(-1, 2)
    weight = np.exp(-((offset / reach) ** 2).sum(axis=1))
    start = corners = grid.reshape(-1, 2)
    for _ in range(_ROUNDS):
        at = corners[:, None] + offset
        g = remap(slopes, at)
        if np.isnan(g).any():
            return None
        G = np.einsum("m,nmi,nmj->nij", weight, g, g)
        new = np.linalg.solve(G, np.einsum("m,nmi,nmj,nmj->ni", weight, g, g, at)[..., None])
        moved, corners = np.abs(new[..., 0] - corners).max(), new[..., 0]
        if np.abs(corners - start).max() > reach:
            return None
        if moved < 1e-4:
            break
    return corners


def _turn(a: NDArray, b: NDArray) -> NDArray:
    """z of a x b, of vectors (..., 2): more than 0 where b is clockwise of a in a picture."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
