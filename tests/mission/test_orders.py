"""Hard orders to the tracks: the score knows a right velocity controller from the usual wrong ones.

The controllers are written as a student's, and not taken from the library.
"""

from functools import cache

import numpy as np
import pytest

from backhoe import mission
from backhoe.machine import BACKHOE
from backhoe.mission import orders
from backhoe.simulation.standing import Tipped
from backhoe.vehicle import travel

KP, KI = map(np.array, travel.GAINS)
MOST = BACKHOE.tracks.max_traction


class Mine:
    """A PI for speed and turn, the turn first, each integral waiting while its loop is cut."""

    kp, ki, moment, side, waits, first, counts = KP, KI, 1.0, 1, True, True, True

    def __init__(self, **spoilt):
        self.__dict__.update(spoilt)
        self.integral = np.zeros(2)

    def __call__(self, v_ref, omega_ref, v, omega, dt):
        error = np.array([v_ref - v, omega_ref - omega])
        grown = self.integral + error * (dt if self.counts else 1.0)
        wanted = (self.kp * error + self.ki * grown) * [1, self.moment]
        given = wanted
        if self.first:
            turn = np.clip(wanted[1], -MOST, MOST)
            given = np.array([np.clip(wanted[0], abs(turn) - MOST, MOST - abs(turn)), turn])
        cut = (given != wanted) & (wanted * error > 0)
        self.integral = np.where(cut & self.waits, self.integral, grown)
        return (given[0] + np.array([-given[1], given[1]]))[:: self.side]


SPOILT = {
    "right": {},
    "half the moment": {"moment": 0.5},
    "no integral": {"ki": 0 * KI},
    "sides swapped": {"side": -1},
    "no limits": {"first": False},
    "winds up": {"waits": False},
    "no dt": {"counts": False},
    "stiffer": {"kp": KP * [1, 1.5], "ki": np.array([90e3, 200e3])},
}


@cache
def scored(name):
    return mission.score(mission.obey(velocity_controller=Mine(**SPOILT[name]), backend="analytic"))


def printed(score):
    """The numbers of its own column, as they are printed."""
    return [line.split("]")[-1].split()[0] for line in str(score).splitlines()[2:]]


def test_a_right_controller_scores_as_the_library():
    score = scored("right")
    assert score.swapped == ("velocity_controller",)
    assert printed(score) == printed(score.reference)
    assert score.beyond == 0


@pytest.mark.parametrize("name", [name for name in SPOILT if name != "right"])
def test_what_differs_moves_at_least_two_printed_numbers(name):
    pairs = zip(printed(scored(name)), printed(scored("right")), strict=True)
    assert sum(one != other for one, other in pairs) >= 2


def test_each_mistake_shows_where_it_must():
    right = scored("right")
    assert scored("no limits").stands > right.stands + 1
    assert scored("no limits").turns_on > 3 * right.turns_on
    assert scored("no limits").beyond > 0.2
    assert scored("winds up").stands > right.stands + 1
    for name in ("half the moment", "no integral", "sides swapped", "no limits"):
        assert scored(name).turn > 1.3 * right.turn
    assert scored("no dt").margin < 0.1 < 0.25 < right.margin
    assert scored("no integral").margin < 0


def test_stiffer_gains_halve_what_the_heading_is_off_and_cost_margin():
    right, stiffer = scored("right"), scored("stiffer")
    assert stiffer.heading < 0.6 * right.heading
    assert 0.1 < stiffer.margin < 0.7 * right.margin


def test_the_ordered_way_is_that_of_a_machine_that_obeys_at_once():
    run = mission.obey(backend="analytic")
    x, y, heading = np.zeros(3)
    for seconds, v, omega in orders.ORDERS:
        there = heading + seconds * omega
        if omega:  # round the centre of rotation
            x += v / omega * (np.sin(there) - np.sin(heading))
            y -= v / omega * (np.cos(there) - np.cos(heading))
        heading = there
    assert run.ordered[-1] == pytest.approx([x, y, heading], abs=1e-4)
    assert run.time[-1] == pytest.approx(sum(seconds for seconds, *_ in orders.ORDERS))
    assert mission.score(run).reference is None


def test_a_machine_that_tips_over_leaves_what_happened_until_then():
    with pytest.raises(Tipped, match="tips over") as error:
        mission.obey(velocity_controller=Mine(kp=KP * [-1, 1]), backend="analytic")
    run = error.value.run
    assert 2 < run.time[-1] < 16
    assert len(run.asked) == len(run.time) == len(run.traction)


def test_the_replay_has_the_ordered_way_and_the_librarys():
    run = mission.obey(velocity_controller=Mine(), backend="analytic", record=True)
    ordered, library = (np.asarray(line.points)[:, :2] for line in run._drawn()["lines"])
    assert ordered == pytest.approx(run.ordered[:, :2])
    assert library == pytest.approx(run.pose[:, :2], abs=1e-6)
    assert "Orders to the tracks" in run.replay()._repr_html_()


def test_bad_parts_are_named():
    with pytest.raises(TypeError, match="unknown part 'tracks'"):
        mission.obey(tracks=Mine())
    with pytest.raises(ValueError, match="your velocity_controller failed"):
        mission.obey(velocity_controller=lambda *state: None, backend="analytic")
