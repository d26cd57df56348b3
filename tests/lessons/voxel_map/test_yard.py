"""The yard of lesson 09b."""

import numpy as np
import pytest

from backhoe.lessons.voxel_map.yard import FAR, Yard, occupied
from backhoe.perception.octree import OccupancyOctree


@pytest.fixture(scope="module")
def points():
    return Yard().scan(1.0)


def test_a_scan_sees_truck_heap_and_ground_and_not_the_machine(points):
    laser = Yard().laser
    x, y, z = points.T
    far = np.linalg.norm(points - laser, axis=1)
    assert np.isclose(far, FAR).any() and (far[far < FAR - 1] > 1.0).all()
    at_truck = (np.abs(x - 0.8) < 2) & (y > 3.8) & (y < 6.8)
    assert ((z > 1) & (z < 2) & at_truck).sum() > 300
    heap = np.hypot(x - 6.0, y) < 1.0
    assert ((z > 0.5) & (z < 1.1) & heap).sum() > 50
    flat = (np.hypot(x - 6.0, y) > 2.7) & (y < 3.5) & (x < 9.5)
    assert np.abs(z[flat & (far < 20)]).max() < 0.05


def test_without_its_truck_the_yard_is_flat_there():
    x, y, z = Yard(truck=False).scan(1.0).T
    assert z[(np.abs(x - 0.8) < 2) & (y > 3.8) & (y < 6.8)].max() < 0.05


def test_occupied_voxels_are_the_leaves_that_are(points):
    tree = OccupancyOctree(0.2)
    tree.insert_scan(points, Yard().laser, 12.0)
    box = [[0.0, 0.0, -0.4], [4.0, 4.0, 2.0]]
    leaves = tree.leaves(box=np.add(box, [[0.01], [-0.01]]))
    small = leaves.sizes < 0.3
    wanted = leaves.centres[small & (leaves.log_odds >= 0)]
    found = occupied(tree, 0.2, box)
    assert len(found) > 100 and {*map(tuple, wanted.round(6))} <= {*map(tuple, found.round(6))}
    assert tree.log_odds(found).min() > 0
    large = occupied(tree, 0.8, box)
    inside = np.abs(found[:, None] - large).max(axis=2) < 0.4
    assert (inside.sum(axis=1) == 1).all() and inside.any(axis=0).all()


def test_bad_calls_say_why(points):
    tree = OccupancyOctree(0.2)
    for edge in (0.1, 0.3, 0.0):
        with pytest.raises(ValueError, match="edge"):
            occupied(tree, edge, [[0, 0, 0], [1, 1, 1]])
    with pytest.raises(ValueError, match="step"):
        Yard().scan(0.0)
