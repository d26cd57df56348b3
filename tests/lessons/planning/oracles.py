"""Independent answers to the exercises of lessons 11a and 11b, planning."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import lsq_linear
from scipy.spatial.distance import cdist

from backhoe.arm.kinematics import forward_kinematics
from backhoe.view.appearance import visuals

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


def the_nearest_point_of_a_box_by_least_squares(answer, spheres, low, high):
    """The nearest point of the box: least squares within bounds."""
    gaps = []
    for *middle, radius in spheres:
        nearest = lsq_linear(np.eye(3), middle, bounds=(low, high), tol=1e-14).x
        nearest = np.where(np.abs(nearest - low) < 1e-6, low, nearest)
        nearest = np.where(np.abs(nearest - high) < 1e-6, high, nearest)
        gaps.append(np.linalg.norm(nearest - middle) - radius)
    np.testing.assert_allclose(answer, min(gaps), atol=1e-5)


def one_joint_is_at_its_limit_and_none_beyond(answer, path, speed_limit):
    """With these times no joint is faster than its limit, and in each piece one is at it."""
    moved = np.abs(path[1:] - path[:-1])
    assert answer.shape == (len(path) - 1,) and (answer >= 0).all()
    assert (moved <= answer[:, None] * speed_limit * (1 + 1e-12)).all()
    np.testing.assert_allclose(np.max(moved - answer[:, None] * speed_limit, axis=1), 0, atol=1e-12)


def level_all_the_way_and_no_mesh_in_a_box(answer, start, goal, world):
    """The bucket's own axes keep their tilt, no corner of the machine's meshes is in a box, and its
    spheres keep the margin from the nearest points of the boxes."""
    assert_allclose(answer[0], start, atol=1e-9)
    assert_allclose(answer[-1], goal, atol=1e-9)
    pieces = pairwise(answer)
    dense = np.concatenate([np.linspace(a, b, 80) for a, b in pieces])
    assert (dense >= world.lower - 1e-12).all() and (dense <= world.upper + 1e-12).all()
    frames = [forward_kinematics(dense, link) for link in ("boom", "stick", "tip")]
    assert_allclose(np.ptp(frames[2][:, 2, :2], axis=0), 0.0, atol=1e-9)
    looks = visuals(world.machine)
    for number, (link, T) in enumerate(zip(("boom", "stick", "bucket"), frames, strict=True)):
        corners = np.concatenate([part.vertices for part in looks[link]])
        mine = world._link == number
        both = np.concatenate([corners, world._middles[mine]])
        sizes = np.r_[np.zeros(len(corners)), world._radii[mine] + world.margin - 0.05]
        placed = np.einsum("nij,kj->nki", T[::4, :3, :3], both) + T[::4, None, :3, 3]
        assert (placed[..., 2] - sizes).min() > 0.0
        for low, high in world._boxes:
            away = np.linalg.norm(np.clip(placed, low, high) - placed, axis=-1)
            assert (away > sizes - 1e-9).all()


EQUAL = {
    "11.2": {"step is never negative": "a length"},
    "11.3": {
        "discs[2]: abs": "a radius",
        "resolution is never negative": "a length",
        "resolution: that of the first case": "any length that jumps over no disc is right",
    },
    "11.4": {"cost is never negative": "lengths of ways", "radius: abs": "a radius"},
    "11.5": {"spheres[3] is never negative": "radii"},
}
"""Mutants that are the reference in disguise, with the reason."""
