"""The solutions that lesson 05 shows are the library's own tracking in other words."""

import numpy as np
import pytest

from backhoe import tracking
from backhoe.exercises.path_tracking import controllers, errors, goal, measuring, own, pursuit


@pytest.fixture
def rng():
    return np.random.default_rng(55)


def test_missing_length_completes_the_printed_run_to_the_way_out_and_once_round():
    printed = 1.084 * 2 * np.pi * 1.5
    assert printed + measuring.missing_length() == pytest.approx(1.5 + 2 * np.pi * 1.5)


def test_metrics_are_the_librarys(rng):
    for actual, reference in measuring.METRICS.inputs():
        np.testing.assert_allclose(
            measuring.metrics(actual, reference), tracking.metrics(actual, reference), rtol=1e-12
        )


def test_pose_errors_are_the_librarys():
    for case in errors.POSE_ERRORS.inputs():
        np.testing.assert_allclose(errors.pose_errors(*case), tracking.pose_errors(*case))


def test_limit_is_the_librarys_and_keeps_every_wheel_within_its_speed():
    for v, omega, wheel_max, r, c in errors.LIMITS.inputs():
        limited = errors.limit(v, omega, wheel_max, r, c)
        right = tracking.Limits(wheel_max, r, c).apply(v, omega)
        np.testing.assert_allclose(limited, right, rtol=1e-12, atol=1e-12)
        assert (abs(limited[0]) + c * abs(limited[1])) / r <= wheel_max * (1 + 1e-12)


def test_goal_is_the_librarys_position_at_the_end_of_the_sample():
    for time, dt, points, times in goal.GOAL.inputs():
        path = tracking.Path(points, times)
        np.testing.assert_allclose(goal.goal(time, dt, points, times), path.position(time + dt))


def test_scaglia_is_the_librarys_optimum():
    for pose, place, dt, kv2, kw2 in controllers.SCAGLIA.inputs():
        tracker = tracking.ScagliaTaylor(kv2, kw2, optimum=True)
        there = tracking.Goal(place, place, 0.0, np.zeros((2, 2)), 0.0)
        right = tracker(pose, np.zeros(2), there, dt)
        np.testing.assert_allclose(controllers.scaglia(pose, place, dt, kv2, kw2), right)


def test_pure_pursuit_drives_through_the_point_ahead():
    for pose, path, lookahead, speed in pursuit.PURSUIT.inputs():
        v, omega = pursuit.pure_pursuit(pose, path, lookahead, speed)
        assert v == speed
        target = pursuit._target(pose, path, lookahead)
        period = 2 * np.pi / max(abs(omega), 1e-3)
        arc = np.array([tracking.arc(pose, v, omega, t) for t in np.linspace(0, period, 2000)])
        assert np.linalg.norm(arc[:, :2] - target, axis=1).min() < 2e-3 * max(1, v * period)


@pytest.mark.parametrize("name", own._PATHS)
def test_own_tracker_trails_its_goal_by_the_speed_over_its_gain(name):
    assert own.distance_to_goal(own.own_tracker(), name) == pytest.approx(0.4 / 4.0, abs=0.005)


def test_trackers_of_the_library_pass_as_ones_own():
    assert own.judged(tracking.ScagliaTaylor(), None) is True
    assert own.judged(tracking.ScagliaLinear(), None) is True


def test_a_slow_tracker_on_the_line_is_told_that_it_is_late():
    pursuer = tracking.PurePursuit(0.2, speed=0.2)
    assert "not to the time" in own.judged(pursuer, None)
