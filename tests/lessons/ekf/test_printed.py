"""What Mastalli prints in chapter 4, judged."""

import numpy as np
import pytest
from scipy import integrate, stats
from scipy.linalg import expm

from backhoe.lessons import published
from backhoe.lessons.ekf import printed
from backhoe.localisation import fusion, imu, kalman

N = 3


def chain(seed=0):
    """Prior, transitions and likelihoods of four instants."""
    rng = np.random.default_rng(seed)
    prior = rng.dirichlet(np.ones(N))
    transition = rng.dirichlet(np.ones(N), size=N).T
    likelihoods = rng.uniform(0.1, 1.0, size=(3, N))
    return prior, transition, likelihoods


def joint_posterior(prior, transition, likelihoods):
    """P(x_1:k | z_1:k) by enumeration of every sequence, x_1 ~ prior measured by likelihoods[0]."""
    k = len(likelihoods)
    joint = np.empty((N,) * k)
    for path in np.ndindex(*joint.shape):
        p = prior[path[0]] * likelihoods[0][path[0]]
        for i in range(1, k):
            p *= transition[path[i], path[i - 1]] * likelihoods[i][path[i]]
        joint[path] = p
    return joint / joint.sum()


def test_44_and_45_the_recursion_over_whole_sequences_is_right():
    prior, transition, likelihoods = chain()
    before = joint_posterior(prior, transition, likelihoods[:2])
    product = before[:, :, None] * transition.T[None] * likelihoods[2]
    after = product / product.sum()
    np.testing.assert_allclose(
        after, joint_posterior(prior, transition, likelihoods), rtol=0, atol=1e-15
    )


def test_46_as_printed_sums_to_the_number_of_states():
    prior, transition, likelihoods = chain()
    joint = joint_posterior(prior, transition, likelihoods[:2])
    found = printed.posterior_46(transition, likelihoods[2], joint)
    assert found.shape == (N, N, N)
    assert found.sum() == pytest.approx(N, abs=1e-12)


def test_46_with_marginals_is_the_filter():
    prior, transition, likelihoods = chain()
    before = joint_posterior(prior, transition, likelihoods[:2]).sum(axis=0)
    found = printed.posterior_46(transition, likelihoods[2], before)[0]
    after = joint_posterior(prior, transition, likelihoods).sum(axis=(0, 1))
    np.testing.assert_allclose(found, after, rtol=0, atol=1e-15)


def test_47_as_printed_still_depends_on_older_states_and_sums_to_too_much():
    prior, transition, likelihoods = chain()
    joint = joint_posterior(prior, transition, likelihoods[:2])
    predicted = printed.predict_47(transition, joint)
    assert predicted.shape == (N, N), "P(x_3 | z_1:2) has one axis"
    np.testing.assert_allclose(predicted.sum(axis=0), transition @ joint.sum(axis=0))
    corrected = printed.correct_47(likelihoods[2], predicted.sum(axis=0), instants=3)
    assert corrected.sum() == pytest.approx(N**2, abs=1e-12)
    after = joint_posterior(prior, transition, likelihoods).sum(axis=(0, 1))
    np.testing.assert_allclose(corrected[0, 0], after, rtol=0, atol=1e-15)


def test_48_and_49_a_point_estimate_is_good_where_the_parameter_is_well_known():
    def evidence(width):
        theta = stats.norm(1.0, width)
        return integrate.quad(lambda t: stats.norm.pdf(0.3, t, 1.0) * theta.pdf(t), -8, 10)[0]

    at_point = stats.norm.pdf(0.3, 1.0, 1.0)
    assert evidence(1.0) == pytest.approx(stats.norm.pdf(0.3, 1.0, np.sqrt(2)), rel=1e-8)
    assert abs(evidence(0.1) - at_point) < 0.02 * abs(evidence(1.0) - at_point)


@pytest.mark.parametrize("k", [1, 2])
def test_footnote_5_integrates_to_less_than_one(k):
    P = np.diag(np.arange(1.0, k + 1)) + 0.3
    axis, step = np.linspace(-9, 9, 91, retstep=True)
    points = np.stack(np.meshgrid(*[axis] * k), axis=-1).reshape(-1, k)
    total = sum(printed.density_footnote_5(p, np.zeros(k), P) for p in points) * step**k
    assert total == pytest.approx(2 ** (-k / 2), rel=1e-9)


def test_footnote_6_is_the_inverse():
    rng = np.random.default_rng(6)
    B, D = _spd(rng, 4), _spd(rng, 2)
    C = rng.normal(size=(4, 2))
    A = np.linalg.inv(B) + C @ np.linalg.inv(D) @ C.T
    found = B - B @ C @ np.linalg.inv(D + C.T @ B @ C) @ C.T @ B
    np.testing.assert_allclose(A @ found, np.eye(4), atol=1e-12)


def test_413_and_414_the_gradient_vanishes_at_the_updated_state():
    rng = np.random.default_rng(14)
    P, R, H = _spd(rng, 3), _spd(rng, 2), rng.normal(size=(2, 3))
    x, z = rng.normal(size=3), rng.normal(size=2)

    def log_posterior(state):
        measured = stats.multivariate_normal.logpdf(z, H @ state, R)
        return np.atleast_1d(measured + stats.multivariate_normal.logpdf(state, x, P))

    best, _ = kalman.information_update(x, P, z, H, R)
    assert np.abs(kalman.numerical_jacobian(log_posterior, best)).max() < 1e-8
    assert np.abs(kalman.numerical_jacobian(log_posterior, x)).max() > 0.1


def test_415_to_417_information_and_gain_form_agree():
    rng = np.random.default_rng(15)
    P, R, H = _spd(rng, 4), _spd(rng, 2), rng.normal(size=(2, 4))
    x, z = rng.normal(size=4), rng.normal(size=2)
    K = kalman.gain(P, H, R)
    by_information, covariance = kalman.information_update(x, P, z, H, R)
    np.testing.assert_allclose(x + K @ (z - H @ x), by_information, rtol=1e-10)
    np.testing.assert_allclose(kalman.joseph(P, K, H, R), covariance, rtol=1e-9, atol=1e-12)


def test_418_second_line_lacks_the_error_of_the_prediction():
    rng = np.random.default_rng(18)
    truth, prior, H = rng.normal(size=3), rng.normal(size=3), rng.normal(size=(2, 3))
    v, K = rng.normal(size=2), rng.normal(size=(3, 2))
    z = H @ truth + v
    error = truth - (prior + K @ (z - H @ prior))
    third_line = (truth - prior) - K @ (H @ (truth - prior) + v)
    np.testing.assert_allclose(third_line, error, atol=1e-13)
    second_line = printed.error_418(truth, prior, z, K, H)
    np.testing.assert_allclose(error - second_line, truth - prior, atol=1e-13)


def test_419_the_short_form_is_right_at_the_optimal_gain_alone():
    rng = np.random.default_rng(19)
    P, R, H = _spd(rng, 3), _spd(rng, 2), rng.normal(size=(2, 3))
    K = kalman.gain(P, H, R)
    third = P - K @ H @ P - P @ H.T @ K.T + K @ (H @ P @ H.T + R) @ K.T
    joseph = kalman.joseph(P, K, H, R)
    np.testing.assert_allclose(third, joseph, atol=1e-12)
    np.testing.assert_allclose(kalman.short_form(P, K, H), joseph, atol=1e-12)
    other = 0.7 * K
    assert np.abs(kalman.short_form(P, other, H) - kalman.joseph(P, other, H, R)).max() > 0.01


def test_420_and_421_the_rate_s_jacobian_is_no_transition():
    A, dt = np.array([[0.0, 1.0], [-4.0, -0.4]]), 0.01
    exact = expm(A * dt)
    assert np.abs(printed.transition_421(A) - exact).max() > 1
    first = [np.abs(kalman.transition(A, T) - expm(A * T)).max() for T in (dt, dt / 2)]
    assert np.log2(first[0] / first[1]) == pytest.approx(2.0, abs=0.02)
    np.testing.assert_allclose(kalman.transition(A, dt, order=None), exact, atol=1e-15)


def test_422_swaps_roll_and_pitch_and_loses_a_sign():
    force = imu.specific_force([0, 0, 0], [0.4, -0.3, 1.0])
    phi, theta = printed.attitude_422(force)
    assert phi == pytest.approx(0.3), "minus the pitch"
    assert theta == pytest.approx(np.arcsin(np.sin(0.4) * np.cos(-0.3)))
    np.testing.assert_allclose(imu.attitude_from_gravity(force), [0.4, -0.3], atol=1e-15)


def test_424_moves_as_far_in_a_cycle_as_it_should_in_a_second():
    moved = printed.motion_424(np.zeros(6), 1.0, 0.0, 1 / 30)
    assert moved[0] == 1.0
    tilted = printed.motion_424([0, 0, 0.5, 0.1, 0.2, 0], 1.0, 0.0, 1 / 30)
    assert tilted[2:5].tolist() == [0, 0, 0], "forgets height and tilt, which (4.25) keeps"


def test_424_with_its_time_is_of_first_order_and_the_mean_heading_of_second():
    def error(steps, share):
        dt, x = 2.0 / steps, np.zeros(3)
        for _ in range(steps):
            heading = x[2] + share * 0.5 * dt
            x = np.add(x, [dt * np.cos(heading), dt * np.sin(heading), 0.5 * dt])
        return np.hypot(x[0] - np.sin(1.0) / 0.5, x[1] - (1 - np.cos(1.0)) / 0.5)

    assert np.log2(error(50, 1.0) / error(100, 1.0)) == pytest.approx(1.0, abs=0.02)
    assert np.log2(error(50, 0.5) / error(100, 0.5)) == pytest.approx(2.0, abs=0.02)


def test_425_is_not_the_jacobian_of_424():
    x, speed, omega, T_s = np.array([1.0, 2, 0, 0, 0, 0.4]), 0.8, 0.6, 1 / 30
    F = printed.jacobian_425(x, speed, omega, T_s)
    true = kalman.numerical_jacobian(lambda s: printed.motion_424(s, speed, omega, T_s), x)
    apart = np.abs(F - true) > 1e-6
    assert np.argwhere(apart).tolist() == [[0, 5], [1, 5], [2, 2], [3, 3], [4, 4]]
    assert np.abs(F @ x - printed.motion_424(x, speed, omega, T_s)).max() > 0.1, "no prediction"


def test_426_and_427_select_and_only_a_noise_in_empty_rows_makes_s_regular():
    P = np.diag(np.arange(1.0, 7.0))
    for H, rows in ((printed.H_ODOM_426, [0, 1, 5]), (printed.H_IMU_427, [3, 4, 5])):
        assert np.flatnonzero(H.any(axis=1)).tolist() == rows
        with pytest.raises(np.linalg.LinAlgError):
            kalman.gain(P, H, np.zeros((6, 6)))
        full = kalman.gain(P, H, 0.02 * np.eye(6))
        np.testing.assert_allclose(
            full[:, rows], kalman.gain(P, H[rows], 0.02 * np.eye(3)), atol=1e-15
        )
        assert not np.delete(full, rows, axis=1).any()


def test_algorithm_2_as_printed_divides_by_one_too_few_and_does_not_wrap():
    time, zeros = np.arange(11.0), np.zeros(11)
    assert printed.rmse_algorithm_2(time, time, zeros, zeros + 1, 1.0) == pytest.approx(
        np.sqrt(11 / 10)
    )
    right = fusion.rmse(time, zeros[:, None], time, zeros[:, None] + 1, period=1.0)
    assert right[0] == pytest.approx(1.0)
    turned = printed.rmse_algorithm_2(time, time, zeros, zeros + 2 * np.pi, 1.0)
    assert turned > 6


def test_algorithm_2_with_errors_that_begin_at_zero_sees_no_sample_at_all():
    time, zeros = np.arange(11.0), np.zeros(11)
    assert printed.rmse_algorithm_2(time, time, zeros, zeros + 1, 1.0, initial=0.0) == 0.0


@pytest.mark.parametrize("number", [1, 2, 3])
def test_the_printed_improvement_is_a_ratio_and_not_a_reduction(number):
    table = published.load(f"mastalli_2013_table_4{number}")
    axes = ("x", "y", "omega")
    reckoned, filtered, printed = (
        np.array([table[row][axis] for axis in axes])
        for row in ("rmse_odometry", "rmse_ekf", "improvement_percent")
    )
    gain = fusion.improvement(reckoned, filtered)
    agrees = np.abs(gain.ratio_percent - printed) < 0.0001 * printed
    assert agrees.tolist() == [True, number != 2, True]
    assert (gain.reduction_percent < 100).all()
    assert (np.abs(gain.reduction_percent - printed) > 50).all()


def test_table_42_prints_412_27_where_its_rows_give_412_73():
    table = published.load("mastalli_2013_table_42")
    gain = fusion.improvement(table["rmse_odometry"]["y"], table["rmse_ekf"]["y"])
    assert round(float(gain.ratio_percent), 2) == 412.73
    assert table["improvement_percent"]["y"] == 412.27
    assert float(gain.reduction_percent) == pytest.approx(75.8, abs=0.05)


def test_the_printed_rmse_of_the_filter_do_not_stay_constant_in_heading():
    headings = [published.load(f"mastalli_2013_table_4{k}")["rmse_ekf"]["omega"] for k in (1, 2, 3)]
    assert max(headings) > 30 * min(headings)


def _spd(rng, n):
    A = rng.normal(size=(n, n))
    return A @ A.T + 0.1 * np.eye(n)
