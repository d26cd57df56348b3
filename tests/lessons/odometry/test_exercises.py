"""What else lesson 06 takes for right, and what it claims in words."""

import numpy as np
import pytest

from backhoe import simulation
from backhoe.lessons.odometry import printed
from backhoe.lessons.odometry.exercises import square, steps
from backhoe.localisation import drives, odometry
from backhoe.machine import BACKHOE

rng = np.random.default_rng(6)


def unicycle(x, u):
    return np.array([u[0] * np.cos(x[2]), u[0] * np.sin(x[2]), u[1]])


def test_a_trapezoid_with_x_k_solved_for_counts_as_right_too():
    x, old, new = rng.normal(size=3), np.array([0.5, 0.4]), np.array([0.7, -0.3])
    step = steps.heun(x, old, new, 0.2, unicycle)
    solved = step
    for _ in range(60):
        solved = x + 0.1 * (unicycle(x, old) + unicycle(solved, new))
    assert not np.allclose(step, solved, rtol=1e-9)
    assert steps.right_trapezoid(solved, step, x, old, new, 0.2, unicycle)
    assert not steps.right_trapezoid(step + 1e-4, step, x, old, new, 0.2, unicycle)


def test_what_the_library_makes_of_x_and_y_counts_as_right_too():
    true, nominal = odometry.Wheels(0.349, 0.351, 2.06), odometry.Wheels(0.35, 0.35, 2.0)
    ends = [odometry.square(true, nominal, 4.0, way)[:, :2] for way in ("cw", "ccw")]
    found = odometry.umbmark(*ends, 4.0, nominal)
    averaged = np.array([found.wheels.gauge, found.ratio])
    reference = square.calibrate(*ends, 4.0, 2.0)
    assert not np.allclose(averaged, reference, rtol=1e-6)
    assert square.right_calibration(averaged, reference, *ends, 4.0, 2.0)
    assert not square.right_calibration(1.001 * averaged, reference, *ends, 4.0, 2.0)


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
