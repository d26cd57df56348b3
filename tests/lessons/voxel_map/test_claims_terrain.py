"""What lesson 09c says in strong words."""

import numpy as np
import pytest
from scipy.stats import norm

from backhoe.machine.sensors import LASERS
from backhoe.perception.distance_field import DistanceField, clearance
from backhoe.perception.terrain_map import TerrainMap, dug_volume, is_soil, surface_levels


def looks_until_near(before, step=0.3, near=0.02):
    """Looks without noise until the average of all is near the new ground."""
    heights = np.r_[np.zeros(before), np.full(4000, step)]
    average = np.cumsum(heights) / np.arange(1, len(heights) + 1)
    return int(np.argmax(average[before:] > step - near)) + 1


def test_an_average_of_more_looks_is_later_in_proportion():
    late = [looks_until_near(before) for before in (10, 30, 100)]
    assert late == pytest.approx([140, 420, 1400], rel=0.01)


def test_chance_passes_the_gate_in_one_look_of_sixteen_thousand():
    assert 2 * norm.sf(4.0) == pytest.approx(1 / 16_000, rel=0.02)
    rng, ground = np.random.default_rng(0), TerrainMap((0, 0), 200, 200, 1.0, roughness=0.01)
    x, y = ground.grid()
    begun = 0
    for k in range(30):
        z = 0.01 * rng.normal(size=x.shape)
        points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
        begun += ground.insert(points, [0, 0, 9], k, range_deviation=0.0)
    assert 40 < begun < 110  # 73 are expected of 1.16 million


def test_a_lift_of_a_centimetre_under_eight_square_metres_is_eighty_litres():
    rng, found = np.random.default_rng(1), []
    inside = np.ones((40, 31), bool)  # 7.9 m^2 of cells of 8 cm
    for points in (1, 100):
        maps = []
        for _ in range(2):
            ground = TerrainMap((0, 0), 40, 31, 0.08)
            grid = np.tile(np.stack([*ground.grid(), 0 * inside], -1).reshape(-1, 3), (points, 1))
            grid[:, 2] += 0.01 * rng.normal(size=len(grid))
            ground.insert(grid, [0, 0, 3], range_deviation=0.0)
            maps.append(ground)
        C = np.diag([0, 0, 0.01**2, 0, 0, 0, 0])
        volume = dug_volume(*maps, inside, [[0, 0, 3]] * 2, C)
        assert volume.common == pytest.approx(0.080 * 2**0.5, rel=0.02)
        found.append((volume.cells, volume.deviation))
    assert found[1][0] < found[0][0] / 9 and found[1][1] > 0.99 * found[0][1]


def test_one_height_fills_the_air_under_a_bed_and_many_surfaces_keep_it():
    x, y = np.meshgrid(np.arange(0.05, 4, 0.1), np.arange(0.05, 4, 0.1))
    sheets = [np.stack([x, y, np.full_like(x, z)], axis=-1).reshape(-1, 3) for z in (0.0, 1.1)]
    points = np.concatenate(sheets)
    many, one = surface_levels(points, 0.1), surface_levels(points, 0.1, gap=100.0)
    assert not ((many.low < 0.7) & (many.high > 0.7)).any()
    assert ((one.low < 0.7) & (one.high > 0.7)).all()


def test_a_bed_seen_across_its_wall_only_passes_for_a_hill():
    x, y = np.meshgrid(np.arange(-6, 6, 0.05), np.arange(-4, 4, 0.05))
    bed = (np.abs(x) < 2.2) & (np.abs(y) < 1.2)
    points = np.stack([x, y, np.where(bed, 1.1, 0.0)], axis=-1)
    around, beyond = points.reshape(-1, 3), points[~((y > -1.2) & ~bed)]
    in_bed = lambda cloud: (np.abs(cloud[:, :2]) < [2.0, 1.1]).all(axis=1) & (cloud[:, 2] > 1)  # noqa: E731
    assert is_soil(around)[in_bed(around)].mean() == 0.0
    assert is_soil(beyond)[in_bed(beyond)].mean() > 0.2


def test_a_range_that_errs_lifts_a_grazing_point_by_a_tenth():
    assert LASERS["left"].most == 30.0
    point = np.array([30.0, 0.0, 0.0])
    for eye, share in (([30.0, 0.0, 3.4], 1.0), ([0.0, 0.0, 3.4], 0.11)):
        ground = TerrainMap((30, 0), 1, 1, 0.1, roughness=0.0)
        ground.insert(point[None], eye, range_deviation=0.01)
        assert ground.variance[0, 0] ** 0.5 == pytest.approx(0.01 * share, rel=0.03)


def test_the_true_gap_is_larger_than_the_clearance_less_a_voxels_diagonal():
    rng = np.random.default_rng(2)
    for _ in range(200):
        occupied = rng.uniform(size=(12, 12, 12)) < 0.01
        occupied[0, 0, 0] = True
        field = DistanceField(occupied, 0.1, [0.05, 0.05, 0.05])
        middle, radius = rng.uniform(0.1, 1.1, 3), rng.uniform(0.0, 0.3)
        T = np.eye(4)
        T[:3, 3] = middle
        found = clearance(field, {"stick": [[0, 0, 0, radius]]}, {"stick": T})
        cubes = np.argwhere(occupied) * 0.1
        nearest = np.clip(middle, cubes, cubes + 0.1)
        true = np.linalg.norm(nearest - middle, axis=1).min() - radius
        assert true >= found.distance - 0.1 * 3**0.5 - 1e-12
