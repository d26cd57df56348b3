"""Where to dig: what a strip brings is what was foreseen, and the choice pays."""

from types import SimpleNamespace

import numpy as np
import pytest

from backhoe.arm import kinematics
from backhoe.machine import BACKHOE
from backhoe.mission import autonomy
from backhoe.mission.autonomy import DIRECTIONS, REACHES, Strip, choice
from backhoe.mission.parts import smooth_trajectory
from backhoe.simulation.scene import untouched_ground
from backhoe.simulation.soil import SANDY_LOAM
from backhoe.simulation.trial import dig

FLAT = np.zeros((len(DIRECTIONS), len(REACHES)))
VIEW = DIRECTIONS, REACHES


def ridge(top=0.8, middle=5.4, slope=0.5):
    """The same profile in all directions: a ridge around the machine."""
    return np.clip(top - slope * np.abs(REACHES - middle), 0, None) + FLAT


def moved(strip, heights):
    """Angles along a stroke, densely."""
    times, path = autonomy.stroke(strip, heights, *VIEW)
    t = np.linspace(0, times[-1], 300)
    return t, smooth_trajectory(times, kinematics.inverse_kinematics(path), t)[0]


def test_a_map_is_seen_from_the_swing_axis_wherever_the_machine_stands():
    x, y = np.meshgrid(np.arange(-10, 10.1, 0.1), np.arange(-12, 12.1, 0.1))
    plane = SimpleNamespace(grid=lambda: (x, y), heights=0.2 * x - 0.1 * y, variance=0.04 + 0 * x)
    for pose in ((0, 0, 0), (1.0, -2.0, 0.4)):
        heights, deviation = autonomy.polar(plane, pose, DIRECTIONS[5:9], REACHES[:20])
        way = np.exp(1j * (pose[2] + DIRECTIONS[5:9]))[:, None] * REACHES[:20]
        there = pose[0] + 1j * pose[1] + BACKHOE.base.offset * np.exp(1j * pose[2]) + way
        np.testing.assert_allclose(heights, 0.2 * there.real - 0.1 * there.imag, atol=1e-9)
        np.testing.assert_allclose(deviation, 0.2)
    assert np.isnan(autonomy.polar(plane, (30, 0, 0))[0]).all()


@pytest.mark.parametrize("strip", [Strip(0.0, 6.0, 0.3), Strip(-0.7, 5.3, 0.15)])
def test_the_edge_enters_where_the_strip_begins_and_as_deep(strip):
    heights = ridge(1.2)
    _, q = moved(strip, heights)
    _, path = autonomy.stroke(strip, heights, *VIEW)
    cut_in = kinematics.forward_kinematics(kinematics.inverse_kinematics(path[1]))
    x, y, z = cut_in[:3, 3]
    direction = np.arctan2(y, x - BACKHOE.base.offset)
    assert direction == pytest.approx(strip.direction, abs=1e-6)
    assert np.hypot(x - BACKHOE.base.offset, y) == pytest.approx(strip.start, abs=1e-6)
    surface = np.interp(strip.start, REACHES, heights[0])
    assert z == pytest.approx(surface - strip.depth, abs=1e-6)
    nominal = choice._moved(0.0, 0.0, 0.0)  # the bucket keeps its slope
    slopes = [kinematics.inverse_kinematics(p)[..., 1:].sum(-1) for p in (path, nominal)]
    np.testing.assert_allclose(*slopes, atol=1e-9)
    edges = kinematics.forward_kinematics(q)[:, :3, 3]
    out = np.hypot(edges[:, 0] - BACKHOE.base.offset, edges[:, 1]) - strip.start
    lowest = [edges[np.abs(out - at) < 0.06, 2].min() - z for at in (-1.2, -0.8, 0.0)]
    np.testing.assert_allclose(np.interp([-1.2, -0.8, 0.0], *autonomy.edge()), lowest, atol=0.02)


def test_no_stroke_digs_into_the_ground_that_the_machine_stands_on():
    for strip in (Strip(0.0, 6.2, 2.0), Strip(0.5, 5.2, 0.6)):
        _, q = moved(strip, ridge(0.4))
        edge = kinematics.forward_kinematics(q)[:, 2, 3]
        assert 0.02 < edge.min() < 0.08


def test_the_depth_of_a_cut_is_the_ground_above_the_edge():
    """Under a plateau, by hand: 0.9 m of soil, an edge that is put in 0.3 m deep."""
    plateau, strip = FLAT + 0.9, Strip(0.1, 6.0, 0.3)
    depth = autonomy.cut_depth(strip, plateau, *VIEW)
    out, low = autonomy.edge()
    there = np.interp(5.2 - 6.0, out, low)
    assert depth[np.isclose(REACHES, 5.2)] == pytest.approx(0.3 - there)
    assert depth[np.isclose(REACHES, 7.5)] == 0.0
    plateau[:, REACHES < 5.15] = np.nan
    assert not autonomy.cut_depth(strip, plateau, *VIEW)[REACHES < 5.15].any()


def test_a_fill_is_the_volume_of_the_cut_but_for_its_beginning_and_ends_at_full():
    heights = ridge(0.5)
    strip = Strip(0.0, 5.8, 0.1)
    depth = autonomy.cut_depth(strip, heights, *VIEW)
    kept = REACHES < 5.55
    volume = BACKHOE.shell.width * 0.1 * depth[kept].sum()
    assert autonomy.expected_fill(strip, heights, *VIEW) == pytest.approx(volume)
    assert 0.1 < volume < choice.FULL
    assert autonomy.expected_fill(Strip(0.0, 5.8, 0.6), ridge(1.3), *VIEW) == choice.FULL
    starts = np.array([5.6, 5.8])
    many = autonomy.expected_fill(Strip(0.0, starts, np.array([0.1, 0.1])), heights, *VIEW)
    assert many[1] == pytest.approx(volume) and many[0] != many[1]


def test_what_is_foreseen_is_what_comes():
    """Digs at random, one after the other on the same heaps: to 0.06 m^3, and hardly biased."""
    rng, errors = np.random.default_rng(3), []
    for seed in (20, 21, 22):
        ground = untouched_ground(autonomy.heap_site(seed), BACKHOE, seed, 0.01, SANDY_LOAM)
        for _ in range(4):
            heights, _ = autonomy.polar(ground.terrain)
            strip = autonomy.random_strip(int(rng.integers(99)))(heights, 0 * heights, *VIEW)
            t, q = moved(strip, heights)
            one = dig(kinematics.pose(q), t, ground=ground)
            errors.append(one.soil - autonomy.expected_fill(strip, heights, *VIEW))
    assert np.sqrt(np.mean(np.square(errors))) < 0.08
    assert abs(np.mean(errors)) < 0.04


def test_soil_deeper_on_the_left_pushes_the_bucket_by_the_earth_pressure_of_both_sides():
    strip = Strip(0.0, 6.0, 0.3)
    assert autonomy.side_load(strip, ridge(), *VIEW) == pytest.approx(0, abs=1e-6)
    left, right = FLAT + 1.0, FLAT + 1.0
    left[DIRECTIONS > 0] += 0.3  # a step along the middle of the strip
    right[DIRECTIONS < -1e-6] += 0.3
    middle = np.isclose(DIRECTIONS, 0.0)
    left[middle] = right[middle] = 1.0
    a, b = (autonomy.side_load(strip, one, *VIEW) for one in (left, right))
    assert a > 0 and b == pytest.approx(-a, rel=1e-6)
    depth = autonomy.cut_depth(strip, FLAT + 1.0, *VIEW)
    higher = np.where(depth > 0, depth + 0.3, np.clip(0.3 + depth, 0, None))
    pressure = (1 - np.sin(np.radians(33))) * 1600 * 9.81
    under = depth > 0
    by_hand = pressure / 2 * 0.1 * (REACHES * (higher**2 - depth**2))[under].sum()
    assert a == pytest.approx(by_hand, rel=0.1)


def test_a_cycle_takes_longer_the_further_the_truck_is():
    here, there = autonomy.cycle_time(0.0), autonomy.cycle_time(-np.pi / 4)
    assert there - here == pytest.approx(2 * 2.0)  # 4 s for a quarter turn, twice half of it
    assert autonomy.cycle_time(0.0, -np.pi / 2) == here == pytest.approx(9.9 + 3.3 + 8.0)


def test_the_choice_is_the_best_of_all_that_it_tries_within_its_side_load():
    rng = np.random.default_rng(1)
    rows, columns = np.mgrid[: len(DIRECTIONS), : len(REACHES)]
    for _ in range(3):
        i, j = rng.uniform(5, 35), rng.uniform(10, 35)
        heights = 1.2 * np.exp(-(((rows - i) / 4) ** 2) - ((columns - j) / 9) ** 2)
        found = autonomy.best_strip(heights, 0 * heights, *VIEW)

        def rate(strip, ground=heights):
            if abs(autonomy.side_load(strip, ground, *VIEW)) > choice.MOST_SIDE_LOAD:
                return 0.0
            fill = autonomy.expected_fill(strip, ground, *VIEW)
            return fill / autonomy.cycle_time(strip.direction)

        others = [
            Strip(rng.choice(DIRECTIONS), rng.choice(choice.STARTS), rng.choice(choice.DEPTHS))
            for _ in range(200)
        ]
        assert rate(found) > 0 and rate(found) >= max(map(rate, others))


def test_it_counts_on_what_is_surely_there_and_leaves_bare_ground_alone():
    bare = autonomy.best_strip(FLAT, FLAT, *VIEW), autonomy.highest_strip(FLAT, FLAT, *VIEW)
    assert bare == (None, None) and autonomy.random_strip(1)(FLAT, FLAT, *VIEW) is None
    unseen = FLAT + np.nan
    assert autonomy.best_strip(unseen, unseen, *VIEW) is None
    heights = np.where(np.abs(DIRECTIONS[:, None]) < 0.9, ridge(), 0.0)
    unsure = np.where(DIRECTIONS[:, None] > -0.2, 0.8, 0.01) + FLAT
    assert autonomy.best_strip(heights, unsure, *VIEW).direction < -0.2
    assert autonomy.best_strip(heights, 0 * heights + 0.01, *VIEW).direction > 0.5


def test_it_beats_the_highest_place_and_chance():
    parts = autonomy.best_strip, autonomy.highest_strip, autonomy.random_strip(0)
    best, highest, chance = (autonomy.job(part, 0, 100.0).rate for part in parts)
    assert best > 1.5 * max(highest, chance)


def test_a_hidden_place_is_behind_something_higher():
    wall = FLAT.copy()
    wall[10, 20:22] = 1.5  # at 5.0 and 5.1 m
    seen = autonomy.seen(wall)
    shadow = 5.1 * 3.4 / (3.4 - 1.5)  # where the ray over the wall comes down
    hidden = np.isnan(seen[10])
    assert not np.isnan(seen[9]).any() and hidden[REACHES > 5.15].any()
    assert not hidden[REACHES < 5.15].any() and shadow > REACHES[-1] and hidden[22:].all()


def test_bad_choices_and_views_are_named():
    with pytest.raises(TypeError, match="dig_choice"):
        autonomy.job(3)
    with pytest.raises(ValueError, match="your strip"):
        autonomy.job(lambda *view: (0.0, 6.0))
    with pytest.raises(ValueError, match="reach"):
        autonomy.job(lambda *view: (0.0, 9.0, 0.3))
    with pytest.raises(ValueError, match="heights"):
        autonomy.best_strip(FLAT[:-1], FLAT[:-1], *VIEW)
    with pytest.raises(ValueError, match="must rise"):
        autonomy.expected_fill(Strip(0, 6, 0.3), FLAT, DIRECTIONS[::-1], REACHES)
    assert len(autonomy.job(lambda *view: None).digs) == 0
