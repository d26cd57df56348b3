"""The demonstrations dig and load where the arm can, and recordings look like recordings."""

import numpy as np
import pytest

from backhoe.arm.kinematics import inverse_kinematics
from backhoe.machine import BACKHOE
from backhoe.mission.worksite import TICK, Led
from backhoe.planning.dmp.demonstrations import (
    NOISE,
    STEPS,
    Demonstration,
    demonstration,
    recorded,
    repetitions,
    through,
)

NAMES = ("dig", "load")


def led_along(led, demo):
    ticks = np.arange(0.0, demo.times[-1], TICK)
    at_samples = inverse_kinematics(demo.positions)
    q = np.stack([np.interp(ticks, demo.times, joint) for joint in at_samples.T], axis=1)
    for angles, speeds in zip(q, np.gradient(q, TICK, axis=0), strict=True):
        led.dig(angles, speeds)


def test_durations_start_and_goal_are_those_of_the_source():
    dig, load = demonstration("dig"), demonstration("load")
    assert (dig.times[-1], load.times[-1]) == (13.68, 10.80)
    np.testing.assert_allclose(dig.positions[0], (5.45, -0.40, 1.84, 0.0), atol=1e-12)
    np.testing.assert_allclose(dig.positions[-1], (6.0, -0.5, 2.0, -0.3), atol=1e-12)
    np.testing.assert_allclose(load.positions[0], dig.positions[-1], atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_the_arm_follows_it_within_its_speed_and_starts_and_ends_at_rest(name):
    times, positions = demonstration(name, dt=0.002)
    q = inverse_kinematics(positions)
    assert (np.abs(np.gradient(q, times, axis=0)) < BACKHOE.speed_limit).all()
    dt = times[1]
    for first, second, third in (positions[:3], positions[:-4:-1]):
        assert np.abs(second - first).max() / dt < 1e-3
        assert np.abs(third - 2 * second + first).max() / dt**2 < 0.05


def test_led_along_both_the_machine_digs_and_what_it_dug_lies_in_the_truck():
    led = Led(0)
    led_along(led, demonstration("dig"))
    dug = led.ground.bucket_volume
    led_along(led, demonstration("load"))
    assert dug > 0.75 * led.ground.fill.heaped
    assert led.ground.truck_volume > 0.98 * dug


def test_a_recording_has_uneven_steps_and_the_noise_that_it_says():
    clean = demonstration("dig", dt=0.001)
    seen = recorded(clean, seed=3)
    steps = np.diff(seen.times)
    assert steps.min() >= STEPS[0] and steps.max() <= sum(STEPS) and steps.std() > 0.01
    assert (seen.times[0], seen.times[-1]) == (0.0, 13.68)
    truth = np.stack([np.interp(seen.times, clean.times, p) for p in clean.positions.T], axis=1)
    np.testing.assert_allclose((seen.positions - truth).std(axis=0), NOISE, rtol=0.15)
    np.testing.assert_allclose(
        recorded(clean, noise=(0, 0, 0, 0)).positions[[0, -1]], clean.positions[[0, -1]]
    )


@pytest.mark.parametrize("name", NAMES)
def test_repetitions_differ_are_the_same_for_a_seed_and_stay_in_reach(name):
    one, again, other = (repetitions(name, 20, seed) for seed in (1, 1, 2))
    durations = [demo.times[-1] for demo in one]
    assert len(set(durations)) == 20
    assert 0.02 < np.std(durations) / np.mean(durations) < 0.1
    for a, b, c in zip(one, again, other, strict=True):
        assert np.array_equal(a.positions, b.positions)
        assert not np.array_equal(a.positions[0], c.positions[0])
        inverse_kinematics(a.positions)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: demonstration("weld"), "name must be"),
        (lambda: demonstration(dt=0.0), "dt must be one number above 0"),
        (lambda: demonstration(dt=20.0), "at most the movement's 13.68 s"),
        (lambda: repetitions(count=0), "count must be"),
        (lambda: through([1.0, 2.0], np.zeros((2, 4))), "must rise from 0"),
        (lambda: through([0.0, 2.0], np.zeros((2, 3))), "points"),
        (lambda: recorded(demonstration(), noise=(0, 0, 0, -1)), "must not be negative"),
        (lambda: recorded(Demonstration(np.arange(3.0), np.zeros((4, 4)))), "positions"),
        (lambda: recorded(Demonstration(np.zeros(3), np.zeros((3, 4)))), "times"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
