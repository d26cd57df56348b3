"""The octree itself, in two arrays: what is known of each node, and where its children are.

A block is the eight children of a node: child i is at +x for bit 0, +y for bit 1, +z for bit 2.
`value` (B, 8) has log-odds in single precision, NaN where nothing is known, for an inner node the
largest of its children, eq. (5.5). `child` (B, 8) has the block of a node's children, 0 for a leaf.
The root is node 0 of block 0. `books` has the number of blocks in use and the first of those given
back, which `child` links. A node whose eight children are equal leaves is itself a leaf: pruned.
`engine` has the same functions compiled.

Source: Hornung et al. 2013, OctoMap; Mastalli 2013, section 5.4.2.
"""

from __future__ import annotations

import numpy as np

from backhoe.perception.octree.rays import mark

DEPTH = 16
"""Levels under the root: the smallest voxels are there."""

BRICK = 13
"""Level of a node that is a brick of 8 x 8 x 8 voxels."""

SPARE = 128
"""Blocks that must be free before a brick is stored: one a level above it, 73 in it."""


def octant(kx, ky, kz, depth):
    """Which child of the node at that depth has the voxel in it."""
    shift = DEPTH - 1 - depth
    return (kx >> shift & 1) | (ky >> shift & 1) << 1 | (kz >> shift & 1) << 2


def take(value, child, books):
    """An empty block."""
    b = books[1]
    if b:
        books[1] = child[b, 0]
    else:
        b = books[0]
        books[0] += 1
    for i in range(8):
        value[b, i] = np.nan
        child[b, i] = 0
    return b


def cut_off(value, child, books, b, i):
    """Make node i of block b a leaf; what was below it is given back."""
    below = child[b, i]
    if below == 0:
        return
    waiting = [below]
    while len(waiting) > 0:
        block = waiting.pop()
        for j in range(8):
            if child[block, j]:
                waiting.append(child[block, j])
            value[block, j] = np.nan
        child[block, 0] = books[1]
        books[1] = block
    child[b, i] = 0


def opened(value, child, books, b, i):
    """The block of the children of node i of block b, which a leaf is split for."""
    if child[b, i] == 0:
        new = take(value, child, books)
        for j in range(8):
            value[new, j] = value[b, i]
        child[b, i] = new
    return child[b, i]


def settle(value, child, books, b, i):
    """Prune node i of block b, or give it the largest value of its children."""
    below = child[b, i]
    if below == 0:
        return
    first, largest, equal = value[below, 0], np.float32(-np.inf), True
    for j in range(8):
        here = value[below, j]
        equal &= here == first and child[below, j] == 0
        if here > largest:
            largest = here
    value[b, i] = largest
    if equal:
        cut_off(value, child, books, b, i)


def find(value, child, kx, ky, kz, depth):
    """Block, number in it and depth of the deepest node, down to `depth`, that has the voxel."""
    b, i, d = 0, 0, 0
    while d < depth and child[b, i]:
        b, i, d = child[b, i], octant(kx, ky, kz, d), d + 1
    return b, i, d


def read_brick(value, child, b, i, odds):
    """Log-odds of the 512 voxels of the brick that is node i of block b, in the octree's order."""
    for m in range(512):
        block, j = child[b, i], m >> 6
        if block and child[block, j]:
            block, j = child[block, j], m >> 3 & 7
            if child[block, j]:
                block, j = child[block, j], m & 7
        odds[m] = value[block, j] if block else value[b, i]


def alike(odds, first, last):
    """Whether these of a brick's voxels are all unknown or all equal."""
    for m in range(first + 1, last):
        if odds[m] != odds[first] and not (np.isnan(odds[m]) and np.isnan(odds[first])):
            return False
    return True


def write_brick(value, child, books, b, i, odds):
    """Make node i of block b the brick with these 512 log-odds, pruned."""
    if alike(odds, 0, 512):
        cut_off(value, child, books, b, i)
        value[b, i] = odds[0]
        return
    upper = opened(value, child, books, b, i)
    for j in range(8):
        if alike(odds, 64 * j, 64 * j + 64):
            cut_off(value, child, books, upper, j)
            value[upper, j] = odds[64 * j]
            continue
        lower = opened(value, child, books, upper, j)
        for k in range(8):
            first = 64 * j + 8 * k
            if alike(odds, first, first + 8):
                cut_off(value, child, books, lower, k)
                value[lower, k] = odds[first]
                continue
            leaves = opened(value, child, books, lower, k)
            for n in range(8):
                value[leaves, n] = odds[first + n]
            settle(value, child, books, lower, k)
        settle(value, child, books, upper, j)
    settle(value, child, books, b, i)


def update(value, child, books, start, bricks, free, hit, misses, hits, l_min, l_max):
    """Add what a scan says to its voxels' log-odds, eqs. (5.3), (5.6): once each, hits win.

    Args:
        start: the first brick to do.
        bricks, free, hit: as `rays.mark` gives them.
        misses, hits, l_min, l_max: log-odds in single precision.

    Returns:
        The first brick that is not done for want of blocks, or how many there are.
    """
    odds = np.empty(512, np.float32)
    way_b, way_i = np.zeros(BRICK + 1, np.int64), np.zeros(BRICK + 1, np.int64)
    for n in range(start, len(bricks)):
        if len(value) - books[0] < SPARE:
            return n
        key = bricks[n]
        kx, ky, kz = (key & 8191) << 3, (key >> 13 & 8191) << 3, key >> 26 << 3
        for depth in range(BRICK):
            way_b[depth + 1] = opened(value, child, books, way_b[depth], way_i[depth])
            way_i[depth + 1] = octant(kx, ky, kz, depth)
        b, i = way_b[BRICK], way_i[BRICK]
        read_brick(value, child, b, i, odds)
        for m in range(512):
            bit = 1 << (m & 7)
            if hit[n, m >> 3] & bit:
                more = hits
            elif free[n, m >> 3] & bit:
                more = misses
            else:
                continue
            sum_ = more if np.isnan(odds[m]) else odds[m] + more
            odds[m] = min(max(sum_, l_min), l_max)
        write_brick(value, child, books, b, i, odds)
        for depth in range(BRICK - 1, -1, -1):
            settle(value, child, books, way_b[depth], way_i[depth])
    return len(bricks)


def update_rays(
    value, child, books, start, points, origin, step, max_range, touched, misses, hits, l_min, l_max
):
    """As `update`, for each ray of a scan after the other: a voxel is told by each that passes it.

    Args:
        start: the first ray to do.
        points, origin, step, max_range: as `rays.mark` takes them.
        touched: room for what `rays.mark` fills in for one ray.

    Returns:
        The first ray that is not done for want of blocks, or how many there are.
    """
    bricks, slots, free, hit, count = touched
    for n in range(start, len(points)):
        count[0] = 0
        for k in range(len(slots)):
            slots[k] = -1
        mark(points[n : n + 1], origin, step, max_range, 0, bricks, slots, free, hit, count)
        if len(value) - books[0] < SPARE * count[0]:
            return n
        ray = bricks[: count[0]]
        update(value, child, books, 0, ray, free, hit, misses, hits, l_min, l_max)
        for b in range(count[0]):
            for m in range(64):
                free[b, m], hit[b, m] = 0, 0
    return len(points)
