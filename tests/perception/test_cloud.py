"""Filters of clouds: against NumPy's own words, by geometry, and what they refuse."""

from __future__ import annotations

from math import radians
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from backhoe.perception import cloud
from backhoe.perception.cloud import engine, loops

RNG = np.random.default_rng
DATA = Path(__file__).resolve().parents[2] / "data"


def by_voxel(points: np.ndarray, leaf: float) -> np.ndarray:
    """Centroids by another way, in order of their voxels' indices."""
    _, which = np.unique(np.floor(points / leaf), axis=0, return_inverse=True)
    return np.stack([np.bincount(which, x) for x in points.T], 1) / np.bincount(which)[:, None]


@pytest.mark.parametrize("leaf", [0.03, 0.1, 0.7, 50.0])
def test_voxel_grid_gives_the_centroid_of_each_voxel(leaf):
    points = RNG(0).normal(size=(60_000, 3)) * [3, 2, 1] + [5e3, -40, 2]
    ours, wanted = cloud.voxel_grid(points, leaf), by_voxel(points, leaf)
    assert ours.shape == wanted.shape
    order, other = (np.lexsort(np.round(x, 7).T) for x in (ours, wanted))
    np.testing.assert_allclose(ours[order], wanted[other], rtol=0, atol=1e-8)


def test_points_of_one_voxel_and_points_of_a_voxel_each_are_thinned():
    one = RNG(8).uniform(0, 1, (30_000, 3))
    np.testing.assert_allclose(cloud.voxel_grid(one, 1.0), [one.mean(axis=0)], atol=1e-9)
    each = np.stack(np.meshgrid(*[np.arange(28.0)] * 3), axis=-1).reshape(-1, 3) + 0.25
    thinned = cloud.voxel_grid(each, 1.0)
    np.testing.assert_array_equal(thinned[np.lexsort(thinned.T)], each[np.lexsort(each.T)])


def test_a_voxel_grid_has_the_same_order_each_time_and_leaves_its_points_alone():
    points = RNG(9).normal(size=(20_000, 3))
    kept = points.copy()
    np.testing.assert_array_equal(cloud.voxel_grid(points, 0.1), cloud.voxel_grid(points, 0.1))
    np.testing.assert_array_equal(points, kept)


def test_voxels_begin_at_multiples_of_the_leaf():
    points = [[0.09, 0, 0], [0.11, 0, 0], [-0.01, 0, 0], [0.19, 0.05, 0.05], [0.01, 0, 0]]
    thinned = cloud.voxel_grid(points, 0.1)
    assert thinned[np.argsort(thinned[:, 0])] == pytest.approx(
        np.array([[-0.01, 0, 0], [0.05, 0, 0], [0.15, 0.025, 0.025]])
    )


def test_a_thinned_cloud_may_be_thinned_again():
    points = RNG(1).uniform(-2, 2, (5000, 3))
    once = cloud.voxel_grid(points, 0.25)
    np.testing.assert_allclose(cloud.voxel_grid(once, 0.25), once, atol=1e-12)


@pytest.mark.parametrize(
    "points, leaf, words",
    [
        (np.empty((0, 3)), 0.1, "points"),
        ([[0, 0, np.nan]], 0.1, "points must be finite"),
        ([[0, 0, np.inf]], 0.1, "points must be finite"),
        ([[0, 0]], 0.1, "shape"),
        ([[0, 0, 0]], 0, "leaf"),
        ([[0, 0, 0]], -1, "leaf"),
        ([[0, 0, 0], [1, 0, 0]], 1e-9, "leaf must be above 4.77e-07 m"),
        ([[0, 0, 0], [1, 0, 0]], 2.0**-21, "leaf must be above"),
        ([[0, 0, 0], [1, 0, 0]], 1e-320, "leaf must be above"),
        ([[1e300, 0, 0]], 1e-9, "leaf must be above"),
    ],
)
def test_voxel_grid_refuses(points, leaf, words):
    with pytest.raises(ValueError, match=words):
        cloud.voxel_grid(points, leaf)


def test_compiled_loops_do_as_the_plain_ones():
    points = RNG(2).normal(size=(300, 3))
    planes = np.vstack([part.planes for part in (cloud.box([0, 0, 0], [1, 1, 1]),)])
    spheres = np.array([0, 6]), np.array([[0.5, 0.5, 0.5]]), np.array([2.0])
    found = []
    for module in (engine, loops):
        ends, starts, keys = np.empty((2, 3)), np.zeros(5, int), np.empty(300, int)
        assert module.extent(points, ends)
        low = np.floor(ends[0] / 0.5).astype(int)
        module.count(points, 0.5, low, keys, 30, starts)
        dealt, dealt_keys, centroids = np.empty((300, 3)), np.empty(300, int), np.zeros((300, 3))
        module.deal(points, keys, 30, starts[:-1].copy(), dealt, dealt_keys)
        room = np.full(1024, -1, np.int32), np.empty((300, 4)), np.empty(300, int)
        filled = module.gather(dealt, dealt_keys, starts, *room, centroids)
        assert 50 < filled < 300 and np.diff(starts).min() > 20
        keep = np.ones(300, bool)
        module.outside(points, planes, *spheres, 0.1, keep)
        found.append([ends, starts, keys, dealt, dealt_keys, centroids, keep])
    for fast, plain in zip(*found, strict=True):
        np.testing.assert_array_equal(fast, plain)


def wall_and_post() -> np.ndarray:
    """One scan of a wall 4 m ahead, a post at 2 m before it, a false point at each of its edges."""
    angles = np.radians(np.arange(-40, 41, 0.5))
    ranges = 4 / np.cos(angles)
    post = np.abs(angles) < radians(5.1)
    ranges[post] = 2 / np.cos(angles[post])
    edge = np.flatnonzero(post)[[0, -1]] + [-1, 1]
    ranges[edge] = 3.0
    return np.c_[ranges * np.cos(angles), ranges * np.sin(angles), np.zeros(len(angles))]


def test_a_surface_that_faces_the_laser_has_right_angles():
    points = wall_and_post()
    angles = cloud.incidence(points, [0, 0, 0])
    assert np.degrees(angles[80]) == pytest.approx(90, abs=1)
    first = points[0] / np.linalg.norm(points[0]), points[1] - points[0]
    wanted = np.arccos(-first[0] @ first[1] / np.linalg.norm(first[1]))
    assert angles[0] == pytest.approx(wanted)


def test_shadows_go_and_surfaces_stay():
    points = wall_and_post()
    keep = cloud.shadow_filter(points, [0, 0, 0])
    false = np.isclose(np.linalg.norm(points, axis=1), 3.0)
    assert false.sum() == 2 and not keep[false].any()
    assert keep.sum() == len(points) - 6, "both ends of the four gaps, two of them shared"
    wider = cloud.shadow_filter(points, [0, 0, 0], neighbours=3)
    assert wider.sum() == len(points) - 2 * 7


def test_ten_to_seventy_degrees_throw_away_what_faces_the_laser():
    points = wall_and_post()
    keep = cloud.shadow_filter(points, [0, 0, 0], most=radians(70))
    ahead = np.abs(np.arctan2(points[:, 1], points[:, 0])) < radians(15)
    assert not keep[ahead].any() and keep.any()


def test_beams_without_a_point_are_not_kept_and_break_no_scan():
    points = np.stack([wall_and_post()] * 2)
    points[1, 10:20] = np.nan
    keep = cloud.shadow_filter(points, [0, 0, 0])
    assert not keep[1, 10:20].any()
    np.testing.assert_array_equal(keep[0, 20:], keep[1, 20:])


def test_statistical_outliers_are_those_far_from_their_neighbours():
    points = np.vstack([RNG(3).normal(size=(500, 3)) * 0.1, [[5, 5, 5], [-4, 0, 1]]])
    distances = np.linalg.norm(points[:, None] - points, axis=-1)
    mean = np.sort(distances, axis=1)[:, 1:9].mean(axis=1)
    wanted = mean <= mean.mean() + 1.5 * np.sqrt(np.var(mean, ddof=1))
    keep = cloud.statistical_outliers(points, 8, 1.5)
    np.testing.assert_array_equal(keep, wanted)
    assert not keep[-2:].any() and keep[:-2].mean() > 0.95


def test_radius_outliers_are_those_with_few_others_near():
    points = RNG(4).normal(size=(400, 3))
    near = (np.linalg.norm(points[:, None] - points, axis=-1) <= 0.5).sum(axis=1) - 1
    for least in (1, 3, 8):
        np.testing.assert_array_equal(cloud.radius_outliers(points, 0.5, least), near >= least)


def test_the_self_filter_takes_the_posed_links_and_their_padding():
    volumes = {"boom": [cloud.box([0, -0.2, -0.2], [3, 0.2, 0.2])]}
    T = np.eye(4)
    T[:3, :3] = Rotation.from_euler("zyx", [0.7, -0.4, 0.2]).as_matrix()
    T[:3, 3] = [1.0, 2.0, 0.5]
    points = RNG(5).uniform(-1, 5, (40_000, 3))
    local = (points - T[:3, 3]) @ T[:3, :3]
    for padding in (0.0, 0.05, 0.3):
        inside = (np.abs(local - [1.5, 0, 0]) <= np.array([1.5, 0.2, 0.2]) + padding).all(axis=1)
        keep = cloud.self_filter(points, volumes, {"boom": T}, padding)
        np.testing.assert_array_equal(keep, ~inside)
        assert inside.any()


def test_a_hull_is_a_volume_of_any_form():
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    points = RNG(6).uniform(-0.2, 1.2, (5000, 3))
    inside = (points >= 0).all(axis=1) & (points.sum(axis=1) <= 1)
    keep = cloud.self_filter(points, {"bucket": [cloud.hull(corners)]}, {"bucket": np.eye(4)}, 0.0)
    np.testing.assert_array_equal(keep, ~inside)


@pytest.mark.parametrize(
    "call, error, words",
    [
        (
            lambda p, v: cloud.self_filter(p, v, {"bom": np.eye(4)}),
            ValueError,
            "link 'boom', got bom",
        ),
        (lambda p, v: cloud.self_filter(p, v, {"boom": np.eye(3)}), ValueError, "the pose of boom"),
        (
            lambda p, v: cloud.self_filter(p, v, {"boom": 2 * np.eye(4)}),
            ValueError,
            "must be rigid",
        ),
        (lambda p, v: cloud.self_filter(p, v, {"boom": np.eye(4)}, -1), ValueError, "padding"),
        (lambda p, v: cloud.self_filter(p[:0], v, {"boom": np.eye(4)}), ValueError, "points"),
        (lambda p, v: cloud.self_filter(p, {"a": [3]}, {"a": np.eye(4)}), TypeError, "box or hull"),
        (lambda p, v: cloud.box([0, 0, 0], [1, 0, 1]), ValueError, "low must be below"),
        (lambda p, v: cloud.hull(np.eye(3)), ValueError, "four or more"),
        (lambda p, v: cloud.statistical_outliers(p, 50, 1), ValueError, "more than 50 neighbours"),
        (lambda p, v: cloud.statistical_outliers(p, 0, 1), ValueError, "neighbours"),
        (lambda p, v: cloud.statistical_outliers(p * np.nan, 1, 1), ValueError, "finite"),
        (lambda p, v: cloud.statistical_outliers(p, 2, -1), ValueError, "multiplier"),
        (lambda p, v: cloud.radius_outliers(p, 0, 1), ValueError, "radius"),
        (lambda p, v: cloud.radius_outliers(p, 1, 1.5), ValueError, "neighbours"),
        (lambda p, v: cloud.shadow_filter(p[:1], [0, 0, 0]), ValueError, "two or more"),
        (lambda p, v: cloud.shadow_filter(p / 0, [0, 0, 0]), ValueError, "infinity"),
        (lambda p, v: cloud.shadow_filter(p, [0, 0]), ValueError, "origin"),
        (lambda p, v: cloud.shadow_filter(p, [0, 0, 0], most=0.1), ValueError, "most"),
        (lambda p, v: cloud.shadow_filter(p, [0, 0, 0], neighbours=0), ValueError, "neighbours"),
    ],
)
@pytest.mark.filterwarnings("ignore:divide by zero")
def test_filters_refuse(call, error, words):
    points = RNG(7).uniform(0.1, 1, (50, 3))
    with pytest.raises(error, match=words):
        call(points, {"boom": [cloud.box([0, 0, 0], [1, 1, 1])]})


def test_each_scan_may_have_an_origin_of_its_own():
    points = np.array([6.0, 0, 0]) + RNG(5).normal(size=(4, 20, 3))
    origins = RNG(6).normal(size=(4, 3))
    wanted = [cloud.incidence(line, origin) for line, origin in zip(points, origins, strict=True)]
    np.testing.assert_array_equal(cloud.incidence(points, origins), wanted)
    masks = [cloud.shadow_filter(line, at) for line, at in zip(points, origins, strict=True)]
    np.testing.assert_array_equal(cloud.shadow_filter(points, origins), masks)
    with pytest.raises(ValueError, match="origin must be one point or one for each scan"):
        cloud.incidence(points, origins[:3])


def test_small_clouds_outliers_are_those_that_all_distances_tell():
    """In clouds of a dozen, n - 1 and whether a point is its own neighbour decide on some."""
    for seed in range(200):
        points = RNG(seed).normal(size=(12, 3)) * RNG(seed + 1000).choice([1.0, 3.0], (12, 1))
        apart = np.linalg.norm(points[:, None] - points, axis=-1)
        mean = [np.sort(np.delete(row, k))[:3].sum() / 3 for k, row in enumerate(apart)]
        middle = sum(mean) / 12
        deviation = (sum((d - middle) ** 2 for d in mean) / 11) ** 0.5
        wanted = [d <= middle + deviation for d in mean]
        np.testing.assert_array_equal(cloud.statistical_outliers(points, 3, 1.0), wanted)


def test_filters_give_what_pcls_own_tests_ask_of_pcl():
    """Facts of PCL's `test_filters.cpp` on its cloud bun0."""
    points = np.loadtxt(DATA / "clouds" / "bun0.csv", delimiter=",", skiprows=1)
    assert len(points) == 397
    assert len(cloud.voxel_grid(points, 0.02)) == 103
    keep = cloud.statistical_outliers(points, 50, 1.0)
    assert keep.sum() == 352
    np.testing.assert_allclose(points[keep][-1], [-0.034667, 0.15131, -0.00071029])
    assert cloud.radius_outliers(points, 0.02, 14).sum() == 307
