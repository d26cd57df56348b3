"""The strong sentences of lesson 05, each over ten times the window of the lesson or exactly."""

import numpy as np
import pytest

from backhoe.lessons.path_tracking.exercises.pursuit import PURSUIT
from backhoe.vehicle import skid_steer, tracking

HUSKY = skid_steer.HUSKY
LIMITS = tracking.Limits.of(HUSKY, 1.0)
SHAPES = {
    "circle": tracking.circle(),
    "square": tracking.square(),
    "eight": tracking.figure_eight(),
}
T0 = 0.1


def linear():
    return skid_steer.SkidSteerPlant(HUSKY, dt=0.05, model="linear")


def with_alpha(sign, k_alpha, path, seconds):
    def tracker(pose, twist, goal, dt):
        rho, dy, alpha = tracking.pose_errors(pose, goal.position, goal.next_position)
        return rho, 4.0 * dy + (rho <= 0.4) * sign * k_alpha * alpha

    return tracking.follow(tracker, tracking.IdealPlant(0.05), path, time_limit=seconds)


@pytest.mark.parametrize("path", SHAPES)
def test_a_small_gain_of_alpha_arrives_with_either_sign_and_is_worse_with_the_printed_one(path):
    right, wrong = (with_alpha(sign, 0.2, SHAPES[path], 100) for sign in (1, -1))
    assert right.reached and wrong.reached
    assert wrong.metrics.d_mean > 1.5 * right.metrics.d_mean


@pytest.mark.parametrize("path", ["circle", "square"])
def test_a_large_gain_of_alpha_circles_with_the_right_sign_too(path):
    assert not with_alpha(1, 2.0, SHAPES[path], 400).reached


def test_in_the_lesson_s_40_s_the_printed_sign_triples_the_distance_at_least_and_never_arrives():
    rises = []
    for path in SHAPES.values():
        right, wrong = (with_alpha(sign, 1.0, path, 40.0) for sign in (1, -1))
        assert right.reached and not wrong.reached
        rises.append(wrong.metrics.d_mean / right.metrics.d_mean)
    assert np.round(rises).tolist() == [3, 14, 6]


@pytest.mark.parametrize("slips", [False, True])
def test_v1_with_twice_the_gain_drives_as_v2_within_a_millimetre(slips):
    grip = skid_steer.turning_half_track(HUSKY)
    limits = (
        tracking.Limits(1.0 / HUSKY.wheel_radius, HUSKY.wheel_radius, grip) if slips else LIMITS
    )

    def slipping():
        return skid_steer.SkidSteerPlant(HUSKY, dt=0.05, model="slipping", half_track=grip)

    alike = {
        "v1": tracking.ScagliaTaylor(0.4, 0.8, period=0.2),
        "v2": tracking.ScagliaLinear(0.4, 0.4, period=0.2),
    }
    paths = {name: path.with_times(0.3) for name, path in SHAPES.items()}
    compared = tracking.compare(
        alike, paths, slipping if slips else linear, mode="trajectory", limits=limits
    )
    for field in tracking.Metrics._fields:
        assert abs(np.diff(compared.values[field])).max() < 1.1e-3


def test_held_71a_is_unstable_whatever_the_gain_and_on_a_ramp_it_never_dies():
    for k in np.linspace(0.001, 1, 300):
        held = tracking.speed_modes(k)
        assert np.prod(held) == pytest.approx(-1) and abs(held[0]) > 1
        assert np.isclose(tracking.speed_modes(k, motion="ramp"), -1).sum() == 1


def test_71a_asks_for_1e12_m_s_after_25_s():
    line = tracking.from_points([(0, 0), (80, 0)]).with_times(0.4)
    printed, plant = tracking.ScagliaRungeKutta.printed(), tracking.IdealPlant(T0)
    run = tracking.follow(printed, plant, line, mode="trajectory", time_limit=25.0)
    assert 1e12 < abs(run.command[:, 0]).max() < 1e13


@pytest.mark.parametrize(("k_w", "calm"), [(0.4, True), (0.5, False)])
def test_turning_on_the_spot_71b_swings_for_ever_at_its_printed_gain(k_w, calm):
    tracker, pose, W, rates = tracking.ScagliaRungeKutta.printed(0.4, k_w), np.zeros(3), 0.0, []
    far = tracking.Goal(np.array([1.0, 0.1]), np.array([1.0, 0.1]), 0.4, np.eye(2), T0)
    for _ in range(4000):
        _, W = tracker(pose, (0.0, W), far, T0)
        pose[2] += W * T0
        rates.append(W)
    largest = abs(np.array(rates[-2:]))
    assert largest.max() < 1e-9 if calm else largest.min() > 0.5
    if not calm:
        assert rates[-1] == pytest.approx(-rates[-2])


def test_dead_beat_swings_for_ever_and_is_3_5_mm_off_between_the_samples():
    pose, law, off = np.array([0.0, 0.0, np.radians(20)]), tracking.ScagliaLinear(1, 1), []
    for n in range(1, 201):
        goal = tracking.Goal(np.array([0.04 * n, 0.0]), np.zeros(2), 0.4, np.eye(2), 0.0)
        order = law(pose, (0, 0), goal, T0)
        off += [abs(tracking.arc(pose, *order, t)[1]) for t in np.linspace(0, T0, 11)]
        pose = tracking.arc(pose, *order, T0)
        assert abs(pose[1]) < 1e-9 and abs(np.degrees(pose[2])) == pytest.approx(20)
    assert max(off) == pytest.approx(3.5e-3, abs=1e-4)


def test_for_a_goal_straight_behind_the_law_of_v2_asks_for_1e16_m_s_without_its_if():
    h = (np.arctan2(0.0, -1.0) + np.pi) % (2 * np.pi) - np.pi
    assert abs(1.0 / T0 / np.sinc(h / np.pi)) > 1e16
    behind = tracking.Goal(np.array([-1.0, 0.0]), np.zeros(2), 0.4, np.eye(2), 0.0)
    assert tracking.ScagliaLinear(1, 1)((0, 0, 0), (0, 0), behind, T0)[0] == pytest.approx(-10)


@pytest.mark.parametrize(
    ("limits", "degrees", "far"), [(None, 0, 20.0), (LIMITS, 0, 4.3), (None, 1, 1.3)]
)
def test_p_drives_off_ahead_of_a_goal_straight_behind_and_then_finds_it(limits, degrees, far):
    behind, pose = tracking.from_points([(-1, 0), (-2, 0)]), (0, 0, np.radians(degrees))
    plant = tracking.IdealPlant(0.05, pose)
    run = tracking.follow(tracking.PIDTracker(), plant, behind, limits=limits)
    assert run.reached and run.pose[:, 0].max() == pytest.approx(far, rel=0.03)


@pytest.mark.parametrize(("gain", "settles"), [(1.0, True), (1.9, True), (2.1, False)])
def test_more_gain_takes_less_than_half_of_a_sample_of_delay_away(gain, settles):
    line = tracking.from_points([(0, 0), (40, 0)]).with_times(0.4)

    def to_the_goal_of_now(pose, twist, goal, dt):
        return gain * (goal.position[0] - 0.4 * dt - pose[0]) / dt, 0.0

    plant = tracking.IdealPlant(T0, (-0.03, 0, 0))
    run = tracking.follow(to_the_goal_of_now, plant, line, mode="trajectory")
    late = (0.4 * run.time - run.pose[:, 0])[-200:]
    if settles:
        assert np.allclose(late, 0.04 / gain, atol=1e-6) and 0.04 / gain > 0.02
    else:
        assert np.ptp(late) > 1.0


def test_with_the_reset_of_code_52_pi_has_the_mean_distance_of_p():
    gains = {"P": (4.0,), "PI": (4.0, 1.0), "reset": (4.0, 1.0)}
    pids = {
        name: tracking.PIDTracker((1.0,), dy, (1.0,), reset_at_waypoints=name == "reset")
        for name, dy in gains.items()
    }
    d_mean = tracking.compare(pids, SHAPES, linear, limits=LIMITS, period=0.1).values["d_mean"]
    assert abs(d_mean[:, 2] - d_mean[:, 0]).max() < 0.6e-3
    assert d_mean[0, 1] < 0.9 * d_mean[0, 0] and d_mean[2, 1] < 0.9 * d_mean[2, 0]


@pytest.mark.parametrize(("lookahead", "speed"), [(0.2, 0.8), (0.5, 0.4), (1.5, 0.1)])
def test_pure_pursuit_is_damped_alike_whatever_the_look_ahead_and_the_speed(lookahead, speed):
    pace, y0 = lookahead / speed, 0.01 * lookahead
    path = tracking.from_points([[0, 0], [100 * lookahead, 0]])
    plant = tracking.IdealPlant(pace / 100, (lookahead, y0, 0))
    pursuer = tracking.PurePursuit(lookahead, speed)
    run = tracking.follow(pursuer, plant, path, arrival=2 * lookahead, time_limit=10 * pace)
    t = run.time / pace
    expected = y0 * np.exp(-t) * (np.cos(t) + np.sin(t))
    assert np.allclose(run.pose[:, 1], expected, atol=0.01 * y0)


def test_only_stopping_to_turn_follows_a_corner_exactly():
    plant, corner = tracking.IdealPlant(1.0), [[0, 0], [1, 0], [1, 1]]
    places = [plant.pose]
    for order in ((1.0, 0.0), (0.0, np.pi / 2), (1.0, 0.0)):
        plant.step(*order)
        places.append(plant.pose)
    assert np.allclose(tracking.distances(np.array(places)[:, :2], corner), 0)
    for make in tracking.TRACKERS.values():
        run = tracking.follow(
            make(), tracking.IdealPlant(0.05), tracking.square().with_times(0.3), mode="trajectory"
        )
        assert run.metrics.d_max > 0.01


def crosses(path):
    a, ways = path[:-1] @ (1, 1j), np.diff(path, axis=0) @ (1, 1j)
    for i, (p, w) in enumerate(zip(a, ways, strict=True)):
        for q, u in zip(a[i + 2 :], ways[i + 2 :], strict=True):
            ends, other = (
                ((np.array([q, q + u]) - p) / w).imag,
                ((np.array([p, p + w]) - q) / u).imag,
            )
            if ends.prod() < 0 and other.prod() < 0:
                return True
    return False


def test_the_paths_of_exercise_57_never_cross_themselves():
    for seed in range(30):
        for _, path, *_ in PURSUIT.cases(np.random.default_rng(seed)):
            assert not crosses(path)


def test_p_is_late_by_one_over_the_gain_less_a_sample():
    line = tracking.from_points([(0, 0), (12, 0)]).with_times(0.3)
    plant = tracking.IdealPlant(0.05)
    run = tracking.follow(tracking.TRACKERS["P"](), plant, line, mode="trajectory")
    late = run.time[-1] - run.pose[-1, 0] / 0.3
    assert late == pytest.approx(1 / 1.25 - 0.05, abs=1e-3)
