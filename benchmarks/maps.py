"""Clouds and maps: a voxel grid against Open3D, octree insertion against OctoMap, the self filter,
terrain, a distance transform against SciPy.

Times are of the processor, the best of several; all of one thread but Open3D's, which takes what it
likes. Exit code 1 when a limit is missed.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import partial
from math import exp
from time import perf_counter, process_time

import numpy as np
import pyoctomap

from backhoe import simulation
from backhoe.perception.cloud import box, self_filter, voxel_grid
from backhoe.perception.distance_field import distance_transform
from backhoe.perception.octree import OccupancyOctree
from backhoe.perception.terrain_map import TerrainMap, is_soil
from backhoe.simulation.sight import Sight


def report(what: str, figure: float, unit: str, limit: float) -> bool:
    verdict = "ok" if figure <= limit else "MISSED"
    print(f"{what:60s} {figure:9.3g} {unit:5s} limit {limit:<6.3g} {verdict}")
    return figure <= limit


def fastest(function: Callable, repeats: int = 5, clock: Callable = process_time) -> float:
    """Shortest time of a call [s], after one that may compile."""
    function()
    times = []
    for _ in range(repeats):
        start = clock()
        function()
        times.append(clock() - start)
    return min(times)


def scene(count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Points on the walls, floor and ceiling of a hall of 20 x 16 x 4 m, and their sensor."""
    rng = np.random.default_rng(seed)
    ways = rng.normal(size=(count, 3))
    origin, low, high = np.array([0.3, 0.2, 2.1]), np.array([-10, -8, 0.0]), np.array([10, 8, 4.0])
    times = ((np.where(ways > 0, high, low) - origin) / ways).min(axis=1)
    points = origin + times[:, None] * ways + rng.normal(0, 0.01, (count, 3))
    return points.astype("f4").astype(float), origin.astype("f4").astype(float)


def grids() -> list[bool]:
    ours = {
        n: fastest(lambda n=n: voxel_grid(scene_of[n], 1 / 16), 15) for n in (10_000, 1_000_000)
    }
    print(f"voxel grid: {ours[1_000_000] * 1e3:.1f} ms for 1e6 points")
    growth = ours[1_000_000] / ours[10_000] / 100
    ok = [report("voxel grid, cost a point, 1e6 points over 1e4", growth, "", 1.25)]
    try:
        import open3d
    except ImportError as error:
        print(f"Open3D is left out: {error}")
        return ok
    # Open3D's voxels begin half a leaf before the lowest point: one more point puts them on ours;
    # a power of 2 divides without rounding.
    points, leaf = scene_of[1_000_000], 1 / 16
    corner = (np.floor(points.min(axis=0) / leaf) - 1.5) * leaf
    cloud = open3d.geometry.PointCloud()
    cloud.points = open3d.utility.Vector3dVector(np.vstack([corner, points]))
    theirs = np.asarray(cloud.voxel_down_sample(leaf).points)
    theirs = theirs[(theirs > corner + leaf / 2).any(axis=1)]
    mine = voxel_grid(points, leaf)
    order, other = (np.lexsort(np.round(x, 6).T) for x in (mine, theirs))
    assert len(mine) == len(theirs)
    print(f"largest difference of a centroid {np.abs(mine[order] - theirs[other]).max():.1g} m")
    peer = fastest(lambda: cloud.voxel_down_sample(leaf), clock=perf_counter)
    print(f"Open3D: {peer * 1e3:.1f} ms, {len(theirs)} voxels")
    mine = fastest(lambda: voxel_grid(points, leaf), clock=perf_counter)
    return [*ok, report("voxel grid of 1e6 points, over Open3D", mine / peer, "", 0.25)]


def peer_of(tree: OccupancyOctree) -> pyoctomap.OcTree:
    other = pyoctomap.OcTree(tree.resolution)
    p = [1 / (1 + exp(-x)) for x in (tree.hit, tree.miss, tree.l_min, tree.l_max)]
    other.setProbHit(p[0])
    other.setProbMiss(p[1])
    other.setClampingThresMin(p[2])
    other.setClampingThresMax(p[3])
    return other


def maps() -> list[bool]:
    ok = []
    for rule in ("scan", "voxels"):
        points, origin = scene(100_000)

        def ours(points=points, origin=origin, rule=rule) -> OccupancyOctree:
            tree = OccupancyOctree(0.1)
            tree.insert_scan(points, origin, rule=rule)
            return tree

        def theirs(points=points, origin=origin, rule=rule) -> pyoctomap.OcTree:
            tree = peer_of(OccupancyOctree(0.1))
            tree.insertPointCloud(points, origin, discretize=rule == "voxels")
            return tree

        mine, peer = ours(), theirs()
        found = [(i.getCoordinate(), i.current_node.getLogOdds()) for i in peer.begin_leafs()]
        centres, odds = (np.array(x) for x in zip(*found, strict=True))
        assert mine.size == peer.size() and (mine.log_odds(centres + 0.01) == odds).all()
        times = fastest(ours), fastest(theirs, 2)
        print(f"1e5 rays at 0.1 m, {rule}: {times[0]:.3f} s, OctoMap {times[1]:.3f} s")
        ok.append(report(f"octree, 1e5 rays, {rule}, over OctoMap", times[0] / times[1], "", 0.1))
        memory = mine.memory / peer.memoryUsage()
        ok.append(report("its memory over OctoMap's", memory, "", 1.0))
    few, many = (fastest(partial(insert, *scene(n))) / n for n in (10_000, 1_000_000))
    ok.append(report("octree, cost a ray, 1e6 rays over 1e4", many / few, "", 1.25))
    return ok


def mission() -> list[bool]:
    """A scan every 2 s for 30 minutes into the map of a scene where the machine works."""
    lens = np.radians(np.stack(np.meshgrid(np.arange(-70, 71, 1.0), np.arange(-60, 5, 1.0)), -1))
    azimuth, elevation = lens.reshape(-1, 2).T
    ahead = np.c_[np.cos(azimuth), np.sin(azimuth)] * np.cos(elevation)[:, None]
    ahead = np.c_[ahead, np.sin(elevation)]
    rng, tree, times = np.random.default_rng(0), OccupancyOctree(0.1), []
    with simulation.open_world(backend="analytic") as world:
        sight = Sight(world)
        for scan in range(900):
            swing = 1.4 * np.sin(0.7 * scan)
            if scan % 5 == 0:
                world.ground.terrain.lay(*rng.uniform([[4, -2]] * 2, [[7, 2]] * 2), 0.05)
            turn = np.array([[np.cos(swing), -np.sin(swing)], [np.sin(swing), np.cos(swing)]])
            way = np.c_[ahead[:, :2] @ turn.T, ahead[:, 2]]
            eye = np.array([*(turn @ [0.9, -0.6]), 3.1])
            hits = sight.cast(eye, way, 30.0)
            points = hits.points[np.isfinite(hits.t)] + rng.normal(0, 0.01, 3)
            start = process_time()
            tree.insert_scan(points, eye, 20.0)
            times.append(process_time() - start)
    first, last = np.median(times[1:91]), np.median(times[-90:])
    print(
        f"a scan of {len(points)} points: {1e3 * first:.1f} ms at first, {1e3 * last:.1f} at last"
    )
    print(f"the map after 900 scans: {tree.size} nodes, {tree.memory / 1e6:.1f} MB")
    return [report("a scan, last tenth of 900 over the first", last / first, "", 1.25)]


def insert(points: np.ndarray, origin: np.ndarray) -> None:
    OccupancyOctree(0.1).insert_scan(points, origin)


def body() -> list[bool]:
    rng = np.random.default_rng(0)
    volumes = {f"link {k}": [box([0, -0.3, -0.3], [3, 0.3, 0.3])] * 3 for k in range(6)}
    poses = {
        link: np.eye(4) + np.outer([1, 1, 1, 0], [0, 0, 0, k]) for k, link in enumerate(volumes)
    }
    points = rng.uniform(-6, 8, (100_000, 3))
    time = fastest(lambda: self_filter(points, volumes, poses))
    return [report("self filter, 1e5 points, 18 volumes", time * 1e3, "ms", 20)]


def terrain() -> list[bool]:
    """A scan into the terrain of the loading scene, and its cost over 30 minutes of looks."""
    rng = np.random.default_rng(0)
    points = {
        n: np.column_stack([rng.uniform(-3, 9, n), rng.uniform(-6, 7, n), rng.normal(0, 0.02, n)])
        for n in (10_000, 30_000, 1_000_000)
    }
    ground, origin = TerrainMap((-3.0, -6.4), 175, 161, 0.08), [0.0, 0.0, 3.0]
    times = {n: fastest(partial(ground.insert, some, origin)) for n, some in points.items()}
    ok = [report("terrain, 3e4 points", times[30_000] * 1e3, "ms", 10)]
    growth = times[1_000_000] / times[10_000] / 100
    ok.append(report("terrain, cost a point, 1e6 points over 1e4", growth, "", 1.25))
    early = fastest(partial(ground.insert, points[30_000], origin), 20)
    for _ in range(1100):  # a sweep every 1.6 s
        ground.insert(points[10_000], origin)
    late = fastest(partial(ground.insert, points[30_000], origin), 20)
    ok.append(report("terrain, a scan after 30 minutes over the first", late / early, "", 1.25))
    layers = fastest(partial(is_soil, points[30_000]))
    return [*ok, report("soil told from things, 3e4 points", layers * 1e3, "ms", 20)]


def distances() -> list[bool]:
    from scipy.ndimage import distance_transform_edt

    occupied = np.random.default_rng(0).uniform(size=(110, 120, 65)) < 0.01
    assert np.allclose(distance_transform(occupied), distance_transform_edt(~occupied), atol=1e-12)
    mine, theirs = (
        fastest(partial(distance_transform, occupied)),
        fastest(partial(distance_transform_edt, ~occupied)),
    )
    print(f"distances in 110 x 120 x 65 voxels: {mine * 1e3:.0f} ms, SciPy {theirs * 1e3:.0f} ms")
    return [report("distance transform over SciPy", mine / theirs, "", 0.5)]


if __name__ == "__main__":
    scene_of = {n: scene(n)[0] for n in (10_000, 1_000_000)}
    jobs = (grids, maps, mission, body, terrain, distances)
    results = [fine for job in jobs for fine in job()]
    sys.exit(0 if all(results) else 1)
