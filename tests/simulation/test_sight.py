"""Our rays meet the scene where PyBullet's do, before and after the machine moved and dug."""

from __future__ import annotations

import numpy as np
import pytest

from backhoe import simulation
from backhoe.perception import stereo
from backhoe.perception.camera import Pinhole
from backhoe.perception.picture import looking
from backhoe.simulation.sight import Sight


def beams(n, eye, seed=0):
    rng = np.random.default_rng(seed)
    azimuth, elevation = rng.uniform(-np.pi, np.pi, n), rng.uniform(-1.2, 0.3, n)
    ahead = np.stack([np.cos(azimuth), np.sin(azimuth)], -1) * np.cos(elevation)[:, None]
    return np.tile(eye, (n, 1)), 30 * np.c_[ahead, np.sin(elevation)]


def differences(world, sight, n=4000):
    """Distance between both hits of each ray [m]; infinite where only one hits."""
    apart = []
    for seed, eye in enumerate([(0.5, -1.2, 3.6), (2.0, 2.5, 4.0), (4.0, -6.0, 1.5)]):
        start, vector = beams(n, eye, seed)
        ours, theirs = sight.cast(start, vector, 1.0), world.cast_rays(start, start + vector)
        assert len(set(ours.surface)) > 5
        both = np.isfinite(theirs).all(axis=1) | np.isfinite(ours.t)
        gap = np.linalg.norm(ours.points - theirs, axis=1)[both]
        apart.append(np.nan_to_num(gap, nan=np.inf))
    return np.concatenate(apart)


def test_rays_hit_as_pybullets_to_a_millimetre():
    pytest.importorskip("pybullet")
    with simulation.open_world(backend="pybullet") as world:
        sight = Sight(world)
        untouched = differences(world, sight)
        world.reset(q=(0.9, 0.2, -1.3, -0.6), pose=(-0.4, 0.3, 0.2))
        world.ground.terrain.lay((5.0, 0.3), (6.0, 0.9), 0.6)
        world.ground.bed.lay((0.0, 5.0), (1.5, 5.5), 2.0)
        moved = differences(world, sight)
    for apart in (untouched, moved):
        assert (apart > 1e-3).sum() <= 3, "but for rays along an edge, which Bullet makes wider"
        assert np.percentile(apart, 99.9) < 1e-6


def test_both_backends_are_seen_alike():
    seen = []
    for backend in ("analytic", "auto"):
        with simulation.open_world(backend=backend) as world:
            sight = Sight(world)
            seen.append(sight.cast(*beams(500, (0.5, -1.2, 3.6))))
            names = sight.names
    np.testing.assert_allclose(seen[0].t, seen[1].t, rtol=1e-9)
    hit = {names[k] for k in seen[0].surface if k >= 0}
    assert {"terrain", "truck", "country", "swing"} <= hit


def test_a_scene_without_soil_is_seen_too():
    with simulation.open_world(backend="analytic", soil=False) as world:
        down = Sight(world).cast([6.0, 0.0, 8.0], [[0.0, 0.0, -1.0]])
    assert down.points[0, 2] == pytest.approx(1.0, abs=0.04)


def test_a_stereo_pair_of_the_scene_is_matched_to_its_true_depth():
    camera, baseline = Pinhole.of_view((320, 240), np.radians(60)), 0.4
    T = looking((1.3, -1.1, 2.9), (6.0, 0.3, 0.4))
    with simulation.open_world(backend="analytic") as world:
        sight = Sight(world)
        left = sight.look(camera, T)
        T[:3, 3] += baseline * T[:3, 0]
        right = sight.look(camera, T)
    d = stereo.block_match(left.grey, right.grey, disparities=64)
    part = np.s_[7:-7, 72:-7]
    z = stereo.depth(d, camera.K[0, 0], baseline)[part]
    near = np.isfinite(z) & (left.depth[part] < 8)
    assert np.isfinite(z).mean() > 0.9
    assert np.median(np.abs(z - left.depth[part])[near]) < 0.05


def test_a_truck_that_has_left_is_not_seen_nor_what_was_in_its_bed():
    with simulation.open_world(backend="analytic") as world:
        sight, truck = Sight(world), world.scene.truck
        start = [truck.x, truck.y, 8.0]
        down = [[0.0, 0.0, -1.0], [0.3, 0.0, -1.0], [1.0, 0.0, -2.0]]
        before = sight.cast(start, down)
        sight.truck = False
        gone, names = sight.cast(start, down), sight.names
        picture = sight.look(
            Pinhole.of_view((64, 48), 1.0), looking((1.0, 0.0, 3.0), (*start[:2], 1.0))
        )
        sight.truck = True
        back = sight.cast(start, down)
    assert before.points[0, 2] == pytest.approx(truck.floor)
    np.testing.assert_allclose(gone.points[:, 2], 0.0, atol=1e-9)
    assert not {"truck", "bed"} & set(names) and "truck" in sight.names
    assert {names[k] for k in gone.surface} == {"terrain"}
    assert picture.surface.max() < len(names)
    np.testing.assert_array_equal(back.t, before.t)
