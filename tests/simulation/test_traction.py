"""Tracks driven by forces: Newton's law, energy, what the drives give, both backends."""

import numpy as np
import pytest

from backhoe import simulation
from backhoe.arm import dynamics
from backhoe.machine import BACKHOE, replace
from backhoe.simulation.tracks import patch_positions

TRACK = BACKHOE.tracks
WEIGHT = BACKHOE.mass * BACKHOE.gravity
RESISTANCE = TRACK.rolling_resistance * WEIGHT
MOVED = BACKHOE.mass + 2 * TRACK.belt_mass
STIFF = np.array([3e6, 4e6, 1e6, 3e5]), np.array([7e5, 9e5, 1.2e5, 2.5e4])


@pytest.fixture(params=["pybullet", "analytic"])
def world(request):
    if request.param == "pybullet":
        pytest.importorskip("pybullet")
    with simulation.open_world(backend=request.param, soil=False) as opened:
        yield opened


def hold(world, start):
    kp, kd = STIFF
    return dynamics.gravity_torque(world.q) + kp * (start - world.q) - kd * world.dq


def push(world, seconds, traction):
    """Drive with constant forces; the log of twist (3,), belts (2,), traction given (2,)."""
    start, log = world.q, []
    for _ in range(round(seconds / world.dt)):
        world.step(hold(world, start), traction=traction)
        log.append([*world.twist, *world.belts, *world.traction])
    return np.array(log)


def test_straight_driving_obeys_newtons_law(world):
    log = push(world, 2.0, (10e3, 10e3))
    acceleration = (log[1999, 0] - log[999, 0]) / 1.0
    assert log[-1, 3] < 0.9 * TRACK.max_speed
    assert acceleration == pytest.approx((20e3 - RESISTANCE) / MOVED, rel=5e-3)


def test_momentum_is_what_drives_and_resistance_gave(world):
    log = np.vstack([push(world, 1.0, (40e3, 40e3)), push(world, 0.6, (5e3, 5e3))])
    held = RESISTANCE / 2 * np.tanh(log[:, 3:5] / 0.02)
    impulse = world.dt * (log[:, 5:].sum() - held.sum())
    momentum = BACKHOE.mass * log[-1, 0] + TRACK.belt_mass * log[-1, 3:5].sum()
    assert momentum == pytest.approx(impulse, rel=2e-3)


def test_the_drives_work_becomes_motion_and_loss_and_nothing_more(world):
    log = push(world, 1.2, (40e3, 30e3))
    belts, given = log[:, 3:5], log[:, 5:]
    work = world.dt * (given * belts).sum()
    rolling = world.dt * (RESISTANCE / 2 * np.tanh(belts / 0.02) * belts).sum()
    speed = np.hypot(*log[-1, :2])
    motion = BACKHOE.mass / 2 * speed**2 + TRACK.belt_mass / 2 * (belts[-1] ** 2).sum()
    slip_and_turning = work - rolling - motion
    assert 0 < slip_and_turning < 0.1 * work


def test_beyond_the_friction_of_the_ground_the_belts_spin(world):
    world._numbers.friction[0] = slippery = 0.1
    log = push(world, 0.8, (30e3, 30e3))
    assert log[-1, 3] > 1.5 * log[-1, 0]
    acceleration = (log[-1, 0] - log[299, 0]) / 0.5
    assert acceleration == pytest.approx(slippery * BACKHOE.gravity, rel=0.02)


def test_the_drives_give_no_more_than_they_can(world):
    log = push(world, 0.2, (500e3, -500e3))
    np.testing.assert_allclose(log[0, 5:], [TRACK.max_traction, -TRACK.max_traction])


def test_a_belt_never_outruns_its_drive_and_can_still_brake(world):
    most = TRACK.max_traction
    log = push(world, 4.0, (most, most))
    assert 0.9 * TRACK.max_speed < log[-1, 3] < TRACK.max_speed
    assert 0 < log[-1, 5] < most
    braking = push(world, 0.01, (-most, -most))
    np.testing.assert_allclose(braking[0, 5:], -most)


def test_without_traction_the_machine_rolls_out(world):
    push(world, 1.0, (40e3, 40e3))
    start = world.twist[0]
    log = push(world, 0.5, (0.0, 0.0))
    assert (start - log[-1, 0]) / 0.5 == pytest.approx(RESISTANCE / MOVED, rel=0.02)
    push(world, 3.0, (0.0, 0.0))
    assert np.abs(world.twist).max() < 1e-3


def test_opposite_forces_turn_it_only_beyond_the_moment_of_lateral_friction(world):
    arms = np.abs(patch_positions(BACKHOE)[:, 0])
    moment = TRACK.friction_lateral * WEIGHT * arms.mean()
    least = moment / TRACK.gauge + RESISTANCE / 2
    held = push(world, 2.0, (-0.8 * least, 0.8 * least))
    assert abs(held[-1, 2]) < 0.01
    turned = push(world, 2.0, (-1.2 * least, 1.2 * least))
    assert turned[-1, 2] > 0.1


def test_both_backends_drive_the_same_machine():
    pytest.importorskip("pybullet")
    worlds = [simulation.open_world(backend=name, soil=False) for name in ("pybullet", "analytic")]
    start = worlds[0].q
    for k in range(1500):
        traction = 40e3 * np.sin(0.004 * k), 55e3
        torque = hold(worlds[0], start)
        for world in worlds:
            world.step(torque, traction=traction)
    one, other = worlds
    assert np.abs(one.pose).max() > 0.3
    np.testing.assert_allclose(one.pose, other.pose, atol=1e-9)
    np.testing.assert_allclose(one.belts, other.belts, atol=1e-9)
    for world in worlds:
        world.close()


def test_a_snapshot_of_a_driven_machine_repeats_bit_for_bit(world):
    push(world, 0.3, (50e3, 20e3))
    kept = world.snapshot()
    first = push(world, 0.3, (-20e3, 60e3))
    world.step(np.zeros(4), (0.5, 0.5))
    world.restore(kept)
    np.testing.assert_array_equal(world.traction, [50e3, 20e3])
    np.testing.assert_array_equal(push(world, 0.3, (-20e3, 60e3)), first)


def test_belt_speeds_take_over_from_forces(world):
    push(world, 0.5, (50e3, 50e3))
    speed = world.belts.copy()
    world.step(hold(world, world.q), (0.0, 0.0))
    np.testing.assert_array_equal(world.traction, [0.0, 0.0])
    np.testing.assert_allclose(world.belts, speed - TRACK.acceleration * world.dt)


def test_a_world_without_rolling_resistance_keeps_rolling(world):
    free = replace(BACKHOE, tracks=replace(TRACK, rolling_resistance=1e-9))
    with simulation.open_world(free, backend=world.backend, soil=False) as frictionless:
        push(frictionless, 0.5, (20e3, 20e3))
        push(frictionless, 1.0, (0.0, 0.0))
        before = frictionless.twist[0]
        log = push(frictionless, 1.0, (0.0, 0.0))
    assert log[-1, 0] == pytest.approx(before, rel=2e-3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"traction": (1.0, 2.0, 3.0)},
            r"traction must be left and right \[N\], shape \(2,\), got sh",
        ),
        ({"traction": (np.nan, 0.0)}, "traction must be finite"),
        ({"traction": ("full", "speed")}, "traction must be numbers"),
        ({"traction": (1j, 0)}, "traction must be numbers"),
        ({"traction": (1.0, 1.0), "belts": (0.1, 0.1)}, "belts .* or traction .*, not both"),
        ({"traction": (1.0, 1.0), "torque": np.zeros(3)}, "torque must be joints"),
    ],
)
def test_what_is_no_traction_is_refused_and_changes_nothing(world, arguments, message):
    push(world, 0.01, (10e3, 10e3))
    before = world.pose, world.belts, world.traction, world.time
    with pytest.raises(ValueError, match=message):
        world.step(**{"torque": np.zeros(4), **arguments})
    for was, now in zip(before, (world.pose, world.belts, world.traction, world.time), strict=True):
        np.testing.assert_array_equal(was, now)


def test_a_fixed_base_cannot_be_driven():
    with (
        simulation.open_world(backend="analytic", base="fixed", soil=False) as world,
        pytest.raises(ValueError, match="a fixed base cannot be driven"),
    ):
        world.step(np.zeros(4), traction=(1.0, 1.0))
