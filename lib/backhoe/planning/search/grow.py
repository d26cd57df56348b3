"""The loops of RRT-Connect in plain Python, for any checker; `engine` has them compiled for the
arm, with `nearest` and `edge_free` of `arm_loops` in the place of those here."""

from __future__ import annotations

import numpy as np


def connect(trees, before, sizes, samples, first, step, resolution, world):
    """Grow two trees until they meet or all samples are used.

    `trees` (2, m, D) and `before` (2, m) have room; `sizes` (2,) says what is filled. The tree
    `first` begins. Gives the node of each tree where they met, or -1, and how many samples it took.
    """
    for k in range(len(samples)):
        one = (first + k) % 2
        other = 1 - one
        near = nearest(trees[one], sizes[one], samples[k])
        new = extend(trees, before, sizes, one, near, samples[k], step, resolution, world)
        if new < 0:
            continue
        target = trees[one, new]
        near = nearest(trees[other], sizes[other], target)
        while near >= 0:
            if distance(trees[other, near], target) == 0.0:
                if one == 0:
                    return new, near, k + 1
                return near, new, k + 1
            near = extend(trees, before, sizes, other, near, target, step, resolution, world)
    return -1, -1, len(samples)


def extend(trees, before, sizes, one, near, towards, step, resolution, world):
    """One step from a node towards a place; gives the new node, or -1 where something is hit."""
    n, way = sizes[one], distance(trees[one, near], towards)
    if way == 0.0:
        return -1
    new = trees[one, n]
    for i in range(len(towards)):
        start = trees[one, near, i]
        new[i] = towards[i] if way <= step else start + step / way * (towards[i] - start)
    if not edge_free(world, trees[one, near], new, resolution):
        return -1
    before[one, n] = near
    sizes[one] = n + 1
    return n


def distance(a, b):
    """Between two places, shape (D,)."""
    total = 0.0
    for i in range(len(a)):
        total += (a[i] - b[i]) ** 2
    return total**0.5


def nearest(tree, n, place):
    """Of the first n nodes of a tree, the one nearest to a place."""
    return int(((tree[:n] - place) ** 2).sum(axis=1).argmin())


def edge_free(world, a, b, resolution):
    """Of any checker; `resolution` is its own."""
    return world.edge(np.array(a), np.array(b))
