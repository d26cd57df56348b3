"""OctoMap: the same leaves to the last bit, the facts of its own unit tests, its files."""

from __future__ import annotations

from math import cos, radians, sin
from pathlib import Path

import numpy as np
import pyoctomap
import pytest

from backhoe.perception.octree import OccupancyOctree
from octomap_peer import equal, leaves, peer

DEFAULT = {"hit": 0.8472979, "miss": -0.4054651, "l_min": -2.0, "l_max": 3.5}
"""OctoMap's own numbers: probabilities 0.7, 0.4, 0.1192, 0.971 [1]."""


def room(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Points around a sensor that moves, in single precision."""
    rng = np.random.default_rng(seed)
    ways = rng.normal(size=(count, 3)) * rng.uniform(0.2, 4.0, (count, 1))
    origin = rng.uniform(-1, 1, 3)
    return ((origin + ways).astype("f4").astype(float), origin.astype("f4").astype(float))


def sphere() -> tuple[np.ndarray, np.ndarray]:
    """360 x 360 rays of the unit tests: one vector turned on and on in single precision."""
    c, s, f = cos(radians(1.0)), sin(radians(1.0)), np.float32
    origin = np.array([0.01, 0.01, 0.02], "f4")
    x, y, z = 2.01, float(f(0.01)), float(f(0.01))
    x, points = float(f(x)), []
    for _ in range(360):
        for _ in range(360):
            points.append((x, y, z))
            x, y = float(f(x * c - y * s)), float(f(x * s + y * c))
        x, z = float(f(z * s + x * c)), float(f(z * c - x * s))
    return np.array(points, "f4") + origin, origin


@pytest.mark.parametrize("rule, discretize", [("scan", False), ("voxels", True)])
@pytest.mark.parametrize("max_range", [None, 2.5])
def test_five_scans_give_octomaps_leaves(rule, discretize, max_range):
    ours = OccupancyOctree(0.1)
    theirs = peer(ours)
    for seed in range(5):
        points, origin = room(1500, seed)
        ours.insert_scan(points, origin, max_range, rule=rule)
        theirs.insertPointCloud(points, origin, max_range or -1.0, discretize=discretize)
    assert ours.size == theirs.size()
    assert equal(ours.leaves(), leaves(theirs))
    assert ours.memory < theirs.memoryUsage()


def test_a_sphere_has_octomaps_number_of_nodes(tmp_path):
    """`InsertScan`, and `InsertRay`, which counts after it has made the map free or occupied."""
    scan, by_ray = (OccupancyOctree(0.05, **DEFAULT) for _ in range(2))
    scan.insert_scan(*sphere())
    assert scan.size == 53_959
    by_ray.insert_scan(*sphere(), rule="rays")
    by_ray.save(tmp_path / "rays.bt")
    assert OccupancyOctree.load(tmp_path / "rays.bt").size == 50_615


def test_rays_inside_a_sphere_all_meet_it():
    """`test_raycasting`: a sphere of 2 m, voxels of 5 cm."""
    points, origin = sphere()
    tree = OccupancyOctree(0.05, **DEFAULT)
    tree.insert_scan(points, origin)
    ways = points[::7].astype(float) - origin
    ends, states = tree.cast(np.tile(origin, (len(ways), 1)), ways, max_range=3.0)
    assert (states == 1).all()
    assert np.linalg.norm(ends - origin, axis=1).mean() == pytest.approx(2.0, abs=0.05)


@pytest.fixture
def cube() -> OccupancyOctree:
    """`test_raycasting`: 2 m of free space before a wall at x = 1, and a strip of floor."""
    tree = OccupancyOctree(0.1, **DEFAULT)
    axis = np.arange(-0.95, 1, 0.1)
    for y in axis:
        for z in axis:
            tree.insert_scan([[0.95, y, z]], [-0.95, y, z])
    for x in (-0.15, -0.05, 0.05, 0.15):
        floor = [x, 0.05, -0.05]
        tree.insert_scan([floor] * 2, floor, rule="rays")
    return tree


@pytest.mark.parametrize(
    "origin, way, end, state",
    [
        ([0, 0, 0], [1, 0, 0], [0.95, 0.05, 0.05], 1),
        ([0.05, 0.05, 0.5], [0, 0, -1], [0.05, 0.05, -0.05], 1),
        ([0, 0, 0], [0, 1, 0], [0.05, 1.05, 0.05], -1),
    ],
)
def test_a_cube_is_left_where_octomap_says(cube, origin, way, end, state):
    met = cube.cast([origin], [way])
    assert met.points[0] == pytest.approx(end, abs=1e-9) and met.states[0] == state


def test_rays_through_the_unknown_end_at_the_border_of_the_map(cube):
    ends, states = cube.cast([[0, 0, 0]] * 2, [[0, 1, 0], [-1, 0, 0]], through_unknown=True)
    assert states.tolist() == [0, 0]
    assert ends[0] == pytest.approx([0.05, 32768 * 0.1 - 0.05, 0.05])
    assert ends[1] == pytest.approx([-32767 * 0.1 - 0.05, 0.05, 0.05])


def test_the_origin_is_a_corner_of_a_voxel():
    """`OcTreeKey`: the voxel with the origin has its middle half an edge away."""
    tree = OccupancyOctree(0.05)
    tree.insert_scan([[0.0, 0.0, 0.0]], [0.0, 0.0, 0.0])
    assert tree.leaves().centres == pytest.approx(np.full((1, 3), 0.025))


def test_nodes_are_pruned_as_octomap_prunes_them():
    """`test_pruning`: one voxel, its octant, a cube of 32 voxels, one more there, one far away."""
    tree = OccupancyOctree(0.01, **DEFAULT)

    def hit(*point: float) -> int:
        tree.insert_scan([point], point)
        return tree.size

    x, y, z = -0.055, -0.015, 1.005
    assert tree.size == 0 and hit(x, y, z) == 17 and hit(x + 0.01, y + 0.01, z + 0.01) == 18
    for j, k, m in [(1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1)]:
        hit(x + 0.01 * j, y + 0.01 * k, z + 0.01 * m)
    assert tree.size == 23 and hit(x, y + 0.01, z + 0.01) == 16
    axis = np.arange(0.005, 0.32, 0.01)
    cells = np.stack(np.meshgrid(axis, axis, axis), -1).reshape(-1, 3)
    for cell in cells[np.random.default_rng(0).permutation(len(cells))[:200]]:
        hit(*cell)
    for cell in cells:
        if np.isnan(tree.log_odds(cell)):
            hit(*cell)
    tree.prune()
    assert tree.size == 27 and hit(0.105, 0.105, 0.105) == 67 and hit(-2.0, -2.0, -2.0) == 83


def test_octomaps_reference_scan_gives_octomaps_map():
    """`test_scans`: 101 x 101 rays on a sphere of 4 m, seen from (1, 0, -0.5)."""
    turn = np.radians(0.5 * np.arange(-50, 51))
    pitch, yaw = (a.ravel() for a in np.meshgrid(turn, turn, indexing="ij"))
    x = 0.01 * np.sin(pitch) + 4.01 * np.cos(pitch)
    z = 0.01 * np.cos(pitch) - 4.01 * np.sin(pitch)
    points = np.c_[x * np.cos(yaw) - 0.01 * np.sin(yaw), x * np.sin(yaw) + 0.01 * np.cos(yaw), z]
    ours = OccupancyOctree(0.05, **DEFAULT)
    theirs = peer(ours)
    ours.insert_scan(points, [1.0, 0.0, -0.5])
    theirs.insertPointCloud(points, np.array([1.0, 0.0, -0.5]))
    assert equal(ours.leaves(), leaves(theirs))


@pytest.fixture
def pair() -> tuple[OccupancyOctree, pyoctomap.OcTree]:
    ours = OccupancyOctree(0.1)
    theirs = peer(ours)
    for seed in range(4):
        points, origin = room(800, seed)
        ours.insert_scan(points, origin)
        theirs.insertPointCloud(points, origin)
    return ours, theirs


@pytest.mark.parametrize("ending", [".ot", ".bt"])
def test_files_are_octomaps_byte_for_byte(pair, ending, tmp_path):
    ours, theirs = pair
    mine, other = tmp_path / f"mine{ending}", tmp_path / f"other{ending}"
    ours.save(mine)
    (theirs.write if ending == ".ot" else theirs.writeBinary)(str(other))
    assert mine.read_bytes() == other.read_bytes()
    again = OccupancyOctree.load(other)
    again.save(tmp_path / f"again{ending}")
    assert (tmp_path / f"again{ending}").read_bytes() == other.read_bytes()


def test_octomap_opens_our_files(pair, tmp_path):
    ours, _ = pair
    ours.save(tmp_path / "map.ot")
    assert equal(ours.leaves(), leaves(peer(ours).read(str(tmp_path / "map.ot"))))
    ours.save(tmp_path / "map.bt")
    theirs = peer(ours)
    assert theirs.readBinary(str(tmp_path / "map.bt"))
    assert equal(OccupancyOctree.load(tmp_path / "map.bt").leaves(), leaves(theirs))


@pytest.mark.parametrize("ending", [".ot", ".bt"])
def test_an_empty_map_is_a_file_too(ending, tmp_path):
    ours, theirs = OccupancyOctree(0.999), pyoctomap.OcTree(0.999)
    ours.save(tmp_path / f"mine{ending}")
    other = tmp_path / f"other{ending}"
    (theirs.write if ending == ".ot" else theirs.writeBinary)(str(other))
    assert (tmp_path / f"mine{ending}").read_bytes() == Path(other).read_bytes()
    again = OccupancyOctree.load(other)
    assert again.size == 0 and again.resolution == 0.999
