"""What lesson 06 claims in words."""

from functools import partial

import numpy as np
import pytest

from backhoe import simulation
from backhoe.lessons.odometry import printed
from backhoe.lessons.odometry.exercises import steps
from backhoe.localisation import drives, odometry
from backhoe.machine import BACKHOE
from backhoe.vehicle.tracks import tracks_twist

rng = np.random.default_rng(6)
RADIUS, GAUGE = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge


def test_rectangles_and_trapezoids_differ_by_their_first_and_last_sample_alone():
    t = np.linspace(0, 3, 31)
    v = rng.normal(size=31)
    difference = odometry.bilinear_sum(t, v) - odometry.euler_sum(t, v)
    np.testing.assert_allclose(difference, (v[0] - v) * 0.1 / 2, atol=1e-12)


def test_noise_of_samples_has_order_one_half():
    periods, spread = np.array([0.1, 0.025, 0.00625]), []
    for T in periods:
        t = np.arange(0, 4 + T / 2, T)
        ends = odometry.bilinear_sum(t, 0.1 * rng.normal(size=(4000, len(t))))[:, -1]
        spread.append(ends.std())
    assert odometry.order(periods, np.array(spread)) == pytest.approx(0.5, abs=0.05)
    assert spread[0] == pytest.approx(0.1 * np.sqrt(0.1 * 4), rel=0.05)


def test_one_wheel_of_four_that_slips_makes_all_four_look_odd_alike():
    robot = odometry.mecanum(0.1, 0.3, 0.25)
    u = robot.wheel_speeds([0.5, 0.0, 0.0])
    u[0] += 1.0
    np.testing.assert_allclose(np.abs(robot.unexplained(u)), 0.25, atol=1e-12)


def test_the_printed_43_is_the_way_in_a_mirror_across_minus_x_equals_y():
    for psi, omega in rng.uniform((-3, 0.1), (3, 1.0), (10, 2)):
        pose = np.array([0.0, 0.0, psi])
        x, y, _ = steps.arc(pose, 0.7, omega, 0.8)
        np.testing.assert_allclose(printed.step_43(pose, 0.7, omega, 0.8)[:2], [-y, -x], atol=1e-9)


def test_on_the_67_seconds_one_per_cent_of_slip_outweighs_every_rule_at_ten_hertz():
    truth = drives.truth("rectangle", rate=10)
    offs = {}
    for rule, share in (("right", 1.0), ("trapezoid", 1.0), ("trapezoid", 0.99)):
        poses = odometry.from_samples(
            np.zeros(3), truth.time, truth.v, truth.omega / share, rule=rule
        )
        gap = (poses - truth.pose)[:, :2]
        offs[rule, share] = np.sqrt(np.mean(np.sum(gap**2, axis=1)))
    assert offs["right", 1.0] > 40 * offs["trapezoid", 1.0]
    assert offs["trapezoid", 0.99] > 7 * offs["right", 1.0]


def test_the_effective_gauge_holds_in_tight_bends_and_drops_in_wide_ones():
    gauges = []
    for v, omega in ((0.0, 0.3), (0.5, 0.3), (1.0, 0.05)):
        with simulation.TrackedPlant(backend="analytic") as excavator:
            while excavator.time < 4:
                excavator.step(v, omega)
            before, way = excavator.pose[2], 0.0
            while excavator.time < 6:
                excavator.step(v, omega)
                way += np.diff(excavator.belts)[0] * excavator.dt
            gauges.append(way / (excavator.pose[2] - before))
    spot, tight, wide = gauges
    assert tight == pytest.approx(spot, rel=0.02)
    assert spot == pytest.approx(1.37 * BACKHOE.tracks.gauge, rel=0.01)
    assert spot == pytest.approx(BACKHOE.tracks.gauge / drives.SLIPPING, rel=0.01)
    assert BACKHOE.tracks.gauge < wide < 0.93 * spot


def test_on_the_spiral_of_the_lesson_algorithm_4_is_worse_than_3():
    robot = odometry.differential(0.35, 2.0)

    def end_by(algorithm):
        def end(t, v, omega):
            u = robot.wheel_speeds(np.stack([v, 0 * v, omega], axis=-1))
            return algorithm(robot.rate, t[1:], u[1:])

        return odometry.final_errors(end)[1]

    assert (end_by(printed.algorithm_4) > 1.2 * end_by(printed.algorithm_3)).all()


def test_algorithm_4_is_worse_than_3_in_about_four_of_five_random_drives():
    def unicycle(x, u):
        return np.array([u[0] * np.cos(x[2]), u[0] * np.sin(x[2]), u[1]])

    worse, t = [], np.linspace(0, 20, 2001)
    for _ in range(200):
        a, f, p = (
            rng.normal(0, 0.3, (2, 4)),
            rng.uniform(0.1, 1, (2, 4)),
            rng.uniform(0, 6.3, (2, 4)),
        )
        mean = rng.uniform((0.3, -0.5), (1.5, 0.5))
        u = mean + np.sum(a * np.sin(f * t[:, None, None] + p), axis=-1)
        end = odometry.from_samples(np.zeros(3), t, *u.T)[-1]
        coarse = t[20::20], u[20::20]
        third, fourth = (
            np.hypot(*(algorithm(unicycle, *coarse)[-1] - end)[:2])
            for algorithm in (printed.algorithm_3, printed.algorithm_4)
        )
        worse.append(fourth > third)
    assert np.mean(worse) == pytest.approx(0.8, abs=0.08)


def rms(poses, truth):
    return np.sqrt(np.mean(np.sum((poses - truth)[:, :2] ** 2, axis=1)))


def test_as_printed_the_67_seconds_are_metres_off_to_the_left_and_5_mm_to_the_right():
    clean = drives.truth("rectangle")
    right, left = ((clean.v + side * clean.omega * GAUGE / 2)[:-1] / RADIUS for side in (1, -1))
    thesis = partial(printed.mastalli_algorithm_1, r=RADIUS, gauge=GAUGE)
    there = printed.roll_out(thesis, np.zeros(3), right, left, T=0.01)
    mirrored = printed.roll_out(thesis, np.zeros(3), left, right, T=0.01) * (1, -1, -1)
    assert rms(there, clean.pose) > 2 and rms(mirrored, clean.pose) == pytest.approx(
        0.005, abs=1e-3
    )


def test_the_way_from_ticks_is_never_more_than_one_tick_off():
    coarse = odometry.Encoder(ticks=64)
    angle = np.append(0.0, np.cumsum(rng.normal(0, 0.2, 100_000)))
    assert np.abs(coarse.angles(coarse.count(angle)) - angle).max() <= coarse.resolution


def out_and_back(length, pause=3.0):
    """Held v and omega of a way along a line, a turn on the spot, and the way back at 1 m/s."""
    along, spot = np.ones(round(length / 0.01)), np.zeros(round(pause / 0.01))
    v = np.concatenate([along, spot, along])
    omega = np.concatenate([0 * along, spot + np.pi / pause, 0 * along])
    return v, omega, len(along)


def gaps(v, omega, change_v=1.0, drift=0.0, corner=None):
    truth, off = odometry.integrate(np.zeros(3), v, omega, 0.01), omega + drift
    if corner is not None:
        off[corner] += np.radians(1) / 0.01
    return np.hypot(*(odometry.integrate(np.zeros(3), change_v * v, off, 0.01) - truth)[:, :2].T)


@pytest.mark.parametrize("length", [10, 20, 200])
def test_errors_of_length_heading_and_drift_grow_by_three_laws(length):
    v, omega, end = out_and_back(length)
    assert gaps(v, omega, 1.01)[end] == pytest.approx(0.01 * length)
    assert gaps(v, omega, corner=0)[end] == pytest.approx(0.01745 * length, rel=1e-3)
    drift = 1e-4
    assert gaps(v, omega, drift=drift)[end] == pytest.approx(drift * length**2 / 2, rel=0.01)


@pytest.mark.parametrize("length", [10, 20, 200])
def test_coming_back_hides_a_length_shrinks_a_corner_and_doubles_a_drift(length):
    v, omega, end = out_and_back(length)
    assert gaps(v, omega, 1.01)[-1] < 1e-9
    for corner in (0, end // 2, end):
        left = gaps(v, omega, corner=corner)[-1]
        assert left == pytest.approx(np.radians(1) * corner * 0.01, abs=0.002 * (1 + length / 20))
    drifting = gaps(v, omega, drift=1e-4)
    assert drifting[-1] > 1.99 * drifting[end]


def test_squares_close_with_radii_and_gauge_too_large_alike_and_not_with_the_radii_alone():
    true = odometry.Wheels.of(BACKHOE)
    for gauge, closes in ((1.01 * true.gauge, True), (true.gauge, False)):
        believed = odometry.Wheels(1.01 * true.left, 1.01 * true.right, gauge)
        for way in ("cw", "ccw"):
            off = np.hypot(*odometry.square(true, believed, 4.0, way)[0, :2])
            assert off < 1e-12 if closes else off > 0.1


def test_with_the_sides_swapped_the_drive_is_its_own_mirror_image():
    left, right = np.cumsum(rng.uniform(0, 0.05, (2, 500)), axis=1)
    wheels = odometry.Wheels.of(BACKHOE)
    drive, swapped = (
        odometry.from_angles(np.zeros(3), *sides, wheels)
        for sides in ((left, right), (right, left))
    )
    np.testing.assert_allclose(swapped, drive * (1, -1, -1), atol=1e-12)


def test_half_of_the_samples_of_a_noisy_straight_turn_to_the_left():
    sides = 0.5 / RADIUS + np.sqrt(0.02) * rng.normal(size=(2, 6700))
    assert np.mean(tracks_twist(*sides)[1] > printed.THRESHOLD) == pytest.approx(0.5, abs=0.03)
