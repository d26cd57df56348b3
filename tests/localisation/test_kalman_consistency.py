"""NEES and NIS of filters that are right, and of filters that lie."""

import numpy as np
import pytest
from scipy import stats

from backhoe.localisation import kalman

DT = 0.1
F = np.array([[1.0, DT], [0.0, 1.0]])
H = np.array([[1.0, 0.0]])
Q, R, P0 = np.diag([1e-4, 4e-3]), np.array([[0.05]]), np.diag([0.5, 0.2])
RUNS, STEPS = 50, 200


def monte_carlo(trust=1.0, seed=0):
    """Errors, P, innovations, S of many runs whose filter believes in Q * trust."""
    rng = np.random.default_rng(seed)
    x = rng.multivariate_normal([0, 0], P0, RUNS)
    batch = kalman.BatchExtendedKalmanFilter(
        lambda x, u, dt: x @ F.T, F, None, H, trust * Q, R, np.zeros((RUNS, 2)), P0
    )
    rows = []
    for _ in range(STEPS):
        x = x @ F.T + rng.multivariate_normal([0, 0], Q, RUNS)
        batch.predict(None, DT)
        batch.update(x @ H.T + np.sqrt(R[0, 0]) * rng.standard_normal((RUNS, 1)))
        rows.append((x - batch.x, batch.P, batch.innovation, batch.S))
    return [np.stack(column, axis=1) for column in zip(*rows, strict=True)]


RIGHT = monte_carlo()


def test_nees_of_a_right_filter_is_in_its_band():
    errors, P, _, _ = RIGHT
    average = kalman.nees(errors, P).mean(axis=0)
    assert average.shape == (STEPS,)
    band = kalman.chi_square_band(2, RUNS)
    assert kalman.share_inside(average, band) > 0.88
    assert average.mean() == pytest.approx(2.0, abs=0.15)


def test_nis_of_a_right_filter_is_in_its_band():
    _, _, y, S = RIGHT
    every = kalman.nis(y, S)
    assert kalman.share_inside(every.mean(axis=0), kalman.chi_square_band(1, RUNS)) > 0.9
    low, high = kalman.chi_square_band(1, RUNS * STEPS)
    assert low < every.mean() < high


def test_a_filter_too_sure_of_itself_is_found_out():
    errors, P, _, _ = monte_carlo(trust=0.01)
    _, high = kalman.chi_square_band(2, RUNS)
    assert (kalman.nees(errors, P).mean(axis=0)[50:] > high).all()


def test_a_filter_too_modest_is_found_out():
    errors, P, _, _ = monte_carlo(trust=30.0)
    low, _ = kalman.chi_square_band(2, RUNS)
    assert (kalman.nees(errors, P).mean(axis=0)[50:] < low).mean() > 0.9


def test_nees_is_the_quadratic_form_of_the_inverse():
    rng = np.random.default_rng(1)
    A = rng.normal(size=(5, 4, 3, 3))
    P, e = A @ np.swapaxes(A, -1, -2) + 0.1 * np.eye(3), rng.normal(size=(5, 4, 3))
    expected = np.einsum("...i,...ij,...j->...", e, np.linalg.inv(P), e)
    np.testing.assert_allclose(kalman.nees(e, P), expected, rtol=1e-9)
    assert kalman.nees(e[0, 0], P[0, 0]).shape == ()


def test_nees_wraps_the_angles_it_is_told():
    e = np.array([0.1, 2 * np.pi + 0.2])
    assert kalman.nees(e, np.eye(2), angles=(1,)) == pytest.approx(0.05)
    assert kalman.nees(e, np.eye(2)) > 40
    assert e[1] > 6, "the caller's array is as before"


@pytest.mark.parametrize(("dof", "runs"), [(1, 1), (3, 50), (6, 7)])
def test_the_band_is_that_of_chi_square(dof, runs):
    expected = stats.chi2.ppf([0.025, 0.975], dof * runs) / runs
    np.testing.assert_allclose(kalman.chi_square_band(dof, runs), expected, rtol=1e-10)


def test_the_band_of_three_degrees_and_fifty_runs_is_the_known_one():
    assert np.round(kalman.chi_square_band(3, 50), 2).tolist() == [2.36, 3.72]


def test_the_ellipse_holds_its_share():
    P, mean = np.array([[2.0, 0.8], [0.8, 0.7]]), np.array([1.0, -2.0])
    outline = kalman.ellipse(mean, P, probability=0.9)
    away = outline - mean
    radius = np.einsum("ki,ij,kj->k", away, np.linalg.inv(P), away)
    np.testing.assert_allclose(radius, stats.chi2.ppf(0.9, 2), rtol=1e-10)
    draws = np.random.default_rng(2).multivariate_normal(mean, P, 20_000) - mean
    inside = np.einsum("ki,ij,kj->k", draws, np.linalg.inv(P), draws) < radius[0]
    assert inside.mean() == pytest.approx(0.9, abs=0.01)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: kalman.nees([1, 2], np.eye(3)), r"errors and covariances must have shapes"),
        (lambda: kalman.nees([1, np.nan], np.eye(2)), "errors must be finite"),
        (lambda: kalman.nees([1, 2], np.diag([1, -1])), "covariances must be positive definite"),
        (lambda: kalman.nees([1, 2], [[1, 0.5], [0, 1]]), "covariances must be symmetric"),
        (lambda: kalman.nis([1], [[0.0]]), "S must be positive definite"),
        (lambda: kalman.nees([1, 2], np.eye(2), angles=(2,)), "angles must be indices from 0 to 1"),
        (lambda: kalman.chi_square_band(0), "dof must be one whole number at least 1"),
        (lambda: kalman.chi_square_band(3, 1.5), "runs must be one whole number at least 1"),
        (
            lambda: kalman.chi_square_band(3, 1, 95),
            "probability must be one number above 0 and below 1",
        ),
        (lambda: kalman.share_inside([], (0, 1)), "at least one number"),
        (lambda: kalman.share_inside([1], (1, 0)), r"band must be \(low, high\)"),
        (lambda: kalman.ellipse([0, 0, 0], np.eye(2)), r"mean must have shape \(2,\)"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_no_runs_have_no_nees():
    assert kalman.nees(np.zeros((0, 3)), np.zeros((0, 3, 3))).shape == (0,)
