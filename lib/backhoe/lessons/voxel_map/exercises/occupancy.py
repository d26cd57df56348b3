"""Exercises of lesson 09b: a look at a voxel, what a ray tells, how many looks a map takes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.perception.octree import looks_until, updated
from backhoe.perception.octree.log_odds import HIT, L_MAX, L_MIN, MISS

__all__ = ["EXERCISES"]


def _voxels(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(20):
        odds = np.clip(rng.uniform(-3, 5, (4, 5)), L_MIN, L_MAX)
        odds[rng.random(odds.shape) < 0.2] = np.nan
        cases.append((odds, rng.random(odds.shape) < 0.5))
    return cases


def _told(reflected: NDArray, hit: float = HIT, miss: float = MISS) -> NDArray:
    return np.where(reflected, hit, miss)


def _known(log_odds: NDArray) -> NDArray:
    return np.nan_to_num(log_odds, nan=0.0)


LOOK = Exercise(
    number="9.4",
    title="One look at a voxel",
    reference=updated,
    cases=_voxels,
    oracle="bayes_with_probabilities_and_their_limits",
    mistakes={
        "nothing limits the sum: (5.3) keeps it between l_min and l_max": (
            lambda log_odds, reflected: _known(log_odds) + _told(reflected)
        ),
        "only the upper limit is there: misses would pile up without end": (
            lambda log_odds, reflected: np.minimum(_known(log_odds) + _told(reflected), L_MAX)
        ),
        "only the lower limit is there: hits would pile up without end": (
            lambda log_odds, reflected: np.maximum(_known(log_odds) + _told(reflected), L_MIN)
        ),
        "the limits are exchanged: l_max is the upper one": (
            lambda log_odds, reflected: np.clip(_known(log_odds) + _told(reflected), -L_MAX, -L_MIN)
        ),
        "an unknown voxel stays unknown: its prior is an even chance, log-odds 0": (
            lambda log_odds, reflected: np.clip(log_odds + _told(reflected), L_MIN, L_MAX)
        ),
        "hit and miss are exchanged: a reflection makes a voxel more likely to be occupied": (
            lambda log_odds, reflected: updated(log_odds, ~reflected)
        ),
        "probabilities are added: log-odds add, 1.39 and -0.80": (
            lambda log_odds, reflected: np.clip(
                _known(log_odds) + _told(reflected, 0.8, 0.31), L_MIN, L_MAX
            )
        ),
        "the old value is forgotten: a look is added to what was known": (
            lambda log_odds, reflected: np.clip(_told(reflected), L_MIN, L_MAX)
        ),
    },
    hints=(
        "np.where(reflected, 1.39, -0.80) is what each voxel is told.",
        "np.nan_to_num turns unknown into 0; np.clip limits the sum at both ends.",
    ),
    tested_on="20 slabs of 20 voxels, some unknown, some at a limit",
)


def _rays(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(30):
        origin, size = rng.uniform(-2, 2, 3), float(rng.choice((0.1, 0.25, 0.5)))
        way = rng.normal(size=3)
        way *= rng.uniform(1.0, 6.0) / np.linalg.norm(way)
        most = float(np.linalg.norm(way) * (rng.uniform(0.3, 0.9) if k % 2 else 1.5))
        cases.append((origin, origin + way, size, most))
    return cases


def _on_the_way(origin: NDArray, end: NDArray, size: float) -> NDArray:
    cuts = [0.0, 1.0]
    for a, b in zip(origin, end, strict=True):
        low, high = sorted((a, b))
        cuts.extend((np.arange(np.ceil(low / size), high / size) * size - a) / (b - a))
    cuts = np.sort(cuts)
    middles = origin + (cuts[:-1, None] + cuts[1:, None]) / 2 * (end - origin)
    return np.floor(middles / size).astype(int)


def _shortened(origin: NDArray, end: NDArray, most: float) -> tuple[NDArray, bool]:
    length = np.linalg.norm(end - origin)
    return (end, True) if length <= most else (origin + (end - origin) * most / length, False)


def told_by_a_ray(origin: NDArray, end: NDArray, size: float, most: float) -> NDArray:
    """Voxels that a ray tells something, from the sensor on, and what it adds to each.

    Args:
        origin, end: of the ray, shape (3,) [m].
        size: edge of the voxels [m].
        most: range of the sensor [m]; a ray that is longer is cut there and hits nothing.

    Returns:
        Rows of three indices and the log-odds that are added, shape (n, 4) [1].
    """
    end, hits = _shortened(origin, end, most)
    way = _on_the_way(origin, end, size)
    passed = np.c_[way[:-1], np.full(len(way) - 1, MISS)]
    return np.vstack([passed, [*way[-1], HIT]]) if hits else passed


def _always_hits(origin: NDArray, end: NDArray, size: float, most: float) -> NDArray:
    end, _ = _shortened(origin, end, most)
    return told_by_a_ray(origin, end, size, np.inf)


def _all_freed(origin: NDArray, end: NDArray, size: float, most: float) -> NDArray:
    rows = _always_hits(origin, end, size, most)
    rows[-1, 3] = MISS
    return rows


def _cut_voxel_freed(origin: NDArray, end: NDArray, size: float, most: float) -> NDArray:
    rows = _always_hits(origin, end, size, most)
    rows[-1, 3] = HIT if np.linalg.norm(end - origin) <= most else MISS
    return rows


def _both(origin: NDArray, end: NDArray, size: float, most: float) -> NDArray:
    rows = told_by_a_ray(origin, end, size, most)
    return np.vstack([rows[:-1], [*rows[-1, :3], MISS], rows[-1]]) if rows[-1, 3] > 0 else rows


def _sampled(origin: NDArray, end: NDArray, size: float, most: float) -> NDArray:
    end, hits = _shortened(origin, end, most)
    share = np.arange(0, 1, size / np.linalg.norm(end - origin))[:, None]
    way = np.floor((origin + share * (end - origin)) / size)
    last = np.floor(end / size)
    way = way[(way != last).any(axis=1)]
    passed = np.c_[way, np.full(len(way), MISS)]
    return np.vstack([passed, [*last, HIT]]) if hits else passed


RAY = Exercise(
    number="9.5",
    title="What a ray tells",
    reference=told_by_a_ray,
    cases=_rays,
    oracle="every_voxel_about_a_ray_asked_whether_it_is_cut",
    mistakes={
        "the range is ignored: a ray longer than that is cut there": (
            lambda origin, end, size, most: told_by_a_ray(origin, end, size, np.inf)
        ),
        "where a ray is cut there is no reflection: it says nothing of that voxel": _always_hits,
        "the voxel where a ray is cut is freed: the ray did not pass all of it, leave it out": (
            _cut_voxel_freed
        ),
        "the last voxel is passed too: if the ray was reflected, it was reflected there": (
            _all_freed
        ),
        "the last voxel is told twice, once as passed: a hit is a hit": _both,
        "the sensor's own voxel is missing: the ray passes it first": (
            lambda *ray: told_by_a_ray(*ray)[1:]
        ),
        "they come from the far end: begin at the sensor": (lambda *ray: told_by_a_ray(*ray)[::-1]),
        "samples one voxel apart step over corners: cut the ray at each border": _sampled,
    },
    hints=(
        "If the ray is longer than `most`, replace its end by origin + most * direction first.",
        "All of on_the_way(...) but its last row is passed; the last is hit, or left out.",
    ),
    tested_on="30 random rays, half of them longer than the range",
)


def _beliefs(rng: np.random.Generator) -> list[tuple]:
    values = [*rng.uniform(L_MIN, L_MAX, 30), L_MIN, L_MAX, np.nan, 0.0, 0.05, -0.05]
    return [(float(value), occupied) for value in values for occupied in (True, False)]


def _needs(log_odds: float, occupied: bool) -> float:
    """Looks as a number with a fraction; 0 where the map says so already."""
    if np.isnan(log_odds):
        return 1.0
    if occupied:
        return max(-log_odds / HIT, 0.0)
    return max(log_odds / -MISS, 0.0)


LOOKS = Exercise(
    number="9.6",
    title="How many looks",
    reference=looks_until,
    cases=_beliefs,
    oracle="counted_look_by_look",
    mistakes={
        "five for all: that is the most, for a voxel that was at l_max": (
            lambda log_odds, occupied: 2 if occupied else 5
        ),
        "looks come whole: half a look changes nothing": _needs,
        "it rounds down: the last look counts as well": (
            lambda log_odds, occupied: int(_needs(log_odds, occupied))
        ),
        "it rounds to the nearest: a map one look short still says the old thing": (
            lambda log_odds, occupied: round(_needs(log_odds, occupied))
        ),
        "at exactly 0 a voxel still counts as occupied: it takes one more miss": (
            lambda log_odds, occupied: int(np.ceil(_needs(log_odds, occupied)))
        ),
        "one where the map says so already: that takes none": (
            lambda log_odds, occupied: max(int(looks_until(log_odds, occupied)), 1)
        ),
        "a hit and a miss weigh differently: 1.39 towards occupied, 0.80 towards free": (
            lambda log_odds, occupied: int(looks_until(log_odds, occupied, hit=-MISS))
        ),
        "an unknown voxel has no log-odds yet: one look settles it": (
            lambda log_odds, occupied: (
                0 if np.isnan(log_odds) else int(looks_until(log_odds, occupied))
            )
        ),
        "occupied and free are exchanged": (
            lambda log_odds, occupied: int(looks_until(log_odds, not occupied))
        ),
    },
    hints=(
        "From -2 with 1.39 a look: -0.61, 0.78, two looks. From 3.48 with -0.80: count them.",
        "int(np.ceil(-l / 1.39)) for occupied; int(l // 0.80) + 1 for free, if l is 0 or more.",
    ),
    tested_on="36 voxels, unknown ones and those at the limits too, both ways",
)

EXERCISES = (LOOK, RAY, LOOKS)
