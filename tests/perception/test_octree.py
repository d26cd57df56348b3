"""The map: log-odds by the source's equations, sizes of voxels, leaves, rays, bad input."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import expit, logit

from backhoe.perception import octree
from backhoe.perception.octree import OccupancyOctree, engine, nodes, rays

HERE = np.array([0.05, 0.05, 0.05])


def scene(count: int = 400, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Points on the walls of a room, and where they are seen from."""
    rng = np.random.default_rng(seed)
    origin = np.array([0.3, 0.2, 1.1])
    ways = rng.normal(size=(count, 3))
    low, high = np.array([-3.0, -2.0, 0.0]), np.array([3.0, 2.5, 2.0])
    times = (np.where(ways > 0, high, low) - origin) / ways
    return origin + times.min(axis=1)[:, None] * ways, origin


def told(tree: OccupancyOctree, hits: str) -> list[float]:
    """Log-odds of one voxel after each of its hits (+) and misses (-)."""
    said = []
    for word in hits:
        end = HERE if word == "+" else np.add(HERE, [0.1, 0, 0])
        tree.insert_scan([end], HERE)
        said.append(float(tree.log_odds(HERE)))
    return said


def test_three_hits_saturate_and_five_misses_free_a_saturated_voxel():
    said = told(OccupancyOctree(0.1), "+++++-----")
    assert said[:3] == pytest.approx([1.39, 2.78, 3.48])
    assert said[4] == pytest.approx(3.48)
    assert np.sign(said[5:]).tolist() == [1, 1, 1, 1, -1]


def test_log_odds_are_those_of_bayes_until_they_are_clamped():
    said = told(OccupancyOctree(0.1, l_min=-50, l_max=50), "+-++--+-")
    p, prior = 0.5, 0.5
    for word, found in zip("+-++--+-", said, strict=True):
        z = expit(1.39 if word == "+" else -0.80)
        p = 1 / (1 + (1 - z) / z * (1 - p) / p * prior / (1 - prior))
        assert found == pytest.approx(logit(p), abs=1e-5)


def test_a_ray_frees_what_it_passes_and_says_nothing_of_what_is_behind():
    tree = OccupancyOctree(0.1)
    tree.insert_scan([[1.05, 0.05, 0.05]], HERE)
    along = np.arange(0.05, 2, 0.1)
    odds = tree.log_odds(np.c_[along, np.full((20, 2), 0.05)])
    assert (odds[:10] == np.float32(-0.8)).all() and odds[10] == np.float32(1.39)
    assert np.isnan(odds[11:]).all()


def test_a_ray_longer_than_the_range_only_frees():
    tree = OccupancyOctree(0.1)
    tree.insert_scan([[5.05, 0.05, 0.05]], HERE, max_range=1.0)
    _, _, odds = tree.leaves()
    assert (odds < 0).all() and tree.bounds()[1, 0] == pytest.approx(1.0)


def test_hits_win_in_a_scan_but_not_ray_by_ray():
    points = [[0.55, 0.05, 0.05], *[[1.05, 0.05, 0.05]] * 3]
    scan, by_ray = OccupancyOctree(0.1), OccupancyOctree(0.1)
    scan.insert_scan(points, HERE)
    by_ray.insert_scan(points, HERE, rule="rays")
    assert scan.log_odds(points[0]) == np.float32(1.39)
    assert by_ray.log_odds(points[0]) == pytest.approx(1.39 - 3 * 0.80, abs=1e-6)
    assert by_ray.log_odds(points[1]) == np.float32(3.48)


def test_one_ray_a_voxel_touches_no_more_voxels_with_hits():
    points, origin = scene(3000)
    scan, voxels = OccupancyOctree(0.1), OccupancyOctree(0.1)
    scan.insert_scan(points, origin)
    voxels.insert_scan(points, origin, rule="voxels")
    hit = scan.log_odds(points)
    assert (hit == voxels.log_odds(points)).all() and (hit == np.float32(1.39)).all()


def test_compiled_loops_do_as_the_plain_ones():
    points, origin = (x.astype("f4") for x in scene(30))
    found = []
    for module in (engine, None):
        room = octree.tree._room(512)
        value, child = np.full((9000, 8), np.nan, "f4"), np.zeros((9000, 8), np.int32)
        books, odds = np.array([1, 0]), [np.float32(x) for x in (-0.8, 1.39, -2, 3.48)]
        mark, update = (module.mark, module.update) if module else (rays.mark, nodes.update)
        assert mark(points, origin, 0.1, 2.5, 0, *room) == 30
        bricks, _, free, hit, (count,) = room
        for _ in range(2):
            assert update(value, child, books, 0, bricks[:count], free, hit, *odds) == count
        found.append((value, child, books))
    for fast, plain in zip(*found, strict=True):
        np.testing.assert_array_equal(fast, plain)


@pytest.mark.parametrize("policy", octree.POLICIES)
@pytest.mark.parametrize("depth", [15, 14, 12])
def test_a_larger_voxel_says_the_largest_or_the_mean_of_its_smallest(policy, depth):
    points, origin = scene()
    tree = OccupancyOctree(0.1)
    for _ in range(4):
        tree.insert_scan(points, origin)
    edge = 1 << (16 - depth)
    for corner in np.random.default_rng(1).integers(-20, 20, (40, 3)) // edge * edge:
        cells = corner + np.stack(np.meshgrid(*[np.arange(edge)] * 3), -1).reshape(-1, 3)
        odds = tree.log_odds((cells + 0.5) * 0.1)
        at = tree.log_odds((corner + 0.5) * 0.1, depth, policy)
        if np.isnan(odds).all():
            assert np.isnan(at)
        else:
            wanted = np.nanmax(odds) if policy == "max" else np.nan_to_num(odds).mean()
            assert at == pytest.approx(wanted, abs=1e-6)


def test_the_mean_of_log_odds_is_not_that_of_probabilities():
    """Two full and six free children: probability 0.348 by eq. (5.4), 0.332 as a mean of theirs."""
    tree = OccupancyOctree(0.1)
    for y, z in [(0.05, 0.05), (0.15, 0.05), (0.05, 0.15)]:
        tree.insert_scan([[0.95, y, z]] * 3, [0.05, y, z], rule="rays")
    for x in (0.05, 0.15):
        tree.insert_scan([[x, 0.15, 0.15]] * 3, [x, 0.15, 0.15], rule="rays")
    mean = float(tree.log_odds(HERE, 15, "mean"))
    assert expit(mean) == pytest.approx(0.348, abs=5e-4)
    assert (2 * expit(3.48) + 6 * expit(-2)) / 8 == pytest.approx(0.332, abs=5e-4)


def test_leaves_fill_known_space_once_and_say_what_queries_say():
    points, origin = scene(2000)
    tree = OccupancyOctree(0.1)
    for _ in range(4):
        tree.insert_scan(points, origin)
    centres, sizes, odds = tree.leaves()
    assert len(np.unique(sizes)) > 2
    np.testing.assert_array_equal(tree.log_odds(centres + 0.01), odds)
    low, high = tree.bounds()
    grid = [np.arange(a + 0.05, b, 0.1) for a, b in zip(low, high, strict=True)]
    cells = np.stack(np.meshgrid(*grid), -1).reshape(-1, 3)
    known = np.isfinite(tree.log_odds(cells)).sum()
    assert known == round(float(np.sum(sizes**3)) / 1e-3)


def test_leaves_of_a_depth_and_in_a_box_are_those_of_all():
    points, origin = scene(2000)
    tree = OccupancyOctree(0.1)
    tree.insert_scan(points, origin)
    centres, sizes, _ = tree.leaves()
    box = np.array([[-1.04, -0.96, 0.52], [0.33, 0.71, 1.66]])
    first, last = np.floor(box / 0.1) * 0.1 - 1e-9, np.ceil(box / 0.1) * 0.1 + 1e-9
    half = sizes[:, None] / 2
    inside = ((centres + half > box[0]) & (centres - half < box[1])).all(axis=1)
    assert inside.any() and not inside.all() and (first < last).all()
    assert {*map(tuple, tree.leaves(box=box).centres)} == {*map(tuple, centres[inside])}
    coarse = tree.leaves(depth=13)
    assert coarse.sizes.min() == pytest.approx(0.8)
    np.testing.assert_array_equal(tree.log_odds(coarse.centres, 13), coarse.log_odds)


def test_eight_equal_leaves_are_one_and_a_change_divides_it_again():
    tree = OccupancyOctree(0.1)
    sizes = []
    for k in range(8):
        voxel = HERE + 0.1 * np.array([k & 1, k >> 1 & 1, k >> 2])
        tree.insert_scan([voxel], voxel)
        sizes.append(len(tree.leaves().sizes))
    assert sizes == [1, 2, 3, 4, 5, 6, 7, 1] and tree.leaves().sizes == pytest.approx([0.2])
    tree.insert_scan([HERE], HERE)
    assert len(tree.leaves().sizes) == 8
    blocks = tree._books[0]
    for _ in range(50):
        told(tree, "+-")
    assert tree._books[0] <= blocks + 2, "blocks that were given back are used again"


def test_scan_after_scan_takes_no_more_memory():
    points, origin = scene(2000)
    tree = OccupancyOctree(0.1)
    tree.insert_scan(points, origin)
    first = tree.memory
    for seed in range(20):
        tree.insert_scan(scene(2000, seed)[0], origin)
    assert tree.memory < 2 * first


def test_casting_meets_what_is_there():
    points, origin = scene(40_000)
    tree = OccupancyOctree(0.1)
    tree.insert_scan(points, origin)
    ways = points[:500] - origin
    ends, states = tree.cast(np.tile(origin, (500, 1)), ways)
    assert (states == 1).mean() > 0.98, "some slip between the voxels of a wall seen aslant"
    near = np.linalg.norm(ends - points[:500], axis=1)[states == 1]
    assert np.median(near) < 0.1
    _, states = tree.cast([origin], [[1.0, 0, 0]], max_range=1.0)
    assert states.tolist() == [0]
    beyond = np.array([[9.0, 9.0, 9.0]])
    assert tree.cast(beyond, [[1.0, 0, 0]]).states.tolist() == [-1]
    through = tree.cast([[9.0, 0.2, 1.1]], [[-1.0, 0, 0]], through_unknown=True)
    assert through.states.tolist() == [1] and through.points[0, 0] == pytest.approx(3.0, abs=0.11)


@pytest.mark.parametrize(
    "arguments, words",
    [
        ((np.empty((0, 3)), HERE), "points"),
        (([[0, 0, np.nan]], HERE), "points must be finite"),
        (([[0, 0, np.inf]], HERE), "points must be finite"),
        (([[0, 0]], HERE), "shape"),
        (([[0, 0, 1]], [0, 0]), "origin"),
        (([[0, 0, 1]], HERE, 0.0), "max_range"),
        (([[0, 0, 1]], HERE, -1.0), "max_range"),
        (([[0, 0, 4000]], HERE), "within 3276"),
        (([[0, 0, 1]], [0, 1e9, 0]), "origin must be within"),
    ],
)
def test_bad_scans_are_refused_and_change_nothing(arguments, words):
    tree = OccupancyOctree(0.1)
    with pytest.raises(ValueError, match=words):
        tree.insert_scan(*arguments)
    assert tree.size == 0


def test_a_scan_that_memory_would_not_hold_changes_nothing(monkeypatch):
    monkeypatch.setattr(octree.tree, "MOST_BRICKS", 4096)
    ends = np.random.default_rng(0).normal(size=(2000, 3)) * 200
    tree = OccupancyOctree(0.1)
    with pytest.raises(ValueError, match="give a max_range"):
        tree.insert_scan(ends, HERE)
    assert tree.size == 0
    tree.insert_scan(ends, HERE, max_range=2.0)
    assert tree.size > 0


@pytest.mark.parametrize("bad", [0, -0.1, np.nan, np.inf, "0.1", True])
def test_a_resolution_is_above_zero(bad):
    with pytest.raises(ValueError, match="resolution"):
        OccupancyOctree(bad)


@pytest.mark.parametrize("name, bad", [("hit", 0), ("miss", 0.4), ("l_min", 1), ("l_max", -1)])
def test_log_odds_have_their_signs(name, bad):
    with pytest.raises(ValueError, match=name):
        OccupancyOctree(0.1, **{name: bad})


def test_bad_queries_say_why():
    tree = OccupancyOctree(0.1)
    assert np.isnan(tree.log_odds([0, 0, 0])) and len(tree.leaves().sizes) == 0
    assert np.isnan(tree.bounds()).all()
    for call, words in [
        (lambda: tree.log_odds([0, 0]), "points must end in 3"),
        (lambda: tree.log_odds([0, 0, 1e9]), "within"),
        (lambda: tree.log_odds([0, 0, 0], 17), "depth"),
        (lambda: tree.log_odds([0, 0, 0], 16, "least"), "policy"),
        (lambda: tree.insert_scan([[0, 0, 0]], HERE, rule="twice"), "rule"),
        (lambda: tree.leaves(box=[[1, 0, 0], [0, 1, 1]]), "lowest corner first"),
        (lambda: tree.cast([[0, 0, 0]], [[0, 0, 0]]), "directions must not be 0"),
    ]:
        with pytest.raises(ValueError, match=words):
            call()
