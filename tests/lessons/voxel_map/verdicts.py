"""What decides each verdict on sections 5.3, 5.4 and 5.6 of Mastalli: properties and forms."""

import inspect
from functools import cache
from math import ceil, degrees

import numpy as np
from scipy.special import expit, logit

from backhoe import simulation
from backhoe.lessons import published
from backhoe.lessons.voxel_map.yard import Yard
from backhoe.machine.sensors import LASERS, STEREO
from backhoe.perception.cloud import box, self_filter, shadow_filter, voxel_grid
from backhoe.perception.octree import OccupancyOctree, updated
from backhoe.simulation.scanning import pose_now
from backhoe.simulation.sight import Sight
from backhoe.view.appearance import truck_visuals

SECTION = published.load("mastalli_2013_section_53")
WIDE = {"l_min": -1e9, "l_max": 1e9}


def _looks(count):
    """Random cases of two independent looks: prior, and likelihoods (occupied, free) of each."""
    rng = np.random.default_rng(51)
    return rng.uniform(0.1, 0.9, count), rng.uniform(0.1, 0.9, (count, 2, 2))


def _given(likelihood, prior):
    """P(n | one look), by counting the two cases."""
    both = likelihood * np.stack([prior, 1 - prior], axis=-1)
    return both[..., 0] / both.sum(axis=-1)


# (5.1), (5.2): one voxel, judged on the joint probability of state and looks


def posterior_is_that_of_the_joint(form):
    prior, likelihoods = _looks(200)
    first, second = (_given(likelihoods[:, k], prior) for k in range(2))
    exact = _given(likelihoods.prod(axis=1), prior)
    assert np.allclose(form(second, first, prior), exact, atol=1e-12)


def posterior(look, before, prior):
    odds = look / (1 - look) * before / (1 - before) * (1 - prior) / prior
    return odds / (1 + odds)


def sum_is_the_joint_for_an_even_prior(form):
    _, likelihoods = _looks(200)
    even = np.full(200, 0.5)
    first, second = (logit(_given(likelihoods[:, k], even)) for k in range(2))
    exact = logit(_given(likelihoods.prod(axis=1), even))
    assert np.allclose([form(a, b) for a, b in zip(second, first, strict=True)], exact, atol=1e-9)


def sum_of_the_library(look, before):
    return updated(before, look > 0, hit=abs(look), miss=-abs(look), **WIDE)


def printed_52(look, before):
    return look + before


def product_of_log_odds(look, before):
    return look * before


def so_many_misses_free_a_voxel(form):
    for hits in range(1, 40):
        odds, misses = 1.39 * hits, 0
        while odds >= 0:
            odds, misses = odds - 0.80, misses + 1
        assert ceil(form(hits)) == misses


def looks_by_the_ratio(hits):
    return hits * 1.39 / 0.80


# (5.3), (5.6): the clamped sum and its numbers


def sum_is_kept_between_its_thresholds(form):
    rng = np.random.default_rng(53)
    for look, before in rng.uniform(-4, 4, (200, 2)):
        found, plain = form(look, before, -2.0, 3.48), look + before
        if -2.0 <= plain <= 3.48:
            assert np.isclose(found, plain)
        else:
            assert found == (3.48 if plain > 0 else -2.0)


def clamped_sum(look, before, l_min, l_max):
    return updated(before, look > 0, hit=abs(look), miss=-abs(look), l_min=l_min, l_max=l_max)


def printed_53(look, before, l_min, l_max):
    return max(min(look + before, l_max), l_min)


def thresholds_exchanged(look, before, l_min, l_max):
    return max(min(look + before, l_min), l_max)


def thresholds_have_their_names(form):
    numbers = {name: SECTION["octree"][name] for name in form}
    assert min(numbers, key=numbers.get) == {word: name for name, word in form.items()}["minimum"]


NAMES = {"l_min": "minimum", "l_max": "maximum"}


def reflection_is_for_and_passage_against(form):
    assert abs(expit(form(True)) - 0.80) < 0.005 and abs(expit(form(False)) - 0.31) < 0.005


def what_the_library_adds(reflected):
    return float(updated(np.nan, reflected))


def printed_56(reflected):
    return SECTION["octree"]["l_occ" if reflected else "l_free"]


def passage_for_and_reflection_against(reflected):
    return printed_56(not reflected)


def probabilities_are_those_of_the_numbers(form):
    for name, p in form.items():
        assert abs(np.log(p / (1 - p)) - SECTION["octree"][name]) < 0.05


PROBABILITIES = {name: float(expit(SECTION["octree"][name])) for name in NAMES | {"l_occ": 0}}
COMPLEMENTS = {"l_occ": 0.80, "l_free": 0.20, "l_min": 0.12, "l_max": 0.97}


def nodes_fall_with_the_thresholds(form):
    """Twelve scans of a room from one place, with three pairs of thresholds."""
    rng, sizes = np.random.default_rng(54), []
    ways = rng.normal(size=(12, 4000, 3))
    low, high = np.array([-3.0, -2.0, -1.0]), np.array([3.0, 2.5, 1.5])
    times = (np.where(ways > 0, high, low) / ways).min(axis=-1)
    for scale in (0.5, 2.0, 100.0):
        tree = OccupancyOctree(0.1, l_min=-scale, l_max=scale)
        for way, t in zip(ways, times, strict=True):
            tree.insert_scan(t[:, None] * way, [0.01, 0.02, 0.03])
        sizes.append(tree.size)
    assert (np.sign(np.diff(sizes)) == form).all()


NODES_GROW_WITH_THE_THRESHOLDS = 1
PRINTED_COMPACTION = 1
NODES_FALL_AS_THRESHOLDS_GROW = -1


# (5.4), (5.5): a node and its eight parts


def _parts():
    rng = np.random.default_rng(55)
    return 0.5 * rng.choice([-3, -2, -1, 1, 2, 3], (20, 8))


def _in_the_map(parts, policy):
    """What the library's map says of a node whose parts were told so."""
    tree = OccupancyOctree(0.1, hit=0.5, miss=-0.5, **WIDE)
    for k, part in enumerate(parts):
        middle = 0.05 + 0.1 * np.array([k & 1, k >> 1 & 1, k >> 2])
        beside = middle + np.array([0.0, 0.0, -0.1 if k < 4 else 0.1])
        for _ in range(round(abs(part) / 0.5)):
            tree.insert_scan([middle if part > 0 else beside], middle)
    return float(tree.log_odds([0.1, 0.1, 0.1], 15, policy))


def parts_lie_about_it_in_balance(form):
    for parts in _parts():
        assert abs(np.sum(parts - form(parts))) < 1e-5


def mean_in_the_map(parts):
    return _in_the_map(parts, "mean")


def printed_54(parts):
    return sum(parts) / 8


def sum_of_the_parts(parts):
    return sum(parts)


def probability_is_the_mean_of_its_parts(form):
    for parts in _parts():
        assert abs(expit(form(parts)) - expit(parts).mean()) < 1e-9


def log_odds_of_the_mean_probability(parts):
    return logit(expit(np.asarray(parts)).mean())


def mean_taken_for_occupancy(parts):
    return sum(parts) / 8


def no_part_is_more_occupied_than_the_node(form):
    for parts in _parts():
        found = form(parts)
        assert (found >= parts - 1e-6).all() and np.abs(found - parts).min() < 1e-6


def largest_in_the_map(parts):
    return _in_the_map(parts, "max")


def printed_55(parts):
    return max(parts)


def least_of_the_parts(parts):
    return min(parts)


# Section 5.3: filters


def wall_that_faces_the_laser_is_kept_and_a_shadow_is_not(form):
    """A line across a near wall, one point half way in the air, and a wall behind."""
    angles = np.radians(np.arange(-40, 40))
    ranges = np.where(angles < 0, 4.0, 8.0) / np.cos(angles)
    ranges[40] = 6.0
    points = np.stack([ranges * np.cos(angles), ranges * np.sin(angles), 0 * ranges], axis=1)
    angles = {name: np.radians(form[name]) for name in ("least", "most")}
    keep = shadow_filter(points, [0, 0, 0], **angles)
    assert not keep[40] and keep.mean() > 0.9


ANGLES = {
    name: degrees(inspect.signature(shadow_filter).parameters[name].default)
    for name in ("least", "most")
}


def it_says_all_that_the_filter_needs(form):
    assert set(form) == set(inspect.signature(shadow_filter).parameters) - {"points", "origin"}


SETTINGS = ("least", "most", "neighbours")


@cache
def _scan():
    return Yard(seed=0).scan(1.0)


def reduction_can_be_made_again(form):
    points = _scan()
    assert form.get("leaf") and form["before"] == len(points)
    assert form["after"] == len(voxel_grid(points, form["leaf"]))


OUR_REDUCTION = {
    "before": len(_scan()),
    "leaf": 0.5,
    "after": len(np.unique(np.floor(_scan() / 0.5), axis=0)),
}


def arm_that_swings_is_filtered_whole(form):
    """An arm of 7 m that swings with 0.5 rad/s; the clock of its encoders is 50 ms late."""
    rng = np.random.default_rng(56)
    side = np.stack([rng.uniform(1, 7, 2000), np.full(2000, 0.25), rng.uniform(-0.2, 0.2, 2000)])
    angle = 0.5 * 0.05
    T = np.eye(4)
    T[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    points = side.T @ T[:3, :3].T + LASERS["left"].noise * rng.standard_normal((2000, 3))
    arm = {"arm": [box([1.0, -0.25, -0.2], [7.0, 0.25, 0.2])]}
    assert not self_filter(points, arm, {"arm": np.eye(4)}, form).any()


PADDING_WITH_A_LATE_CLOCK = 0.05 + 7.0 * 0.5 * 0.05


# Section 5.4: representations, results


def _column(kind):
    """Which heights of ground and bridge a representation calls occupied."""
    heights = np.arange(0.05, 4.0, 0.1)
    seen = heights[(heights < 0.2) | ((heights > 3.0) & (heights < 3.4))]
    if kind == "elevation map":
        return heights, seen, heights <= seen.max()
    if kind == "multi-level surfaces":
        breaks = np.flatnonzero(np.diff(seen) > 0.5) + 1
        layers = [(part[0], part[-1]) for part in np.split(seen, breaks)]
        return heights, seen, np.any([(heights >= a) & (heights <= b) for a, b in layers], axis=0)
    tree = OccupancyOctree(0.1)
    for height in seen:
        tree.insert_scan([[0.05, 0.05, height]], [0.05, 0.05, height])
    column = np.c_[np.full((len(heights), 2), 0.05), heights]
    return heights, seen, tree.log_odds(column) >= 0


def bridge_is_shown_with_its_gap(form):
    for kind, claimed in form.items():
        heights, seen, occupied = _column(kind)
        assert claimed == np.array_equal(occupied, np.isin(heights, seen))


OVERHANG = {"elevation map": False, "multi-level surfaces": True, "octree": True}


class _Hashed:
    """Voxels in a dictionary: no tree."""

    def __init__(self, resolution):
        self.resolution, self.voxels = resolution, {}

    def tell(self, keys, reflected):
        for key, hit in zip(map(tuple, keys), reflected, strict=True):
            self.voxels[key] = float(updated(self.voxels.get(key, np.nan), hit))

    def log_odds(self, keys, level):
        largest = {}
        for key, odds in self.voxels.items():
            above = tuple(k >> level for k in key)
            largest[above] = max(largest.get(above, -np.inf), odds)
        return np.array([largest.get(tuple(k >> level for k in key), np.nan) for key in keys])


@cache
def _fulfil_all():
    """Free and unknown apart, updated, several sizes; a tenth of a cube of voxels about it."""
    rng, tree, table = np.random.default_rng(57), OccupancyOctree(0.25), _Hashed(0.25)
    axis = np.arange(-40, 40)
    keys = np.stack(np.meshgrid(axis, axis, axis[36:44]), axis=-1).reshape(-1, 3)
    for far in (8.0, 8.0, 5.0):
        angle = rng.uniform(0, 2 * np.pi, 300)
        ends = np.c_[far * np.cos(angle), far * np.sin(angle), rng.uniform(-0.8, 0.8, 300)]
        fresh = OccupancyOctree(0.25)
        for one in (tree, fresh):
            one.insert_scan(ends, [0.1, 0.1, 0.1])
        told = fresh.log_odds((keys + 0.5) * 0.25)
        table.tell(keys[~np.isnan(told)], told[~np.isnan(told)] > 0)
    kept = {"octree"}
    same = all(
        np.allclose(
            tree.log_odds((keys + 0.5) * 0.25, 16 - level),
            table.log_odds(keys, level),
            equal_nan=True,
            atol=1e-5,
        )
        for level in (0, 1, 2)
    )
    if same and 10 * len(table.voxels) < 4 * 80**3 / 10:
        kept.add("hashed voxels")
    return kept


def all_that_fulfil_the_list_are_named(form):
    assert set(form) == _fulfil_all()


THOSE_THAT_FULFIL = ("octree", "hashed voxels")


def heap_is_left(form):
    """All points of the scan that lie on the heap, its foot too."""
    points = _scan()
    heap = simulation.LOADING.heaps[0]
    on_it = np.hypot(points[:, 0] - heap.x, points[:, 1] - heap.y) < 0.95 * heap.radius
    near = np.linalg.norm(points, axis=1) < 20
    assert form(points)[on_it & near].all()


def everything_is_kept(points):
    return np.ones(len(points), bool)


@cache
def _share_of_the_truck_seen():
    """Of all places on the truck that some eye around it sees, those that the machine's see."""
    world = simulation.open_world(backend="analytic")
    sight, rng = Sight(world), np.random.default_rng(58)
    corners = np.concatenate(
        [part.vertices[np.asarray(part.faces)] for part in truck_visuals(world.scene.truck)]
    )
    a, b, c = np.moveaxis(corners, 1, 0)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    pick = rng.choice(len(areas), 1500, p=areas / areas.sum())
    u, v = rng.random((2, 1500, 1))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    places = a[pick] + u * (b - a)[pick] + v * (c - a)[pick]

    def sees(eye):
        way = places - eye
        far = np.linalg.norm(way, axis=1)
        hits = sight.cast(np.tile(eye, (len(way), 1)), way / far[:, None])
        return hits.t > far - 0.01

    turn = np.arange(12) * np.pi / 6
    around = np.c_[0.8 + 9 * np.cos(turn), 5.3 + 9 * np.sin(turn)]
    eyes = [np.append(place, z) for place in around for z in (0.6, 2.0, 6.0)]
    could = np.any([sees(eye) for eye in eyes], axis=0)
    mounts = [LASERS["left"].mount, LASERS["right"].mount, STEREO.mount]
    does = np.any([sees(pose_now(world, mount)[:3, 3]) for mount in mounts], axis=0)
    return (could & does).sum() / could.sum()


def share_of_the_truck_is_what_is_seen(form):
    assert abs(form - _share_of_the_truck_seen()) < 0.03


SEEN_OF_THE_TRUCK = 0.28
