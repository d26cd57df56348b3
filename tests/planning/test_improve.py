"""Improvement by practice: known minima, weights by hand, and what must not matter."""

import numpy as np
import pytest

from backhoe.planning.improve import pi2, pi2_weights, power, power_weights

METHODS = {"pi2": pi2, "power": power}
both = pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
LOWEST = np.array([0.4, -0.2, 0.1, 0.3, -0.5, 0.2])


def bowl(x):
    return ((x - LOWEST) ** 2).sum(axis=1)


def test_pi2_weights_by_hand():
    weights = pi2_weights([3.0, 5.0, 4.0, np.inf], hardness=2.0)
    shares = np.array([1.0, np.e**-2, np.e**-1, 0.0])
    np.testing.assert_allclose(weights, shares / shares.sum(), rtol=1e-12)
    np.testing.assert_allclose(pi2_weights([7.0, 7.0, np.inf]), [0.5, 0.5, 0.0])


def test_power_weights_by_hand():
    weights = power_weights([3.0, 5.0, 4.0, np.inf], scale=0.5)
    rewards = np.array([np.e**-6, np.e**-10, np.e**-8, 0.0])
    np.testing.assert_allclose(weights, rewards / rewards.sum(), rtol=1e-12)
    np.testing.assert_allclose(power_weights([1e6, 1e6 + 1], 1.0)[1], 1 / (1 + np.e))


@both
def test_the_lowest_point_of_a_bowl_is_found(method):
    found = [method(bowl, np.zeros(6), 0.3, batch=20, budget=600, rng=k) for k in range(5)]
    assert max(one.cost for one in found) < 0.02 * bowl(np.zeros((1, 6)))[0]
    off = [np.abs(one.mean - LOWEST).max() for one in found]
    assert np.median(off) < 0.08


def test_one_batch_of_pi2_goes_as_far_as_theory_says():
    """Tries from a normal law under a slope: soft weights move the mean by -h / range * s^2."""
    slope, spread, hardness = np.array([2.0, -1.0]), 0.1, 1e-3
    learnt = pi2(
        lambda x: x @ slope, [1.0, 2.0], spread, batch=200_000, budget=200_000, hardness=hardness
    )
    reach = learnt.costs.max() - learnt.costs.min()
    drift = learnt.mean - learnt.tries.mean(axis=0)
    np.testing.assert_allclose(drift, -hardness / reach * spread**2 * slope, rtol=0.02)


@both
def test_the_unit_and_the_zero_of_the_cost_do_not_matter(method):
    plain = method(bowl, np.zeros(6), 0.3, budget=60, rng=3)
    other = method(lambda x: 7000.0 + 400.0 * bowl(x), np.zeros(6), 0.3, budget=60, rng=3)
    np.testing.assert_allclose(other.tries, plain.tries, atol=1e-9)


@both
def test_parameters_may_be_shifted_and_scaled_with_their_spread(method):
    spread = np.array([0.3, 1.0, 20.0, 0.1, 2.0, 0.5])
    shift = np.arange(6.0)
    plain = method(bowl, np.zeros(6), 0.3, budget=60, rng=4)
    other = method(lambda x: bowl((x - shift) / spread * 0.3), shift, spread, budget=60, rng=4)
    np.testing.assert_allclose((other.tries - shift) / spread * 0.3, plain.tries, atol=1e-9)


@both
def test_a_seed_gives_the_same_again_and_another_seed_another(method):
    first, again, other = (method(bowl, np.zeros(6), 0.3, budget=40, rng=k) for k in (8, 8, 9))
    np.testing.assert_array_equal(first.tries, again.tries)
    assert not np.array_equal(first.tries, other.tries)


@both
def test_the_start_comes_first_and_the_budget_is_kept(method):
    sizes = []

    def cost(x):
        sizes.append(len(x))
        return bowl(x)

    learnt = method(cost, 0.1 * LOWEST, 0.3, batch=8, budget=30, rng=0)
    assert sizes == [8, 8, 8, 6]
    np.testing.assert_array_equal(learnt.tries[0], 0.1 * LOWEST)
    np.testing.assert_allclose(learnt.costs, bowl(learnt.tries))
    assert learnt.cost == learnt.curve[-1] == learnt.costs.min() == bowl(learnt.parameters[None])[0]
    assert (np.diff(learnt.curve) <= 0).all()
    assert learnt.gain == pytest.approx(1 - learnt.costs.min() / learnt.costs[0])
    assert str(learnt).endswith("in 30 tries")


@both
def test_the_spread_shrinks_from_batch_to_batch(method):
    learnt = method(lambda x: np.zeros(len(x)), np.zeros(4), 2.0, batch=500, budget=1500, decay=0.5)
    spreads = [learnt.tries[k : k + 500].std(axis=0).mean() for k in (0, 500, 1000)]
    np.testing.assert_allclose(spreads, [2.0, 1.0, 0.5], rtol=0.05)


@both
def test_failed_tries_count_and_teach_nothing(method):
    """Half of the plane fails: the others alone decide, and a batch that fails moves nothing."""

    def cost(x):
        return np.where(x[:, 0] > 0.05, np.inf, bowl(x))

    learnt = method(cost, np.zeros(6), 0.3, budget=200, rng=1)
    assert np.isinf(learnt.costs).any() and learnt.mean[0] <= 0.05
    assert learnt.cost < 0.6 * learnt.costs[0]
    calls = []

    def once(x):
        calls.append(x)
        return bowl(x) if len(calls) == 1 else np.full(len(x), np.inf)

    learnt = method(once, np.zeros(6), 0.3, batch=10, budget=20, rng=1)
    first = method(bowl, np.zeros(6), 0.3, batch=10, budget=10, rng=1)
    np.testing.assert_allclose(learnt.mean, first.mean, rtol=1e-12)


def test_power_remembers_good_tries_and_pi2_starts_each_batch_anew():
    """The second batch is worse throughout: PoWER stays with the best of the first."""
    found = {}
    for name, method in METHODS.items():
        batches = []

        def cost(x, batches=batches):
            batches.append(x)
            return bowl(x) + 10.0 * (len(batches) - 1)

        found[name] = method(cost, np.zeros(6), 0.3, batch=10, budget=20, rng=2)
    costs, tries = found["power"].costs, found["power"].tries
    best = np.argsort(costs)[:5]
    assert best.max() < 10
    remembered = power_weights(costs[best], costs[:10].std()) @ tries[best]
    np.testing.assert_allclose(found["power"].mean, remembered)
    only = pi2_weights(found["pi2"].costs[10:]) @ found["pi2"].tries[10:]
    np.testing.assert_allclose(found["pi2"].mean, only)


@both
@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"cost": 3.0}, "cost must be a function"),
        ({"cost": lambda x: x}, "what cost gives"),
        ({"cost": lambda x: bowl(x) * np.nan}, "what cost gives"),
        ({"cost": lambda x: -np.inf * np.ones(len(x))}, "what cost gives"),
        ({"cost": lambda x: np.inf * np.ones(len(x))}, "first batch"),
        ({"start": [[0.0]]}, "start must"),
        ({"start": [np.nan]}, "start must be finite"),
        ({"spread": 0.0}, "spread must be above 0"),
        ({"spread": [1.0, 2.0]}, "spread must be above 0, one or 6"),
        ({"batch": 1}, "batch must"),
        ({"budget": 2.5}, "budget must"),
        ({"rng": "seed"}, "rng must"),
        ({"decay": 1.2}, "decay must"),
    ],
)
def test_bad_input_is_named(method, change, words):
    given = {"cost": bowl, "start": np.zeros(6), "spread": 0.3, **change}
    with pytest.raises((ValueError, TypeError), match=words):
        method(given.pop("cost"), given.pop("start"), given.pop("spread"), **given)


@pytest.mark.parametrize("weights", [pi2_weights, power_weights])
@pytest.mark.parametrize(
    ("costs", "unit", "words"),
    [
        ([np.inf, np.inf], 1.0, "tries that did not fail|least of costs"),
        ([1.0, np.nan], 1.0, "costs .* must be finite"),
        ([[1.0, 2.0]], 1.0, "costs must"),
        ([1.0, 2.0], 0.0, "above 0"),
    ],
)
def test_bad_weights_are_named(weights, costs, unit, words):
    with pytest.raises(ValueError, match=words):
        weights(costs, unit)
