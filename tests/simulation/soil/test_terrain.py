from math import pi, radians, tan

import numpy as np
import pytest

from backhoe.simulation.soil.ground import Terrain

REPOSE = radians(34)
STEEPEST = tan(REPOSE) * 1.006


def steepness(terrain):
    """Length of the downhill gradient of each cell, shape (ny, nx) [1]."""
    falls = []
    for h in (terrain.heights, terrain.heights.T):
        rim = np.full((1, h.shape[1]), np.inf)
        lower = np.minimum(np.vstack([rim, h[:-1]]), np.vstack([h[1:], rim]))
        falls.append(np.maximum(h - lower, 0.0))
    return np.hypot(falls[0], falls[1].T) / terrain.cell


def rough(seed=0, shape=(40, 50), height=3.0):
    return np.random.default_rng(seed).uniform(0, height, shape)


def test_height_at_is_exact_on_a_plane():
    x, y = np.meshgrid(2 + 0.1 * np.arange(30), -1 + 0.1 * np.arange(20))
    terrain = Terrain(0.3 * x - 0.2 * y, 0.1, (2.0, -1.0))
    points = np.random.default_rng(0).uniform([2, -1], [4.9, 0.9], (200, 2))
    assert np.allclose(terrain.height_at(points), points @ [0.3, -0.2], atol=1e-12)


def test_height_at_reaches_the_outermost_cells():
    terrain = Terrain([[0.0, 1.0], [2.0, 3.0]], 0.5)
    corners = [[0, 0], [0.5, 0], [0, 0.5], [0.5, 0.5], [0.25, 0.25]]
    assert terrain.height_at(corners).tolist() == [0, 1, 2, 3, 1.5]


def test_volume_is_height_times_area():
    assert Terrain(np.full((10, 20), 0.5), 0.1).volume == pytest.approx(10 * 20 * 0.5 * 0.01)


def test_relaxing_keeps_the_volume_and_leaves_no_slope_above_repose():
    terrain = Terrain(rough(), 0.1)
    before = terrain.volume
    assert steepness(terrain).max() > 10
    terrain.relax(REPOSE)
    assert terrain.settled
    assert terrain.volume == pytest.approx(before, rel=1e-12)
    assert steepness(terrain).max() <= STEEPEST


def test_steepness_is_the_downhill_gradient():
    slope = Terrain(np.add.outer(0.3 * np.arange(5), 0.4 * np.arange(6)), 0.5)
    assert steepness(slope)[1:, 1:] == pytest.approx(np.full((4, 5), 1.0))
    assert steepness(slope)[0, 0] == 0


def test_relaxing_leaves_gentle_slopes_as_they_are():
    x = np.arange(40) * 0.1
    gentle = np.tile(tan(radians(30)) * x, (30, 1))
    terrain = Terrain(gentle, 0.1)
    assert terrain.relax(REPOSE) == 0
    assert np.array_equal(terrain.heights, gentle)


def poured(volume, cell):
    terrain = Terrain.flat((0, 6), (0, 6), cell)
    terrain.lay((3.0, 3.0), (3.0, 3.0), volume)
    terrain.relax(REPOSE)
    return terrain


def test_a_poured_cone_stands_at_the_angle_of_repose_in_all_directions():
    cone = poured(4.0, 0.08)
    for angle in np.linspace(0, 2 * pi, 24, endpoint=False):
        along = np.array([np.cos(angle), np.sin(angle)])
        inner, outer = cone.height_at(np.array([3.0, 3.0]) + np.outer([0.4, 1.2], along))
        assert (inner - outer) / 0.8 == pytest.approx(tan(REPOSE), rel=0.05)


def test_a_poured_cone_comes_nearer_to_the_cone_of_its_volume_on_a_finer_grid():
    volume = 2.0
    height = (3 * volume * tan(REPOSE) ** 2 / pi) ** (1 / 3)
    coarse, fine = (abs(poured(volume, cell).top - height) for cell in (0.1, 0.05))
    assert fine < 0.7 * coarse < 0.1 * height


def test_soil_slides_down_to_the_floor_and_no_deeper():
    floor = np.zeros((30, 30))
    floor[10:20, 10:20] = 1.0
    terrain = Terrain(np.maximum(floor, 0.2), 0.1, floor=floor)
    before = terrain.volume
    terrain.relax(REPOSE)
    assert (terrain.heights >= floor).all()
    assert (terrain.heights[10:20, 10:20] == 1.0).all()
    assert terrain.volume == pytest.approx(before, rel=1e-12)


def test_relaxing_in_short_turns_ends_as_steep_as_in_one():
    terrain = Terrain(rough(3), 0.1)
    while not terrain.settled:
        assert terrain.relax(REPOSE, sweeps=3) <= 3
    assert steepness(terrain).max() <= STEEPEST


def test_relaxing_is_repeatable_bit_for_bit():
    one, two = Terrain(rough(5), 0.1), Terrain(rough(5), 0.1)
    one.relax(REPOSE)
    two.relax(REPOSE)
    assert np.array_equal(one.heights, two.heights)


@pytest.mark.parametrize("x, y", [(1.0, 1.0), (0.0, 0.0), (0.03, 1.99)])
def test_a_volume_that_is_laid_is_there_even_at_the_rim(x, y):
    terrain = Terrain.flat((0, 2), (0, 2), 0.1)
    assert terrain.lay((1.0, 1.0), (x, y), 0.7) == 0.0
    assert terrain.volume == pytest.approx(0.7, rel=1e-12)


def test_what_falls_beside_the_map_or_below_the_soil_is_given_back():
    terrain = Terrain.flat((0, 2), (0, 2), 0.1)
    assert terrain.lay((1.0, 1.0), (9.0, 1.0), 0.7) == pytest.approx(0.7 * 11 / 13)
    assert terrain.lay((1.0, 0.2), (1.0, 0.2), 0.7, from_height=-0.1) == pytest.approx(0.7)
    assert terrain.volume == pytest.approx(0.7 * 2 / 13)


def test_nobody_else_writes_the_heights():
    terrain = Terrain.flat((0, 2), (0, 2), 0.1)
    for array in (terrain.heights, terrain.floor, terrain.ceiling):
        with pytest.raises(ValueError, match="read-only"):
            array[3, 3] = 1.0


def test_a_heap_has_the_volume_of_its_cone():
    terrain = Terrain.flat((0, 6), (0, 6), 0.04).with_heap(3, 3, 1.0, 2.0)
    assert terrain.volume == pytest.approx(pi * 4 / 3, rel=1e-3)


def test_a_cell_of_any_type_of_number_is_kept_as_a_float():
    terrain = Terrain(np.zeros((3, 3)), np.float32(0.25))
    assert type(terrain.cell) is float and terrain.cell == 0.25


def test_a_bed_has_its_inside_measures():
    bed = Terrain.bed((0.8, 5.3), 4.4, 2.3, floor=1.1, wall=1.9)
    x, y = bed.grid()
    inside = bed.heights == 1.1
    assert bed.volume == 0
    assert inside.sum() * bed.cell**2 == pytest.approx(4.4 * 2.3, rel=0.03)
    assert x[inside].mean() == pytest.approx(0.8)
    assert y[inside].mean() == pytest.approx(5.3)
    assert (bed.heights[~inside] == 1.9).all()


def test_the_version_counts_changes():
    terrain = Terrain(rough(), 0.1)
    seen = [terrain.version]
    for change in (
        lambda: terrain.relax(REPOSE),
        lambda: terrain.lay((1, 1), (2, 1), 0.5),
        lambda: terrain.restore(terrain.snapshot()),
    ):
        change()
        seen.append(terrain.version)
    assert seen == sorted(set(seen))
    terrain.relax(REPOSE)
    settled = terrain.version
    terrain.relax(REPOSE)
    assert terrain.version == settled


def test_a_snapshot_brings_back_heights_and_what_is_still_sliding():
    terrain = Terrain(rough(), 0.1)
    terrain.relax(REPOSE, sweeps=5)
    kept = terrain.snapshot()
    terrain.relax(REPOSE)
    end = terrain.heights.copy()
    terrain.restore(kept)
    assert not np.array_equal(terrain.heights, end)
    terrain.relax(REPOSE)
    assert steepness(terrain).max() <= STEEPEST


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: Terrain(np.zeros(5), 0.1), r"heights must have shape \(ny, nx\)"),
        (lambda: Terrain(np.zeros((1, 5)), 0.1), "2 by 2"),
        (lambda: Terrain(np.full((3, 3), np.nan), 0.1), "heights must be finite"),
        (lambda: Terrain(np.zeros((3, 3)) + 1j, 0.1), "heights must be numbers"),
        (lambda: Terrain("hilly", 0.1), "heights must be numbers"),
        (lambda: Terrain(np.zeros((3, 3)), 0.1, "ab"), "origin must be numbers"),
        (lambda: Terrain(np.zeros((3, 3)), 0.0), "cell must be one number above 0"),
        (lambda: Terrain(np.zeros((3, 3)), float("nan")), "cell must be one number above 0"),
        (lambda: Terrain(np.zeros((3, 3)), 0.1, (0, np.inf)), "origin must be"),
        (
            lambda: Terrain(np.zeros((3, 3)), 0.1, floor=np.zeros((2, 3))),
            r"floor must have shape \(3, 3\)",
        ),
        (lambda: Terrain(np.zeros((3, 3)), 0.1, floor=np.ones((3, 3))), "below the floor"),
        (lambda: Terrain.flat((1, 0), (0, 1), 0.1), "rising ranges"),
        (lambda: Terrain.bed((0, 0), 4, 2, floor=1.0, wall=1.0), "wall must be one number above 1"),
        (lambda: Terrain.bed((0, 0), 0.1, 2, floor=1.0, wall=2.0), "at least 2 cells"),
        (
            lambda: Terrain.flat((0, 1), (0, 1), 0.1).with_heap(0, 0, 1, 0),
            "radius must be one number above 0",
        ),
    ],
)
def test_a_terrain_of_bad_numbers_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize(
    "use, message",
    [
        (lambda t: t.height_at([0.5, 1.5]), "off the map"),
        (lambda t: t.height_at([0.5, np.nan]), "off the map"),
        (lambda t: t.height_at([1.0, 2.0, 3.0]), "points must end in 2 x, y"),
        (lambda t: t.relax(0.0), "repose must be one number above 0 and below 1.57"),
        (lambda t: t.relax(2.0), "repose must be one number above 0 and below 1.57"),
        (
            lambda t: t.restore(Terrain(np.zeros((3, 3)), 1.0).snapshot()),
            "the snapshot's heights must have shape",
        ),
    ],
)
def test_bad_use_of_a_terrain_is_refused(use, message):
    terrain = Terrain.flat((0, 1), (0, 1), 0.1)
    with pytest.raises(ValueError, match=message):
        use(terrain)
    assert terrain.volume == 0
