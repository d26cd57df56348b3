"""Independent answers to the exercises of lessons 11a and 11b, planning."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.distance import cdist

# search


def steps_counted_one_by_one(answer, cell, goal):
    """Walks there, each step by the signs of what is left, and adds up the steps' lengths."""
    at, total = np.array(cell), 0.0
    while (at != goal).any():
        step = np.sign(goal - at)
        at, total = at + step, total + float(step @ step) ** 0.5
    assert answer == pytest.approx(total)


def a_step_on_the_straight_way_from_the_nearest(answer, nodes, towards, step):
    """SciPy's distances; both parts of the way add up to the whole, the first is at most a step."""
    near, new = answer
    assert near in range(len(nodes))
    near = int(near)
    apart = cdist(nodes, towards[None])[:, 0]
    assert apart[near] == apart.min()
    done, left = np.linalg.norm(new - nodes[near]), np.linalg.norm(towards - new)
    assert done == pytest.approx(min(step, apart[near]))
    assert done + left == pytest.approx(apart[near], abs=1e-9)
    assert new.shape == towards.shape


def the_exact_distance_of_a_segment(answer, a, b, discs, resolution):
    """Of each disc's middle to the segment by its projection, with no places in between."""
    way = b - a
    share = np.clip((discs[:, :2] - a) @ way / (way @ way), 0.0, 1.0)
    feet = a + share[:, None] * way
    gap = np.hypot(*(feet - discs[:, :2]).T) - discs[:, 2]
    assert answer == bool(gap.min() > 0)


def each_way_is_added_up(answer, nodes, cost, new, radius, free):
    """Node by node, in a loop: ways to the new place in a list, and then on to each other node."""
    parent, mended = answer
    assert parent in range(len(nodes))
    ways = {}
    for k, node in enumerate(nodes):
        edge = sum((x - y) ** 2 for x, y in zip(node, new, strict=True)) ** 0.5
        if free[k] and edge <= radius:
            ways[k] = edge
    reached = min(cost[k] + edge for k, edge in ways.items())
    assert parent in ways and cost[parent] + ways[parent] == pytest.approx(reached)
    for k in range(len(nodes)):
        shorter = k in ways and reached + ways[k] < cost[k]
        assert bool(mended[k]) == bool(shorter)


# spilling
