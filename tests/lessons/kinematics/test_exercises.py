"""The solutions that lesson 01 shows are the library's own kinematics in other words."""

import numpy as np
import pytest

from backhoe.arm import kinematics
from backhoe.lessons.kinematics.exercises import inverse, posture, tracks, velocity
from backhoe.machine import BACKHOE, replace
from backhoe.vehicle.tracks import world_rates


@pytest.fixture
def postures():
    return posture.random_postures(np.random.default_rng(5), 60)


def test_joint_angles_are_undone_by_the_forward_kinematics(postures):
    for q in postures:
        T = kinematics.link_transforms(q)
        pitches = np.cumsum(q[1:] + posture.OFFSETS)
        np.testing.assert_allclose(T[1:, 2, 0], np.sin(pitches), atol=1e-12)
        np.testing.assert_allclose(posture.joint_angles(q[0] + np.pi / 2, pitches), q, atol=1e-12)


def test_side_view_is_the_tip_of_the_forward_kinematics(postures):
    for q in postures:
        r, z, _ = posture.side_view(q)
        x, y, height = kinematics.forward_kinematics(q)[:3, 3]
        assert np.hypot(x - BACKHOE.base.offset, y) == pytest.approx(abs(r), abs=1e-12)
        assert height == pytest.approx(z, abs=1e-12)


def test_dig_depth_is_the_hanging_arm_under_the_lowest_boom():
    lowest = BACKHOE.lower[1] + BACKHOE.boom.angle_offset
    hanging = BACKHOE.stick.length + BACKHOE.bucket.length
    height = BACKHOE.base.height + BACKHOE.swing.height + BACKHOE.boom.length * np.sin(lowest)
    assert posture.dig_depth(BACKHOE) == pytest.approx(hanging - height, abs=0.005)
    longer = replace(BACKHOE, stick=replace(BACKHOE.stick, length=2.9129))
    assert posture.dig_depth(longer) - posture.dig_depth(BACKHOE) == pytest.approx(1.0, abs=0.01)


def test_angular_jacobian_is_the_librarys(postures):
    for q in postures:
        right = kinematics.jacobian(q, "tip")[3:]
        np.testing.assert_allclose(velocity.angular_jacobian(q), right, atol=1e-15)


def test_grading_moves_the_teeth_level_and_keeps_the_pitch(postures):
    dt = 1e-6
    for q in postures:
        moved = q + dt * velocity.grading_speeds(q, 0.4)
        change = (posture.side_view(moved) - posture.side_view(q)) / dt
        np.testing.assert_allclose(change, (0.4, 0.0, 0.0), atol=1e-4)


def test_inverse_kinematics_is_the_librarys(postures):
    for target in kinematics.pose(postures):
        right = kinematics.inverse_kinematics(target)
        np.testing.assert_allclose(inverse.inverse_kinematics(target), right, atol=1e-9)


def test_damped_step_is_the_librarys(postures):
    rng = np.random.default_rng(6)
    for q in postures:
        J, error = kinematics.task_jacobian(q), rng.normal(size=4)
        right = kinematics.damped_inverse(J, 0.1) @ error
        np.testing.assert_allclose(inverse.damped_step(J, error, 0.1), right, atol=1e-12)


def test_track_matrix_is_the_librarys():
    rng = np.random.default_rng(7)
    for heading, right, left in rng.uniform(-3, 3, (40, 3)):
        rates = world_rates(left, right, heading)
        mine = tracks.track_matrix(heading) @ (right, left)
        np.testing.assert_allclose(mine, rates, atol=1e-12)
