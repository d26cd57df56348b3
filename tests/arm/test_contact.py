"""A push at the bucket's tip and the joints' torques, against virtual work and the dynamics."""

import numpy as np
import pytest

from backhoe.arm import contact, dynamics, kinematics
from backhoe.machine import BACKHOE


@pytest.fixture
def rng():
    return np.random.default_rng(7)


@pytest.fixture
def postures(rng):
    return BACKHOE.lower + rng.uniform(0.1, 0.9, (20, 4)) * (BACKHOE.upper - BACKHOE.lower)


def test_a_force_turns_the_joints_as_in_the_equation_of_motion(rng, postures):
    force = rng.normal(size=(20, 3)) * 1e4
    still = np.zeros((20, 4))
    pushed = dynamics.inverse_dynamics(postures, still, still, tip_force=-force)
    free = dynamics.inverse_dynamics(postures, still, still)
    felt = contact.joint_torque(postures, np.c_[force, np.zeros(20)])
    np.testing.assert_allclose(felt, free - pushed, atol=1e-6)


def test_a_push_does_the_work_that_the_joints_get(rng, postures):
    step = 1e-6 * rng.normal(size=(20, 4))
    push = rng.normal(size=(20, 4))
    before, after = (
        kinematics.forward_kinematics(postures + half, "tip") for half in (-step / 2, step / 2)
    )
    moved = (after - before)[:, :3, 3]
    work = (push[:, :3] * moved).sum(axis=1) + push[:, 3] * step[:, 1:].sum(axis=1)
    got = (contact.joint_torque(postures, push) * step).sum(axis=1)
    np.testing.assert_allclose(got, work, atol=1e-12)


def test_the_torques_tell_the_push(rng, postures):
    push = rng.normal(size=(20, 4)) * [1e4, 1e4, 1e4, 1e3]
    told = contact.push_from(postures, contact.joint_torque(postures, push))
    np.testing.assert_allclose(told, push, rtol=1e-6, atol=1e-4)


def test_a_stretched_arm_does_not_tell():
    q = np.array([0.3, 0.2, -BACKHOE.stick.angle_offset, 0.1])
    with pytest.raises(ValueError, match="singular"):
        contact.push_from(q, np.ones(4))


@pytest.mark.parametrize("bad", [np.ones(3), [np.nan, 0, 0, 0], "much"])
def test_bad_pushes_are_named(bad):
    q = np.array([0.0, 0.5, -1.0, 0.0])
    with pytest.raises(ValueError, match="push must"):
        contact.joint_torque(q, bad)
    with pytest.raises(ValueError, match="torque must"):
        contact.push_from(q, bad)
