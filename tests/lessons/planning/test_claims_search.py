"""What lesson 11a says in strong words, and its numbers."""

from itertools import pairwise

import numpy as np
import pytest

from backhoe.machine import BACKHOE
from backhoe.planning.search import ArmWorld, Log, astar, path_length, rrt_connect, rrt_star

SPHERES = {
    "boom": [[-0.9, 0.2, 0, 0.55], [-2.2, 0.45, 0, 0.6], [-3.5, 0.3, 0, 0.55]],
    "stick": [[-0.4, 0.1, 0, 0.5], [-1.5, 0.1, 0, 0.5]],
    "bucket": [[-0.4, 0.2, 0, 0.7], [-1.1, 0.3, 0, 0.6]],
}


def test_eight_directions_are_too_long_by_up_to_eight_per_cent_whatever_the_cells():
    """Ways in all directions on an empty grid; with four neighbours the square root of 2."""
    for size in (48, 96):
        grid, eight, four = np.zeros((size + 1, size + 1), bool), [], []
        for other in range(0, size + 1, size // 24):
            straight = np.hypot(size, other)
            eight.append(path_length(astar(grid, (0, 0), (size, other))) / straight)
            ends = (0, 0), (size, other)
            four.append((size + other) / straight)
            assert path_length(astar(grid, *ends, diagonal=False)) == pytest.approx(size + other)
        assert max(eight) == pytest.approx(1 / np.cos(np.pi / 8), abs=1e-3)
        assert np.argmax(eight) == pytest.approx(24 * np.tan(np.pi / 8), abs=1)
        assert max(four) == pytest.approx(2**0.5)
    assert 1 / np.cos(np.pi / 8) == pytest.approx(1.082, abs=5e-4)


def test_a_tree_that_only_grows_keeps_its_first_way_and_rrt_star_shortens_it():
    discs = np.array([[4.0, 4.0, 2.0], [7.0, 7.0, 1.0]])

    def is_free(points):
        apart = np.linalg.norm(points[:, None] - discs[:, :2], axis=-1)
        return (apart > discs[:, 2]).all(axis=1)

    for seed in range(3):
        lengths = []
        for radius in (1e-6, None):
            log = Log()
            given = {"step": 1.5, "seed": seed, "budget": 400, "radius": radius, "log": log}
            rrt_star([0.5, 0.5], [9.5, 9.5], is_free, [0, 0], [10, 10], **given)
            lengths.append([length for _, length in log.best])
        grown, mended = lengths
        assert grown[-1] > 0.97 * grown[0]
        assert mended[-1] < 0.95 * mended[0] or mended[-1] < 0.93 * grown[-1]


def test_an_edge_cuts_in_by_at_most_half_of_what_a_point_moves_between_two_looks():
    """And it does cut in, deeper the more seldom it looks: at the closest it only grazes."""
    pole = ArmWorld(SPHERES, [[[6.5, -0.1, 0.0], [6.7, 0.1, 3.0]]])
    q = np.array([[-2.1, 0.3, 0.3, 0.4], [-1.0, 0.3, 0.3, 0.4]])
    deepest = []
    for resolution in (0.4, 0.2, 0.1, 0.05):
        worst = np.inf
        for seed in range(8):
            given = {"step": 0.8, "resolution": resolution, "seed": seed}
            way = rrt_connect(*q, pole.is_free, pole.lower, pole.upper, **given)
            for a, b in pairwise(way):
                n = int(np.ceil(np.linalg.norm(b - a) / resolution))
                close = a + np.linspace(0, 1, 40 * n + 1)[:, None] * (b - a)
                moved = np.linalg.norm(np.diff(pole.middles(close), axis=0), axis=-1)
                between = moved.reshape(n, 40, -1).sum(axis=1).max()
                gap = pole.clearance(close).min()
                worst = min(worst, gap)
                assert gap >= -between / 2 - 1e-9 or resolution == 0.4
        deepest.append(-worst)
    assert deepest[0] > 0.3 and deepest[1] < 0.3 and deepest[3] < 0.05


def test_the_grown_pole_takes_up_a_quarter_of_a_radian():
    """Bucket's largest sphere, the pole's half thickness, and the distance from the swing axis."""
    base = BACKHOE.base.offset
    assert 6.6 - base == pytest.approx(6.2)
    thick = 0.2 + 2 * 0.7
    assert thick / 6.2 == pytest.approx(0.26, abs=0.005)
