"""OctoMap itself, as a peer: maps with the same numbers, and their leaves in one order."""

from __future__ import annotations

from math import exp

import numpy as np
import pyoctomap

from backhoe.perception.octree import Leaves, OccupancyOctree


def peer(tree: OccupancyOctree) -> pyoctomap.OcTree:
    """An empty map with the resolution and the log-odds of ours."""
    other = pyoctomap.OcTree(tree.resolution)
    other.setProbHit(_probability(tree.hit))
    other.setProbMiss(_probability(tree.miss))
    other.setClampingThresMin(_probability(tree.l_min))
    other.setClampingThresMax(_probability(tree.l_max))
    return other


def leaves(other: pyoctomap.OcTree) -> Leaves:
    """The peer's leaves, as ours give them."""
    found = [
        (it.getCoordinate(), it.getSize(), it.current_node.getLogOdds())
        for it in other.begin_leafs()
    ]
    centres, sizes, odds = zip(*found, strict=True)
    return Leaves(np.array(centres), np.array(sizes), np.array(odds))


def equal(ours: Leaves, theirs: Leaves) -> bool:
    """Whether the leaves are the same cubes with the same log-odds, to the last bit."""
    rows = []
    for centres, sizes, odds in (ours, theirs):
        order = np.lexsort(np.round(centres / sizes.min() * 2).T)
        rows.append((centres[order], sizes[order], odds[order]))
    (c, s, o), (c2, s2, o2) = rows
    if len(o) != len(o2):
        return False
    return np.abs(c - c2).max() < 1e-4 and np.abs(s - s2).max() < 1e-9 and bool((o == o2).all())


def _probability(log_odds: float) -> float:
    return 1 / (1 + exp(-log_odds))
