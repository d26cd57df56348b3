"""What lesson 07 says in strong words."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from backhoe.lessons.ekf import printed_filter
from backhoe.localisation import drives, fusion, imu, kalman

F, H = np.array([[1.0, 0.5], [0.0, 1.0]]), np.array([[1.0, 0.0]])
Q = 0.02 * np.array([[0.5**3 / 3, 0.5**2 / 2], [0.5**2 / 2, 0.5]])
R = np.array([[0.09]])


@pytest.fixture
def rng():
    return np.random.default_rng(7)


def spd(rng, n):
    A = rng.normal(size=(n, n))
    return A @ A.T + 0.1 * np.eye(n)


def test_a_posterior_is_no_wider_than_its_prior_in_any_direction(rng):
    for _ in range(50):
        P, H = spd(rng, 4), rng.normal(size=(2, 4))
        _, after = kalman.update(np.zeros(4), P, 9 * rng.normal(size=2), H, spd(rng, 2))
        assert np.linalg.eigvalsh(P - after).min() > -1e-12


def test_josephs_form_is_the_spread_that_happens_with_any_gain(rng):
    P = spd(rng, 2)
    K = kalman.gain(P, H, R)
    errors = rng.multivariate_normal([0, 0], P, 200_000)
    noise = 0.3 * rng.normal(size=(len(errors), 1))
    for share in (0.0, 0.5, 1.0, 1.5, 2.0):
        left = errors - (errors @ H.T + noise) @ (share * K).T
        joseph = kalman.joseph(P, share * K, H, R)
        np.testing.assert_allclose(joseph, np.cov(left.T), atol=0.02 * P.max())


def test_the_short_form_falls_with_the_gain_to_below_zero(rng):
    P = spd(rng, 2) + np.diag([0.5, 0.0])
    short = [kalman.short_form(P, c * kalman.gain(P, H, R), H)[0, 0] for c in np.linspace(0, 2, 21)]
    assert (np.diff(short) < 0).all() and short[-1] < 0


def run(Q, R, steps=600):
    one = kalman.KalmanFilter(F, H, Q, R, np.zeros(2), np.diag([0.5**2, 0.3**2]))
    found = []
    for _ in range(steps):
        one.predict(None, 0.5)
        one.update([0.0])
        found.append(one.P)
    return np.array(found)


def test_the_band_settles_in_seconds_where_riccati_has_it_and_is_there_after_ten_times_as_long():
    found = run(Q, R)
    before = solve_discrete_are(F.T, H.T, Q, R)
    settled = before - kalman.gain(before, H, R) @ H @ before
    np.testing.assert_allclose(found[20:], np.broadcast_to(settled, (580, 2, 2)), rtol=0.1)
    np.testing.assert_allclose(found[60:], np.broadcast_to(settled, (540, 2, 2)), rtol=1e-4)


def test_the_settled_gain_depends_on_the_ratio_of_q_and_r_alone():
    plain, large = run(Q, R)[-1], run(100 * Q, 100 * R)[-1]
    np.testing.assert_allclose(large, 100 * plain, rtol=1e-9)


def test_gravity_looks_the_same_from_any_compass_point(rng):
    for yaw in rng.uniform(-np.pi, np.pi, 20):
        felt = imu.specific_force([0, 0, 0], [0.4, -0.3, yaw])
        np.testing.assert_allclose(felt, imu.specific_force([0, 0, 0], [0.4, -0.3, 0]), atol=1e-12)


def test_no_yaw_moves_the_path_of_the_printed_filter(rng):
    drive = drives.load("rectangle_slip")
    other = replace(drive, yaw=drive.yaw + rng.normal(size=drive.yaw.shape))
    paths = [printed_filter.as_printed(one).pose[..., :2] for one in (drive, other)]
    np.testing.assert_array_equal(*paths)


def test_the_printed_filter_lies_more_the_longer_it_drives():
    nees = [
        fusion.monte_carlo(name, printed_filter.as_printed).mean_nees
        for name in ("rectangle", "g", "circle")
    ]
    np.testing.assert_allclose(nees, [10, 20, 160], rtol=0.05)


def test_on_the_circle_the_honest_filter_needs_a_compass_or_fixes():
    alone = fusion.monte_carlo("circle", fusion.pose_filter)
    told = fusion.monte_carlo("circle", fusion.pose_filter, heading="yaw")
    assert alone.nees[-100:].mean() == pytest.approx(6, abs=0.7)
    assert told.mean_nees == pytest.approx(3, abs=0.3)
    fixed = fusion.monte_carlo(
        "circle", fusion.pose_filter, fixes=lambda r, rng: fusion.total_station(r, 15.0, rng)
    )
    assert fixed.mean_nees == pytest.approx(3, abs=0.3)


def test_without_a_fix_the_deviation_grows_but_on_the_way_home():
    sigma = fusion.monte_carlo("rectangle", fusion.pose_filter, turning=drives.SLIPPING).sigma_xy
    assert sigma[-1] > 5 * sigma[0]
    assert sigma.argmax() < len(sigma) - 100 and sigma.max() > 1.1 * sigma[-1]
    away = fusion.monte_carlo("g", fusion.pose_filter, turning=drives.SLIPPING).sigma_xy
    assert away[-1] > 3 * away[len(away) // 4]
