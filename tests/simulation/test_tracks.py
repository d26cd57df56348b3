"""The tracks' friction: loads, holding, driving, turning, and the same machine in both backends."""

import numpy as np
import pytest

from backhoe import simulation
from backhoe.arm import dynamics, kinematics
from backhoe.machine import BACKHOE
from backhoe.simulation import tracks
from backhoe.simulation.forces import numbers_of
from backhoe.simulation.loop import REST

PATCHES = tracks.patch_positions(BACKHOE)
NUMBERS = numbers_of(BACKHOE, friction=True)
TRACK = BACKHOE.tracks
WEIGHT = BACKHOE.mass * BACKHOE.gravity


def rub(velocity, yaw_rate, belts=(0.0, 0.0), sheared=None, steps=1, dt=0.001):
    sheared = np.zeros_like(PATCHES) if sheared is None else sheared
    for _ in range(steps):
        push, _ = tracks.shear(NUMBERS, WEIGHT, (*velocity, yaw_rate), belts, sheared, dt)
    return np.array(push)


@pytest.fixture
def world():
    with simulation.open_world(backend="analytic", soil=False) as opened:
        yield opened


def drive(world, seconds, belts):
    hold = dynamics.gravity_torque(world.q)
    stiff = np.array([4e5, 4e5, 1e5, 3e4])
    start = world.q
    for _ in range(round(seconds / world.dt)):
        world.step(hold + stiff * (start - world.q) - 0.3 * stiff * world.dq, belts)


@pytest.mark.parametrize(
    "axis, coefficient", [(0, "friction_longitudinal"), (1, "friction_lateral")]
)
def test_sliding_tracks_pull_with_coulombs_force(axis, coefficient):
    velocity = np.zeros(2)
    velocity[axis] = 0.4
    push = rub(velocity, 0.0, steps=100)
    assert push[axis] == pytest.approx(-getattr(TRACK, coefficient) * WEIGHT)


def test_friction_takes_energy_from_every_steady_slide():
    rng = np.random.default_rng(1)
    for _ in range(50):
        twist = rng.uniform(-1, 1, 3)
        push = rub(twist[:2], twist[2], steps=60)
        assert push @ twist < 0


def test_a_spin_on_one_friction_is_held_by_the_levers_of_all_patches():
    alike = NUMBERS._replace(friction=np.full(2, 0.5))
    for sign in (-1.0, 1.0):
        sheared = np.zeros_like(PATCHES)
        for _ in range(200):
            spin = 0.0, 0.0, sign
            (*force, moment), _ = tracks.shear(alike, WEIGHT, spin, (0.0, 0.0), sheared, 0.001)
        assert moment == pytest.approx(-sign * 0.5 * WEIGHT * np.hypot(*PATCHES.T).mean())
        assert force == pytest.approx([0.0, 0.0], abs=1e-6 * WEIGHT)


def test_a_small_push_is_held_elastically_and_comes_back():
    sheared = np.zeros_like(PATCHES)
    there = rub((0.01, 0.0), 0.0, sheared=sheared, steps=200)
    assert -TRACK.friction_longitudinal * WEIGHT < there[0] < 0
    rub((-0.01, 0.0), 0.0, sheared=sheared, steps=200)
    np.testing.assert_allclose(sheared, 0.0, atol=1e-12)


def test_running_belts_leave_the_sheared_soil_behind():
    sheared = np.full_like(PATCHES, 0.5)
    rub((1.0, 0.0), 0.0, belts=(1.0, 1.0), sheared=sheared, steps=20_000)
    np.testing.assert_allclose(sheared, 0.0, atol=1e-6)


def test_the_machine_drives_straight_at_the_speed_of_its_belts(world):
    drive(world, 4.0, (1.0, 1.0))
    assert world.twist[0] == pytest.approx(1.0, abs=0.01)
    assert abs(world.pose[1]) < 0.02
    assert abs(world.pose[2]) < 0.01


def test_belts_follow_within_speed_and_acceleration(world):
    drive(world, 0.5, (9.0, -9.0))
    np.testing.assert_allclose(world.belts, np.array([0.5, -0.5]) * TRACK.acceleration)
    drive(world, 2.0, (9.0, -9.0))
    np.testing.assert_allclose(world.belts, [TRACK.max_speed, -TRACK.max_speed])


def test_turning_on_the_spot_slips_like_a_tracked_machine(world):
    drive(world, 3.0, (-0.5, 0.5))
    assert world.twist[2] * TRACK.gauge / 1.0 == pytest.approx(0.73, abs=0.03)
    assert np.hypot(*world.pose[:2]) < 0.05


def test_tracks_off_the_ground_do_not_push():
    sheared = np.zeros_like(PATCHES)
    push, _ = tracks.shear(NUMBERS, -1.0, (1.0, 1.0, 0.5), (0.0, 0.0), sheared, 0.001)
    assert push == (0.0, 0.0, 0.0)


def test_the_machine_stops_and_stays(world):
    drive(world, 2.0, (0.8, 0.8))
    drive(world, 3.0, (0.0, 0.0))
    stopped = world.pose
    drive(world, 5.0, (0.0, 0.0))
    np.testing.assert_allclose(world.pose, stopped, atol=1e-6)


def test_the_machine_keeps_its_place_under_a_full_swing_and_does_not_creep(world):
    hold = dynamics.gravity_torque(world.q)
    for k in range(4000):
        torque = hold.copy()
        torque[0] += 0.9 * BACKHOE.torque_limit[0] * np.sign(np.sin(2 * np.pi * k / 800))
        stiff = np.array([0.0, 4e5, 1e5, 3e4])
        world.step(torque + stiff * (REST - world.q) - 0.3 * stiff * world.dq)
    assert np.abs(world.pose).max() < 0.01


def test_a_push_at_the_tip_beyond_the_friction_moves_the_machine(world):
    """The teeth are on the ground, where a level push moves the machine and does not tip it."""
    world.reset(np.radians([-90.0, 5.3, -27.8, 75.0]))
    assert abs(kinematics.forward_kinematics(world.q)[2, 3]) < 0.03
    world._state.soil[:3] = -1.2 * TRACK.friction_longitudinal * WEIGHT, 0.0, 0.0
    drive(world, 1.0, (0.0, 0.0))
    assert world.pose[0] < -0.1
