"""The solutions that lesson 07 shows are the library's own functions in other words."""

import numpy as np
import pytest

from backhoe.lessons.ekf.exercises import beliefs, cycle, honesty, motion, sensors, update
from backhoe.localisation import drives, fusion, imu, kalman
from backhoe.localisation.fusion import Model

rng = np.random.default_rng(7)


def spread(n):
    A = rng.normal(size=(n, n))
    return A @ A.T + 0.1 * np.eye(n)


def test_one_step_of_bayes_is_the_librarys():
    belief, transition = rng.dirichlet(np.ones(5)), rng.dirichlet(np.ones(5), 5).T
    likelihood = rng.uniform(0.1, 1, 5)
    bayes = kalman.DiscreteBayesFilter(belief)
    bayes.predict(transition)
    bayes.update(likelihood)
    mine = beliefs.bayes(belief, transition, likelihood)
    np.testing.assert_allclose(mine, bayes.belief, rtol=1e-12)


def test_update_is_that_of_the_information_form():
    x, P, z, H, R = rng.normal(size=4), spread(4), rng.normal(size=2), rng.normal(size=(2, 4)), None
    R = spread(2)
    for mine, theirs in zip(
        update.update(x, P, z, H, R), kalman.information_update(x, P, z, H, R), strict=True
    ):
        np.testing.assert_allclose(mine, theirs, atol=1e-10)


def test_jacobian_is_the_librarys_model_without_slip():
    model, psi, v, omega, dt = Model(), 0.7, 0.6, 0.4, 0.1
    turns = np.array([v - omega * model.gauge / 2, v + omega * model.gauge / 2]) * dt / model.radius
    F = model.F(np.array([0, 0, psi, 0, 1.0, 0]), turns, dt)
    np.testing.assert_allclose(motion.step_jacobian(psi, v, omega, dt), F[:3, :3], atol=1e-12)


def test_noise_of_the_encoders_is_the_librarys_without_slip():
    model, dt = Model(), 0.03
    x, turns = np.array([1.0, 2.0, 0.7, 0.0, 1.0, 0.0]), np.array([0.5, 0.9])
    mine = motion.encoder_noise(0.7, *turns, model.encoder_variance(dt))
    np.testing.assert_allclose(mine, model.Q(x, turns, dt)[:3, :3], rtol=1e-12)


def test_attitude_is_the_librarys():
    force = rng.normal(size=(20, 3))
    mine = [sensors.attitude_from_gravity(one) for one in force]
    np.testing.assert_allclose(mine, imu.attitude_from_gravity(force), atol=1e-12)


def test_nees_is_the_librarys():
    P, truth = spread(3), np.array([1.0, 2.0, 3.1])
    estimate = np.array([0.8, 2.1, -3.1])
    theirs = kalman.nees(truth - estimate, P, angles=(2,))
    assert honesty.nees(truth, estimate, P) == pytest.approx(theirs, rel=1e-12)


def test_rmse_is_the_librarys():
    t, t_e = np.linspace(0, 8, 161), np.linspace(0, 8, 257)
    psi, psi_e = honesty.wrapped(0.7 * t), honesty.wrapped(0.72 * t_e)
    theirs = fusion.rmse(t, psi[:, None], t_e, psi_e[:, None], period=0.25, angles=(0,))
    assert honesty.rmse(t, psi, t_e, psi_e, 0.25) == pytest.approx(theirs[0], rel=1e-9)


def test_cycles_one_after_another_are_the_librarys_honest_filter_with_a_yaw():
    drive, model = drives.load("rectangle"), Model()
    theirs = fusion.honest(drive, heading="yaw", slip=False)
    steps = fusion.increments(drive)
    x, P = drive.truth[0], np.diag(fusion.START_STD) ** 2
    for k, dt in enumerate(steps.dt[:600]):
        M = model.encoder_variance(dt)
        x, P = cycle.cycle(x, P, steps.left[k], steps.right[k], steps.yaw[k], M, 0.02)
    np.testing.assert_allclose(x, theirs.pose[600], atol=1e-9)
    np.testing.assert_allclose(P, theirs.covariance[600], atol=1e-12)
