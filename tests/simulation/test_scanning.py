"""What the lasers measure: the scene's own surfaces, each beam from where its sensor was."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from backhoe import simulation
from backhoe.machine.sensors import LASERS
from backhoe.perception.laser import Motion, deskew, sensor_poses
from backhoe.simulation import scanning
from backhoe.simulation.scanning import Scanner

DIG = np.array([-pi / 2, 0.3, 0.2, 0.5])
SWING = np.array([1.0, 0, 0, 0])
FEW = {"left": replace(LASERS["left"], nod_period=0.4)}


@pytest.fixture(scope="module")
def world():
    with simulation.open_world(backend="analytic") as world:
        world.reset(DIG)
        yield world


def points_of(scan, motion):
    points = deskew(scan.laser, scan.time, scan.truth, motion)
    return points[np.isfinite(scan.truth)], scan.surface[np.isfinite(scan.truth)]


def test_a_sweep_sees_terrain_truck_and_arm_where_they_are(world):
    scanner = Scanner(world)
    scans = scanner.sweep()
    names = np.array(scanner.names)
    points, surface = points_of(scans["left"], Motion.standing(world.q, world.pose))
    seen = set(names[np.unique(surface)])
    assert {"terrain", "truck", "boom", "bucket", "country"} <= seen and "swing" not in seen
    ground = points[names[surface] == "country"]
    np.testing.assert_allclose(ground[:, 2], 0, atol=1e-9)
    truck = points[names[surface] == "truck"]
    assert (truck.min(0) > [-1.5, 3.9, -0.01]).all() and (truck.max(0) < [5.3, 6.7, 3.01]).all()


def test_the_noise_is_the_lasers(world):
    scans = Scanner(world, seed=3).sweep()["right"]
    near = np.abs(scans.ranges - scans.truth)
    smooth = near[(np.isfinite(scans.ranges)) & (near < 0.05) & (scans.truth < 4)]
    assert len(smooth) > 1000
    assert np.sqrt(np.mean(smooth**2)) == pytest.approx(0.007, rel=0.2)


def test_mixed_pixels_lie_between_what_the_beam_meets(world):
    quiet = replace(LASERS["left"], noise=0.0)
    scan = Scanner(world, {"left": quiet}).sweep()["left"]
    assert 30 < scan.mixed.sum() < 600
    row, beam = np.argwhere(scan.mixed).T
    inner = (beam > 0) & (beam < quiet.beams - 1) & (row > 0) & (row < 79)
    row, beam = row[inner], beam[inner]
    around = np.stack([scan.truth[row + i, beam + j] for i in (-1, 0, 1) for j in (-1, 0, 1)])
    low, high = np.nanmin(around, 0), np.nanmax(around, 0)
    between = (scan.ranges[row, beam] > low - 0.1) & (scan.ranges[row, beam] < high + 0.1)
    assert between.mean() > 0.95


def test_one_range_of_a_beam_is_the_mean_within_its_echo():
    laser = replace(LASERS["left"], echo=1.0)
    t = np.array([[2, 2, 2, 2, 2.7, 2.7, 2.7], [2, 2, 2, 9, 9, 9, 9], [np.inf] * 7])
    got = scanning._echo(t, laser)
    np.testing.assert_allclose(got[:2], [2.3, 2.0])
    assert np.isnan(got[2])


def test_without_divergence_no_pixel_is_mixed(world):
    thin = replace(LASERS["left"], divergence=0.0, spot=0.0, noise=0.0)
    scan = Scanner(world, {"left": thin}).sweep()["left"]
    same = np.isfinite(scan.ranges)
    np.testing.assert_allclose(scan.ranges[same], scan.truth[same], atol=1e-12)


def test_beams_start_where_the_sensor_was_at_their_time(world):
    scanner = Scanner(world, {"left": replace(LASERS["left"], noise=0.0)})
    time = np.linspace(0, 1.6, 33)
    q = DIG + np.c_[0.6 * time, 0.1 * time, 0 * time, 0 * time]
    motion = Motion(time, q, np.c_[0.3 * time, 0 * time, 0.1 * time])
    scan = scanner.scan(scanner.lasers["left"], motion, 80)
    points, surface = points_of(scan, motion)
    ground = points[np.array(scanner.names)[surface] == "country"]
    assert len(ground) > 1000
    np.testing.assert_allclose(ground[:, 2], 0, atol=1e-9)
    truck = points[np.array(scanner.names)[surface] == "truck"]
    assert (truck.min(0) > [-1.5, 3.9, -0.01]).all() and (truck.max(0) < [5.3, 6.7, 3.01]).all()


def test_following_a_moving_world_gives_every_line_once():
    with simulation.open_world(backend="analytic", scene=simulation.LOADING) as world:
        world.reset(DIG)
        scanner = Scanner(world, FEW)
        with pytest.raises(RuntimeError, match="no line"):
            scanner.take()
        parts = []
        for step in range(300):
            world.step([8e3, 0, 0, 0])
            scanner.follow()
            if step in (120, 299):
                parts.append(scanner.take())
        time = np.concatenate([scans["left"].time[:, 0] for scans, _ in parts])
        np.testing.assert_allclose(time, np.arange(len(time)) / 50, atol=1e-9)
        assert len(time) == int((0.3 - 0.02 * 140 / 360) * 50) + 1
        scans, motion = parts[1]
        assert motion.time[0] <= scans["left"].time[0, 0]
        points, surface = points_of(scans["left"], motion)
        ground = points[np.array(scanner.names)[surface] == "country"]
        np.testing.assert_allclose(ground[:, 2], 0, atol=1e-9)
        world.reset(DIG)
        with pytest.raises(RuntimeError, match="went back"):
            scanner.follow()


def test_the_arm_is_hit_where_it_was_to_a_few_millimetres(world):
    """A posture's own sweep and one in motion through it see the same arm from the house."""
    scanner = Scanner(world, {"left": replace(LASERS["left"], noise=0.0)})
    laser = scanner.lasers["left"]
    standing = scanner.scan(laser, Motion.standing(DIG), 80)
    swinging = Motion([0.0, 1.6], [DIG - 0.8 * SWING, DIG + 0.8 * SWING], np.zeros((2, 3)))
    moving = scanner.scan(laser, swinging, 80)
    names = np.array(scanner.names)
    arm = np.isin(names[standing.surface], ["boom", "stick", "bucket"])
    arm &= standing.surface == moving.surface
    apart = np.abs(standing.truth - moving.truth)[arm]
    assert arm.sum() > 1000
    assert np.percentile(apart, 95) < 0.01


def test_poses_now_are_those_of_the_links(world):
    T = scanning.pose_now(world, LASERS["left"].mount)
    now = Motion.standing(world.q, world.pose)
    np.testing.assert_allclose(T, sensor_poses(LASERS["left"].mount, 0.0, now), atol=1e-12)
    camera, left, right = scanning.stereo_now(world)
    assert camera.size == (640, 480)
    assert np.linalg.norm(right[:3, 3] - left[:3, 3]) == pytest.approx(0.40)
    np.testing.assert_allclose(
        np.linalg.inv(left) @ right @ [0, 0, 0, 1], [0.4, 0, 0, 1], atol=1e-9
    )


def test_both_backends_are_scanned_alike():
    seen = []
    for backend in ("analytic", "auto"):
        with simulation.open_world(backend=backend) as world:
            world.reset(DIG)
            seen.append(Scanner(world, FEW, seed=2).sweep()["left"].ranges)
    np.testing.assert_allclose(seen[0], seen[1], atol=1e-6)
