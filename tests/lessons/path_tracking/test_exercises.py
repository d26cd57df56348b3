"""The solutions that lesson 05 shows are the library's own tracking in other words."""

import numpy as np
import pytest

from backhoe.lessons import published
from backhoe.lessons.path_tracking.exercises import (
    controllers,
    errors,
    goal,
    measuring,
    own,
    pursuit,
)
from backhoe.vehicle import skid_steer, tracking


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


def _compared(paths, controllers=("P", "PI")):
    """The runs of section 8: the lesson's gains on the linear model, in path mode."""
    gains = {"P": (4.0,), "PI": (4.0, 1.0)}
    trackers = {
        name: tracking.PIDTracker(rho=(1.0,), dy=gains[name], alpha=(1.0,)) for name in controllers
    }
    return tracking.compare(
        trackers,
        paths,
        lambda: skid_steer.Plant(dt=0.05, model="linear"),
        limits=tracking.Limits.of(skid_steer.HUSKY, 1.0),
        period=0.1,
    )


def test_on_circle_and_eight_the_best_values_are_those_that_table_51_prints_in_bold():
    bold = published.load("dangelo_2022_table_51")["bold"]
    compared = _compared({"circle": tracking.circle(), "figure_eight": tracking.figure_eight()})
    for row, path in enumerate(compared.paths):
        for field in tracking.Metrics._fields:
            best = compared.best(field)[row]
            names = [name for name, marked in zip(compared.trackers, best, strict=True) if marked]
            assert names == bold[path][field], (path, field)


def test_a_square_of_1_2_m_has_the_four_numbers_that_table_51_prints_for_p():
    square = {"square": tracking.square(1.2), "too large": tracking.square(2.0)}
    values = _compared(square, ("P",)).values
    printed = published.load("dangelo_2022_table_51")["P"]["square"]
    for field, value in printed.items():
        assert values[field][0, 0] == pytest.approx(value, abs=0.006)
    assert values["d_ratio"][1, 0] > printed["d_ratio"] + 0.05


@pytest.mark.parametrize("path", [tracking.circle(), tracking.square(), tracking.figure_eight()])
def test_alpha_as_printed_never_arrives_with_gains_that_do_with_the_other_sign(path):
    def drive(alpha):
        def tracker(pose, twist, goal, dt):
            rho, dy, angle = tracking.pose_errors(pose, goal.position, goal.next_position)
            return rho, 4.0 * dy + (rho <= 0.4) * alpha * angle

        return tracking.follow(tracker, tracking.IdealPlant(0.05), path, time_limit=60.0)

    assert drive(1.0).reached
    assert not drive(-1.0).reached


def test_tables_51_and_52_print_other_numbers_for_p_in_what_both_captions_call_matlab():
    first, second = (published.load(f"dangelo_2022_table_5{number}") for number in (1, 2))
    assert all(table["caption"].endswith("MATLAB") for table in (first, second))
    for path in ("circle", "square", "figure_eight"):
        assert second[path]["d_mean"] < 0.81 * first["P"][path]["d_mean"]


@pytest.mark.parametrize(
    "make", [tracking.ScagliaTaylor, tracking.ScagliaLinear, tracking.ScagliaRungeKutta]
)
def test_the_gains_of_fig_63_steer_otherwise_with_every_sample_time(make):
    half_track = skid_steer.turning_half_track(skid_steer.HUSKY)
    eight = tracking.figure_eight().with_times(0.3)
    limits = tracking.Limits(6.0, skid_steer.HUSKY.wheel_radius, half_track)
    steering = []
    for period in (0.05, 0.2, 0.4):
        plant = skid_steer.Plant(dt=0.05, model="slipping", half_track=half_track)
        run = tracking.follow(make(), plant, eight, mode="trajectory", period=period, limits=limits)
        steering.append(tracking.assess(run).change_omega)
    assert steering[0] > 3 * steering[1] > 5 * steering[2]
