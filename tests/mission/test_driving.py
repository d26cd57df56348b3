"""Driving a route: the library's run, swapped parts that matter, scores, calm errors."""

import numpy as np
import pytest

from backhoe import mission, simulation
from backhoe.machine import BACKHOE, replace
from backhoe.vehicle import tracking, travel
from backhoe.vehicle.tracking import PurePursuit
from backhoe.vehicle.travel import VelocityPI

NARROW, WIDE = (replace(BACKHOE, tracks=replace(BACKHOE.tracks, gauge=g)) for g in (2.0, 3.0))
SHORT = tracking.from_points([(0.0, 0.0), (1.5, 0.0), (2.5, 0.6)], 0.1).with_times(0.4)


_TURN = np.linspace(-np.pi / 2, np.pi / 2, 60)
BEND = tracking.from_points(
    np.vstack([[0.0, 0.0], np.column_stack([1.0 + 1.5 * np.cos(_TURN), 1.5 + 1.5 * np.sin(_TURN)])])
).with_times(0.5)


def short(**parts):
    return mission.drive(**{"path": SHORT, "backend": "analytic", **parts})


@pytest.fixture(scope="module")
def whole():
    return mission.drive()


@pytest.fixture(scope="module")
def plain():
    return short()


def test_the_default_route_is_a_g_of_about_a_minute_that_starts_along_x():
    route = mission.default_route()
    first = route.points[1] - route.points[0]
    assert np.arctan2(first[1], first[0]) == 0.0
    assert route.end_time == pytest.approx(60.0, abs=5.0)
    assert np.ptp(route.points, axis=0).max() == pytest.approx(7.0, abs=0.2)
    headings = np.unwrap(np.arctan2(*np.diff(route.points, axis=0).T[::-1]))
    assert headings[-1] == pytest.approx(2 * np.pi)
    turn = np.abs(np.diff(headings)) / np.hypot(*np.diff(route.points, axis=0).T)[1:]
    limits = tracking.Limits.of_tracks()
    assert turn.max() * mission.route.SPEED < 0.5 * limits.max_turn_rate


def test_the_machine_keeps_to_the_route_and_arrives_in_time(whole):
    assert whole.reached
    assert whole.metrics.d_mean < 0.02
    assert whole.metrics.d_max < 0.1
    assert whole.metrics.d_ratio == pytest.approx(1.0, abs=0.01)
    assert abs(whole.assessment.lag) < 0.1
    assert whole.time[-1] == pytest.approx(mission.default_route().end_time, abs=0.02)


def test_the_log_has_one_row_for_each_sample_and_one_for_the_end(whole):
    n = len(whole.time)
    assert whole.pose.shape == (n, 3)
    assert whole.goal.shape == whole.twist.shape == whole.command.shape == (n, 2)
    assert whole.traction.shape == (n, 2)
    np.testing.assert_allclose(np.diff(whole.time), 0.02)
    assert np.abs(whole.traction).max() <= BACKHOE.tracks.max_traction
    assert np.abs(whole.traction[1:]).max() > 0.5 * BACKHOE.tracks.max_traction


def test_in_the_curves_the_outer_track_pushes_and_the_inner_one_holds_back(whole):
    turning = whole.command[1:-1, 1] > 0.1
    left, right = whole.traction[2:][turning].T
    assert (right > 20e3).mean() > 0.95
    assert (left < -10e3).mean() > 0.95


def test_swapping_in_the_librarys_own_parts_changes_nothing(plain):
    tracker = PurePursuit(lookahead=mission.driving.LOOKAHEAD)
    again = short(tracker=tracker, velocity_controller=VelocityPI())
    np.testing.assert_array_equal(again.pose, plain.pose)
    np.testing.assert_array_equal(again.traction, plain.traction)
    assert again.swapped == ("velocity_controller", "tracker")


@pytest.mark.parametrize("name", tracking.TRACKERS)
def test_a_tracker_drives_as_in_follow_with_its_own_sample_time(name):
    with simulation.TrackedPlant(backend="analytic") as plant:
        plainly = tracking.follow(tracking.TRACKERS[name](), plant, SHORT, mode="trajectory")
    run = short(tracker=tracking.TRACKERS[name]())
    np.testing.assert_array_equal(run.pose, plainly.pose)
    np.testing.assert_array_equal(run.command, plainly.command)


def test_the_same_drive_repeats_bit_for_bit_and_in_both_backends(plain):
    np.testing.assert_array_equal(short().pose, plain.pose)
    pytest.importorskip("pybullet")
    bullet = short(backend="pybullet")
    assert (bullet.backend, plain.backend) == ("pybullet", "analytic")
    np.testing.assert_allclose(bullet.pose, plain.pose, atol=1e-8)


def test_a_used_controller_and_tracker_start_afresh(plain):
    tracker, controller = PurePursuit(lookahead=mission.driving.LOOKAHEAD), VelocityPI()
    for _ in range(2):
        run = short(tracker=tracker, velocity_controller=controller)
    np.testing.assert_array_equal(run.pose, plain.pose)


# What a poor part costs


def test_a_wrong_sign_of_the_turning_loop_is_plain_to_see():
    library = VelocityPI()

    def crossed(*speeds):
        left, right = library(*speeds)
        return right, left

    score = mission.score(short(path=BEND, velocity_controller=crossed))
    assert score.way < 0.5 < 1.0 < score.reference.way  # it spins on the spot at the first turn
    assert score.late > 0.4 * score.time and abs(score.reference.late) < 0.1
    assert score.push > 1.5 * score.reference.push
    assert not score.reached and score.reference.reached
    assert "velocity_controller" in str(score) and "library" in str(score)


def test_without_the_integral_the_friction_of_turning_pushes_it_off_the_path():
    kp, _ = travel.GAINS
    score = mission.score(short(path=BEND, velocity_controller=VelocityPI(kp, (0.0, 0.0))))
    assert score.distance > 2 * score.reference.distance


def test_a_missing_lever_shows_the_more_the_wider_the_machine_and_not_on_2_m():
    worse = []
    for machine in (NARROW, BACKHOE, WIDE):
        runs = [
            short(machine=machine, velocity_controller=VelocityPI(lever=lever, limit=np.inf))
            for lever in (machine.tracks.gauge / 2, 1.0)
        ]
        with_it, without = (np.abs(run.command[:-1, 1] - run.twist[1:, 1]).mean() for run in runs)
        worse.append(without / with_it)
    assert worse[0] == 1.0
    assert 1.15 < worse[1] < 1.3 and worse[2] > 1.4


def test_a_tracker_that_only_drives_ahead_leaves_the_path():
    score = mission.score(short(tracker=lambda pose, twist, goal, dt: (goal.speed, 0.0)))
    assert score.farthest > 0.5 > 4 * score.reference.farthest


def test_a_recorded_drive_is_replayed_with_its_path_in_view():
    run = short(record=True, time_limit=1.0)
    shown = run.replay().recording
    nodes = {node.name: node for node in shown.nodes}
    np.testing.assert_allclose(nodes["undercarriage"].values[-1], run.pose[-1])
    np.testing.assert_allclose(np.asarray(shown.lines[0].points)[:, :2], SHORT.points)
    eye, target = shown.camera
    assert eye[2] > 3.0
    np.testing.assert_allclose(target[:2], (SHORT.points.min(0) + SHORT.points.max(0)) / 2)
    with pytest.raises(ValueError, match="camera must be eye and target"):
        run.recorder.replay(title="a", alt="b", camera=((0.0, 1.0), (1.0, 0.0)))


# Other paths and plants


def test_a_path_without_times_is_followed_to_its_last_way_point():
    run = short(path=tracking.from_points([(0.0, 0.0), (1.0, 0.0), (1.6, 0.3)]))
    assert run.mode == "path" and run.reached
    assert np.isnan(run.assessment.lag)
    assert [line.split()[-1] for line in str(mission.score(run)).splitlines()][5] == "nan"


def test_a_drive_may_start_elsewhere():
    start = np.array([2.0, 1.0, np.pi / 2])
    path = tracking.from_points([(2.0, 1.0), (2.0, 2.5)], 0.1).with_times(0.4)
    run = short(path=path, pose=start, tracker=PurePursuit(lookahead=0.8))
    np.testing.assert_array_equal(run.pose[0], start)
    assert run.reached
    assert mission.score(run).reference.reached


def test_a_rover_drives_by_the_same_call():
    with simulation.open_rover(backend="analytic") as rover:
        run = mission.drive(plant=rover, path=SHORT)
    assert run.reached and run.metrics.d_max < 0.1
    assert run.traction is None and run.machine is None
    assert mission.score(run).reference is None
    assert [line.split()[-1] for line in str(mission.score(run)).splitlines()][7] == "nan"


def test_a_machine_of_your_own_drives_on_from_where_it_stands():
    with simulation.TrackedPlant(backend="analytic") as plant:
        first = mission.drive(plant=plant, path=SHORT)
        second = mission.drive(plant=plant, path=SHORT, time_limit=0.1)
        np.testing.assert_array_equal(second.pose[0], first.pose[-1])
        plant.step(0.0, 0.0)


def test_the_reference_of_a_run_that_was_cut_short_is_cut_short_too():
    score = mission.score(short(tracker=PurePursuit(lookahead=1.0), time_limit=2.0))
    assert score.reference.time == score.time == pytest.approx(2.0)


def test_a_tracker_that_raises_is_called_by_its_own_name():
    def lost(*situation):
        raise KeyError("map")

    with pytest.raises(KeyError) as error:
        short(tracker=lost)
    assert "raised by tracker 'lost' at t = 0.00 s" in error.value.__notes__


def test_a_longer_sample_and_a_time_limit_are_kept():
    assert short(time_limit=0.5).time[-1] == pytest.approx(0.5)


# Errors


class Diverging:
    def reset(self):
        raise AssertionError("a class is not reset")


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"planner": print}, TypeError, "unknown part 'planner': the parts are velocity_contro"),
        ({"tracker": 3}, TypeError, "tracker must be a function or an object to call: tracker"),
        ({"tracker": Diverging}, TypeError, "tracker must be a function or an object to call"),
        ({"velocity_controller": VelocityPI}, TypeError, "velocity_controller must be a func"),
        ({"path": [(0, 0), (1, 0)]}, TypeError, "path must be a Path"),
        ({"mode": "fast"}, ValueError, "mode must be one of path, trajectory"),
        ({"tracker": lambda *_: 1.0}, ValueError, "your tracker failed: its answer must"),
        ({"tracker": lambda *_: (np.nan, 0)}, ValueError, "your tracker failed: .* finite"),
        ({"tracker": lambda *_: None}, ValueError, "your tracker failed: its answer must"),
        ({"tracker": lambda pose: (0, 0)}, TypeError, "your tracker failed"),
        (
            {"velocity_controller": lambda *_: (1.0, 2.0, 3.0)},
            ValueError,
            r"your velocity_controller failed: .* got shape \(3,\). It is velocity_cont",
        ),
        (
            {"velocity_controller": lambda *_: (np.inf, 0.0)},
            ValueError,
            "your velocity_controller failed: its answer must be finite",
        ),
        ({"velocity_controller": lambda v: (0, 0)}, TypeError, "your velocity_controller failed"),
        ({"pose": (0.0, 0.0)}, ValueError, r"pose must be .*, got shape \(2,\)"),
    ],
)
def test_what_breaks_its_promise_is_named(arguments, error, message):
    with pytest.raises(error, match=message):
        short(**arguments)


def test_an_error_inside_a_part_keeps_its_type_and_names_the_part():
    def divides(*_):
        return [1, 2][7]

    for name in ("tracker", "velocity_controller"):
        with pytest.raises(IndexError) as caught:
            short(**{name: divides})
        assert any(f"in your {name}" in note for note in caught.value.__notes__)


def test_parts_that_write_into_their_arguments_spoil_nothing(plain):
    library = PurePursuit(lookahead=mission.driving.LOOKAHEAD)

    def tracker(pose, twist, goal, dt):
        answer = library(pose.copy(), twist.copy(), goal, dt)
        for argument in (pose, twist, goal.position, goal.next_position):
            argument[:] = np.nan
        return answer

    run = short(tracker=tracker)
    np.testing.assert_array_equal(run.pose, plain.pose)
    np.testing.assert_array_equal(run.goal, plain.goal)


def test_a_plant_of_your_own_brings_its_controller_along():
    with simulation.TrackedPlant(backend="analytic") as plant:
        for extra in (
            {"velocity_controller": VelocityPI()},
            {"pose": (0.0, 0.0, 0.0)},
            {"machine": WIDE},
            {"backend": "analytic"},
        ):
            with pytest.raises(ValueError, match="a plant of your own brings them"):
                mission.drive(plant=plant, **extra)


def test_only_what_has_a_shape_can_be_recorded():
    with pytest.raises(ValueError, match="record=True needs something to look at"):
        mission.drive(plant=tracking.IdealPlant(), path=SHORT, record=True)
    with pytest.raises(ValueError, match="record=True"):
        short(time_limit=0.1).replay()


def test_score_refuses_what_is_no_run():
    with pytest.raises(
        TypeError, match=r"take what mission\.run, drive, .* or autonomy\.run returned"
    ):
        mission.score(7)


def test_the_parts_are_listed():
    text = mission.parts(mission.DRIVE_PARTS)
    assert "velocity_controller(v_ref, omega_ref, v, omega, dt)" in text and "lesson 05" in text
    assert "plan(cycle)" in mission.parts() and "tracker" not in mission.parts()
