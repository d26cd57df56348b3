"""What acts on the machine in the simulation: soil at the tip, joints, ground, and its inertia."""

import numpy as np
import pytest

from backhoe.arm import dynamics, kinematics
from backhoe.arm.dynamics import terms
from backhoe.machine import BACKHOE, replace
from backhoe.simulation import forces, moving_base

NUMBERS = forces.numbers_of(BACKHOE, friction=False)
LOPSIDED = replace(BACKHOE, swing=replace(BACKHOE.swing, com_angle=2.5))
H = 1e-6


@pytest.fixture
def rng():
    return np.random.default_rng(21)


def state(rng):
    found = forces.state_in(forces.memory_of(NUMBERS))
    found.q[:], found.dq[:] = rng.uniform(-1.0, 1.0, (2, 7))
    return found


def test_the_tips_velocity_is_the_derivative_of_its_place(rng):
    for _ in range(20):
        q, dq = rng.uniform(-1.5, 1.5, (2, 7))
        ahead, behind = (forces.tip_motion(NUMBERS.reach, q + h * dq, dq)[0] for h in (H, -H))
        slope = (ahead - behind)[:3, 3] / (2 * H)
        np.testing.assert_allclose(forces.tip_motion(NUMBERS.reach, q, dq)[1], slope, atol=1e-7)


def test_soil_at_the_tip_works_as_much_on_the_joints_as_on_the_tip(rng):
    for _ in range(20):
        s = state(rng)
        s.soil[:] = rng.normal(0.0, 1e4, 4)
        forces.tip_force(NUMBERS.reach, s)
        _, velocity = forces.tip_motion(NUMBERS.reach, s.q, s.dq)
        work = s.soil[:3] @ velocity + s.soil[3] * s.dq[4:].sum()
        assert s.forces @ s.dq == pytest.approx(work, rel=1e-9, abs=1e-6)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_no_joint_gives_more_than_its_actuator(sign, rng):
    s = state(rng)
    s.q[3:], s.dq[:] = 0.0, 0.0
    forces.joint_torques(NUMBERS.joints, s, np.full(4, sign * 1e9))
    np.testing.assert_allclose(s.torque, sign * BACKHOE.torque_limit)
    np.testing.assert_allclose(s.forces[3:], s.torque)


def test_a_machine_that_slides_ahead_is_held_by_the_friction_of_its_weight(rng):
    s = state(rng)
    NUMBERS.load[1], s.q[2], s.soil[2] = 500.0, 0.0, 2e4
    s.dq[:3] = 0.5, 0.0, 0.0
    for _ in range(200):
        s.forces[:] = 0.0
        forces.ground_force(NUMBERS, s, 0.001)
    weight = (BACKHOE.mass + 500.0) * BACKHOE.gravity - 2e4
    assert s.forces[0] == pytest.approx(-BACKHOE.tracks.friction_longitudinal * weight)


def masses(q, machine):
    """Mass, place (3,), isotropic inertia and pitch of the house and the links on a placed base."""
    c, s = np.cos(q[2]), np.sin(q[2])
    pitch = 0.0
    for frame, part, angle in zip(
        ("swing_com", "boom_com", "stick_com", "bucket_com"),
        (machine.swing, *machine.links),
        (0.0, *q[4:]),
        strict=True,
    ):
        pitch += angle
        x, y, z = kinematics.forward_kinematics(q[3:], frame, machine)[:3, 3]
        place = np.array([q[0] + c * x - s * y, q[1] + s * x + c * y, z])
        yield part.mass, place, part.inertia, pitch


def inertia(q, machine):
    """The mass matrix by the bodies' kinetic energies, from differences of their places."""
    M = np.zeros((7, 7))
    M[:2, :2] = machine.tracks.mass * np.eye(2)
    M[2, 2] = machine.tracks.yaw_inertia
    ends = [[list(masses(q + h * e, machine)) for h in (1e-5, -1e-5)] for e in np.eye(7)]
    yaw = np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    for k, (mass, _, own, _) in enumerate(masses(q, machine)):
        J = np.stack([(a[k][1] - b[k][1]) / 2e-5 for a, b in ends], axis=-1)
        pitch = np.array([(a[k][3] - b[k][3]) / 2e-5 for a, b in ends])
        M += mass * J.T @ J + own * (np.outer(yaw, yaw) + np.outer(pitch, pitch))
    return M


def balanced(q, dq, machine):
    M, left = np.empty((7, 7)), np.zeros(7)
    moving_base.balance(terms.arm_of(machine), moving_base.carrier_of(machine), q, dq, M, left)
    return M, left


@pytest.mark.parametrize("machine", [BACKHOE, LOPSIDED], ids=["backhoe", "lopsided"])
def test_the_inertia_of_the_moving_machine_is_that_of_its_bodies(machine, rng):
    for _ in range(10):
        q, dq = rng.uniform(-1.5, 1.5, (2, 7))
        M, _ = balanced(q, dq, machine)
        np.testing.assert_allclose(M, inertia(q, machine), rtol=1e-6, atol=1e-2)


@pytest.mark.parametrize("machine", [BACKHOE, LOPSIDED], ids=["backhoe", "lopsided"])
def test_what_drives_the_moving_machine_is_gravity_and_the_change_of_its_inertia(machine, rng):
    """Lagrange: M ddq = -g - (dM/dt dq - d(dq M dq / 2)/dq), by differences of M."""

    def slope(q, dq):
        ends = (balanced(q + h * dq, dq, machine)[0] for h in (H, -H))
        return np.subtract(*ends) / (2 * H)

    for _ in range(10):
        q, dq = rng.uniform(-1.5, 1.5, (2, 7))
        change = slope(q, dq) @ dq - [dq @ slope(q, e) @ dq / 2 for e in np.eye(7)]
        gravity = np.append(np.zeros(3), dynamics.gravity_torque(q[3:], machine))
        _, left = balanced(q, dq, machine)
        np.testing.assert_allclose(left, -gravity - change, rtol=1e-6, atol=1.0)
