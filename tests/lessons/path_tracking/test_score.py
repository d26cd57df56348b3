"""The score of lesson 05's swap-in sees the mistakes that students make with a tracker."""

from functools import lru_cache

import numpy as np
import pytest

from backhoe import mission
from backhoe.basics.angles import wrap
from backhoe.vehicle import tracking

ROUTE = tracking.figure_eight(3.0).with_times(speed=0.6)  # the lesson's, smaller
ROWS = {
    "mean distance [cm]": 0.5,
    "largest distance [cm]": 3.0,
    "late by [s]": 0.05,
    "steering [rad/s]": 0.5,
}
"""Row -> what counts as another number; two runs of one tracker give the same."""


def lines(wrap=wrap, gain=3.0, told=1.0, back=0.0):
    def tracker(pose, twist, goal, dt):
        aim = goal.position - back * (goal.next_position - goal.position)
        dx, dy = aim - pose[:2]
        ahead = dx * np.cos(pose[2]) + dy * np.sin(pose[2])
        turn = gain * wrap(np.arctan2(dy, dx) - pose[2])
        return ahead + 0.7 * told * goal.speed, turn

    return tracker


MISTAKES = {
    "angle not wrapped": lines(wrap=float),
    "only to the left": lambda *now: np.abs(lines()(*now)),
    "gain of 20": lines(gain=20.0),
    "no feed-forward": lines(told=0.0),
    "the goal of now": lines(back=1.0),
}


@lru_cache(maxsize=1)
def right():
    return printed(lines())


def printed(tracker):
    drive = mission.drive(
        path=ROUTE, tracker=tracker, pose=(0, 0, np.pi / 4), backend="analytic", time_limit=26.0
    )
    text = str(mission.score(drive))
    cells = {row[:24].strip(): row[24:].split()[0] for row in text.splitlines()[2:9]}
    return {row: float(cells[row]) for row in ROWS}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_moves_a_number_of_the_score(mistake):
    wrong = printed(MISTAKES[mistake])
    assert any(abs(wrong[row] - right()[row]) > size for row, size in ROWS.items())
