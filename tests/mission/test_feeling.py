"""Digging by feel: the estimated push against the simulation's, and a rock that is dug around."""

from dataclasses import replace

import numpy as np
import pytest

from backhoe.arm import contact, dynamics
from backhoe.machine import BACKHOE
from backhoe.mission import feeling
from backhoe.mission.feeling import BACK, ESCAPE, START, STOP, Feel, felt_push, strain_of
from backhoe.planning.dmp.demonstrations import demonstration
from backhoe.simulation import trial
from backhoe.simulation.scene import LOADING
from backhoe.simulation.soil import Rock
from backhoe.whole_body import stability

TIMES, PATH = demonstration("dig", 0.02)
ROCK = Rock(5.8, -0.44, 0.15, 0.3)
SCENE = replace(LOADING, rocks=(ROCK,))


@pytest.fixture
def rng():
    return np.random.default_rng(3)


@pytest.fixture(scope="module", params=["analytic", "pybullet"])
def felt(request):
    return feeling.dig(PATH, TIMES, scene=SCENE, backend=request.param)


@pytest.fixture(scope="module")
def blind():
    return feeling.dig(PATH, TIMES, feel=False, base="fixed", scene=SCENE, backend="analytic")


def test_with_feeling_a_rock_neither_stalls_nor_saturates_and_the_bucket_is_nearly_full(felt):
    free = trial.dig(PATH, TIMES)
    assert felt.finished and felt.tipped is None
    assert felt.saturated == felt.stalled == 0.0
    assert felt.soil > 0.8 * free.soil
    assert felt.time[-1] < 1.25 * TIMES[-1]


def test_the_edge_goes_over_the_rock(felt):
    inside = np.linalg.norm(felt.edge - [ROCK.x, felt.edge[0, 1], ROCK.z], axis=1) < ROCK.radius
    assert felt.lift.max() > 0.1
    assert inside.sum() < 0.02 * len(inside)


def test_the_felt_push_is_that_of_soil_and_load(felt):
    missed = felt.push[:, :3] - felt.true
    assert (np.median(np.abs(missed), axis=0) < [100, 20, 250]).all()
    assert (np.sqrt((missed**2).mean(axis=0)) < [1500, 200, 3500]).all()
    assert np.abs(felt.true).max() > 30e3


def test_without_feeling_it_stalls_and_saturates(blind):
    assert blind.saturated > 1.0 and blind.stalled > 0.5
    assert blind.strain.max() > 1.5
    assert blind.lift.max() == 0.0 and blind.time[-1] == pytest.approx(TIMES[-1], abs=0.02)
    assert "at a limit for" in str(blind)


def test_without_feeling_the_machine_tips_over_its_tracks():
    run = feeling.dig(PATH, TIMES, feel=False, scene=SCENE, backend="analytic")
    assert run.tipped is not None and not run.finished
    assert run.strain.max() > 1.0 and "tipped over" in str(run)


def test_a_still_machine_feels_what_pushes_it():
    q = np.array([-1.5, 0.5, -1.2, -0.6])
    push = np.array([2e4, -3e3, -1e4, 5e3])
    torque = dynamics.gravity_torque(q) - contact.joint_torque(q, push)
    np.testing.assert_allclose(felt_push(q, np.zeros(4), np.zeros(4), torque), push, atol=1e-6)
    rate = np.array([0.1, -0.2, 0.3, 0.2])
    moving = dynamics.inverse_dynamics(q, rate, rate)
    moving += dynamics.friction_torque(rate, smoothing=0.01) - contact.joint_torque(q, push)
    np.testing.assert_allclose(felt_push(q, rate, rate, moving), push, atol=1e-6)


def test_at_strain_one_a_joint_or_the_tracks_are_at_their_limit(rng):
    kinds = set()
    for _ in range(20):
        q = np.array([-1.5, 0.4, -1.2, -0.6]) + 0.2 * rng.normal(size=4)
        push = np.r_[rng.normal(size=3) * 3e4, 0.0]
        limit = push / strain_of(q, push)
        given = np.abs(dynamics.gravity_torque(q) - contact.joint_torque(q, limit))
        joints = (given / BACKHOE.torque_limit).max()
        margin = stability.margin(q, soil=limit).distance
        assert joints < 1 + 1e-9 and margin > -1e-9
        assert joints > 1 - 1e-9 or margin < 1e-9
        kinds.add(joints > 1 - 1e-9)
    assert kinds == {True, False}
    assert strain_of(q, np.zeros(4)) == 0.0


def test_a_push_that_carries_the_whole_machine_is_beyond_the_limit():
    q = np.array([-1.5, 0.4, -1.2, -0.6])
    assert strain_of(q, [0.0, 0.0, 1.1 * BACKHOE.mass * 9.81, 0.0]) >= 1.0


def test_the_law_slows_lifts_goes_back_and_forgets():
    feel = Feel()
    assert feel(START, False, 0.1) == (1.0, 0.0)
    rate, lift = feel((START + STOP) / 2, False, 0.1)
    assert 0 < rate <= 0.5 and lift == pytest.approx(0.025)
    assert feel(STOP, False, 0.1) == (0.0, pytest.approx(0.075))
    assert feel(2.0, False, 0.1) == (BACK, pytest.approx(0.125))
    rate, lift = feel(0.0, False, 0.1)
    assert 0.4 < rate < 0.6 and lift < 0.125  # it waits until it is down again
    for _ in range(60):
        rate, lift = feel(0.0, False, 0.1)
    assert rate > 0.99 and lift < 0.01


def test_a_hooked_bucket_goes_back_before_it_is_lifted():
    feel = Feel()
    assert feel(0.8, True, 0.1) == (BACK, 0.0)
    assert feel(0.7, False, 0.1) == (BACK, 0.0)
    assert feel(0.1, False, 0.1)[1] > 0.0
    for _ in range(round(ESCAPE / 0.1)):
        rate, _ = feel(0.1, False, 0.1)
    assert rate > 0


def test_bad_digs_are_named():
    with pytest.raises(ValueError, match="path must"):
        feeling.dig(PATH[:-1], TIMES)
    with pytest.raises(ValueError, match="out"):
        feeling.dig(PATH + np.array([5.0, 0, 0, 0]), TIMES)
    with pytest.raises(ValueError, match="feel must"):
        feeling.dig(PATH, TIMES, feel=1)
    with pytest.raises(ValueError, match="push must"):
        strain_of(np.zeros(4), [1, 2, 3])
    with pytest.raises(ValueError, match="torque must"):
        felt_push(np.zeros(4), np.zeros(4), np.zeros(4), [1, 2])
