"""Pose errors, limits, the trackers by PID and pure pursuit, runs and comparisons."""

import re
from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from backhoe.lessons import published
from backhoe.vehicle import skid_steer, tracking
from backhoe.vehicle.skid_steer import SkidSteerPlant
from backhoe.vehicle.tracking import (
    Goal,
    IdealPlant,
    Limits,
    PIDTracker,
    PurePursuit,
    arc,
    follow,
)
from backhoe.vehicle.tracking import tuned as tuned_trackers
from backhoe.vehicle.tracking.foot import Foot

angles = st.floats(-30.0, 30.0)
places = st.tuples(st.floats(-5, 5), st.floats(-5, 5))
LIMITS = Limits(6.0, 0.165, 0.285)
HALF_TRACK = skid_steer.turning_half_track(skid_steer.HUSKY)
HUSKY_LIMITS = Limits(
    1.0 / skid_steer.HUSKY.wheel_radius, skid_steer.HUSKY.wheel_radius, HALF_TRACK
)
PATHS = {
    "circle": tracking.circle(),
    "square": tracking.square(),
    "figure_eight": tracking.figure_eight(),
}


def distances_of(run):
    return tracking.distances(run.pose[:, :2], run.path.points)


def slipping():
    return SkidSteerPlant(skid_steer.HUSKY, 0.02, "slipping", half_track=HALF_TRACK)


def goal_at(*position, following=None, speed=0.5, waypoint=None, path=((0, 0), (1, 0))):
    following = position if following is None else following
    place = np.array(position, float), np.array(following, float)
    return Goal(*place, speed, np.array(path, float), 0.02, waypoint)


@given(places, angles, places, places)
def test_the_pose_errors_are_the_way_point_in_the_frame_of_the_vehicle(here, theta, a, b):
    errors = tracking.pose_errors((*here, theta), a, b)
    dx, dy = a[0] - here[0], a[1] - here[1]
    assert errors.rho == pytest.approx(np.hypot(dx, dy), abs=1e-12)
    assert errors.dy == pytest.approx(-dx * sin(theta) + dy * cos(theta), abs=1e-11)
    onward = np.array(b) - a
    if onward.any():
        ahead = np.hypot(*onward) * np.array([cos(errors.alpha + theta), sin(errors.alpha + theta)])
        np.testing.assert_allclose(ahead, onward, atol=1e-11)


def test_both_errors_grow_smaller_by_a_turn_to_the_side_they_name():
    pose, turned = (0, 0, 0.0), (0, 0, 0.1)
    before = tracking.pose_errors(pose, (1, 0.5), (1, 2))
    after = tracking.pose_errors(turned, (1, 0.5), (1, 2))
    assert before.dy > after.dy > 0 and before.alpha > after.alpha > 0


def test_whole_turns_of_the_heading_change_no_pose_error():
    for turns in (-2, -1, 1):
        pose = (0.5, -0.2, 3.0 + 2 * np.pi * turns)
        turned = tracking.pose_errors(pose, (1.0, 2.0), (-1.0, 1.5))
        one = tracking.pose_errors((0.5, -0.2, 3.0), (1.0, 2.0), (-1.0, 1.5))
        assert turned == pytest.approx(one)


def test_without_a_next_way_point_there_is_no_alpha():
    assert tracking.pose_errors((0, 0, 1), (1, 1)).alpha == 0.0
    assert tracking.pose_errors((0, 0, 1), (1, 1), (1, 1)).alpha == 0.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (((0, 0), (1, 1), (2, 2)), r"pose must be x, y, heading, shape \(3,\)"),
        (((0, 0, np.nan), (1, 1), (2, 2)), "pose must be finite"),
        (((0, 0, 0), (1, 1, 1), (2, 2)), r"waypoint must be x, y, shape \(2,\)"),
        (((0, 0, 0), (1, 1), "ab"), "next_waypoint must be numbers"),
        (((0, 0, 0), np.ones((2, 2)), (1, 1)), "waypoint must be x, y"),
        ((None, (1, 1), (1, 1)), "pose must be"),
    ],
)
def test_pose_errors_name_what_is_wrong(arguments, message):
    with pytest.raises(ValueError, match=message):
        tracking.pose_errors(*arguments)


@given(st.floats(-10, 10), st.floats(-20, 20))
def test_within_the_limits_no_wheel_is_too_fast_and_the_turn_comes_first(v, omega):
    v_given, omega_given = LIMITS.apply(v, omega)
    wheels = np.array([v_given - 0.285 * omega_given, v_given + 0.285 * omega_given]) / 0.165
    assert np.abs(wheels).max() <= 6.0 * (1 + 1e-12)
    assert omega_given == pytest.approx(np.clip(omega, -LIMITS.max_turn_rate, LIMITS.max_turn_rate))
    assert abs(v_given) <= abs(v) and v_given * v >= 0
    if np.abs([v - 0.285 * omega, v + 0.285 * omega]).max() <= 6.0 * 0.165:
        assert (v_given, omega_given) == (pytest.approx(v), omega)


def test_limits_are_those_of_section_51():
    limits = Limits(wheel_speed=6.0, wheel_radius=0.165, half_track=0.285)
    assert limits.max_turn_rate == pytest.approx(0.165 / 0.285 * 6.0)
    assert limits.apply(9.0, 2.0) == (pytest.approx(0.165 * 6.0 - 0.285 * 2.0), 2.0)
    assert limits.apply(-9.0, -99.0) == (0.0, -limits.max_turn_rate)


def test_limits_of_a_vehicle_and_of_the_tracks():
    husky = Limits.of(skid_steer.HUSKY, 1.0)
    assert husky.max_speed == pytest.approx(1.0)
    assert husky.half_track == skid_steer.HUSKY.half_track
    tracks = Limits.of_tracks()
    assert tracks.max_speed == pytest.approx(1.5)
    assert tracks.max_turn_rate == pytest.approx(1.5 / 1.19)


@pytest.mark.parametrize("wrong", [0.0, -1.0, np.nan, np.inf, "fast", None])
def test_limits_are_positive_numbers(wrong):
    with pytest.raises(ValueError, match="wheel_speed must be"):
        Limits(wrong, 0.165, 0.285)


def test_the_pid_tracker_sums_its_loops():
    tracker = PIDTracker((2.0,), (3.0,), (5.0,), rho_alpha=1.5)
    v, omega = tracker([0, 0, 0], [0, 0], goal_at(1.0, 0.5, following=(1.0, 1.5)), 0.02)
    assert v == pytest.approx(2.0 * np.hypot(1.0, 0.5))
    assert omega == pytest.approx(3.0 * 0.5 + 5.0 * pi / 2)


def test_alpha_counts_near_the_way_point_alone():
    goal = goal_at(1.0, 0.0, following=(1.0, 1.0))
    near, far = PIDTracker(rho_alpha=1.01), PIDTracker(rho_alpha=0.99)
    assert near([0, 0, 0], [0, 0], goal, 0.02)[1] == pytest.approx(pi / 2)
    assert far([0, 0, 0], [0, 0], goal, 0.02)[1] == 0.0


def test_the_last_way_point_asks_for_no_direction():
    tracker = PIDTracker(rho_alpha=9.0)
    assert tracker([0.1, 0.1, 0.3], [0, 0], goal_at(0.7, 0.7), 0.02)[1] == pytest.approx(
        4.0 * np.hypot(0.6, 0.6) * sin(pi / 4 - 0.3)
    )


def test_the_integral_of_the_lateral_error_grows_until_reset():
    tracker = PIDTracker((1.0,), (2.0, 3.0), (0.0,))
    state = [0, 0, 0], [0, 0], goal_at(1.0, 0.5), 0.1
    turns = [tracker(*state)[1] for _ in range(3)]
    np.testing.assert_allclose(turns, 2.0 * 0.5 + 3.0 * 0.5 * 0.1 * np.array([1, 2, 3]))
    tracker.reset()
    assert tracker(*state)[1] == pytest.approx(turns[0])


@pytest.mark.parametrize("forgets", [True, False])
def test_integrals_are_forgotten_at_a_way_point_only_if_so_asked(forgets):
    tracker = PIDTracker((1.0,), (2.0, 3.0), (0.0,), reset_at_waypoints=forgets)
    for _ in range(5):
        tracker([0, 0, 0], [0, 0], goal_at(1.0, 0.5, waypoint=0), 0.1)
    turn = tracker([0, 0, 0], [0, 0], goal_at(1.0, 0.5, waypoint=1), 0.1)[1]
    assert turn == pytest.approx(1.0 + 3.0 * 0.5 * 0.1 * (1 if forgets else 6))


def test_each_loop_stops_winding_up_at_the_limits_of_the_vehicle():
    tracker = PIDTracker((1.0, 5.0), (1.0, 5.0), (0.0,), limits=LIMITS)
    goal = goal_at(0.0, 3.0)
    for _ in range(200):
        v, omega = tracker([0, 0, 0], [0, 0], goal, 0.05)
    assert (v, omega) == (0.0, pytest.approx(LIMITS.max_turn_rate))
    _, omega = tracker([0, 0, 0], [0, 0], goal_at(0.0, -0.1), 0.05)
    assert omega < LIMITS.max_turn_rate - 3.0


def test_a_goal_straight_behind_makes_the_pid_tracker_drive_away():
    v, omega = tracking.TRACKERS["P"]()([0, 0, 0], [0, 0], goal_at(-1.0, 0.0), 0.02)
    assert v > 0 and omega == pytest.approx(0.0, abs=1e-12)


def test_an_integral_of_the_distance_never_unwinds_and_overshoots_a_trajectory():
    path = tracking.figure_eight().with_times(0.3)
    runs = {
        ki: follow(PIDTracker((1.25, ki), (6.0,)), IdealPlant(), path, mode="trajectory")
        for ki in (0.0, 0.5)
    }
    assert runs[0.0].metrics.d_ratio < 1.0
    assert runs[0.5].metrics.d_ratio > 1.2


def test_the_pid_tracker_says_that_its_sample_time_changed():
    tracker = PIDTracker()
    tracker([0, 0, 0], [0, 0], goal_at(1.0, 0.0), 0.02)
    with pytest.raises(ValueError, match=r"changed from 0.02 s to 0.1 s: call reset"):
        tracker([0, 0, 0], [0, 0], goal_at(1.0, 0.0), 0.1)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: PIDTracker(rho=1.0), "rho must be gains kp, ki, kd or fewer, shape"),
        (lambda: PIDTracker(dy=(1, 2, 3, 4)), "dy must be gains kp, ki, kd or fewer, got 4"),
        (lambda: PIDTracker(alpha=(-1.0,)), "alpha must be one number at least 0"),
        (lambda: PIDTracker(alpha=(np.inf,)), "alpha must be finite"),
        (lambda: PIDTracker(rho=("a",)), "rho must be"),
        (lambda: PIDTracker(rho=()), "rho must be"),
        (lambda: PIDTracker(rho_alpha=-1), "rho_alpha must be one number at least 0"),
        (lambda: PIDTracker(rho_alpha=np.nan), "rho_alpha must be one number at least 0"),
        (lambda: PurePursuit(0.0), "lookahead must be one number above 0"),
        (lambda: PurePursuit(speed=-1), "speed must be one number above 0"),
        (lambda: PurePursuit(window=0), "window must be one number above 0"),
        (lambda: PurePursuit(catch_up=-1), "catch_up must be one number at least 0"),
        (lambda: IdealPlant(0.0), "dt must be one number above 0"),
        (lambda: IdealPlant(pose=(0, 0)), "pose must be x, y, heading"),
    ],
)
def test_settings_out_of_range_are_named(make, message):
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize("tracker", [make() for make in tracking.TRACKERS.values()])
@pytest.mark.parametrize(
    ("pose", "twist", "message"),
    [
        ([0, 0], [0, 0], r"pose must be x, y, heading, shape \(3,\)"),
        ([0, np.nan, 0], [0, 0], "pose must be"),
        ([0, 0, 0], [0], r"twist must be v, omega, shape \(2,\)"),
    ],
)
def test_every_tracker_names_a_state_that_is_none(tracker, pose, twist, message):
    with pytest.raises(ValueError, match=message):
        tracker(pose, twist, goal_at(1.0, 0.0), 0.1)


@pytest.mark.parametrize("y", [0.0, 0.1, -0.25])
def test_pure_pursuit_drives_the_arc_through_its_target(y):
    tracker = PurePursuit(0.4, speed=0.5)
    goal = goal_at(9, 0, waypoint=1, path=[[0, 0], [9, 0]])
    v, omega = tracker([0.3, y, 0.1], [0, 0], goal, 0.02)
    target = np.array([0.3 + np.sqrt(0.4**2 - y**2), 0.0])
    times = np.linspace(0.0, 2.0, 4001)
    way = np.array([arc([0.3, y, 0.1], v, omega, t)[:2] for t in times])
    assert np.hypot(*(way - target).T).min() < 2e-4
    assert v == 0.5


def test_pure_pursuit_comes_to_a_line_as_its_linear_equation_says():
    L, v, y0 = 0.5, 0.4, 0.01
    path = tracking.from_points([[0, 0], [20, 0]])
    run = follow(PurePursuit(L, v), IdealPlant(0.005, (0.1, y0, 0.0)), path, time_limit=6.0)
    rate = v / L
    expected = y0 * np.exp(-rate * run.time) * (np.cos(rate * run.time) + np.sin(rate * run.time))
    np.testing.assert_allclose(run.pose[:, 1], expected, atol=0.01 * y0)


def test_pure_pursuit_keeps_to_its_branch_where_a_path_crosses_itself():
    path = tracking.figure_eight()
    tracker, plant = PurePursuit(0.3, 0.5), IdealPlant(pose=(0, 0, pi / 4))
    progress = []

    def watched(*state):
        answer = tracker(*state)
        progress.append(tracker._foot.way)
        return answer

    assert follow(watched, plant, path).reached
    steps = np.diff(progress)
    assert (steps >= 0).all() and steps.max() < 0.03
    assert progress[-1] > path.length - 0.3


def test_the_foot_on_a_path_never_goes_back():
    foot = Foot(np.array([[0.0, 0.0], [4.0, 0.0]]), window=1.0)
    for x, way in ((0.8, 0.8), (0.3, 0.8), (1.2, 1.2), (9.0, 2.2)):
        foot.move_to(x, 0.1)
        assert foot.way == pytest.approx(way)


def test_pure_pursuit_stops_when_it_has_passed_the_end():
    tracker = PurePursuit(0.4, 0.5)
    goal = goal_at(1, 0, waypoint=2, path=[[0, 0], [1, 0], [1, 0]])
    assert tracker([0.95, 0, 0], [0, 0], goal, 0.02)[0] == 0.5
    assert tracker([1.01, 0.02, 0], [0, 0], goal, 0.02) == (0.0, 0.0)


def test_pure_pursuit_turns_as_tightly_as_it_can_for_a_point_behind():
    tracker = PurePursuit(0.4, 0.5)
    goal = goal_at(9, 0, waypoint=1, path=[[2, 0], [9, 0]])
    v, omega = tracker([2, -0.01, pi], [0, 0], goal, 0.02)
    assert v == 0.5 and abs(omega) == pytest.approx(0.5 * 2 / 0.4)


def test_pure_pursuit_hurries_after_a_goal_that_is_ahead_and_waits_for_one_behind():
    tracker = PurePursuit(0.4, catch_up=2.0, window=5.0)
    path = [[0, 0], [9, 0]]
    assert tracker([1, 0, 0], [0, 0], goal_at(1.3, 0, path=path), 0.02)[0] == pytest.approx(1.1)
    tracker.reset()
    assert tracker([1, 0, 0], [0, 0], goal_at(0.5, 0, path=path), 0.02)[0] == 0.0
    in_path_mode = goal_at(1.3, 0, path=path, waypoint=1)
    assert tracker([1, 0, 0], [0, 0], in_path_mode, 0.02)[0] == 0.5


def test_pure_pursuit_does_not_stand_still_when_it_looks_away_from_the_goal():
    path = tracking.from_points([[0, 0], [9, 0]]).with_times(0.5)
    run = follow(PurePursuit(0.4), IdealPlant(pose=(0, -1, pi)), path, mode="trajectory")
    assert run.reached
    assert (run.command[:, 0] > 0.4).all()


@pytest.mark.parametrize("lookahead", [0.1, 1.6])
def test_pure_pursuit_comes_through_with_an_unlucky_look_ahead(lookahead):
    path = PATHS["figure_eight"].with_times(0.3)
    tracker = PurePursuit(lookahead)
    run = follow(tracker, slipping(), path, mode="trajectory", limits=HUSKY_LIMITS)
    assert 0.6 < run.metrics.d_ratio < 1.6
    assert run.goal_distance[-1] < 0.6


@pytest.mark.parametrize("name", tracking.TRACKERS)
@pytest.mark.parametrize("path", PATHS)
def test_in_path_mode_every_way_point_is_reached_in_its_turn(name, path):
    run = follow(tracking.TRACKERS[name](), IdealPlant(), PATHS[path], limits=HUSKY_LIMITS)
    assert run.reached
    order = [int(np.argmin(np.hypot(*(run.goal[0] - PATHS[path].points).T)))]
    goals = run.goal[np.r_[True, np.diff(run.goal, axis=0).any(axis=1)]]
    points = PATHS[path].points.tolist()
    for goal in goals[1:].tolist():
        order.append(points.index(goal, order[-1] + 1))
    assert order == sorted(order)
    assert np.hypot(*(run.pose[-1, :2] - points[-1])) <= tracking.ARRIVAL
    for point in points:
        assert np.hypot(*(run.pose[:, :2] - point).T).min() <= tracking.ARRIVAL


@pytest.mark.parametrize("path", PATHS)
def test_the_distance_to_the_goal_is_never_less_than_to_the_path_nor_than_the_arrival(path):
    run = follow(tracking.TRACKERS["P"](), IdealPlant(), PATHS[path])
    assert (run.goal_distance[:-1] > tracking.ARRIVAL).all()
    assert (distances_of(run) <= run.goal_distance + 1e-12).all()


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("name", tracking.TRACKERS)
@pytest.mark.parametrize("make", [IdealPlant, slipping])
def test_every_tuned_tracker_keeps_to_every_trajectory_on_ideal_and_on_slipping_wheels(
    make, name, path
):
    route = PATHS[path].with_times(0.3)
    tracker = tracking.TRACKERS[name]()
    run = follow(tracker, make(), route, mode="trajectory", limits=HUSKY_LIMITS)
    once_there = distances_of(run)[len(run.time) // 3 :]
    assert once_there.mean() < 0.06 and once_there.max() < 0.16
    assert np.hypot(*(run.pose[-1, :2] - route.points[-1])) < 0.35
    assert abs(tracking.time_lag(run)) < 0.9


def test_the_pattern_of_table_51_is_found_on_slipping_wheels_but_for_the_ratio_and_the_circle():
    bold = published.load("dangelo_2022_table_51")["bold"]
    trackers = {"P": tracking.TRACKERS["P"](), "PI": tracking.TRACKERS["PI"]()}
    found = tracking.compare(trackers, PATHS, slipping, limits=HUSKY_LIMITS)
    for path, metrics in (
        ("square", ["d_mean", "d_std", "d_max", "d_ratio"]),
        ("figure_eight", ["d_mean", "d_std", "d_max"]),
        ("circle", ["d_max"]),
    ):
        for metric in metrics:
            best = found.best(metric)[found.paths.index(path)]
            assert [n for n, b in zip(trackers, best, strict=True) if b] == bold[path][metric]


def test_in_trajectory_mode_the_goal_is_where_the_trajectory_is_at_the_end_of_the_sample():
    path = tracking.figure_eight().with_times(0.4)
    seen = []

    def tracker(pose, twist, goal, dt):
        seen.append((goal, dt))
        return 0.1, 0.2

    run = follow(tracker, IdealPlant(0.05), path, mode="trajectory")
    goals, dts = zip(*seen, strict=True)
    times = np.array([goal.time for goal in goals])
    np.testing.assert_allclose(times, 0.05 * np.arange(1, len(goals) + 1))
    np.testing.assert_array_equal([g.position for g in goals], path.position(times))
    following = np.array([g.next_position for g in goals])
    np.testing.assert_allclose(following, path.position(times + 0.05), atol=1e-12)
    assert {goal.waypoint for goal in goals} == {None} and set(dts) == {0.05}
    assert goals[10].speed == pytest.approx(0.4)
    assert run.time[-1] == pytest.approx(path.end_time, abs=0.05)
    assert not run.reached


def test_a_goal_in_path_mode_is_a_way_point_and_the_one_after_it():
    seen = []

    def tracker(pose, twist, goal, dt):
        seen.append(goal)
        return 0.5, 0.0

    path = tracking.from_points([[0, 0], [1, 0], [2, 0]])
    run = follow(tracker, IdealPlant(0.1), path, speed=0.7)
    assert run.reached and run.time[-1] == pytest.approx(3.6)
    assert [g.waypoint for g in seen[:3]] == [1, 1, 1] and seen[-1].waypoint == 2
    assert seen[0].position.tolist() == [1, 0] and seen[0].next_position.tolist() == [2, 0]
    assert seen[-1].position.tolist() == seen[-1].next_position.tolist() == [2, 0]
    assert {g.speed for g in seen} == {0.7}
    assert [g.time for g in seen[:2]] == [pytest.approx(0.1), pytest.approx(0.2)]


def test_a_tracker_with_a_longer_period_has_its_command_held():
    calls = []

    def tracker(pose, twist, goal, dt):
        calls.append(dt)
        return 0.1 * len(calls), 0.0

    path = tracking.from_points([[0, 0], [9, 0]])
    run = follow(tracker, IdealPlant(0.02), path, period=0.1, time_limit=0.5)
    assert calls == [pytest.approx(0.1)] * 5
    np.testing.assert_allclose(run.command[:25, 0], np.repeat(0.1 * np.arange(1, 6), 5))
    assert run.time[-1] == pytest.approx(0.5) and len(run.time) == 26


def test_a_tracker_may_bring_its_own_period():
    tracker = tracking.ScagliaTaylor(period=0.1)
    run = follow(tracker, IdealPlant(0.02), tracking.circle().with_times(0.3), mode="trajectory")
    assert (np.diff(run.command[:-1].reshape(-1, 5, 2)[:20], axis=1) == 0).all()


def test_a_run_is_what_the_plant_did():
    path = tracking.square().with_times(0.3)
    run = follow(tracking.TRACKERS["P"](), IdealPlant(0.05), path, mode="trajectory")
    pose = run.pose[0]
    for k, command in enumerate(run.command[:-1]):
        pose = arc(pose, *command, 0.05)
        np.testing.assert_allclose(pose, run.pose[k + 1], atol=1e-9)
    np.testing.assert_array_equal(run.twist[1:], run.command[:-1])


def test_the_same_run_twice_gives_the_same_numbers():
    tracker, path = tracking.TRACKERS["PI"](), tracking.circle()
    runs = [follow(tracker, slipping(), path, limits=HUSKY_LIMITS) for _ in range(2)]
    np.testing.assert_array_equal(runs[0].pose, runs[1].pose)


def test_the_limits_of_a_plant_are_used_unless_others_are_given():
    plant = IdealPlant()
    plant.limits = LIMITS
    path = tracking.from_points([[0, 0], [9, 0]])
    own = follow(lambda *_: (9.0, 1.0), plant, path, time_limit=0.1)
    assert own.command[0].tolist() == list(LIMITS.apply(9.0, 1.0))
    given_ones = follow(lambda *_: (9.0, 1.0), plant, path, time_limit=0.1, limits=HUSKY_LIMITS)
    assert given_ones.command[0].tolist() == list(HUSKY_LIMITS.apply(9.0, 1.0))


def test_a_run_that_never_arrives_ends_at_its_time_limit():
    path = tracking.from_points([[0, 0], [9, 0]])
    run = follow(lambda *_: (0.0, 0.0), IdealPlant(0.1), path, time_limit=2.0)
    assert not run.reached and run.time[-1] == pytest.approx(2.0)
    patient = follow(lambda *_: (0.0, 0.0), IdealPlant(0.1), path, speed=1.0)
    assert patient.time[-1] == pytest.approx(10 + 4 * 9)


def test_a_path_that_lies_within_the_arrival_is_done_at_once():
    run = follow(tracking.TRACKERS["P"](), IdealPlant(), tracking.from_points([[0, 0], [0.1, 0]]))
    assert run.reached and len(run.time) == 1


def test_a_tracker_cannot_change_the_path_or_the_plant():
    def meddler(pose, twist, goal, dt):
        pose[:], twist[:] = 99.0, 99.0
        return 0.5, 0.0

    run = follow(meddler, IdealPlant(), tracking.from_points([[0, 0], [1, 0]]))
    assert run.reached and np.abs(run.pose).max() < 1.0

    def vandal(pose, twist, goal, dt):
        goal.path[:] = 0.0

    with pytest.raises(ValueError, match="read-only") as error:
        follow(vandal, IdealPlant(), tracking.from_points([[0, 0], [1, 0]]))
    assert error.value.__notes__ == ["raised by tracker 'vandal' at t = 0.00 s"]


@pytest.mark.parametrize(
    "answer",
    [
        None,
        0.5,
        (0.5,),
        (0.5, 0.1, 0.0),
        (0.5, np.nan),
        (np.inf, 0.0),
        ("fast", "left"),
        "ab",
        ("1", "2"),
        (1j, 0.0),
        (None, 0.0),
        np.zeros((2, 1)),
        np.zeros((1, 2)),
        {"v": 1.0, "omega": 0.0},
        [[0.5, 0.1], [0.5, 0.1]],
        (1, True),
    ],
)
def test_a_tracker_that_returns_no_two_finite_numbers_is_named(answer):
    def my_tracker(pose, twist, goal, dt):
        return answer

    message = "tracker 'my_tracker' must return v, omega: two finite numbers .* at t = 0.00 s"
    with pytest.raises(ValueError, match=message):
        follow(my_tracker, IdealPlant(), tracking.circle())


@pytest.mark.parametrize("answer", [[0.5, 0], np.array([0.5, 0]), (np.float32(0.5), 0), (1, 0)])
def test_two_real_numbers_of_any_kind_will_do(answer):
    path = tracking.from_points([[0, 0], [9, 0]])
    run = follow(lambda *_: answer, IdealPlant(), path, time_limit=0.1)
    assert run.command[0].tolist() == [float(x) for x in answer]


class NoPlant:
    pose, twist, time, dt = np.zeros(3), np.zeros(2), 0.0, 0.02

    def step(self, v, omega):
        self.pose = np.array([0.0, np.nan, 0.0])


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        (
            {"tracker": "P"},
            TypeError,
            "tracker must be a function .*: tracker.pose, twist, goal, dt",
        ),
        ({"tracker": PurePursuit}, TypeError, "tracker must be a function or an object to call"),
        ({"plant": 3}, TypeError, "plant must have pose, twist, time, dt, step"),
        ({"plant": NoPlant()}, ValueError, "the plant's pose must be finite"),
        ({"path": [[0, 0], [1, 1]]}, TypeError, "path must be a Path, got list: make one, such as"),
        ({"mode": "both"}, ValueError, "mode must be one of path, trajectory"),
        ({"mode": "trajectory"}, ValueError, "no times: use path.with_times"),
        ({"arrival": 0.0}, ValueError, "arrival must be one number above 0"),
        ({"speed": -1.0}, ValueError, "speed must be one number above 0"),
        ({"time_limit": np.nan}, ValueError, "time_limit must be one number above 0"),
        ({"period": 0.03}, ValueError, "period must be a whole multiple of the plant's dt = 0.02"),
        ({"period": 0.001}, ValueError, "period must be a whole multiple"),
        ({"period": 0.0}, ValueError, "period must be one number above 0"),
    ],
)
def test_follow_names_what_is_wrong(options, error, message):
    arguments = {
        "tracker": tracking.TRACKERS["P"](),
        "plant": IdealPlant(),
        "path": tracking.circle(),
    }
    with pytest.raises(error, match=message):
        follow(**(arguments | options))


def comparison(**options):
    trackers = {"P": tracking.TRACKERS["P"](), "v2": tracking.ScagliaLinear(period=0.1)}
    paths = {"circle": tracking.circle(), "square": tracking.square(1.0)}
    return tracking.compare(trackers, paths, IdealPlant, limits=LIMITS, **options)


def test_a_comparison_holds_each_run_and_its_numbers():
    found = comparison()
    assert found.trackers == ("P", "v2") and found.paths == ("circle", "square")
    for i, path in enumerate(found.paths):
        for j, tracker in enumerate(found.trackers):
            run = found.follows[tracker, path]
            assert run.name == tracker
            for field, value in tracking.assess(run)._asdict().items():
                np.testing.assert_array_equal(found.values[field][i, j], value)


def test_the_table_marks_the_best_of_each_path_as_the_source_does():
    found = comparison()
    found.values["d_mean"] = np.array([[0.1004, 0.1001], [0.3, 0.2]])
    found.values["d_ratio"] = np.array([[0.9, 1.2], [1.2, 1.1]])
    assert found.table(("d_mean", "d_ratio")) == (
        "path    tracker    d_mean   d_ratio\n"
        "circle  P          0.100*    0.900*\n"
        "circle  v2         0.100*    1.200\n"
        "square  P          0.300     1.200\n"
        "square  v2         0.200*    1.100*"
    )


def test_the_table_is_the_same_text_every_time():
    assert comparison().table() == comparison().table()
    assert not re.search(r" +$", comparison().table(), re.MULTILINE)


def test_time_errors_enter_a_comparison_of_trajectories():
    paths = {"eight": tracking.figure_eight().with_times(0.3)}
    trackers = {"P": tracking.TRACKERS["P"]()}
    found = tracking.compare(trackers, paths, IdealPlant, mode="trajectory")
    assert found.values["lag"][0, 0] == pytest.approx(1 / 1.25, abs=0.1)
    assert "time_error_mean" in found.table(("time_error_mean", "lag"))


@pytest.mark.parametrize(
    ("use", "error", "message"),
    [
        (lambda c: c.table(("d_men",)), ValueError, "field must be one of d_mean, d_std"),
        (lambda c: tracking.compare({}, PATHS, IdealPlant), ValueError, "at least one tracker"),
        (
            lambda c: tracking.compare({"P": tracking.TRACKERS["P"]()}, PATHS, IdealPlant()),
            TypeError,
            "plant must be a function that makes a plant",
        ),
    ],
)
def test_comparisons_name_what_is_wrong(use, error, message):
    with pytest.raises(error, match=message):
        use(comparison())


def test_a_students_own_function_enters_a_comparison():
    def mine(pose, twist, goal, dt):
        errors = tracking.pose_errors(pose, goal.position, goal.next_position)
        return 0.8 * errors.rho, 5.0 * errors.dy + errors.alpha

    found = tracking.compare(
        {"mine": mine, "P": tracking.TRACKERS["P"]()}, {"square": tracking.square()}, IdealPlant
    )
    assert found.follows["mine", "square"].reached
    assert "mine" in found.table()


def test_the_tuned_trackers_bring_the_options_they_are_given():
    assert tracking.TRACKERS["PI"](rho_alpha=0.1).rho_alpha == 0.1
    assert tracking.TRACKERS["Scaglia v1"](optimum=True, period=None).period is None
    assert tracking.TRACKERS["Scaglia v2"]().period == tuned_trackers.SCAGLIA_PERIOD


def waypoint_at(position, next_position, path, speed=0.3):
    return tracking.Goal(np.array(position), np.array(next_position), speed, np.array(path), 0.1)


def test_pure_pursuit_hurries_by_its_look_ahead_at_most():
    tracker = tracking.PurePursuit(lookahead=0.5, window=20.0, catch_up=2.0)
    far = waypoint_at((5.0, 0.0), (5.1, 0.0), [(0.0, 0.0), (9.0, 0.0)])
    assert tracker(np.zeros(3), np.zeros(2), far, 0.1) == pytest.approx((0.3 + 2.0 * 0.5, 0.0))


def test_the_pid_tracker_looks_beyond_the_way_point_only_when_it_is_near():
    tracker = tracking.PIDTracker(rho_alpha=0.4)
    for distance, turns in ((0.5, False), (0.3, True)):
        goal = waypoint_at((distance, 0.0), (distance, 1.0), [(0.0, 0.0), (distance, 0.0)])
        tracker.reset()
        assert (tracker(np.zeros(3), np.zeros(2), goal, 0.1)[1] > 0) == turns
