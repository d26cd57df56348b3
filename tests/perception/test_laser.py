"""Beams of a nodding laser, and points from ranges while the machine moves."""

from __future__ import annotations

from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from backhoe.machine.sensors import LASERS
from backhoe.perception import laser as lasers
from backhoe.perception.laser import Motion

LEFT = LASERS["left"]
Q = np.array([0.4 - pi / 2, 0.3, 0.1, 0.2])
"""The arm 0.4 rad to the left of straight ahead: q1 = 0 is to the left."""


def test_beams_go_from_right_to_left_at_equal_angles():
    angles = lasers.beam_angles(LEFT)
    assert angles[0] == -angles[-1] == pytest.approx(-radians(70))
    np.testing.assert_allclose(np.diff(angles), radians(2 / 3))


def test_a_line_begins_every_turn_and_takes_its_part_of_one():
    time = lasers.beam_times(LEFT, 3, 5.0)
    np.testing.assert_allclose(time[:, 0], [5.0, 5.02, 5.04])
    np.testing.assert_allclose(time[1, -1] - time[1, 0], 0.02 * 140 / 360)


def test_a_nod_goes_from_the_highest_line_down_and_back():
    nod = lasers.nod_angles(LEFT, [0.0, 0.8, 1.6, 2.4, 3.2])
    np.testing.assert_allclose(np.degrees(nod), [-4, 28, 60, 28, -4], atol=1e-9)


def test_directions_are_the_lines_plane_turned_about_y():
    time = lasers.beam_times(LEFT, 7, 0.3)
    beams, a = lasers.directions(LEFT, time), lasers.beam_angles(LEFT)
    flat = np.stack([np.cos(a), np.sin(a), np.zeros_like(a)], axis=-1)
    nod = lasers.nod_angles(LEFT, time)
    wanted = [
        [Rotation.from_euler("y", n).apply(v) for n, v in zip(row, flat, strict=True)]
        for row in nod
    ]
    np.testing.assert_allclose(beams, wanted, atol=1e-12)
    assert beams[0, -1, 1] > 0 > beams[0, 0, 1], "the last beam is on the left"


def test_poses_follow_the_machine_between_its_times():
    motion = Motion([1.0, 2.0], [Q, Q + 0.2], [[0, 0, 0], [1.0, 2.0, 0.4]])
    q, pose = motion.at([0.0, 1.25, 9.0])
    np.testing.assert_allclose(q - Q, np.array([0, 0.05, 0.2])[:, None] * np.ones(4))
    np.testing.assert_allclose(pose[1], [0.25, 0.5, 0.1])
    assert not motion.still and Motion.standing(Q).still
    T = lasers.sensor_poses(LEFT.mount, [1.25], motion)[0]
    base = np.eye(4)
    base[:3, :3] = Rotation.from_euler("z", 0.1).as_matrix()
    base[:2, 3] = [0.25, 0.5]
    heading = Rotation.from_euler("z", 0.4 + 0.05)
    # from the swing axis: the boom's joint and the mount
    lever = heading.apply([0.6241 + 0.75, 1.5, 1.1811 + 0.2756 + 1.95])
    wanted = base @ np.append(lever + np.array([0.4, 0, 0]), 1)
    np.testing.assert_allclose(T[:3, 3], wanted[:3], atol=1e-9)
    ahead = Rotation.from_euler("z", 0.1 + 0.4 + 0.05 + radians(20)).apply([1, 0, 0])
    np.testing.assert_allclose(T[:3, 0], ahead, atol=1e-9)


def wall_ranges(time, motion, x=7.0):
    """Ranges to a wall at x, from the poses themselves."""
    T = lasers.sensor_poses(LEFT.mount, time, motion)
    v = np.einsum("lbij,lbj->lbi", T[..., :3, :3], lasers.directions(LEFT, time))
    with np.errstate(divide="ignore"):
        r = (x - T[..., 0, 3]) / v[..., 0]
    return np.where((r > 0) & (r < 30), r, np.nan)


SWING = np.array([1.0, 0, 0, 0])
TURNING = Motion([0.0, 2.0], [Q - 0.9 * SWING, Q + 0.1 * SWING], np.zeros((2, 3)))


def test_a_wall_stays_flat_while_the_machine_turns():
    time = lasers.beam_times(LEFT, 80)
    ranges = wall_ranges(time, TURNING)
    points = lasers.deskew(LEFT, time, ranges, TURNING)
    hit = np.isfinite(ranges)
    assert hit.sum() > 5000 and np.isnan(points[~hit]).all()
    np.testing.assert_allclose(points[hit][:, 0], 7.0, atol=1e-9)
    bent = lasers.deskew(LEFT, time, ranges, Motion.standing(Q))
    assert np.abs(bent[hit][:, 0] - 7.0).max() > 1.0


def test_a_late_clock_moves_points_by_omega_r_dt():
    time = lasers.beam_times(LEFT, 80)
    ranges = wall_ranges(time, TURNING)
    inside = np.isfinite(ranges) & (time > 0.1) & (time < 1.5)
    true = lasers.deskew(LEFT, time, ranges, TURNING)[inside]
    shifted = replace(TURNING, time=TURNING.time + 0.05)
    late = lasers.deskew(LEFT, time, ranges, shifted)[inside]
    r = np.hypot(true[:, 0] - 0.4, true[:, 1])
    error = np.linalg.norm(late - true, axis=-1)
    np.testing.assert_allclose(error, 2 * r * np.sin(0.5 * 0.05 / 2), rtol=1e-9)
    np.testing.assert_allclose(error, 0.5 * r * 0.05, rtol=1e-3)


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: lasers.beam_times(LEFT, 0), "lines"),
        (lambda: lasers.beam_times(LEFT, 2, np.nan), "start"),
        (lambda: lasers.nod_angles(LEFT, [np.inf]), "time"),
        (lambda: lasers.directions(LEFT, np.zeros((2, 3))), "time must"),
        (lambda: lasers.deskew(LEFT, np.zeros((2, 211)), np.zeros((3, 211)), TURNING), "alike"),
        (lambda: Motion([0, 0], [Q, Q], np.zeros((2, 3))), "time must rise"),
        (lambda: Motion([0], [Q, Q], np.zeros((2, 3))), "q must"),
        (lambda: Motion([0], [Q], np.zeros((1, 2))), "pose must"),
        (lambda: TURNING.at([1.0, np.nan]), "time must be finite"),
    ],
)
def test_it_refuses(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_it_refuses_other_things():
    with pytest.raises(TypeError, match="laser"):
        lasers.beam_angles(LEFT.mount)
    with pytest.raises(TypeError, match="motion"):
        lasers.sensor_poses(LEFT.mount, [0.0], Q)
