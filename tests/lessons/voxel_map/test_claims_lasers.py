"""What lesson 09a says in strong words, or in numbers that no cell of it prints."""

from __future__ import annotations

from functools import cache
from math import pi, radians

import numpy as np
import pytest

from backhoe import simulation
from backhoe.localisation import drives, fusion
from backhoe.machine.sensors import LASERS
from backhoe.perception import cloud, laser
from backhoe.perception.octree import OccupancyOctree
from backhoe.simulation.scanning import Scanner
from backhoe.simulation.volumes import link_volumes

LEFT = LASERS["left"]
OMEGA = 0.6
ARM = ("boom", "stick", "bucket")


def swung(delay=0.0):
    """The lesson's motion, as known by a clock that is late."""
    clock = np.linspace(0, 1.6, 33)
    q = np.array([-1.3, 0.35, 0.1, 0.6]) + OMEGA * clock[:, None] * [1, 0, 0, 0]
    return laser.Motion(clock + delay, q, np.zeros((33, 3)))


class Scene:
    """The lesson's sweep: scans, names of surfaces, points and origins of the left laser."""

    def __init__(self, seed):
        with simulation.open_world(backend="analytic") as world:
            world.reset(swung().at(0.8)[0])
            scanner = Scanner(world, seed=seed)
            self.scans = {n: scanner.scan(one, swung(), 80) for n, one in LASERS.items()}
            self.names = np.array(scanner.names)
        self.scan = self.scans["left"]
        self.points = laser.deskew(LEFT, self.scan.time, self.scan.ranges, swung())
        poses = laser.sensor_poses(LEFT.mount, self.scan.time[:, 105], swung())
        self.origins = poses[:, :3, 3]
        self.back = np.isfinite(self.scan.ranges)
        self.on = self.names[self.scan.surface]
        self.arm = self.back & np.isin(self.on, ARM)


@cache
def scene(seed=1):
    return Scene(seed)


def test_both_lasers_send_21100_beams_a_second():
    assert sum(one.beams * one.line_rate for one in LASERS.values()) == 21_100


def test_lines_are_sparse_and_beams_dense_on_the_ground_8_m_ahead():
    time = laser.beam_times(LEFT, 80)
    beams = laser.directions(LEFT, time)
    with np.errstate(divide="ignore"):
        ground = np.where(beams[..., 2:] < 0, -3.4067 / beams[..., 2:], np.nan) * beams
    row = np.nanargmin(np.abs(ground[:, 105, 0] - 8))
    along = np.linalg.norm(ground[row, 106] - ground[row, 105])
    across = np.linalg.norm(ground[row + 1, 105] - ground[row, 105])
    assert (round(along, 2), round(across, 2)) == (0.10, 0.45)


def test_one_pose_is_right_in_the_middle_and_half_a_radian_off_at_the_ends():
    turned = swung().at([0.0, 0.8, 1.6])[0][:, 0]
    np.testing.assert_allclose(turned[1] - turned, [0.48, 0, -0.48])


def test_the_spot_is_5_cm_wide_8_m_away():
    assert LEFT.spot + 8 * LEFT.divergence == pytest.approx(0.05, abs=0.001)


def test_fifty_milliseconds_cost_more_than_twenty_deviations_and_nothing_at_rest():
    s = scene()
    late = laser.deskew(LEFT, s.scan.time, s.scan.ranges, swung(0.05))
    inner = s.back & (s.on == "truck") & (s.scan.time > 0.15) & (s.scan.time < 1.5)
    error = np.linalg.norm(late - s.points, axis=-1)[inner].mean()
    assert 0.145 < error < 0.16 and error > 20 * LEFT.noise
    still = laser.Motion([0.0, 1.0], np.tile(swung().q[0], (2, 1)), np.zeros((2, 3)))
    delayed = laser.Motion([0.05, 1.05], still.q, still.pose)
    same = [laser.deskew(LEFT, s.scan.time, s.scan.ranges, m) for m in (still, delayed)]
    np.testing.assert_array_equal(*same)


def test_the_maps_error_lies_within_two_of_the_filters_deviations():
    log = drives.load("rectangle")
    estimate = fusion.pose_filter(log)
    for at in (10, 30, 67):
        k = np.argmin(np.abs(estimate.time - at))
        truth = log.truth_at(estimate.time[k])
        ahead = 8 * np.array([np.cos(truth[2]), np.sin(truth[2])])
        J = np.array([[1, 0, -ahead[1]], [0, 1, ahead[0]]])
        off = np.linalg.norm(J @ (estimate.pose[k] - truth))
        assert off < 2 * np.sqrt(np.trace(J @ estimate.covariance[k] @ J.T))


@pytest.mark.parametrize("seed", [1, 2])
def test_seventy_degrees_throws_away_all_that_faces_the_laser(seed):
    s = scene(seed)
    beta = np.degrees(cloud.incidence(s.points, s.origins))
    facing = (beta > 70) & (beta < 110)
    assert facing.sum() > 2500
    kept = cloud.shadow_filter(s.points, s.origins, most=radians(70))
    assert not kept[:, :-1][facing].any()
    assert cloud.shadow_filter(s.points, s.origins)[:, :-1][facing].mean() > 0.97


def test_each_more_neighbour_costs_another_three_per_cent_and_finds_few():
    s = scene()
    true = s.back & ~s.scan.mixed & (s.scan.truth < 15)
    lost, left = [], []
    for n in (1, 2, 3):
        kept = cloud.shadow_filter(s.points, s.origins, neighbours=n)
        lost.append(np.mean(~kept[true]))
        left.append((kept & s.scan.mixed).sum())
    np.testing.assert_allclose(np.diff(lost), 0.03, atol=0.005)
    assert s.scan.mixed.sum() == 120 and left[0] == 30 and left[0] - left[2] < 12


def test_what_is_left_is_far_or_on_an_edge_or_off_by_a_decimetre_or_two():
    s = scene()
    left = cloud.shadow_filter(s.points, s.origins) & s.scan.mixed
    far = left & (s.scan.truth > 15)
    error = np.abs(s.scan.ranges - s.scan.truth)
    small, large = left & ~far & (error < 0.25), left & ~far & (error >= 0.25)
    assert (left.sum(), far.sum(), large.sum(), small.sum()) == (30, 17, 6, 7)
    for row, beam in np.argwhere(large):
        around = s.scan.truth[row - 1 : row + 2, beam - 1 : beam + 2]
        assert np.nanmin(np.abs(around - s.scan.ranges[row, beam])) < 0.06


def test_a_leaf_as_large_as_the_maps_cells_marks_the_same_cells():
    s = scene()
    points = s.points[s.back]
    cells = [set(map(tuple, np.floor(p / 0.2))) for p in (points, cloud.voxel_grid(points, 0.2))]
    assert cells[0] == cells[1]


def test_points_a_cubic_metre_are_hundreds_near_and_two_far_away():
    s = scene()
    points = s.points[s.back]
    cubes, counts = np.unique(np.floor(points), axis=0, return_counts=True)
    away = np.linalg.norm(cubes, axis=1)
    assert np.sort(counts[away < 8])[-5:].min() > 200
    assert np.median(counts[away > 15]) <= 2


def on_arm(s, which, padding, delay=0.0):
    """The library's filter line by line: a way of its own beside the lesson's."""
    found = np.zeros(s.back.shape, bool)
    for line in range(80):
        mask = which[line]
        if mask.any():
            frames = swung().link_poses(float(s.scan.time[line, 105]) - delay)
            keep = cloud.self_filter(s.points[line, mask], link_volumes(), frames, padding)
            found[line, mask] = ~keep
    return found


@pytest.mark.parametrize(
    ("delay", "padding", "least", "most"),
    [(0.0, 0.02, 0, 0.005), (0.02, 0.05, 0.04, 0.12), (0.02, 0.08, 0, 0.02), (0.05, 0.05, 0.35, 1)],
)
def test_noise_and_delay_are_paid_in_padding(delay, padding, least, most):
    s = scene()
    leak = np.mean(~on_arm(s, s.arm, padding, delay)[s.arm])
    assert least <= leak <= most


def test_what_is_behind_the_arm_is_unknown_unless_its_beams_are_taken_for_misses():
    s = scene()
    mine = on_arm(s, s.back, 0.05)
    keep = cloud.shadow_filter(s.points, s.origins) & ~mine
    honest, shortcut = OccupancyOctree(0.2), OccupancyOctree(0.2)
    for line, origin in enumerate(s.origins):
        for tree in (honest, shortcut):
            if keep[line].any():
                tree.insert_scan(s.points[line, keep[line]], origin)
        if mine[line].any():
            beyond = origin + 30 * (s.points[line, mine[line]] - origin)
            shortcut.insert_scan(beyond, origin, 12.0)
    row, beam = np.nonzero(mine)
    eye, hit = s.origins[row], s.points[row, beam]
    behind = hit + (hit - eye) / np.linalg.norm(hit - eye, axis=1)[:, None]
    assert np.isnan(honest.log_odds(behind)).mean() > 0.7
    assert (shortcut.log_odds(behind) < 0).mean() > 0.97


def test_the_heaps_foot_is_what_a_plane_takes():
    s = scene()
    on_heap = s.names[s.scans["right"].surface] == "terrain"
    right = s.scans["right"]
    points = laser.deskew(LASERS["right"], right.time, right.ranges, swung())
    away = np.hypot(points[..., 0] - 6, points[..., 1])
    on_heap &= np.isfinite(right.ranges) & (away < 2.5)
    gone = np.abs(points[..., 2]) < 0.1
    assert np.mean(gone[on_heap]) > 0.15
    assert away[on_heap & gone].min() > 1.5
    assert gone[on_heap & (away > 2.0)].mean() > 0.9


def test_lonely_is_not_false():
    s = scene()
    found = [
        laser.deskew(one, s.scans[n].time, s.scans[n].ranges, swung()) for n, one in LASERS.items()
    ]
    points = np.concatenate([p[np.isfinite(p[..., 0])] for p in found])
    false = np.concatenate([x.mixed[np.isfinite(x.ranges)] for x in s.scans.values()])
    far = np.hypot(*points.T[:2]) > 12
    for keep in (
        cloud.statistical_outliers(points, 10, 2.0),
        cloud.radius_outliers(points, 0.3, 4),
    ):
        assert (~keep & far & ~false).sum() > 0.9 * (~keep).sum()
        assert (~keep & false & ~far).sum() < 0.03 * (false & ~far).sum()


def test_the_nods_are_those_that_the_lesson_writes():
    time = np.array([0.0, LEFT.nod_period / 2])
    nod = LEFT.nod_middle - LEFT.nod_amplitude * np.cos(2 * pi * time / LEFT.nod_period)
    np.testing.assert_allclose(np.degrees(nod), [-4, 60])
