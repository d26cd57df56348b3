"""The sensors sit where their numbers say, and look where they should."""

from __future__ import annotations

import re
from dataclasses import replace
from math import radians

import numpy as np
import pytest

from backhoe.machine import sensors
from backhoe.machine.sensors import LASERS, STEREO, Mount

AHEAD, UP, RIGHT = np.eye(3)
MOUNTS = {name: laser.mount for name, laser in LASERS.items()} | {"camera": STEREO.mount}


@pytest.mark.parametrize("name", MOUNTS)
def test_mounts_are_rigid_and_on_the_house(name):
    mount = MOUNTS[name]
    R = mount.T_link_sensor[:3, :3]
    assert mount.link == "swing"
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(R) == pytest.approx(1)


def test_the_lasers_stand_upright_on_either_side_and_are_turned_outwards():
    left, right = (LASERS[side].mount.T_link_sensor for side in ("left", "right"))
    np.testing.assert_allclose(left[:3, 2], UP, atol=1e-12)
    np.testing.assert_allclose(right[:3, 2], UP, atol=1e-12)
    assert left[:3, 3] @ RIGHT == -(right[:3, 3] @ RIGHT) < 0
    assert -left[:3, 0] @ RIGHT == pytest.approx(np.sin(radians(20))) == right[:3, 0] @ RIGHT
    assert left[:3, 0] @ AHEAD > 0.9 and left[:3, 1] @ RIGHT < 0


def test_the_cameras_look_forward_and_down_side_by_side():
    left, right = STEREO.mount.T_link_sensor, STEREO.right.T_link_sensor
    np.testing.assert_allclose(left[:3, :3], right[:3, :3])
    np.testing.assert_allclose(right[:3, 3] - left[:3, 3], 0.40 * RIGHT, atol=1e-12)
    np.testing.assert_allclose(left[:3, 2], np.cos(radians(25)) * AHEAD - np.sin(radians(25)) * UP)
    assert left[:3, 1] @ UP < 0 and left[:3, 0] @ RIGHT == pytest.approx(1)


def test_a_sweep_of_both_lasers_is_twenty_to_forty_thousand_beams():
    beams = sum(laser.sweep_lines * laser.beams for laser in LASERS.values())
    assert beams == 33760
    spacing = LASERS["left"].field_of_view / (LASERS["left"].beams - 1)
    assert np.degrees(spacing) == pytest.approx(2 / 3)


def test_the_beams_numbers_are_a_public_scanners():
    row = sensors.PUBLIC_SCANNERS["SICK LMS5xx HR"]
    for laser in LASERS.values():
        assert (laser.noise, laser.divergence, laser.spot) == (0.007, 0.0046, 0.013)
        assert laser.noise == row["noise"] < row["bias"]


def test_a_sensors_pose_is_its_links_times_its_mount():
    T = np.tile(np.eye(4), (3, 1, 1))
    T[:, 0, 3] = [1, 2, 3]
    poses = sensors.sensor_pose(T, STEREO.mount)
    assert poses.shape == (3, 4, 4)
    np.testing.assert_allclose(poses[2], T[2] @ STEREO.mount.T_link_sensor)


@pytest.mark.parametrize(
    "change, words",
    [
        ({"beams": 1}, "Laser.beams"),
        ({"line_rate": 0}, "Laser.line_rate"),
        ({"field_of_view": 7.0}, "field_of_view"),
        ({"noise": -1}, "Laser.noise"),
        ({"nod_amplitude": np.nan}, "nod_amplitude"),
        ({"most": 0.2}, "Laser.most"),
    ],
)
def test_a_laser_refuses(change, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        replace(LASERS["left"], **change)


def test_mounts_and_pairs_refuse():
    with pytest.raises(ValueError, match="link must"):
        Mount("cab", np.eye(4))
    with pytest.raises(ValueError, match="turn and move"):
        Mount("swing", 2 * np.eye(4))
    with pytest.raises(ValueError, match="turn and move"):
        Mount("swing", np.diag([1.0, 1.0, -1.0, 1.0]))
    with pytest.raises(ValueError, match="baseline"):
        replace(STEREO, baseline=0)
    with pytest.raises(TypeError, match="mount"):
        replace(STEREO, mount=np.eye(4))
    with pytest.raises(ValueError, match="T_frame_link"):
        sensors.sensor_pose(np.eye(3), STEREO.mount)
