"""The solutions that lesson 06 shows are the library's own functions in other words; its claims."""

import numpy as np
import pytest

from backhoe import simulation
from backhoe.lessons.odometry.exercises import encoder, robots, square, steps, sums, tracks
from backhoe.localisation import drives, odometry
from backhoe.machine import BACKHOE
from backhoe.vehicle.tracks import tracks_twist

rng = np.random.default_rng(6)
RADIUS, GAUGE = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge


def unicycle(x, u):
    return np.array([u[0] * np.cos(x[2]), u[0] * np.sin(x[2]), u[1]])


def test_way_is_the_librarys_sum_of_trapezoids():
    t = np.cumsum(rng.uniform(0.1, 0.5, 20))
    v = rng.normal(size=20)
    np.testing.assert_allclose(sums.way(t, v), odometry.bilinear_sum(t, v), atol=1e-12)


def test_order_is_the_librarys():
    steps_ = 0.5 ** np.arange(5)
    errors = 2 * steps_**1.7 * rng.uniform(0.9, 1.1, 5)
    assert sums.order(steps_, errors) == pytest.approx(odometry.order(steps_, errors))


def test_order_of_what_has_no_logarithm_is_no_number_and_prints_nothing(capfd):
    with np.errstate(all="ignore"):
        assert np.isnan(sums.order(-(0.5 ** np.arange(5)), np.ones(5)))
    assert capfd.readouterr() == ("", "")


def test_jacobian_is_the_librarys_robot_on_three_wheels():
    np.testing.assert_allclose(
        robots.jacobian(0.05, 0.2), odometry.omni(0.05, 0.2).body, atol=1e-15
    )


def test_heun_is_the_librarys_step_and_the_fixed_point_counts_as_right_too():
    x, old, new = rng.normal(size=3), np.array([0.5, 0.4]), np.array([0.7, -0.3])
    state = odometry.streaming.State(1.0, x, old)
    mine = steps.heun(x, old, new, 0.2, unicycle)
    theirs = odometry.streaming.heun(state, 1.2, new, unicycle).x
    solved = odometry.streaming.bilinear(state, 1.2, new, unicycle).x
    np.testing.assert_allclose(mine, theirs, rtol=1e-12)
    assert not np.allclose(mine, solved, rtol=1e-9)
    assert steps.right_trapezoid(solved, mine, x, old, new, 0.2, unicycle)
    assert not steps.right_trapezoid(mine + 1e-4, mine, x, old, new, 0.2, unicycle)


@pytest.mark.parametrize("omega", [0.7, -0.7, 0.0, 1e-12, -1e-12])
def test_arc_is_the_librarys_advance(omega):
    pose = rng.normal(size=3)
    mine = steps.arc(pose, 0.8, omega, 1.3)
    np.testing.assert_allclose(mine, odometry.advance(pose, 0.8 * 1.3, omega * 1.3), atol=1e-12)


def test_ticks_are_the_librarys():
    counts = np.cumsum(rng.integers(-90, 90, 50)) % 256
    theirs = odometry.Encoder(ticks=64, bits=8).increments(counts)
    np.testing.assert_array_equal(encoder.ticks(counts, 8), theirs)


def test_what_squares_say_is_what_the_library_makes_of_their_x():
    true, nominal = odometry.Wheels(0.349, 0.351, 2.06), odometry.Wheels(0.35, 0.35, 2.0)
    ends = [odometry.square(true, nominal, 4.0, way)[:, :2] for way in ("cw", "ccw")]
    found = square.calibrate(*ends, 4.0, 2.0)
    theirs = odometry.umbmark(*ends, 4.0, nominal)
    alpha, beta = theirs.alpha_xy[0], theirs.beta_xy[0]
    assert found[0] == pytest.approx(2.0 * (np.pi / 2) / (np.pi / 2 - alpha), rel=1e-12)
    lever = 2.0 / 4.0 * np.sin(beta / 2)
    assert found[1] == pytest.approx((1 + lever) / (1 - lever), rel=1e-12)
    averaged = theirs.wheels.gauge, theirs.ratio
    assert square.right_calibration(averaged, found, *ends, 4.0, 2.0)


def test_the_machines_odometry_is_the_librarys_to_a_micrometre_a_step():
    pose = rng.normal(size=3)
    v, omega = tracks_twist(2.0, 3.0, gauge=2.6)
    theirs = odometry.advance(pose, v * 0.02, omega * 0.02)
    np.testing.assert_allclose(tracks.odometry(pose, 2.0, 3.0, 0.02, 2.6), theirs, atol=1e-7)


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
    from backhoe.lessons.odometry import printed

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
    assert spot > 1.3 * GAUGE
    assert GAUGE < wide < 0.93 * spot
