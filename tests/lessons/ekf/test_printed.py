"""What Mastalli prints in chapter 4, judged."""

import numpy as np
import pytest

from backhoe.lessons.ekf import printed
from backhoe.localisation import fusion, kalman

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


@pytest.mark.parametrize("k", [1, 2])
def test_footnote_5_integrates_to_less_than_one(k):
    P = np.diag(np.arange(1.0, k + 1)) + 0.3
    axis, step = np.linspace(-9, 9, 91, retstep=True)
    points = np.stack(np.meshgrid(*[axis] * k), axis=-1).reshape(-1, k)
    total = sum(printed.density_footnote_5(p, np.zeros(k), P) for p in points) * step**k
    assert total == pytest.approx(2 ** (-k / 2), rel=1e-9)


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


def _spd(rng, n):
    A = rng.normal(size=(n, n))
    return A @ A.T + 0.1 * np.eye(n)
