"""A map that keeps up: how many looks change its mind, one voxel at a time and in the scene."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import expit, logit

from backhoe import simulation
from backhoe.perception.octree import OccupancyOctree, looks_until, updated
from backhoe.simulation import LOADING
from backhoe.simulation.scene import Heap
from backhoe.simulation.sight import Sight

HERE = np.array([0.05, 0.05, 0.05])
EYE = np.array([1.75, 1.5, 3.6])
"""Of a laser on the left of the house [m]."""
TRUCK = np.array([[-3.0, 3.7, 0.25], [5.0, 7.2, 3.5]])
"""Box about the truck, above the ground [m]."""
NEVER = 1e6


def look(tree: OccupancyOctree, reflected: bool) -> float:
    """Log-odds of the voxel HERE after one more look at it."""
    tree.insert_scan([HERE if reflected else np.add(HERE, [0.1, 0, 0])], HERE)
    return float(tree.log_odds(HERE))


@pytest.mark.parametrize("clamps", [{}, {"l_min": -NEVER, "l_max": NEVER}])
def test_a_look_adds_what_it_adds_in_the_map(clamps):
    tree, odds = OccupancyOctree(0.1, **clamps), np.nan
    for reflected in np.random.default_rng(0).integers(0, 2, 60):
        odds = updated(odds, bool(reflected), **clamps)
        assert look(tree, reflected) == pytest.approx(odds, abs=2e-5)


def test_a_look_is_bayes_with_an_even_prior():
    p = np.random.default_rng(1).uniform(0.05, 0.95, 50)
    for reflected, z in ((True, expit(1.39)), (False, expit(-0.80))):
        after = z * p / (z * p + (1 - z) * (1 - p))
        free = {"l_min": -NEVER, "l_max": NEVER}
        np.testing.assert_allclose(expit(updated(logit(p), reflected, **free)), after, atol=1e-12)


@pytest.mark.parametrize("occupied", [True, False])
def test_so_many_looks_change_the_mind_of_a_map(occupied):
    """After any history; one look fewer does not."""
    rng = np.random.default_rng(2)
    for _ in range(40):
        hit, miss = rng.uniform(0.3, 2.0), -rng.uniform(0.3, 2.0)
        tree = OccupancyOctree(0.1, hit=hit, miss=miss)
        odds = np.nan
        for reflected in rng.integers(0, 2, rng.integers(0, 8)):
            odds = look(tree, reflected)
        wanted = looks_until(odds, occupied, hit=hit, miss=miss)
        looks = 0
        while np.isnan(odds) or (odds >= 0) != occupied:
            odds, looks = look(tree, occupied), looks + 1
        assert looks == wanted


def test_a_clamped_map_takes_two_hits_or_five_misses_at_most():
    every = np.r_[np.nan, np.linspace(-2.0, 3.48, 1001)]
    assert looks_until(every, True).max() == looks_until(-2.0, True) == 2
    assert looks_until(every, False).max() == looks_until(3.48, False) == 5
    assert looks_until(np.nan, True) == looks_until(np.nan, False) == 1


@pytest.mark.parametrize("hits", [1, 3, 20])
def test_without_clamping_it_takes_as_many_misses_as_hits_times_the_ratio(hits):
    tree = OccupancyOctree(0.1, l_min=-NEVER, l_max=NEVER)
    odds = [look(tree, True) for _ in range(hits)][-1]
    misses = 0
    while odds >= 0:
        odds, misses = look(tree, False), misses + 1
    assert misses == np.ceil(hits * 1.39 / 0.80)


@pytest.mark.parametrize("call", [updated, looks_until])
@pytest.mark.parametrize("bad", [{"hit": 0.0}, {"hit": np.nan}, {"miss": 0.8}, {"miss": None}])
def test_bad_looks_say_why(call, bad):
    with pytest.raises(ValueError, match=next(iter(bad))):
        call(0.0, True, **bad)
    with pytest.raises(ValueError, match="log_odds must be numbers"):
        call("even", True)


class Laser:
    """Scans a scene from one place: rays every degree, each scan as a whole turned at random."""

    def __init__(self, jitter: float = 0.0, noise: float = 0.0) -> None:
        turn, rise = np.meshgrid(np.radians(np.arange(-50, 120)), np.radians(np.arange(-60, 3)))
        self.turn, self.rise = turn.ravel(), rise.ravel()
        self.jitter, self.noise, self.rng = np.radians(jitter), noise, np.random.default_rng(5)

    def __call__(self, sight: Sight) -> np.ndarray:
        shift = self.rng.uniform(-0.5, 0.5, 2) * self.jitter
        turn, rise = self.turn + shift[0], self.rise + shift[1]
        flat = np.cos(rise)
        ways = np.c_[flat * np.cos(turn), flat * np.sin(turn), np.sin(rise)]
        t = sight.cast(np.broadcast_to(EYE, ways.shape), ways).t
        t = np.where(np.isfinite(t), t + self.noise * self.rng.standard_normal(len(t)), 50.0)
        return EYE + t[:, None] * ways


def sight(q: object = None, **changes: object) -> Sight:
    world = simulation.open_world(backend="analytic", scene=replace(LOADING, **changes), q=q)
    return Sight(world)


HEAP = LOADING.heaps[0]
GROWN = {"heaps": (replace(HEAP, height=1.6),)}
DUG = {"heaps": (HEAP, Heap(x=5.0, y=0.4, height=-0.9, radius=1.2))}
UP, DOWN = np.radians([-90, 50, -40, 0]), np.radians([-90, 10, -70, -40])
EVENTS = {
    "truck gone": ({}, {"truck": None}),
    "truck come": ({"truck": None}, {}),
    "heap grown": ({}, GROWN),
    "heap dug": ({}, DUG),
    "arm moved": ({"q": UP}, {"q": DOWN}),
}


def voxels(tree: OccupancyOctree) -> np.ndarray:
    """Middles of all known smallest voxels near the machine."""
    axes = [np.arange(low + 0.1, high, 0.2) for low, high in ((-4, 9), (-5, 8), (-0.4, 4))]
    cells = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)
    return cells[np.isfinite(tree.log_odds(cells))]


@pytest.mark.parametrize("event", EVENTS)
def test_the_map_agrees_with_the_scene_after_as_many_scans_as_one_voxel_takes(event):
    """With the map that begins with the event: two scans for what came, five for what went."""
    before, after = EVENTS[event]
    laser, tree, fresh = Laser(), OccupancyOctree(0.2), OccupancyOctree(0.2)
    old, new = laser(sight(**before)), laser(sight(**after))
    for _ in range(10):
        tree.insert_scan(old, EYE, 15.0)
    fresh.insert_scan(new, EYE, 15.0)
    cells = voxels(fresh)
    now, occupied = tree.log_odds(cells), fresh.log_odds(cells) >= 0
    came, went = occupied & ~(now >= 0), ~occupied & ~(now < 0)
    assert came.any() and went.any() and came.sum() + went.sum() > 200
    assert looks_until(now, True)[came].max() == 2
    assert looks_until(now, False)[went].max() == 5
    need = np.where(occupied, looks_until(now, True), looks_until(now, False))
    for k in range(5):
        odds = tree.log_odds(cells)
        np.testing.assert_array_equal(np.isnan(odds) | ((odds >= 0) != occupied), need > k)
        tree.insert_scan(new, EYE, 15.0)
    np.testing.assert_array_equal(tree.log_odds(cells) >= 0, occupied)


def stale(tree: OccupancyOctree) -> float:
    """Volume that is occupied where the truck was [m^3]."""
    _, sizes, odds = tree.leaves(box=TRUCK)
    return float(np.sum(sizes[odds >= 0] ** 3))


def test_less_than_2_percent_of_the_truck_is_left_when_it_has_gone():
    """With noise of 1 cm, and each scan's rays between those of the last: still five scans."""
    laser, tree = Laser(jitter=1.0, noise=0.01), OccupancyOctree(0.1)
    there, gone = sight(), sight(truck=None)
    for _ in range(12):
        tree.insert_scan(laser(there), EYE, 15.0)
    first = stale(tree)
    left = []
    for _ in range(5):
        tree.insert_scan(laser(gone), EYE, 15.0)
        left.append(stale(tree) / first)
    assert first > 1.0 and left[3] > 0.5 and left[4] < 0.02


def test_what_no_ray_passes_stays_as_it_was():
    """The truck leaves while something stands in the way: those voxels are not looked at."""
    laser, tree = Laser(), OccupancyOctree(0.1)
    there = laser(sight())
    for _ in range(10):
        tree.insert_scan(there, EYE, 15.0)
    first = stale(tree)
    half = laser(sight(truck=None))
    ways = half - EYE
    behind = np.arctan2(ways[:, 1], ways[:, 0]) > np.radians(90)
    half[behind] = EYE + 1.5 * ways[behind] / np.linalg.norm(ways[behind], axis=1)[:, None]
    for _ in range(100):
        tree.insert_scan(half, EYE, 15.0)
    assert 0.2 < stale(tree) / first < 0.8
