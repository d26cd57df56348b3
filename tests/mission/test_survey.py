"""A survey beside the truth, and what becomes of its numbers with a part that is wrong."""

from __future__ import annotations

from dataclasses import fields
from functools import lru_cache

import numpy as np
import pytest

from backhoe import mission
from backhoe.arm import kinematics
from backhoe.mission import sensing
from backhoe.mission.sensing import BEYOND, Chart, laser_cloud
from backhoe.mission.surveying import SurveyRun
from backhoe.mission.truth import truth_of
from backhoe.mission.worksite import SET_OFF, SWEEP, TICK, Led, worked
from backhoe.perception.cloud import incidence, shadow_filter
from backhoe.perception.laser import deskew, sensor_poses
from backhoe.perception.octree import OccupancyOctree
from backhoe.perception.stereo import block_match

SEEDS = 0, 1, 2
NUMBERS = [field.name for field in fields(mission.SurveyScore)][:9]


@lru_cache
def library(seed: int = 0) -> SurveyRun:
    return mission.survey(seed=seed)


@lru_cache
def noise() -> dict[str, float]:
    """How far each number differs between seeds."""
    scores = [mission.score(library(seed)) for seed in SEEDS]
    return {name: np.ptp([getattr(score, name) for score in scores]) for name in NUMBERS}


@pytest.mark.parametrize("seed", SEEDS)
def test_the_map_finds_what_the_beams_end_at_and_little_else(seed):
    run = library(seed)
    assert run.found.min() > 0.93
    assert run.false[-1] < 0.1
    assert run.dark == 1.0
    assert sum(cloud.own for seen in run.clouds for cloud in seen.values()) == 0


@pytest.mark.parametrize("seed", SEEDS)
def test_the_truck_that_left_is_gone_after_as_many_looks_as_clear_a_sure_voxel(seed):
    fresh = OccupancyOctree(0.2)
    looks = int(np.floor(fresh.l_max / -fresh.miss)) + 1
    run = library(seed)
    away = [k for k, event in enumerate(run.events) if event == "the truck has left"]
    assert len(away) == looks == 5
    assert np.isnan(run.left[: away[0]]).all()
    assert run.left[away[0]] > 0.5
    assert run.left[away[-1]] < 0.02


def test_the_truck_that_came_is_there_after_as_many_looks_as_fill_a_free_voxel():
    run = library()
    truths = [truth_of(look, run.resolution) for look in run.looks[:3]]
    free = (run.odds[0] < 0) & truths[1].hit & truths[2].hit & ~truths[0].ground
    assert free.sum() > 300
    assert np.ceil(-run.odds[0][free].min() / OccupancyOctree(0.2).hit) == 2
    assert (run.odds[2][free] >= 0).mean() > 0.9


def test_soil_that_was_dug_away_stays_in_the_map_until_the_next_look_at_it():
    run = library()
    first, last = (truth_of(run.looks[k], run.resolution) for k in (0, -1))
    dug = first.hit & (run.odds[1] >= 0) & ~last.ground
    assert dug.sum() > 20
    assert (run.odds[6][dug] >= 0).mean() > 0.9
    assert (run.odds[-1][dug] >= 0).mean() < 0.02


@pytest.mark.parametrize("seed", SEEDS)
def test_the_heap_is_seen_to_its_noise_and_the_soil_that_is_gone_is_measured(seed):
    run = library(seed)
    for name, most in (("lasers", 0.005), ("stereo", 0.015)):
        seen, off, high = run.heap[name][[0, -1]].T
        assert (seen > 0.6).all() and (off < most).all() and (np.abs(high) < 0.002).all()
    measured, true = run.dug
    assert true > 0.6 and abs(measured - true) < 0.05
    assert np.isnan(run.heap["stereo"][1]).all()


def test_what_is_seen_while_it_swings_lies_where_it_is():
    run = library()
    for k in (k for k, event in enumerate(run.events) if event == "while it swings"):
        assert not run.looks[k].motion.still
        assert run.heap["lasers"][k, 1] < 0.01 and run.found[k] > 0.93


def test_a_look_while_it_swings_is_of_the_motion_that_is_led():
    from scipy.interpolate import PchipInterpolator

    look = worked(1, 0, False).looks[2]
    lift, swing = mission.hand_made_plan(0)[4:6]
    ends = [kinematics.inverse_kinematics(np.array(point.target)) for point in (lift, swing)]
    when = look.motion.time + SET_OFF + TICK
    wanted = PchipInterpolator([0.0, swing.time], ends)(when)
    assert look.event == "while it swings" and when[-1] == pytest.approx(SET_OFF + SWEEP + TICK)
    np.testing.assert_allclose(look.motion.q, wanted, atol=1e-9)
    assert np.ptp(look.motion.q[:, 0]) > 0.5


def test_the_soil_is_told_the_buckets_own_motion(monkeypatch):
    led, told = Led(0), []
    monkeypatch.setattr(led.ground, "advance", lambda *given: told.append(given))
    before, step = led.q.copy(), np.array([0.0, 0.02, -0.05, 0.04]) * TICK
    led.dig(before + step, step / TICK)
    T, velocity, dt, pitch_rate = told[0]
    tips = [kinematics.forward_kinematics(q)[:3, 3] for q in (before, before + step)]
    np.testing.assert_allclose(velocity, (tips[1] - tips[0]) / dt, atol=1e-3)
    np.testing.assert_allclose(T[:3, 3], tips[1], atol=1e-9)
    turned = [kinematics.pose(q)[3] for q in (before, before + step)]
    assert (dt, led.time) == (TICK, TICK)
    assert pitch_rate == pytest.approx(0.01) and turned[1] - turned[0] != 0.0


def before_and_behind_the_machine():
    """Points kept on the machine, and the shares that are known half a metre before and behind."""
    look, chart = worked(1, 0, False).looks[0], Chart(OccupancyOctree, 0.2)
    own = laser_cloud(look, "left", shadow_filter, chart).own
    scan = look.scans["left"]
    on_it = np.isin(scan.surface, look.own)
    inner = on_it.copy()
    for axis in (0, 1):
        inner &= np.roll(on_it, 1, axis) & np.roll(on_it, -1, axis)
    assert inner.sum() > 100
    shares = []
    for further in (-0.5, 0.8):
        points = deskew(scan.laser, scan.time, scan.truth + further, look.motion)[inner]
        shares.append(np.isfinite(chart.log_odds(points)).mean())
    return own, *shares


def test_what_falls_on_the_machine_is_no_obstacle_and_frees_nothing(monkeypatch):
    own, before, behind = before_and_behind_the_machine()
    assert own == 0 and before < 0.1 and behind < 0.03
    monkeypatch.setattr(sensing, "_off_the_machine", lambda points, *a: np.ones(len(points), bool))
    own, before, behind = before_and_behind_the_machine()
    assert own > 150 and before > 0.9, "the filter is what takes them out"
    assert behind < 0.03


def test_the_map_does_not_grow_while_nothing_new_is_seen():
    run = library()
    again, sizes = OccupancyOctree(0.2), []
    origin = np.array([0.5, 1.5, 3.0])
    for _ in range(12):
        again.insert_scan(run.clouds[-1]["left"].points, origin, 12.0)
        sizes.append(again.size)
    assert sizes[5:] == [sizes[-1]] * 7


def test_the_same_survey_gives_the_same_numbers():
    once, twice = library(), mission.survey()
    np.testing.assert_array_equal(once.odds, twice.odds)
    assert once.backend == "led", "no dynamics, so the same with PyBullet and without"


def halved(left, right):
    return block_match(left, right) + 0.5


class Wrong(OccupancyOctree):
    """A map with one mistake."""

    def __init__(self, resolution, mistake):
        super().__init__(resolution)
        self.mistake = mistake
        if mistake == "hit and miss swapped":
            self._odds[:2] = self._odds[1::-1]
        elif mistake == "no clamping":
            self._odds[2:] = np.float32(-1e6), np.float32(1e6)
        elif mistake == "no misses":
            self._odds[0] = np.float32(0.0)

    def insert_scan(self, points, origin, max_range=None):
        if self.mistake == "origin ignored":
            origin = np.zeros(3)
        elif self.mistake == "range ignored":
            max_range = None
        super().insert_scan(points, origin, max_range)

    def log_odds(self, points):
        odds = super().log_odds(points)
        return np.nan_to_num(odds, nan=-2.0) if self.mistake == "unknown is free" else odds


def wrong(mistake):
    return lambda resolution: Wrong(resolution, mistake)


def one_end(points, origin):
    angles = incidence(points, origin)
    keep = np.isfinite(points).all(axis=-1)
    keep[:, :-1] &= ~((angles < np.radians(10)) | (angles > np.radians(170)))
    return keep


def next_line(points, origin):
    if len(points) == 1:
        return np.isfinite(points).all(axis=-1)
    return shadow_filter(np.swapaxes(points, 0, 1), origin).T


MISTAKES = {
    "negated": ("matcher", lambda left, right: -block_match(left, right), "seen"),
    "times 16": ("matcher", lambda left, right: 16 * block_match(left, right), "wrong"),
    "swapped": ("matcher", lambda a, b: block_match(b, a, uniqueness=0, speckle=0), "wrong"),
    "half a pixel": ("matcher", halved, "off"),
    "no test of texture or of uniqueness": (
        "matcher",
        lambda left, right: block_match(left, right, texture=0, uniqueness=0),
        "wrong",
    ),
    "no uniqueness": (
        "matcher",
        lambda left, right: block_match(left, right, uniqueness=0),
        "wrong",
    ),
    "no speckles dropped": (
        "matcher",
        lambda left, right: block_match(left, right, speckle=0),
        "dark",
    ),
    "all kept": ("scan_filter", lambda p, origin: np.isfinite(p).all(axis=-1), "strays"),
    "10 to 70": ("scan_filter", lambda p, o: shadow_filter(p, o, most=np.radians(70)), "covered"),
    "inverted": ("scan_filter", lambda p, origin: ~shadow_filter(p, origin), "covered"),
    "one end": ("scan_filter", one_end, "strays"),
    "the next line": ("scan_filter", next_line, "covered"),
    "in the laser's frame": (
        "scan_filter",
        lambda p, origin: shadow_filter(p, 0 * origin),
        "strays",
    ),
    "no clamping": ("map", wrong("no clamping"), "left"),
    "no misses": ("map", wrong("no misses"), "left"),
    "hit and miss swapped": ("map", wrong("hit and miss swapped"), "found"),
    "origin ignored": ("map", wrong("origin ignored"), "left"),
    "range ignored": ("map", wrong("range ignored"), "false"),
    "unknown is free": ("map", wrong("unknown is free"), "dark"),
}
"""Part, mistake, and a number that moves."""


@pytest.mark.parametrize("name", MISTAKES)
def test_a_usual_mistake_moves_a_printed_number_beyond_the_noise_of_seeds(name):
    part, mistake, number = MISTAKES[name]
    score = mission.score(mission.survey(**{part: mistake}))
    right, its = (getattr(s, number) for s in (score.reference, score))
    assert abs(its - right) > 5 * noise()[number], (its, right)
    rows = [line.split()[-2:] for line in str(score).splitlines()[2:]]
    one, other = rows[NUMBERS.index(number)]
    assert one != other


def boxes(image, side=15):
    """Sums over windows, zero at the edges."""
    half = side // 2
    sums = np.pad(np.cumsum(np.cumsum(np.pad(image, half), 0), 1), ((1, 0), (1, 0)))
    return sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]


def plain_matcher(left, right, most=64):
    """Blocks in plain NumPy: normalised response, sums of differences, a line through the costs."""
    L, R = (
        np.clip(image - np.round(boxes(image.astype(float), 9) / 81), -31, 31)
        for image in (left.astype(float), right.astype(float))
    )
    costs = np.full((most + 2, *left.shape), 1e6, dtype=np.float32)
    for d in range(most + 2):
        costs[d, :, d:] = boxes(np.abs(L[:, d:] - R[:, : L.shape[1] - d]))
    best = costs[1:-1].argmin(axis=0) + 1
    below, at, above = (np.take_along_axis(costs, (best + k)[None], 0)[0] for k in (-1, 0, 1))
    far = costs.copy()
    for k in (-1, 0, 1):
        np.put_along_axis(far, (best + k)[None], np.inf, 0)
    sure = (far.min(axis=0) > 1.15 * at) & (boxes(np.abs(L)) > 10)
    sure[:, : most + 7] = sure[:7] = sure[-7:] = sure[:, -7:] = False
    slope = np.maximum(np.maximum(below, above) - at, 1e-6)
    return np.where(sure, best + (below - above) / (2 * slope), np.nan)


class Dense:
    """Log-odds in one array."""

    def __init__(self, resolution):
        self.resolution, self.low = resolution, np.array([-16.0, -16.0, -8.0])
        self.odds = np.full((160, 160, 100), np.nan)

    def _index(self, points):
        return tuple(np.floor((points - self.low) / self.resolution + 1e-9).astype(int).T)

    def insert_scan(self, points, origin, max_range=None):
        reach = np.linalg.norm(points - origin, axis=1)
        free = np.zeros(self.odds.shape, bool)
        for share in np.arange(0, 1, 0.4 * self.resolution / max_range):
            at = share * max_range
            on = points[at < reach - self.resolution / 2] - origin
            free[self._index(origin + at * on / np.linalg.norm(on, axis=1, keepdims=True))] = True
        hit = np.zeros(self.odds.shape, bool)
        hit[self._index(points[reach <= max_range])] = True
        change = np.where(hit, 1.39, np.where(free, -0.8, np.nan))
        new = np.clip(np.nan_to_num(self.odds) + change, -2.0, 3.48)
        self.odds = np.where(np.isnan(change), self.odds, new)

    def log_odds(self, points):
        return self.odds[self._index(points)]


def own_filter(points, origin):
    """The angle at each point by the law of cosines."""
    back = origin - points
    step = np.diff(points, axis=1)
    with np.errstate(invalid="ignore"):
        cosine = (back[:, :-1] * step).sum(-1)
        cosine /= np.linalg.norm(back[:, :-1], axis=-1) * np.linalg.norm(step, axis=-1)
        bad = np.abs(cosine) > np.cos(np.radians(10))
    keep = np.isfinite(points).all(axis=-1)
    keep[:, 1:] &= ~bad
    keep[:, :-1] &= ~bad
    return keep


def test_a_right_part_of_the_students_own_does_as_well_as_the_library():
    score = mission.score(mission.survey(matcher=plain_matcher, scan_filter=own_filter, map=Dense))
    assert score.swapped == ("matcher", "scan_filter", "map")
    other = score.reference
    assert score.seen > other.seen - 0.03 and score.off < other.off + 0.005
    assert score.wrong < other.wrong + 0.02
    assert score.covered == pytest.approx(other.covered) and score.strays == other.strays
    assert score.found > other.found - 0.02 and score.false < other.false + 0.1
    assert score.left < 0.02 and score.dark > 0.99


def test_a_library_survey_is_its_own_reference():
    score = mission.score(library())
    assert score.reference is None and score.swapped == ()
    assert len(str(score).splitlines()) == 2 + 9
    same = mission.score(mission.survey(matcher=block_match)).reference
    assert [getattr(same, n) for n in NUMBERS] == [getattr(score, n) for n in NUMBERS]


def test_parts_cannot_change_what_was_seen():
    def spoils(left, right):
        answer = block_match(left, right)
        left[:], right[:] = 0, 0
        return answer

    def takes_away(points, origin):
        keep = shadow_filter(points, origin)
        points[:], origin[:] = 0, 0
        return keep

    run = mission.survey(matcher=spoils, scan_filter=takes_away)
    np.testing.assert_array_equal(run.odds, library().odds)


BAD = [
    ({"matcher": lambda left, right: left[:5].astype(float)}, ValueError, "your matcher.*shape"),
    ({"matcher": lambda left, right: np.full(left.shape, np.nan)}, ValueError, "no disparity"),
    ({"matcher": lambda left, right: None}, ValueError, "your matcher failed"),
    ({"scan_filter": lambda p, origin: np.ones(p.shape[:2])}, ValueError, "truth values.*float"),
    ({"scan_filter": lambda p, origin: np.ones(3, bool)}, ValueError, r"shape \(3,\)"),
    ({"map": lambda resolution: {}}, TypeError, "method insert_scan"),
    ({"map": 3}, TypeError, "map must be a function"),
    ({"matcher": OccupancyOctree}, TypeError, "got a class"),
    (
        {"mapper": Dense},
        TypeError,
        "unknown part 'mapper': the parts are matcher, scan_filter, map",
    ),
    ({"cycles": 0}, ValueError, "cycles"),
    ({"resolution": -1.0}, ValueError, "resolution"),
    ({"seed": -1}, ValueError, "seed"),
]


@pytest.mark.parametrize(("given", "kind", "words"), BAD)
def test_bad_parts_and_settings_are_named(given, kind, words):
    with pytest.raises(kind, match=words):
        mission.survey(**given)


def test_a_map_that_answers_in_another_shape_is_named():
    class Odd(OccupancyOctree):
        def log_odds(self, points):
            return super().log_odds(points)[:, None]

    with pytest.raises(ValueError, match="your map failed: what log_odds gives"):
        mission.survey(map=Odd)


def test_beams_that_meet_nothing_free_up_to_the_range_and_no_further():
    look, chart = worked(1, 0, False).looks[0], Chart(OccupancyOctree, 0.2)
    cloud = laser_cloud(look, "left", shadow_filter, chart)
    start = sensor_poses(look.scans["left"].laser.mount, 0.0, look.motion)[:3, 3]
    ahead = (cloud.empty - start) / BEYOND
    assert len(cloud.empty) > 500
    assert (chart.log_odds(start + 9.0 * ahead) < 0).mean() > 0.99
    assert np.isnan(chart.log_odds(cloud.empty)).all()


def test_the_survey_is_replayed():
    run = mission.survey(record=True)
    assert "the truck has left" in run.replay().recording.labels[-3][1]
    with pytest.raises(ValueError, match=r"mission\.survey"):
        library().replay()
