"""What lessons 14a and 14b say in strong words."""

import numpy as np
import pytest

from backhoe.lessons.autonomy.exercises import decisions
from backhoe.mission import autonomy
from backhoe.mission.autonomy import DIRECTIONS, REACHES, ActionServer, Goal


@pytest.mark.parametrize("middle", [5.2, 5.5, 5.8])
def test_the_best_strip_begins_behind_the_crest(middle):
    away = (DIRECTIONS[:, None] - 0.1) * REACHES, REACHES - middle
    heights = 1.1 * np.exp(-(away[0] ** 2 + away[1] ** 2) / 1.5)
    best = autonomy.best_strip(heights, 0 * heights, DIRECTIONS, REACHES)
    highest = autonomy.highest_strip(heights, 0 * heights, DIRECTIONS, REACHES)
    assert best.start > highest.start + 0.2
    fills = [autonomy.expected_fill(s, heights, DIRECTIONS, REACHES) for s in (best, highest)]
    assert fills[0] > 1.2 * fills[1]


def test_cancelling_one_goal_leaves_the_others_and_the_machine_rests_first():
    """The library's server, step by step, ends its queue as the answer to exercise 14.3."""
    dt, rng = 0.05, np.random.default_rng(2)
    for _ in range(6):
        durations = [float(d) for d in rng.integers(2, 6, 3)]
        number, at = int(rng.integers(3)), float(rng.integers(1, 240)) * dt
        server, now = ActionServer(np.zeros(4), dt), 0.0
        actions = [
            server.send(Goal(f"{d} s", lambda q, d=d: (np.array([0, d]), np.array([q, q + 0.1]))))
            for d in durations
        ]
        ends = [None] * 3
        while server.active:
            if abs(now - at) < 1e-9 and not actions[number].done:
                server.cancel(actions[number])
            server.step(server.q_ref)
            now += dt
            for k, action in enumerate(actions):
                if action.done and ends[k] is None:
                    ends[k] = action.status == "succeeded", now
        told = decisions.queue(durations, {number: at})
        assert [end[0] for end in ends] == [bool(row[0]) for row in told]
        np.testing.assert_allclose([end[1] for end in ends], told[:, 1], atol=2.1 * dt)


def test_three_in_a_row_are_enough_against_noise_without_memory():
    """0.0027 to the third power, 180,000 times an hour: one in 280 hours."""
    sound = np.random.default_rng(5).normal(size=2_000_000)
    beyond = np.abs(sound) > 3
    assert beyond.mean() == pytest.approx(0.0027, rel=0.1)
    assert not (beyond[2:] & beyond[1:-1] & beyond[:-2]).any()
