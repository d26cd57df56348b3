"""Loaded and scaled machines behave as mechanics says."""

import numpy as np
import pytest

from backhoe.arm import dynamics, kinematics
from backhoe.machine import BACKHOE
from backhoe.machine.variants import loaded, reading, scaled

POSTURES = np.random.default_rng(5).uniform(-1, 1, (50, 4))


def test_a_load_weighs_on_every_joint_with_its_lever_arm():
    J = kinematics.jacobian(POSTURES, "bucket_com")
    extra = 1000.0 * 9.81 * J[:, 2]
    np.testing.assert_allclose(
        dynamics.gravity_torque(POSTURES, machine=loaded(1000.0)),
        dynamics.gravity_torque(POSTURES) + extra,
        atol=1e-6,
    )


def test_lengths_scale_positions_torques_and_inertias():
    giant = scaled(2.0)
    tip = kinematics.forward_kinematics(POSTURES, machine=giant)[:, :3, 3]
    np.testing.assert_allclose(tip, 2 * kinematics.forward_kinematics(POSTURES)[:, :3, 3])
    g, M = dynamics.gravity_torque, dynamics.mass_matrix
    np.testing.assert_allclose(g(POSTURES, machine=giant), 2 * g(POSTURES), atol=1e-6)
    np.testing.assert_allclose(M(POSTURES, machine=giant), 4 * M(POSTURES), atol=1e-6)


def test_a_giant_swings_slower_by_the_root_of_its_size():
    still = np.zeros(4)
    fast = dynamics.forward_dynamics(POSTURES[0], still, still)
    slow = dynamics.forward_dynamics(POSTURES[0], still, still, machine=scaled(4.0))
    np.testing.assert_allclose(slow, fast / 4)


@pytest.mark.parametrize("load", [-1.0, float("nan")])
def test_a_load_is_a_mass(load):
    with pytest.raises(ValueError, match=r"load must be one number at least 0 \[kg\]"):
        loaded(load)


@pytest.mark.parametrize("factor", [0.0, -2.0, float("inf")])
def test_a_factor_is_positive(factor):
    with pytest.raises(ValueError, match="factor must be one number above 0"):
        scaled(factor)


def test_the_machine_itself_is_the_reading_with_hanging_stick_and_curled_bucket():
    same = reading([-88.1, -86.2, -104.1, -78.6])
    for name in ("stick", "bucket"):
        link, own = getattr(same, name), getattr(BACKHOE, name)
        assert link.angle_offset == pytest.approx(own.angle_offset)
        assert link.com_angle == pytest.approx(own.com_angle)


@pytest.mark.parametrize("offsets", [[1.0, 2.0], [0.0, 0.0, 0.0, float("nan")]])
def test_a_reading_is_four_angles(offsets):
    with pytest.raises(
        ValueError,
        match=r"offsets_deg must be (angles .*, shape \(4,\), got shape \(2,\)|finite, got nan)",
    ):
        reading(offsets)
