"""Movements: smooth, within the machine's limits, through their way-points, and calm refusals."""

from dataclasses import replace

import numpy as np
import pytest

from backhoe.arm import dynamics, kinematics, movement
from backhoe.arm.movement import Movement
from backhoe.machine import BACKHOE, variants
from backhoe.simulation.soil import SANDY_LOAM


@pytest.fixture(scope="module")
def loading():
    return movement.loading()


def test_loading_lasts_35_s_and_rests_between_its_phases(loading):
    assert len(loading) == 35_001
    assert loading.dt == pytest.approx(1e-3)
    for times in movement.PHASES.values():
        for time in times:
            row = round(time / loading.dt)
            assert loading.t[row] == pytest.approx(time)
            assert not loading.dq[row].any()
            assert not loading.ddq[row].any()


def test_loading_digs_ahead_and_empties_to_the_left():
    """Swing and bucket [deg], and the reach from the swing axis [m], at rest."""
    loading = movement.loading(dt=0.01)
    for time, swing, bucket, reach in ((5.0, -90, 60, 6.0), (20.0, 0, 90, 5.7)):
        q = loading.q[round(time / loading.dt)]
        assert np.degrees(q[[0, 3]]) == pytest.approx([swing, bucket])
        x, y, _ = kinematics.forward_kinematics(q, "stick")[:3, 3] - [BACKHOE.base.offset, 0, 0]
        ahead = np.radians(swing + 90)
        assert (x, y) == pytest.approx((reach * np.cos(ahead), reach * np.sin(ahead)))


def test_loading_is_as_fast_as_the_movement_of_the_thesis(loading):
    """59.53 deg/s; ours is laid out to come within 0.1 deg/s of it."""
    assert np.degrees(loading.speed.max()) == pytest.approx(59.53, abs=0.1)


def test_loading_stays_within_range_speed_and_torque_with_a_full_bucket(loading):
    q, dq = loading.q, loading.dq
    assert (q > BACKHOE.lower).all() and (q < BACKHOE.upper).all()
    assert (np.abs(dq) < 0.8 * BACKHOE.speed_limit).all()
    load = BACKHOE.shell.struck_capacity * SANDY_LOAM.density
    for mass in (0.0, load):
        needed = dynamics.inverse_dynamics(
            q, dq, loading.ddq, friction=True, machine=variants.loaded(mass)
        )
        assert (np.abs(needed) < 0.8 * BACKHOE.torque_limit).all()


def test_speeds_and_accelerations_are_the_derivatives_of_the_angles(loading):
    """The error of the trapezoidal rule falls with the square of the step."""

    def gaps(m):
        by_speed = np.diff(m.q, axis=0) / m.dt - (m.dq[1:] + m.dq[:-1]) / 2
        by_acceleration = np.diff(m.dq, axis=0) / m.dt - (m.ddq[1:] + m.ddq[:-1]) / 2
        return np.abs(by_speed).max(), np.abs(by_acceleration).max()

    coarse, fine = gaps(movement.loading(dt=0.01)), gaps(loading)
    for large, small in zip(coarse, fine, strict=True):
        assert small < large / 50
    assert fine[1] < 1e-5


def test_acceleration_is_continuous(loading):
    """Its largest step between samples shrinks with them."""
    coarse = movement.loading(dt=0.01)
    jumps = [np.abs(np.diff(m.ddq, axis=0)).max() for m in (coarse, loading)]
    assert jumps[1] < jumps[0] / 8


def test_a_coarser_loading_is_the_same_movement(loading):
    coarse = movement.loading(dt=0.1)
    for name in ("q", "dq", "ddq"):
        found, expected = getattr(coarse, name), getattr(loading, name)[::100]
        np.testing.assert_allclose(found, expected, atol=1e-12)


def test_a_waiting_joint_waits_without_rounding(loading):
    tipping = (loading.t > 16.5) & (loading.t < 20)
    assert not loading.dq[tipping, :3].any()


def test_from_targets_passes_its_way_points():
    targets = np.array([[0.4, 5.7, 3.9, 0.0], [2.4, 5.0, 3.0, 0.5], [6.0, 0.0, 3.0, 1.0]])
    m = movement.from_targets([0, 4, 8], targets, dt=0.01)
    np.testing.assert_allclose(kinematics.pose(m.q[[0, 400, 800]]), targets, atol=1e-9)
    assert m.dq[400].any()


def test_a_rest_is_a_stop_on_the_way():
    postures = np.radians([[0, 10, 0, 0], [20, 15, 5, 30], [40, 10, 0, 0]])
    m = movement.from_postures([0, 4, 8], postures, dt=0.01, rest=[1])
    assert not m.dq[400].any()


def test_between_two_rests_it_is_the_minimum_jerk_polynomial():
    start, end = np.radians([[0, 10, 0, 0], [40, 20, -10, 30]])
    m = movement.from_postures([0, 5], [start, end], dt=0.01)
    s = m.t / 5
    share = 10 * s**3 - 15 * s**4 + 6 * s**5
    np.testing.assert_allclose(m.q, start + share[:, None] * (end - start), atol=1e-12)


POSTURES = np.zeros((3, 4))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ([0, 1, 2], np.zeros((2, 4))),
            r"postures must be joint angles .*, shape \(3, 4\), got shape \(2, 4\)",
        ),
        (([0, 2, 1], POSTURES), "times must rise: 2.0 s at index 1 is followed by 1.0 s"),
        (([1, 2, 3], POSTURES), "times must rise from 0"),
        (([0.0], POSTURES[:1]), "times must be a row of 2 or more times, got 1"),
        (([0, np.nan, 2], POSTURES), "times must be finite, got nan at index 1"),
        (([0, 1, 2.0005], POSTURES), "multiples of dt"),
        (([0, 1, 2], POSTURES, 0.0), r"dt must be one number above 0 \[s\], got 0.0"),
        (([0, 1, 2], POSTURES * np.nan), "postures must be finite"),
        (([0, 1, 2], POSTURES, 0.1, BACKHOE, [3]), r"rest must be indices from 0 to 2, got \[3\]"),
        (([0, 1], np.radians([[0, 0, 0, 0], [0, 0, 0, 130]])), "bucket would be at 130.0 deg"),
        (([0, 1], np.radians([[0, 0, 0, 0], [90, 0, 0, 0]])), "swing would turn at 2.9"),
    ],
)
def test_bad_way_points_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        movement.from_postures(*arguments)


def test_a_target_out_of_reach_is_named():
    with pytest.raises(ValueError, match="outside the reach"):
        movement.from_targets([0, 5], [[5.0, 0.0, 3.0, 0.0], [15.0, 0.0, 3.0, 0.0]])


def test_a_movement_just_above_the_speed_limit_is_refused():
    """From rest to rest in T the fifth order's largest speed is 15/8 of the mean one."""
    turn = 1.0
    quickest = 15 / 8 * turn / BACKHOE.speed_limit[0]
    q = np.array([[0.0, 0.2, 0.0, 0.0], [turn, 0.2, 0.0, 0.0]])
    movement.from_postures([0.0, round(1.01 * quickest, 3)], q)
    with pytest.raises(ValueError, match="swing"):
        movement.from_postures([0.0, round(0.99 * quickest, 3)], q)


def test_the_advice_on_speed_is_enough():
    """Taking as many times as long as the message says brings the joint to its limit."""
    turn = np.radians([[0, 0, 0, 0], [90, 0, 0, 0]])
    with pytest.raises(ValueError, match="take") as caught:
        movement.from_postures([0, 1], turn)
    factor = float(str(caught.value).split("take ")[1].split(" times")[0])
    slower = movement.from_postures([0, round(factor + 0.005, 2)], turn)
    assert slower.speed.max() == pytest.approx(BACKHOE.speed_limit[0], rel=0.01)


T = np.arange(4) / 10
ZEROS = np.zeros((4, 4))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"t": T[::-1]}, "Movement.t must rise: 0.3.* s at index 0 is followed by 0.2 s"),
        ({"t": np.array([0, 0.1, 0.1, 0.2])}, "t must rise"),
        ({"t": np.array([0, 0.1, 0.2, 0.4])}, "evenly spaced"),
        (
            {"q": np.where(np.eye(4) > 0, np.nan, 0)},
            r"Movement.q must be finite, got nan at index \(0, 0\)",
        ),
        ({"dq": np.zeros((3, 4))}, r"dq must have shape \(4, 4\)"),
        ({"t": T[:0]}, r"Movement.t must be times .*, shape \(n,\), got shape \(0,\)"),
        ({"t": 1.0}, r"t must be times .*, shape \(n,\), got shape \(\)"),
        ({"ddq": "fast"}, "ddq must be numbers"),
    ],
)
def test_a_malformed_movement_is_refused(change, message):
    good = Movement(T, ZEROS, ZEROS, ZEROS)
    with pytest.raises(ValueError, match=message):
        replace(good, **change)
