"""A tree of boxes over the triangles of a mesh, so that a ray tests few of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

LEAF = 4
"""Triangles that a box is not split for."""

DEEP = 30
"""Below so many splits a box is halved, so that no tree is deeper than `loops.DEPTH`."""


def box_tree(corners: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Boxes over triangles, each split where its children's surfaces times triangles are least.

    That is what a ray costs on average (MacDonald and Booth 1990).

    Args:
        corners: of the triangles, shape (t, 3, 3) [m].

    Returns:
        Boxes (nodes, 6) [m], tree (nodes, 2) and the triangles' order (t,), as `loops.Surfaces` has
        them: a node's first child follows it.
    """
    lower, upper = corners.min(axis=1), corners.max(axis=1)
    order, boxes, tree = np.arange(len(corners)), [], []

    def grow(first: int, count: int, depth: int) -> None:
        node, mine = len(boxes), order[first : first + count]
        boxes.append(np.r_[lower[mine].min(axis=0), upper[mine].max(axis=0)])
        tree.append((first, count))
        if count <= LEAF:
            return
        mine, left = _split(lower, upper, mine)
        left = left if depth < DEEP else count // 2
        order[first : first + count] = mine
        grow(first, left, depth + 1)
        tree[node] = (len(boxes), 0)
        grow(first + left, count - left, depth + 1)

    grow(0, len(corners), 0)
    return np.array(boxes), np.array(tree), order


def _split(lower: NDArray, upper: NDArray, mine: NDArray) -> tuple[NDArray, int]:
    """The triangles in their best order and how many of them go left."""
    orders = np.argsort((lower + upper)[mine], axis=0, kind="stable").T
    low, high = lower[mine][orders], upper[mine][orders]
    areas = [
        _area(np.minimum.accumulate(a, axis=1), np.maximum.accumulate(b, axis=1))
        for a, b in ((low, high), (low[:, ::-1], high[:, ::-1]))
    ]
    left = np.arange(1, len(mine))
    costs = areas[0][:, :-1] * left + areas[1][:, -2::-1] * left[::-1]
    axis, at = np.unravel_index(np.argmin(costs), costs.shape)
    return mine[orders[axis]], int(left[at])


def _area(lower: NDArray, upper: NDArray) -> NDArray:
    x, y, z = np.moveaxis(upper - lower, -1, 0)
    return x * y + y * z + z * x
