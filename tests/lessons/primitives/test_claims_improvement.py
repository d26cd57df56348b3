"""What lesson 10c says of forces that are felt, of its methods and of what was learnt."""

from functools import cache

import numpy as np
import pytest

from backhoe.arm import dynamics
from backhoe.arm.contact import push_from
from backhoe.machine import BACKHOE
from backhoe.mission.dig_practice import SPREAD, DigPractice, dig_cost, practised
from backhoe.planning.improve import pi2, pi2_weights


@cache
def digs(soil):
    """The job there, and the demonstrated and the learnt dig."""
    job = DigPractice(soil, processes=1)
    stored = practised()["PI2"]
    best = stored.parameters[stored.costs.min(axis=1).argmin()]
    return job, *job.trials([job.start, best])


def test_a_load_in_free_air_is_felt_as_its_weight():
    _, shown, _ = digs("sandy loam")
    t, q, dq = shown.time, shown.q, shown.dq
    needed = dynamics.inverse_dynamics(q, dq, np.gradient(dq, t, axis=0))
    needed = needed + BACKHOE.viscous * dq + BACKHOE.coulomb * np.tanh(dq / 0.02)
    felt = np.linalg.norm(push_from(q, needed - shown.torque)[:, :3], axis=1)
    end = t > 12.5
    weight = 9.81 * 1500.0 * shown.soil
    assert not shown.force[end].any()
    assert felt[end] == pytest.approx(weight, rel=0.15)
    early = (t > 5.0) & (t < 6.0)
    true = np.linalg.norm(shown.force[early, :3], axis=1)
    assert np.abs(felt[early] - true).max() < 0.1 * true.max()


def test_the_median_seed_of_each_method_gains_a_quarter():
    for one in practised().values():
        gain = 1 - one.costs.min(axis=1) / one.costs[:, 0]
        assert np.median(gain) > 0.25


def test_pi2_and_power_are_quicker_and_at_the_end_the_bands_overlap():
    best = {name: np.minimum.accumulate(one.costs, axis=1) for name, one in practised().items()}
    peer = best.pop("CMA-ES")
    for one in best.values():
        assert np.median(one[:, 60]) < np.median(peer[:, 60])
        assert one[:, -1].min() < peer[:, -1].max() and peer[:, -1].min() < one[:, -1].max()


def test_the_learnt_dig_brings_as_much_for_less():
    _, shown, learnt = digs("sandy loam")
    assert learnt.soil == pytest.approx(shown.soil, rel=0.03)
    assert learnt.energy < 0.77 * shown.energy
    assert learnt.peak_force < 0.5 * shown.peak_force
    assert learnt.spilled < 0.03


def test_it_is_better_in_two_other_soils_too():
    gains = {}
    for soil in ("gravel", "sandy loam", "loam"):
        job, shown, learnt = digs(soil)
        gains[soil] = 1 - dig_cost(learnt, job.full).total / dig_cost(shown, job.full).total
    assert min(gains.values()) > 0.25


def test_an_update_that_does_not_weigh_stays_and_one_with_the_wrong_sign_gets_dearer():
    """On a bowl as far from its start as the dig's costs, over ten seeds."""

    def bowl(x):
        return np.sum((x - 0.15) ** 2, axis=1)

    def last(weigh, seed):
        rng, mean = np.random.default_rng(seed), np.zeros(9)
        for k in range(3):
            tries = mean + 0.9**k * SPREAD * rng.standard_normal((10, 9))
            mean = weigh(bowl(tries)) @ tries
        return bowl(mean[None])[0] / bowl(np.zeros((1, 9)))[0]

    ways = {
        "right": pi2_weights,
        "mean": lambda costs: np.full(10, 0.1),
        "sign": lambda costs: pi2_weights(-costs),
    }
    ends = {name: np.mean([last(way, k) for k in range(10)]) for name, way in ways.items()}
    assert ends["right"] < 0.8 < ends["mean"] < 1.4 < ends["sign"]
    assert pi2(bowl, np.zeros(9), SPREAD, budget=30).gain > 0
