"""The Bayes filter on a grid and the particle filter, against enumeration and the Kalman filter."""

import numpy as np
import pytest

from backhoe.basics.angles import wrap
from backhoe.localisation import kalman


def test_the_discrete_filter_is_the_sum_over_all_histories():
    rng = np.random.default_rng(0)
    n, steps = 4, 5
    start, T = rng.dirichlet(np.ones(n)), rng.dirichlet(np.ones(n), size=n).T
    likelihoods = rng.uniform(0.05, 1.0, size=(steps, n))
    expected, total = np.zeros(n), 0.0
    for path in np.ndindex(*(n,) * (steps + 1)):
        p = start[path[0]]
        for k in range(steps):
            p *= T[path[k + 1], path[k]] * likelihoods[k, path[k + 1]]
        expected[path[-1]] += p
        total += p
    filter, evidence = kalman.DiscreteBayesFilter(start), 1.0
    for likelihood in likelihoods:
        filter.predict(T)
        evidence *= filter.update(likelihood)
    np.testing.assert_allclose(filter.belief, expected / total, rtol=0, atol=1e-14)
    assert evidence == pytest.approx(total, rel=1e-12)


def test_on_a_fine_grid_the_discrete_filter_is_the_kalman_filter():
    grid = np.linspace(-6, 6, 601)

    def bell(x, variance):
        return np.exp(-0.5 * x**2 / variance)

    move = bell(grid[:, None] - grid[None, :], 0.04)
    belief = bell(grid, 0.5)
    discrete = kalman.DiscreteBayesFilter(belief / belief.sum())
    linear = kalman.KalmanFilter([[1.0]], [[1.0]], [[0.04]], [[0.09]], [0.0], [[0.5]])
    for z in (0.3, 0.5, 0.1, -0.2, 0.4):
        discrete.predict(move / move.sum(axis=0))
        discrete.update(bell(z - grid, 0.09))
        linear.predict(None, 1.0)
        linear.update(z)
    mean = grid @ discrete.belief
    assert mean == pytest.approx(linear.x[0], abs=1e-9)
    assert (grid - mean) ** 2 @ discrete.belief == pytest.approx(linear.P[0, 0], abs=1e-9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: kalman.DiscreteBayesFilter([0.5, 0.6]), "belief must not be negative and sum"),
        (lambda: kalman.DiscreteBayesFilter([1.5, -0.5]), "belief must not be negative"),
        (lambda: kalman.DiscreteBayesFilter([[1.0]]), r"shape \(n,\), got shape \(1, 1\)"),
        (
            lambda: kalman.DiscreteBayesFilter([0.5, 0.5]).predict([[0.9, 0.1], [0.3, 0.7]]),
            "each column of transition",
        ),
        (
            lambda: kalman.DiscreteBayesFilter([0.5, 0.5]).predict(np.eye(3)),
            r"transition must have shape \(2, 2\)",
        ),
        (lambda: kalman.DiscreteBayesFilter([1.0, 0.0]).update([0.0, 1.0]), "impossible in every"),
        (lambda: kalman.DiscreteBayesFilter([1.0, 0.0]).update([-1.0, 1.0]), "likelihood must not"),
    ],
)
def test_bad_beliefs_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


# ---- particles

F, H = np.array([[1.0, 0.1], [0.0, 1.0]]), np.array([[1.0, 0.0]])
Q, R, P0 = np.diag([1e-3, 1e-2]), np.array([[0.05]]), np.diag([0.5, 0.3])


def swarm(particles, seed=0, **options):
    return kalman.ParticleFilter(
        lambda x, u, dt: x @ F.T,
        lambda x: x @ H.T,
        Q,
        R,
        [0.0, 0.0],
        P0,
        particles=particles,
        rng=seed,
        **options,
    )


def apart(particles, repeats=24):
    """Root mean square distance of the particles' mean from the Kalman filter's after 20 steps."""
    linear = kalman.KalmanFilter(F, H, Q, R, [0.0, 0.0], P0)
    swarms = [swarm(particles, seed) for seed in range(repeats)]
    rng, x = np.random.default_rng(9), np.zeros(2)
    for _ in range(20):
        x = F @ x + rng.multivariate_normal([0, 0], Q)
        z = x[0] + np.sqrt(R[0, 0]) * rng.standard_normal()
        for filter in (linear, *swarms):
            filter.predict(None, 0.1)
            filter.update([z])
    away = np.array([filter.x - linear.x for filter in swarms])
    spread = np.mean([filter.P for filter in swarms], axis=0)
    return np.sqrt(np.mean(away**2)), np.abs(spread - linear.P).max() / linear.P.max()


def test_particles_converge_to_the_kalman_filter_with_the_root_of_their_number():
    numbers = [400, 1600, 6400]
    errors, spreads = zip(*[apart(particles) for particles in numbers], strict=True)
    slope = np.polyfit(np.log(numbers), np.log(errors), 1)[0]
    assert slope == pytest.approx(-0.5, abs=0.15)
    assert errors[-1] < 0.02 and spreads[-1] < 0.05


def test_a_hundred_thousand_particles_have_the_posterior_of_a_normal_prior_to_one_per_cent():
    """By the information that prior and measurement give; nothing is resampled."""
    prior, R = np.array([[0.5, 0.2], [0.2, 0.3]]), np.array([[0.6]])
    many = kalman.ParticleFilter(
        lambda x, u, dt: x,
        lambda x: x @ H.T,
        Q,
        R,
        [0.1, -0.2],
        prior,
        particles=100_000,
        rng=4,
        threshold=0.0,
    )
    many.update([0.9])
    posterior = np.linalg.inv(np.linalg.inv(prior) + H.T @ H / R)
    mean = posterior @ (np.linalg.inv(prior) @ [0.1, -0.2] + H[0] * 0.9 / R[0, 0])
    deviation = np.sqrt(np.diag(posterior))
    np.testing.assert_allclose(many.P, posterior, rtol=0, atol=0.01 * np.diag(posterior).min())
    np.testing.assert_allclose(many.x, mean, rtol=0, atol=0.01 * deviation.min())


def test_two_measurements_weigh_the_particles_as_both_at_once():
    one_by_one, together = swarm(500, threshold=0.0), swarm(500, threshold=0.0)
    one_by_one.update([0.4])
    one_by_one.update([-0.3])
    together.update([0.4, -0.3], lambda x: x[..., [0, 0]], R=R[0, 0] * np.eye(2))
    np.testing.assert_allclose(one_by_one.weights, together.weights, rtol=1e-9)


def test_the_same_seed_gives_the_same_particles():
    one, two, other = swarm(50, 1), swarm(50, 1), swarm(50, np.random.default_rng(2))
    for filter in (one, two, other):
        filter.predict(None, 0.1)
        filter.update([0.4])
    np.testing.assert_array_equal(one.particles, two.particles)
    assert (one.particles != other.particles).any()


def test_systematic_resampling_keeps_each_particle_as_often_as_it_weighs():
    rng = np.random.default_rng(3)
    weights = rng.dirichlet(np.ones(40))
    for offset in (0.0, 0.3, 0.999):
        counts = np.bincount(kalman.systematic_resample(weights, offset), minlength=40)
        assert counts.sum() == 40
        assert (np.abs(counts - 40 * weights) < 1).all()
    counts = np.mean(
        [
            np.bincount(kalman.systematic_resample(weights, u), minlength=40)
            for u in (np.arange(1000) + 0.5) / 1000
        ],
        axis=0,
    )
    np.testing.assert_allclose(counts, 40 * weights, atol=2e-3)


def test_effective_size_counts_particles_and_resampling_restores_it():
    never = swarm(500, threshold=0.0)
    never.update([2.0])
    assert never.effective_size == pytest.approx(1 / np.sum(never.weights**2))
    assert never.effective_size < 250
    always = swarm(500, threshold=1.0)
    always.update([2.0])
    np.testing.assert_allclose(always.weights, 1 / 500)
    assert len(np.unique(always.particles, axis=0)) < 500
    assert swarm(500).effective_size == 500


def test_the_mean_of_directions_is_not_torn_at_half_a_turn():
    filter = kalman.ParticleFilter(
        lambda x, u, dt: wrap(x + u * dt),
        lambda x: x,
        [[1e-4]],
        [[0.1]],
        [3.0],
        [[0.01]],
        particles=4000,
        rng=4,
        angles=(0,),
        measurement_angles=(0,),
    )
    filter.predict(np.array([0.14]), 1.0)
    assert np.ptp(filter.particles) > 6, "some have wrapped"
    assert abs(wrap(filter.x[0] - 3.14)) < 0.01
    assert filter.P[0, 0] == pytest.approx(0.01, rel=0.1)
    filter.update([-3.1])
    assert abs(wrap(filter.x[0] - 3.14)) < 0.03


def test_each_particle_may_have_its_own_noise():
    filter = kalman.ParticleFilter(
        lambda x, u, dt: x,
        None,
        lambda x, u, dt: np.einsum("k,ij->kij", x[:, 0] ** 2, np.diag([0.0, 1.0])),
        None,
        [2.0, 0.0],
        np.diag([0.0, 0.0]),
        particles=5000,
        rng=5,
    )
    filter.predict(None, 1.0)
    np.testing.assert_array_equal(filter.particles[:, 0], 2.0)
    assert filter.particles[:, 1].std() == pytest.approx(2.0, rel=0.05)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: swarm(1), "particles must be one whole number at least 2"),
        (lambda: swarm(10, seed=None), "rng must be a seed of 0 or more or a numpy Generator"),
        (lambda: swarm(10, threshold=2), "threshold must be one number at least 0 and at most 1"),
        (lambda: swarm(10).update([np.nan]), "z must be finite"),
        (lambda: kalman.systematic_resample([0.5, 0.4], 0.1), "sum to 1"),
        (
            lambda: kalman.systematic_resample([0.5, 0.5], 1.0),
            "offset must be one number at least 0 and below 1",
        ),
        (
            lambda: kalman.ParticleFilter(
                lambda x, u, dt: F @ x, None, Q, None, [0, 0], P0, particles=10, rng=0
            ).predict(None, 0.1),
            "shapes|leading axes|matmul",
        ),
        (
            lambda: kalman.ParticleFilter(
                lambda x, u, dt: x[0], None, Q, None, [0, 0], P0, particles=10, rng=0
            ).predict(None, 0.1),
            r"f\(x, u, dt\) must work over leading axes",
        ),
    ],
)
def test_bad_particles_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
