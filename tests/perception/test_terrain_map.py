"""The terrain map: Kalman's step a cell, what is dug, soil and things, and an honest volume."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from backhoe.perception.rays import HeightField, RayCaster
from backhoe.perception.terrain_map import (
    TerrainMap,
    dug_volume,
    engine,
    is_soil,
    loops,
    shared_errors,
    surface_levels,
)

RNG = np.random.default_rng
ORIGIN = np.array([0.0, 0.0, 3.0])
COMMON = np.array([0.01, 0.01, 0.01, 0.002, 0.002, 0.002, 0.01])
"""Standard deviations of a scan's common errors [m, rad, m]."""


def flat(count=4, **how):
    return TerrainMap((1.0, -0.5), count, count + 1, 0.5, **how)


def over(ground, height=0.0, times=1):
    """Points in the middle of each cell."""
    x, y = ground.grid()
    return np.tile(np.stack([x, y, height + 0 * x], axis=-1).reshape(-1, 3), (times, 1))


class TestACell:
    def test_an_unseen_cell_is_nan_and_a_seen_one_has_the_mean_of_its_points(self):
        ground = flat(roughness=0.0)
        points = [[1.1, -0.4, 0.2], [0.9, -0.6, 0.4], [3.1, 0.9, 7.0]]
        ground.insert(points, ORIGIN)
        assert ground.heights[0, 0] == pytest.approx(0.3)
        assert ground.heights[3, 4] == 7.0
        assert np.isnan(ground.heights).sum() == np.isnan(ground.variance).sum() == 18

    def test_its_variance_is_that_of_the_mean_of_ranges_seen_at_that_angle(self):
        rng, found = RNG(1), []
        x, slope, o = np.array([2.0, 0.0]), np.array([0.3, -0.2]), np.array([0.2, 0.4, 1.5])
        u = np.array([*x, slope @ x]) - o
        for _ in range(4000):
            ground = flat(roughness=0.0)
            grid = over(ground)
            grid[:, 2] = grid[:, :2] @ slope
            way = np.linalg.norm(grid - o, axis=1, keepdims=True)
            grid = np.repeat(grid, 5, axis=0)
            away = (grid - o) / np.repeat(way, 5, axis=0)
            noise = 0.01 * rng.normal(size=(len(grid), 1))
            lifted = (grid + noise * away) @ np.array([-slope[0], -slope[1], 1.0])
            lifted = np.column_stack([grid[:, :2], lifted + grid[:, :2] @ slope])
            ground.insert(lifted, o, range_deviation=0.01)
            found.append(ground.heights[1, 2])
        u = u / np.linalg.norm(u)
        wanted = 0.01**2 * (u[2] - slope @ u[:2]) ** 2 / 5
        ground = flat(roughness=0.0)
        ground.insert(np.repeat(over_slope(ground, slope), 5, axis=0), o, range_deviation=0.01)
        assert ground.variance[1, 2] == pytest.approx(wanted, rel=1e-9)
        assert np.var(found) == pytest.approx(wanted, rel=0.1)

    def test_points_beside_its_middle_are_brought_there_along_the_slope(self):
        ground, rng = TerrainMap((0, 0), 20, 20, 0.1), RNG(2)
        xy = rng.uniform(-0.05, 1.95, (20_000, 2))
        ground.insert(np.column_stack([xy, xy @ [0.7, -0.4]]), ORIGIN)
        x, y = ground.grid()
        assert np.std(ground.heights - (0.7 * x - 0.4 * y)) < 4e-4  # 3e-3 without

    def test_measurements_are_weighed_by_their_information(self):
        ground = flat(roughness=0.1, gate=100.0)
        for k, height in enumerate((1.0, 1.3, 1.1)):
            ground.insert(over(ground, height), ORIGIN, k, range_deviation=0.0)
        assert ground.heights == pytest.approx(np.full((4, 5), 3.4 / 3))
        assert ground.variance == pytest.approx(np.full((4, 5), 0.01 / 3))

    def test_it_forgets_with_time_when_told_to(self):
        ground = flat(growth=0.01, roughness=0.1, gate=100.0)
        ground.insert(over(ground, 0.0), ORIGIN, 0.0, range_deviation=0.0)
        ground.insert(over(ground, 1.0), ORIGIN, 3.0, range_deviation=0.0)
        assert ground.heights[0, 0] == pytest.approx(0.04 / 0.05)
        assert (ground.age(5.0) == 2.0).all()

    def test_what_was_dug_is_followed_at_once_and_averaged_from_there(self):
        ground = flat(roughness=0.02)
        for k in range(30):
            ground.insert(over(ground, 1.0), ORIGIN, k, range_deviation=0.0)
        dug = over(ground, 1.0)
        dug[7, 2] = 0.6
        assert ground.insert(dug, ORIGIN, 30.0, range_deviation=0.0) == 1
        assert ground.heights.ravel()[7] == 0.6
        assert ground.variance.ravel()[7] == pytest.approx(0.02**2)
        assert ground.changed.ravel()[7] == 30.0 and np.sum(ground.changed == 0.0) == 19

    def test_the_gate_is_as_wide_as_said_and_wider_by_what_a_scan_has_in_common(self):
        for common in (0.0, 0.05):
            for step, changed in ((0.99, 0), (1.01, 20)):
                ground = flat(roughness=0.02, gate=3.0)
                ground.insert(over(ground), ORIGIN, range_deviation=0.0)
                up = step * 3.0 * np.sqrt(2 * 0.02**2 + common**2)
                how = {"range_deviation": 0.0, "common_deviation": common}
                assert ground.insert(over(ground, up), ORIGIN, 1.0, **how) == changed

    def test_points_beside_the_map_change_nothing(self):
        ground = flat()
        for x, y in ((0.7, 0.0), (3.3, 0.0), (2.0, -0.8), (2.0, 1.3), (1e300, -1e300)):
            assert ground.insert([[x, y, 5.0]], ORIGIN) == 0
        assert np.isnan(ground.heights).all()
        assert ground.insert(np.empty((0, 3)), ORIGIN) == 0

    def test_cells_lie_on_the_grid_of_the_scene(self):
        from backhoe.simulation import LOADING

        ground = TerrainMap(LOADING.corner, LOADING.rows, LOADING.columns, LOADING.cell)
        for mine, theirs in zip(ground.grid(), LOADING.grid(), strict=True):
            np.testing.assert_allclose(mine, theirs, atol=1e-12)


def over_slope(ground, slope):
    points = over(ground)
    points[:, 2] = points[:, :2] @ slope
    return points


def test_compiled_loops_do_what_the_plain_ones_do():
    results = []
    for loop in (loops, engine):
        rng = RNG(3)
        points = rng.normal(size=(300, 3)) * [2, 2, 0.1] + [2, 0, 0]
        state = [np.full((7, 9), np.nan) for _ in range(4)]
        for time in (0.0, 1.0):
            sums, gradient = np.zeros((7, 9, 4)), np.zeros((7, 9, 2))
            lifts = np.zeros((7, 9))
            loop.gather(points + time, 0.5, -1.5, 0.5, sums)
            loop.slopes(state[0], sums, 0.5, gradient)
            loop.lift(points + time, ORIGIN, 0.5, -1.5, 0.5, gradient, lifts)
            how = (1e-4, 1e-4, 0.0, 0.1, 3.0)
            count = loop.update(*state, sums, gradient, lifts, time, how)
        surface = np.where(np.isnan(state[0]), np.inf, state[0])
        loop.envelope(surface, 0.1)
        results.append([*state, sums, gradient, lifts, surface, count])
    for one, other in zip(*results, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12)


class TestSoil:
    def test_the_surface_that_soil_can_form_is_the_least_cone_over_all_cells(self):
        rng = RNG(4)
        lowest = rng.uniform(0, 2, (12, 15))
        lowest[rng.uniform(size=lowest.shape) < 0.5] = np.inf
        i, j = np.indices(lowest.shape)
        far, near = (
            f(np.abs(i[..., None, None] - i), np.abs(j[..., None, None] - j))
            for f in (np.maximum, np.minimum)
        )
        wanted = (lowest + 0.1 * (far - near + np.sqrt(2) * near)).min(axis=(2, 3))
        found = lowest.copy()
        engine.envelope(found, 0.1)
        np.testing.assert_allclose(found, wanted, rtol=1e-12)

    def test_a_heap_at_its_angle_of_repose_is_soil_and_a_box_on_it_is_not(self):
        rng = RNG(5)
        xy = rng.uniform(-4, 4, (40_000, 2))
        heap = np.maximum(1.5 - np.tan(0.59) * np.hypot(*xy.T), 0.0)
        box = (np.abs(xy - [3.0, 3.0]) < [0.8, 0.6]).all(axis=1)
        points = np.column_stack([xy, np.where(box, 1.0, heap)])
        points[:, 2] += 0.01 * rng.normal(size=len(points))
        found = is_soil(points)
        assert found[~box].all() and not found[box].any()

    def test_what_hangs_over_the_ground_is_no_soil(self):
        ground = np.stack(np.meshgrid(np.arange(0, 4, 0.1), np.arange(0, 4, 0.1), [0.0]), -1)
        boom = np.add(ground.reshape(-1, 3)[::7], [0, 0, 2.5])
        points = np.concatenate([ground.reshape(-1, 3), boom])
        np.testing.assert_array_equal(is_soil(points), points[:, 2] == 0)


class TestLevels:
    def test_points_within_the_gap_are_one_surface_and_others_another(self):
        points = [[0.1, 0.1, 0.0], [0.3, 0.2, 0.2], [0.2, 0.2, 2.0], [0.2, 0.2, 0.45], [-0.1, 0, 1]]
        found = surface_levels(points, 0.5, gap=0.3)
        assert found.cells.tolist() == [[-1, 0], [0, 0], [0, 0]]
        assert found.low == pytest.approx([1.0, 0.0, 2.0])
        assert found.high == pytest.approx([1.0, 0.45, 2.0])
        assert found.count.tolist() == [1, 3, 1]

    def test_no_point_is_lost(self):
        points = RNG(6).normal(size=(5000, 3))
        assert surface_levels(points, 0.3, 0.1).count.sum() == 5000


def digs(seed):
    """A heap with bumps, the same with a pit in it, and the cells around the pit."""
    rng = RNG(seed)
    x, y = np.meshgrid(2.8 + 0.08 * np.arange(81), -3.2 + 0.08 * np.arange(81))
    away = np.minimum(np.hypot(x - 6, y) / 2.5, 1)
    heap = rng.uniform(0.5, 1.2) / 2 * (1 + np.cos(np.pi * away))
    for _ in range(6):
        turn, phase, wave = rng.uniform(0, 2 * np.pi), rng.uniform(0, 6), rng.uniform(0.5, 1.5)
        along = np.cos(turn) * x + np.sin(turn) * y
        heap += 0.005 * np.sin(2 * np.pi * along / wave + phase)
    at, half = (rng.uniform(5, 6.2), rng.uniform(-0.8, 0.8)), rng.uniform(0.35, 0.8, 2) * [1.3, 1]
    within = np.minimum(np.hypot((x - at[0]) / half[0], (y - at[1]) / half[1]), 1)
    pit = rng.uniform(0.2, 0.5) * half[1] * (1 + np.cos(np.pi * within)) / 2
    inside = (np.abs(x - at[0]) < half[0] + 0.25) & (np.abs(y - at[1]) < half[1] + 0.25)
    return rng, x, y, heap, heap - pit, inside


def look(rng, x, y, heights, origin, rays, noise, errors):
    """A map of one scan whose pose and ranges err."""
    field = HeightField(heights, 0.08, (x[0, 0], y[0, 0]))
    aim = np.column_stack(
        [rng.uniform(x.min(), x.max(), rays), rng.uniform(y.min(), y.max(), rays), np.zeros(rays)]
    )
    u = (aim - origin) / np.linalg.norm(aim - origin, axis=1)[:, None]
    hits = RayCaster([field]).cast(origin, u)
    there = np.isfinite(hits.t)
    ranges = hits.t[there] + rng.normal(0, noise, there.sum()) + errors[6]
    turned = Rotation.from_rotvec(errors[3:6]).apply(ranges[:, None] * u[there])
    ground = TerrainMap((x[0, 0], y[0, 0]), *x.shape, 0.08)
    ground.insert(origin + errors[:3] + turned, origin, range_deviation=noise)
    return ground


class TestVolume:
    @pytest.fixture(scope="class")
    @staticmethod
    def runs():
        """z scores by what is known of the common errors: nothing, their sizes, and still cells."""
        found = {"naive": [], "common": [], "still": []}
        deviations = {name: [] for name in found}
        seed = 0
        while len(found["still"]) < 100:
            rng, x, y, heap, dug, inside = digs(seed)
            seed += 1
            rays, noise = int(rng.uniform(5e3, 3e4)), rng.uniform(0.005, 0.04)
            origins = [
                np.array([0.8, rng.choice([-1.2, 1.2]), rng.uniform(3, 6)]) for _ in range(2)
            ]
            maps = [
                look(rng, x, y, heights, origin, rays, noise, COMMON * rng.normal(size=7))
                for heights, origin in zip((heap, dug), origins, strict=True)
            ]
            if max(np.isnan(one.heights[inside]).mean() for one in maps) > 0.1:
                continue
            for name, known, still in (
                ("naive", 0 * COMMON, None),
                ("common", COMMON, None),
                ("still", COMMON, ~inside),
            ):
                volume = dug_volume(*maps, inside, origins, np.diag(known**2), still)
                error = volume.value - 0.08**2 * (heap - dug).sum()
                found[name].append(error / volume.deviation)
                deviations[name].append(volume.deviation)
        return {k: np.array(v) for k, v in found.items()}, deviations

    def test_its_deviation_covers_the_truth_in_90_to_99_of_100_digs(self, runs):
        for name in ("common", "still"):
            assert 90 <= (np.abs(runs[0][name]) < 1.96).sum() <= 99

    def test_independent_cells_would_cover_it_in_fewer_than_20(self, runs):
        assert (np.abs(runs[0]["naive"]) < 1.96).sum() < 20

    def test_still_ground_makes_it_ten_times_as_sure(self, runs):
        assert np.median(runs[1]["still"]) < np.median(runs[1]["common"]) / 10

    def test_common_errors_are_the_derivatives_of_heights_by_the_pose(self):
        """A smooth hill seen through a pose that errs a little: its heights, once more."""
        o = np.array([-1.0, 0.5, 2.0])

        def hill(x, y):
            return 0.3 * np.sin(0.7 * x) + 0.2 * np.cos(0.5 * y)

        ground = TerrainMap((0, -2), 41, 41, 0.05)
        x, y = ground.grid()
        found = shared_errors(hill(x, y), ground, o)
        step = 1e-5
        for k in range(7):
            moved = np.zeros(7)
            moved[k] = step
            p = np.stack([x, y, hill(x, y)], axis=-1)
            u = (p - o) / np.linalg.norm(p - o, axis=-1, keepdims=True)
            turn = Rotation.from_rotvec(moved[3:6]).as_matrix()
            q = o + moved[:3] + (p - o + moved[6] * u) @ turn.T
            wanted = (q[..., 2] - hill(q[..., 0], q[..., 1])) / step
            inner = slice(5, -5), slice(5, -5)
            np.testing.assert_allclose(found[(*inner, k)], wanted[inner], atol=0.02)

    @pytest.fixture
    def pair(self):
        """Two maps of level ground at 1 m and 0.4 m, all cells seen, variance 1e-4."""
        maps = []
        for height in (1.0, 0.4):
            ground = TerrainMap((0, 0), 21, 21, 0.1, roughness=0.01)
            ground.insert(over(ground, height), ORIGIN, range_deviation=0.0)
            maps.append(ground)
        inside = np.zeros((21, 21), bool)
        inside[5:15, 5:15] = True
        return *maps, inside

    def test_a_lift_of_the_scan_counts_with_the_area_and_a_cells_noise_with_its_root(self, pair):
        before, after, inside = pair
        lift = np.diag([0, 0, 0.02**2, 0, 0, 0, 0])
        volume = dug_volume(before, after, inside, [ORIGIN, ORIGIN], lift)
        assert volume.value == pytest.approx(0.6)
        assert volume.common == pytest.approx(1.0 * 0.02 * 2**0.5)
        assert volume.cells == pytest.approx(0.01 * 10 * 0.01 * 2**0.5)
        assert volume.deviation**2 == pytest.approx(volume.common**2 + volume.cells**2)

    def test_still_ground_takes_away_a_lift(self, pair):
        before, after, inside = pair
        after.heights += np.where(inside, 0.05, 0.65)
        lift = np.diag([0, 0, 0.5**2, 0, 0, 0, 0])
        volume = dug_volume(before, after, inside, [ORIGIN, ORIGIN], lift, ~inside)
        assert volume.value == pytest.approx(0.6, abs=1e-4)
        assert volume.common == pytest.approx(0.01 * 2**0.5 / 341**0.5, rel=1e-3)

    def test_a_gap_is_the_mean_of_its_neighbours_and_weighs_on_them(self, pair):
        before, after, inside = pair
        for one in (before, after):
            one.heights += 0.3 * one.grid()[0]
        for cell in ((8, 8), (8, 9), (9, 8)):
            after.heights[cell] = after.variance[cell] = np.nan
        volume = dug_volume(before, after, inside, [ORIGIN, ORIGIN], np.zeros((7, 7)))
        assert volume.value == pytest.approx(0.6)
        L = np.array([[4.0, -1, -1], [-1, 4, 0], [-1, 0, 4]])
        inverse = np.linalg.inv(L)
        weights = inverse.sum(axis=0) @ np.array(
            [[1, 1, 0, 0, 0, 0, 0], [0, 0, 1, 1, 1, 0, 0], [0, 0, 0, 0, 1, 1, 1]]
        )
        shares = np.r_[np.ones(100 - 3 - 7), 1 + weights]
        wanted = 0.01**2 * 0.01**2 * (100 + (shares**2).sum())
        assert volume.cells**2 == pytest.approx(wanted)
        z = after.heights[5:15, 5:15]
        steps = np.diff(z, axis=1).ravel(), np.diff(z, axis=0).ravel()
        stiffness = 2 * np.nanmean(np.concatenate(steps) ** 2)
        assert volume.gaps**2 == pytest.approx(0.01**2 * stiffness * inverse.sum())

    def test_what_it_refuses(self, pair):
        before, after, inside = pair
        known = np.zeros((7, 7)), [ORIGIN, ORIGIN]
        call = lambda b, a, mask, still=None: dug_volume(b, a, mask, known[1], known[0], still)  # noqa: E731
        with pytest.raises(TypeError, match="before"):
            call(before.heights, after, inside)
        with pytest.raises(ValueError, match="alike"):
            call(before, flat(), inside)
        with pytest.raises(ValueError, match="same corner"):
            call(before, TerrainMap((0, 1), 21, 21, 0.1), inside)
        with pytest.raises(ValueError, match="truth values"):
            call(before, after, inside.astype(int))
        with pytest.raises(ValueError, match="still"):
            call(before, after, inside, inside)
        with pytest.raises(ValueError, match="inside must have cells"):
            call(before, after, inside & False)
        after.heights[6:12, 6:12] = np.nan
        with pytest.raises(ValueError, match="36% are hidden"):
            call(before, after, inside)
        after.heights[:] = np.nan
        after.heights[5:15, 5:14] = 1.0
        lone = np.zeros_like(inside)
        lone[5:15, 5:13] = lone[0, 0] = True
        with pytest.raises(ValueError, match="no seen cell around"):
            call(before, after, lone)


@pytest.mark.parametrize(
    "function, words",
    [
        (lambda: TerrainMap((0, 0), 0, 4, 0.1), "rows"),
        (lambda: TerrainMap((0, 0), 4, 4, 0), "cell"),
        (lambda: TerrainMap((0, np.nan), 4, 4, 0.1), "corner"),
        (lambda: TerrainMap((0, 0), 10**6, 10**6, 0.1), "rows times columns"),
        (lambda: TerrainMap((0, 0), 4, 4, 0.1, gate=0), "gate"),
        (lambda: flat().insert([[0, 0, np.nan]], ORIGIN), "points must be finite"),
        (lambda: flat().insert([[0, 0]], ORIGIN), "shape"),
        (lambda: flat().insert([], ORIGIN), "shape"),
        (lambda: flat().insert([[0, 0, 0]], [0, 0, np.inf]), "origin"),
        (lambda: flat().insert([[0, 0, 0]], ORIGIN, range_deviation=-1), "range_deviation"),
        (lambda: is_soil(np.empty((0, 3))), "points"),
        (lambda: is_soil([[0, 0, 0]], steepest=2.0), "steepest"),
        (lambda: is_soil([[0, 0, 0], [1e5, 1e5, 0]], cell=1e-3), "cell must be larger"),
        (lambda: is_soil([[0, 0, 0], [1e300, 1e300, 0]], cell=1e-300), "cell must be larger"),
        (lambda: surface_levels([[0, 0, 0]], 0.0), "cell"),
        (lambda: surface_levels([[1e300, 0, 0]], 0.1), "cell must be larger"),
        (lambda: surface_levels([[0, 0, 0]], 0.1, -1), "gap"),
    ],
)
def test_what_is_refused(function, words):
    with pytest.raises(ValueError, match=words):
        function()


def test_time_does_not_run_backwards():
    ground = flat()
    ground.insert(over(ground), ORIGIN, 5.0)
    with pytest.raises(ValueError, match="time"):
        ground.insert(over(ground), ORIGIN, 4.0)
