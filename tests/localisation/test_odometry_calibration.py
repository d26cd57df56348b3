"""Radii and gauge from squares driven both ways, and from logs."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from backhoe.localisation import odometry
from backhoe.localisation.odometry import Wheels
from backhoe.machine import BACKHOE
from backhoe.vehicle.tracks import tracks_twist

NOMINAL = Wheels(0.35, 0.35, 2.0)
SIDE = 4.0


def wheels(ratio, factor, mean=NOMINAL.mean):
    return Wheels(2 * mean / (1 + ratio), 2 * mean * ratio / (1 + ratio), factor * NOMINAL.gauge)


def ends(true, noise=0.0, runs=1, rng=None):
    return [
        odometry.square(true, NOMINAL, SIDE, way, noise=noise, runs=runs, rng=rng)
        for way in ("cw", "ccw")
    ]


@pytest.mark.parametrize("way", ["cw", "ccw"])
def test_with_the_right_wheels_a_square_closes(way):
    np.testing.assert_allclose(odometry.square(NOMINAL, NOMINAL, SIDE, way), 0, atol=1e-14)


def test_a_square_is_driven_side_by_side_by_the_true_wheels():
    """Against the poses of a vehicle with the true wheels, leg after leg, by hand."""
    true = wheels(1.02, 1.03)
    pose = np.zeros(3)
    for _ in range(4):
        for left, right in ((SIDE, SIDE), (-np.pi / 2, np.pi / 2)):
            d, a = true.twist(left / NOMINAL.left, right / NOMINAL.right)
            pose = odometry.compose(pose, odometry.se2_exp([d, 0, a]))
    pose[2] -= 2 * np.pi
    np.testing.assert_allclose(odometry.square(true, NOMINAL, SIDE, "ccw")[0], pose, atol=1e-13)


def test_ends_are_off_as_the_formulas_say_to_first_order():
    gaps = []
    for size in (2e-4, 1e-4):
        true = wheels(1 + size, 1 + 2 * size)
        alpha = np.pi / 2 * (1 - 1 / (1 + 2 * size))
        beta = SIDE * (true.right - true.left) / true.gauge / NOMINAL.mean
        expected = -2 * SIDE * np.array([[alpha + beta] * 2, [alpha - beta, beta - alpha]])
        gaps.append(np.abs(np.array([end[0, :2] for end in ends(true)]) - expected).max())
    assert gaps[0] < 0.02 * np.abs(expected).max() and gaps[0] / gaps[1] == pytest.approx(
        4, rel=0.05
    )


def test_umbmark_finds_the_wheels_up_to_second_order_of_their_errors():
    gaps = []
    for size in (0.002, 0.001):
        true = wheels(1 - size / 4, 1 + size)
        found = odometry.umbmark(*ends(true), SIDE, NOMINAL)
        gaps.append([found.ratio - true.ratio, found.gauge_factor - 1 - size])
    gaps = np.abs(gaps)
    assert (gaps[0] < 0.01 * 0.002).all()
    np.testing.assert_allclose(gaps[0] / gaps[1], 4, rtol=0.1)


def test_with_the_corrected_wheels_the_squares_close_ten_times_better():
    true = wheels(0.995, 1.02)
    before = odometry.umbmark(*ends(true), SIDE, NOMINAL)
    after = [odometry.square(true, before.wheels, SIDE, way)[0, :2] for way in ("cw", "ccw")]
    assert np.hypot(*np.transpose(after)).max() < before.error / 10


@settings(max_examples=40, deadline=None)
@given(st.floats(0.97, 1.03), st.floats(0.9, 1.1))
def test_without_approximation_the_wheels_come_back_exactly(ratio, factor):
    true = wheels(ratio, factor)
    found = odometry.umbmark_exact(*ends(true), SIDE, NOMINAL)
    np.testing.assert_allclose(
        [found.wheels.left, found.wheels.right, found.wheels.gauge],
        [true.left, true.right, true.gauge],
        rtol=1e-9,
    )


def test_measured_ends_with_noise_are_solved_near_the_formulas():
    rng = np.random.default_rng(5)
    cw, ccw = (end[:, :2] + 0.03 * rng.normal(size=(5, 2)) for end in ends(wheels(0.998, 1.02)))
    exact = odometry.umbmark_exact(cw, ccw, SIDE, NOMINAL)
    first = odometry.umbmark(cw, ccw, SIDE, NOMINAL)
    assert exact.ratio == pytest.approx(first.ratio, abs=3e-4)
    assert exact.gauge_factor == pytest.approx(first.gauge_factor, abs=1e-3)


def test_ends_that_no_wheels_explain_are_refused():
    with pytest.raises(ArithmeticError, match="no wheels were found whose squares end there"):
        odometry.umbmark_exact([[2.2, 0.9]], [[0.8, -3.5]], SIDE, NOMINAL)


def test_one_way_round_alone_would_take_a_gauge_for_unequal_wheels():
    gauge_wrong = wheels(1.0, 1.005)
    alpha = np.pi / 2 * (1 - 1 / 1.005)
    unequal = wheels((1 + alpha * 2.0 / 4 / 2) / (1 - alpha * 2.0 / 4 / 2), 1.0)
    cw, ccw = zip(ends(gauge_wrong), ends(unequal), strict=True)
    assert np.hypot(*(cw[0] - cw[1])[0, :2]) < 0.1 * np.hypot(*cw[0][0, :2])
    np.testing.assert_allclose(ccw[0][0, :2], -ccw[1][0, :2], rtol=0.1)


def test_the_mean_radius_is_not_seen_by_closed_squares():
    small = wheels(1.0, 1.0, mean=0.9 * NOMINAL.mean)
    small = Wheels(small.left, small.right, 0.9 * NOMINAL.gauge)
    np.testing.assert_allclose(np.concatenate(ends(small))[:, :2], 0, atol=1e-13)


def test_more_squares_make_bumps_count_less():
    true, spread = wheels(0.998, 1.01), {}
    for runs in (5, 125):
        factors = []
        for seed in range(200):
            rng = np.random.default_rng(seed)
            found = odometry.umbmark(*ends(true, 0.01, runs, rng), SIDE, NOMINAL)
            factors.append(found.gauge_factor)
        spread[runs] = np.std(factors)
    assert spread[5] / spread[125] == pytest.approx(5, rel=0.2)


def test_x_and_y_agree_for_systematic_errors_and_not_for_an_obstacle():
    found = odometry.umbmark(*ends(wheels(0.998, 1.01)), SIDE, NOMINAL)
    assert found.alpha_xy[0] == pytest.approx(found.alpha_xy[1], rel=0.05)
    cw, ccw = ends(wheels(0.998, 1.01))
    pushed = odometry.umbmark(cw + np.array([0.3, 0, 0]), ccw, SIDE, NOMINAL)
    assert abs(pushed.alpha_xy[0] - pushed.alpha_xy[1]) > abs(found.alpha)


@pytest.mark.parametrize(
    ("cw", "ccw", "side", "message"),
    [
        ([], [[0, 0]], 4.0, "cw must be a row x, y"),
        ([[0, 0]], [0, 0], 4.0, "ccw must be a row x, y"),
        ([[0, np.nan]], [[0, 0]], 4.0, "cw must be finite"),
        ([[0, 0]], [[0, 0]], 0.0, "side must be one number above 0"),
        ([[-300, -300]], [[-300, 300]], 4.0, "are the ends in metres"),
    ],
)
def test_umbmark_refuses_ends_that_are_none(cw, ccw, side, message):
    with pytest.raises(ValueError, match=message):
        odometry.umbmark(cw, ccw, side, NOMINAL)


def test_square_refuses_what_it_cannot_drive():
    with pytest.raises(TypeError, match="true must be a Wheels, got tuple"):
        odometry.square((0.35, 0.35, 2.0), NOMINAL)
    with pytest.raises(ValueError, match="way must be one of cw, ccw, got 'left'"):
        odometry.square(NOMINAL, NOMINAL, SIDE, "left")
    with pytest.raises(
        ValueError, match="rng must be a seed of 0 or more or a numpy Generator, got None"
    ):
        odometry.square(NOMINAL, NOMINAL, SIDE, noise=0.1)
    with pytest.raises(ValueError, match=r"noise must be one number at least 0 \[rad\], got -1"):
        odometry.square(NOMINAL, NOMINAL, SIDE, noise=-1)
    with pytest.raises(ValueError, match="runs must be one whole number at least 1, got 0"):
        odometry.square(NOMINAL, NOMINAL, SIDE, runs=0)


def drive(true, n=3000, seed=1, left_turns_only=False):
    """Encoder angles and poses of a drive with turns to both sides."""
    s = np.linspace(0, 1, n)
    sway = 1.0 if left_turns_only else np.sin(2 * np.pi * 3 * s)
    left = np.cumsum(np.full(n, 0.03) - 0.01 * sway)
    right = np.cumsum(np.full(n, 0.03) + 0.01 * sway)
    return left, right, odometry.from_angles([3.0, -1.0, 0.7], left, right, true)


def test_a_log_without_noise_gives_the_wheels_exactly():
    true = Wheels(0.34, 0.352, 2.3)
    found = odometry.calibrate(*drive(true))
    np.testing.assert_allclose(
        [found.wheels.left, found.wheels.right, found.wheels.gauge], [0.34, 0.352, 2.3], rtol=1e-9
    )
    assert found.slip[0] == pytest.approx(1 - 0.34 / BACKHOE.tracks.sprocket_radius)
    assert found.gauge_factor == pytest.approx(2.3 / BACKHOE.tracks.gauge)
    assert found.heading_residual < 1e-9 and found.position_residual < 1e-9


def test_a_noisy_log_gives_them_to_a_few_per_mille_and_its_noise():
    true, rng = Wheels(0.34, 0.352, 2.3), np.random.default_rng(2)
    left, right, pose = drive(true)
    found = odometry.calibrate(left, right, pose + rng.normal(size=pose.shape) * [0.03, 0.03, 0.01])
    np.testing.assert_allclose(
        [found.wheels.left, found.wheels.right, found.wheels.gauge], [0.34, 0.352, 2.3], rtol=5e-3
    )
    assert found.heading_residual == pytest.approx(0.01, rel=0.05)
    assert found.position_residual == pytest.approx(0.03 * np.sqrt(2), rel=0.15)


def test_longitudinal_slip_is_found_as_a_smaller_radius():
    left, right, _ = drive(NOMINAL)
    d, a = tracks_twist(np.diff(left), np.diff(right), slip=(0.1, 0.2), gauge=2.6)
    found = odometry.calibrate(left, right, odometry.integrate(np.zeros(3), d, a, 1.0))
    np.testing.assert_allclose(found.slip, [0.1, 0.2], atol=1e-9)
    assert found.wheels.gauge == pytest.approx(2.6)


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda le, ri, p: (le, le, p), "drive straights and turns to both sides"),
        (lambda le, ri, p: (ri, le, p), "are left and right swapped"),
        (lambda le, ri, p: (le, ri, p * [1, 1, -1]), "psi clockwise"),
        (lambda le, ri, p: (le, ri, p + np.array([0, 0, 1.5])), "beside the heading"),
        (lambda le, ri, p: (le[:3], ri[:3], p[:3]), "rows of 4 or more angles, got 3"),
        (lambda le, ri, p: (le[:5], ri, p), r"right must be as many angles, shape \(5,\)"),
        (lambda le, ri, p: (le, ri, p[:, :2]), "as many x, y, psi"),
        (lambda le, ri, p: (le, ri * np.nan, p), "right must be finite"),
        (
            lambda le, ri, p: (le, ri, np.where(np.arange(3000)[:, None] > 99, p + 7, p)),
            "psi jumps",
        ),
    ],
)
def test_a_log_that_cannot_be_calibrated_says_why(spoil, message):
    with pytest.raises(ValueError, match=message):
        odometry.calibrate(*spoil(*drive(NOMINAL)))


def test_turns_to_one_side_alone_do_not_tell_the_wheels_apart():
    with pytest.raises(ValueError, match="does not tell radii and gauge apart"):
        odometry.calibrate(*drive(NOMINAL, left_turns_only=True))
