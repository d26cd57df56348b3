"""A rhythmic primitive gives back a swing, around any centre, as large and as fast as asked."""

from __future__ import annotations

import numpy as np
import pytest

from backhoe.planning.dmp import Rhythmic

PERIOD = 0.8
t = np.linspace(0, 2 * PERIOD, 321)


def swing(t, period=PERIOD):
    turn = 2 * np.pi * t / period
    return np.column_stack([1 + 0.3 * np.sin(turn) + 0.05 * np.cos(3 * turn), np.cos(turn)])


@pytest.fixture(scope="module")
def learnt():
    return Rhythmic().learn(swing(t), t, PERIOD)


def test_gives_back_what_was_shown_and_goes_on(learnt):
    assert np.abs(learnt.centre - [1, 0]).max() < 2e-5
    times, x, v = learnt.rollout(10 * PERIOD, dt=1e-3)
    assert np.abs(x - swing(times)).max() < 2e-3
    assert np.abs(v - np.gradient(swing(times), times, axis=0))[2:-2].max() < 0.02
    assert np.abs(x[-1] - x[0]).max() < 1e-5


def test_moves_its_centre_its_size_and_its_time(learnt):
    times, x, v = learnt.rollout(6.0, dt=1e-3, centre=[2, 3], size=-0.5, period=2.0)
    assert np.abs(x - ([2, 3] - 0.5 * (swing(times, 2.0) - [1, 0]))).max() < 2e-3
    assert np.abs(np.gradient(x, times, axis=0) - v)[2:-2].max() < 1e-3


def test_is_drawn_to_the_swing_from_wherever_it_starts(learnt):
    times, x, v = learnt.rollout(PERIOD, dt=1e-3, start=[5, 5], velocity=[1, 0])
    assert x[0].tolist() == [5, 5] and v[0].tolist() == [1, 0]
    # after 20 times tau / sqrt(K) a critically damped spring has forgotten all but 5e-8 of it
    settled = times > 20 * 6.0 / 50_000**0.5
    assert np.abs(x - swing(times))[settled].max() < 2e-3


def test_wrong_input_is_refused(learnt):
    with pytest.raises(ValueError, match="must show a period of 2 s"):
        Rhythmic().learn(swing(t), t, 2.0)
    with pytest.raises(ValueError, match="centre must have shape \\(2,\\)"):
        learnt.rollout(1.0, centre=[1.0])
    with pytest.raises(RuntimeError, match="learnt nothing yet"):
        Rhythmic().rollout(1.0)
