"""Independent answers to the exercises of lessons 14a and 14b, the machine alone."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from backhoe.mission import autonomy
from backhoe.mission.autonomy import DIRECTIONS, REACHES, Strip, choice

# decisions


def slices_of_the_cut_one_by_one(answer, surface, bottom, reaches, start):
    """Slices 0.1 m long and 1.2 m wide, those beyond 0.3 m from the start; a bucket of 0.7 m^3."""
    volume = 0.0
    for ground, edge, reach in zip(surface, bottom, reaches, strict=True):
        if start - reach > 0.3 - 1e-6 and ground > edge:
            volume += 1.2 * 0.1 * (ground - edge)
    assert answer == pytest.approx(volume if volume < 0.7 else 0.7, rel=1e-9, abs=1e-12)


def no_strip_that_may_be_dug_pays_more(answer, fill, side, directions, truck):
    """Every strip by itself: what it would bring a second, and whether it may be dug."""
    rates = {}
    for i, direction in enumerate(directions):
        for k in range(fill.shape[1]):
            if fill[i, k] >= 0.1 and -20e3 <= side[i, k] <= 20e3:
                seconds = 9.9 + 3.3 + 2 * 4.0 * abs(truck - direction) / (pi / 2)
                rates[i, k] = fill[i, k] / seconds
    assert answer == (max(rates, key=rates.get) if rates else (-1, -1))


def a_clock_that_ticks_through_the_queue(answer, durations, cancels):
    """Ticks of 0.05 s: what waits is asked whether it is wanted, what moves whether it may go on.

    All times of a case are whole numbers of ticks.
    """
    tick, ends = 0, []
    for number, duration in enumerate(durations):
        stop = round(cancels.get(number, 1e6) * 20)
        length, done = round(duration * 20), 0
        if stop <= tick:
            ends.append((0, stop / 20, 0.0))
            continue
        while done < length and tick < stop:
            tick, done = tick + 1, done + 1
        if done < length:
            tick += 10
        ends.append((done == length, tick / 20, done / length))
    np.testing.assert_allclose(answer, ends, rtol=1e-9, atol=1e-9)


def best_of_strips_tried_at_random(answer, heights, deviation, directions, reaches):
    """One of the strips that are tried, and none of 60 others of them brings more a second."""
    rng, most = np.random.default_rng(4), 0.0
    for _ in range(60):
        strip = Strip(rng.choice(DIRECTIONS), rng.choice(choice.STARTS), rng.choice(choice.DEPTHS))
        sure = heights - deviation, DIRECTIONS, REACHES
        fill = float(autonomy.expected_fill(strip, *sure))
        if fill >= 0.1 and abs(autonomy.side_load(strip, *sure)) <= 20e3:
            most = max(most, fill / autonomy.cycle_time(strip.direction))
    for value, tried in zip(answer, (DIRECTIONS, choice.STARTS, choice.DEPTHS), strict=True):
        assert np.abs(np.array(tried) - value).min() < 1e-12
    found = float(autonomy.expected_fill(answer, heights - deviation, DIRECTIONS, REACHES))
    assert found / autonomy.cycle_time(answer.direction) >= most > 0


# report
