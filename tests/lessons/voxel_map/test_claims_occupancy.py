"""What lesson 09b says in strong words, and the numbers that it prints nowhere."""

import numpy as np
import pytest
from scipy.special import expit

from backhoe.lessons.voxel_map.yard import Yard
from backhoe.perception.octree import OccupancyOctree, looks_until, updated

SIZE, MOST = 0.2, 12.0
TRUCK = [[-3.0, 3.7, 0.25], [5.6, 7.2, 3.5]]


def test_five_misses_free_a_voxel_after_any_number_of_hits_from_three_on():
    for hits in (3, 4, 10, 300, 3000):
        odds, misses = np.nan, 0
        for _ in range(hits):
            odds = updated(odds, True)
        while odds >= 0:
            odds, misses = updated(odds, False), misses + 1
        assert misses == 5


def test_three_hundred_hits_without_a_clamp_are_odds_of_ten_to_the_181():
    assert 300 * 1.39 / np.log(10) == pytest.approx(181, abs=0.5)
    minutes = looks_until(300 * 1.39, False) / 60
    assert 8.5 < minutes < 9
    assert expit([-2.0, 3.48]) == pytest.approx([0.12, 0.97], abs=0.005)


def flat(step: float) -> tuple[np.ndarray, np.ndarray]:
    """Points of flat ground, the far ones first, and the laser."""
    eye = np.array([0.1, 0.1, 3.4])
    reach = 3.35 / np.tan(np.radians(np.arange(11.5, 60, step)))
    return np.stack([0.1 + reach, 0 * reach + 0.1, 0 * reach + 0.05], axis=1), eye


def free(points: np.ndarray, eye: np.ndarray, rule: str) -> float:
    tree = OccupancyOctree(SIZE)
    tree.insert_scan(points, eye, rule=rule)
    return float(np.mean(tree.log_odds(points) < 0))


def test_order_means_nothing_to_a_scan_and_all_to_rays():
    points, eye = flat(0.1)
    shuffled = np.random.default_rng(0).permutation(points)
    assert {free(one, eye, "scan") for one in (points, points[::-1], shuffled)} == {0.0}
    assert free(points, eye, "rays") < 0.05 and free(points[::-1], eye, "rays") > 0.99


def test_rays_that_are_farther_apart_also_lose_ground_ray_by_ray():
    """Over a range of spacings, not only the lesson's."""
    for step in (0.05, 0.1, 0.2):
        points, eye = flat(step)
        assert free(points, eye, "scan") == 0.0
        assert max(free(points, eye, "rays"), free(points[::-1], eye, "rays")) > 0.5


def test_a_clamp_prunes_more():
    """Twelve scans: the lesson's numbers, to a twentieth."""
    yard = Yard(seed=3)
    maps = OccupancyOctree(SIZE), OccupancyOctree(SIZE, l_min=-1e6, l_max=1e6)
    for _ in range(12):
        points = yard.scan()
        for tree in maps:
            tree.insert_scan(points, yard.laser, MOST)
    clamped, plain = (tree.size for tree in maps)
    assert clamped < 0.9 * plain
    assert clamped == pytest.approx(28_000, rel=0.05) and plain == pytest.approx(32_500, rel=0.05)


@pytest.mark.parametrize("seed", range(4))
def test_after_five_scans_a_truck_that_left_is_forgotten_but_for_a_voxel_or_two(seed):
    yard, empty, tree = Yard(seed=seed), Yard(truck=False, seed=100 + seed), OccupancyOctree(SIZE)
    for _ in range(12):
        tree.insert_scan(yard.scan(), yard.laser, MOST)

    def there() -> float:
        leaves = tree.leaves(box=TRUCK)
        return float(np.sum(leaves.sizes[leaves.log_odds >= 0] ** 3))

    volume = [there()]
    for _ in range(5):
        tree.insert_scan(empty.scan(), empty.laser, MOST)
        volume.append(there())
    left = np.array(volume) / volume[0]
    assert left[4] > 0.9 and left[5] < 0.002 and round((volume[5]) / SIZE**3) <= 2


def test_a_heading_that_is_one_degree_off_moves_the_truck_by_10_cm():
    assert 6 * np.tan(np.radians(1)) == pytest.approx(0.10, abs=0.006)


def test_noise_puts_ground_that_lies_on_a_border_into_two_layers():
    yard, tree = Yard(), OccupancyOctree(SIZE)
    tree.insert_scan(yard.scan(), yard.laser, MOST)
    for z in (-0.1, 0.1):
        ground = [(1.7, y, z) for y in np.arange(3.5, 5.0, 0.2)]
        assert (tree.log_odds(ground) > 0).all()
