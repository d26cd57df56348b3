"""Independent answers to the exercises of lessons 14a and 14b, the machine alone."""

from __future__ import annotations

from itertools import permutations
from math import pi

import numpy as np
import pytest

from backhoe.arm.kinematics import forward_kinematics, inverse_kinematics
from backhoe.mission import autonomy
from backhoe.mission.autonomy import DIRECTIONS, REACHES, Strip, choice
from backhoe.mission.parts import STROKE as PLAN

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


def a_foremans_book(answer, begins, ends, dug, loaded, time, power):
    """Buckets and steps counted one by one."""
    ways = [begins[k] - begins[k - 1] for k in range(1, len(begins))]
    joules = 0.0
    for k in range(1, len(time)):
        if power[k] > 0:
            joules += power[k] * (time[k] - time[k - 1])
    seconds = ends[-1] - begins[0]
    by_hand = np.mean(ways), sum(dug) / len(dug) / 0.764, sum(loaded) * 3600 / seconds
    np.testing.assert_allclose(answer, [*by_hand, joules / 3600 / 1000], rtol=1e-9)


def words_of_ones(answer, gyro, left, right, sigma, count):
    """Flags as a text: where `count` ones stand together for the first time."""
    rate = (0.35 * right - 0.35 * left) / 2.38
    flags = "".join("1" if not -3 * sigma <= r <= 3 * sigma else "0" for r in gyro - rate)
    first = flags.find("1" * count)
    assert answer == (first + count - 1 if first >= 0 else -1)


def a_stroke_that_begins_and_ends_right(answer, strip, heights, directions, reaches):
    """By the arm's geometry: the edge at the start, at its depth or 0.05 m above the ground at the
    lowest; the bucket with the slopes of the hand-made stroke; lifted where that lifts."""
    times, path = answer
    np.testing.assert_allclose(times, [0.0, 2.5, 4.9, 6.9, 9.9])
    q = inverse_kinematics(path, on_failure="nan")
    assert np.isfinite(q).all()
    x, y, z = forward_kinematics(q)[:, :3, 3].T
    np.testing.assert_allclose(np.arctan2(y, x - 0.4), strip.direction, atol=1e-6)
    row = int(np.abs(directions - strip.direction).argmin())
    surface = np.interp(strip.start, reaches, heights[row])
    assert np.hypot(x - 0.4, y)[1] == pytest.approx(strip.start, abs=1e-6)
    wanted = max(surface - strip.depth, 0.05 + 0.2587)
    assert z[1] == pytest.approx(wanted, abs=5e-4)
    tips = np.array([(r, z) for _, _, r, z, _ in PLAN])
    angles = np.radians([angle for *_, angle in PLAN])
    by_hand = inverse_kinematics(np.c_[0.4 + tips[:, 0], 0 * tips[:, 0], tips[:, 1], angles])
    np.testing.assert_allclose(q[:, 1:].sum(1), by_hand[:, 1:].sum(1), atol=1e-6)
    reach = np.hypot(path[:, 0] - 0.4, path[:, 1])
    np.testing.assert_allclose(np.diff(reach[:4]), np.diff(tips[:4, 0]), atol=1e-6)
    np.testing.assert_allclose(np.diff(path[1:4, 2]), np.diff(tips[1:4, 1]), atol=1e-6)
    np.testing.assert_allclose([path[0, 2], reach[4], path[4, 2]], [4.2, 5.8, 3.4], atol=1e-6)


EQUAL = {
    "14.1": {
        "the result is never negative": "a volume",
        "surface is never negative": "heights over the ground of a heap",
        "reaches is never negative": "distances",
        "reaches: even steps": "those of a polar map",
        "reaches: that of the first case": "only their steps count, and those are a map's",
        "start: abs": "a distance",
    },
    "14.2": {"fill: abs": "shares of a bucket"},
    "14.5": {
        "the result is never negative": "times, shares and rates of a site that digs",
        **dict.fromkeys(
            [f"{name} is never negative" for name in ("begins", "ends", "dug", "loaded", "time")],
            "times since the mission began, and volumes",
        ),
        **{
            f"{one} cut to the length of {other}": "one number a cycle in each"
            for one, other in permutations(("begins", "ends", "dug", "loaded"), 2)
        },
    },
    "14.6": {
        "left: the first sample is the second": "one sample never rings",
        "gyro: the first sample is the second": "one sample never rings",
        "sigma: abs": "a standard deviation",
        "count is never negative": "a count",
    },
}
"""Mutants that are the reference in disguise, with the reason."""
