"""Practice of a dig: what a parameter does to the path, what a try costs, and the stored curves."""

from types import SimpleNamespace

import numpy as np
import pytest

from backhoe.mission.dig_practice import MOMENTS, SPREAD, DigPractice, dig_cost, practised
from backhoe.planning.dmp import DMP
from backhoe.planning.dmp.demonstrations import demonstration
from backhoe.planning.improve import pi2

PRACTICE = DigPractice(processes=1)
OFFSETS = np.array([0.1, -0.2, 0.05, 0.2, 0.1, -0.1, -0.15, 0.05, 0.2])


@pytest.mark.parametrize("spacing", ["exponential", "uniform", "time"])
def test_a_parameter_moves_the_path_by_its_way_at_its_moment(spacing):
    """Whatever the kernels: the demonstration, and Gaussian bumps on it."""
    shown = demonstration("dig")
    dmp = DMP(kernels=400 if spacing == "uniform" else 100, spacing=spacing)
    practice = DigPractice(primitive=dmp.learn(shown.positions, shown.times), processes=1)
    times, moved = practice.path(OFFSETS)
    _, plain = practice.path(np.zeros(9))
    share = times / times[-1]
    bumps = np.exp(-0.5 * ((share[:, None] - np.array(MOMENTS)) / 0.088) ** 2)
    expected = np.zeros_like(plain)
    expected[:, [0, 2, 3]] = bumps @ OFFSETS.reshape(3, 3)
    late = 0.02  # the spring lags, and the kernels smooth [m, rad]
    np.testing.assert_allclose(moved - plain, expected, atol=late)
    np.testing.assert_allclose(moved[[0, -1]], plain[[0, -1]], atol=2e-3)
    np.testing.assert_array_equal(moved[:, 1], plain[:, 1])


def test_the_cost_is_a_sum_of_shares():
    trial = SimpleNamespace(soil=0.6, energy=100e3, peak_force=60e3, spilled=0.2)
    cost = dig_cost(trial, 0.8)
    np.testing.assert_allclose(cost, [0.25, 0.2, 0.2, 0.25])
    assert cost.total == pytest.approx(0.9)
    assert dig_cost(SimpleNamespace(**{**vars(trial), "soil": 0.9}), 0.8).missing == 0.0


def test_costs_are_those_of_the_digs_and_what_fails_is_infinite():
    out_of_reach, too_deep = np.zeros(9), np.zeros(9)
    out_of_reach[3] = 3.0
    too_deep[[1, 4, 7]] = -1.5
    tries = [np.zeros(9), out_of_reach, too_deep]
    trials = PRACTICE.trials(tries)
    costs = PRACTICE.costs(tries)
    one = trials[0]
    assert costs[0] == dig_cost(one, PRACTICE.full).total
    share = (1 - one.soil / PRACTICE.full) + one.spilled / PRACTICE.full
    assert costs[0] == pytest.approx(share + one.energy / 500e3 + one.peak_force / 300e3)
    assert trials[1] is None and costs[1] == np.inf
    assert costs[2] == np.inf


def test_the_stored_first_batches_are_those_of_today():
    """PI2 and PoWER of one seed try the same before their first update, CMA-ES the same start."""
    stored = practised()
    assert list(stored) == ["PI2", "PoWER", "CMA-ES"]
    first = stored["PI2"].costs[1, :4]
    np.testing.assert_array_equal(first, stored["PoWER"].costs[1, :4])
    today = pi2(
        lambda x: np.r_[PRACTICE.costs(x[:4]), np.ones(6)],
        PRACTICE.start,
        SPREAD,
        budget=10,
        rng=1,
    )
    np.testing.assert_allclose(today.costs[:4], first, rtol=1e-3)
    assert len({*stored["CMA-ES"].costs[:, 0]} | {first[0]}) == 1


def test_the_stored_best_are_what_they_are_said_to_be():
    for one in practised().values():
        assert one.costs.shape[1] == 150 and one.parameters.shape == (len(one.costs), 9)
    best = practised()["PI2"]
    cost = PRACTICE.costs(best.parameters[1:2])[0]
    assert cost == pytest.approx(best.costs[1].min(), abs=5e-3)


def test_way_points_lead_along_the_primitive():
    plan = PRACTICE.plan(OFFSETS, step=0.4)
    times, path = PRACTICE.path(OFFSETS)
    assert [point.name for point in plan[-3:]] == ["swing to the truck", "tip out", "empty"]
    digging = plan[1:-3]
    at = np.cumsum([point.time for point in digging])
    assert at[-1] == pytest.approx(times[-1], abs=0.4)
    for k in (3, 20):
        there = path[np.searchsorted(times, at[k] - 1e-9)]
        np.testing.assert_allclose(digging[k].target, there, atol=5.1e-4)
    np.testing.assert_allclose(digging[-1].target, path[-1], atol=5.1e-4)


def test_way_points_are_the_same_where_a_sum_ends_in_other_digits():
    """Another processor adds in another order; the soil would make a hill of it."""
    plans = [PRACTICE.plan(parameters) for parameters in (OFFSETS, OFFSETS + 1e-12)]
    assert plans[0] == plans[1]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: DigPractice("mud"), "soil must be one of"),
        (lambda: DigPractice(seed=-1), "seed must be"),
        (lambda: DigPractice(primitive=3), "primitive must be a DMP"),
        (lambda: PRACTICE.costs(np.zeros((2, 8))), "tries must"),
        (lambda: PRACTICE.path(np.zeros(8)), "parameters must"),
        (lambda: PRACTICE.plan(np.full(9, np.nan)), "parameters must be finite"),
    ],
)
def test_bad_input_is_named(call, words):
    with pytest.raises((ValueError, TypeError), match=words):
        call()
