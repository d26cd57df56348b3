"""RRT-Connect on the arm, compiled: it goes the way that the plain loops go."""

import numpy as np
import pytest

from backhoe.machine import BACKHOE, variants
from backhoe.planning.search import ArmWorld, Log, NoPath, Relief, engine, grow, rrt_connect

SPHERES = {
    "boom": [[-1.0, 0.0, 0.0, 0.4], [-2.0, 0.3, 0.1, 0.4], [-3.0, 0.3, 0.0, 0.4]],
    "stick": [[-0.3, 0.1, 0.0, 0.35], [-1.2, 0.0, -0.1, 0.35]],
    "bucket": [[-0.4, 0.0, 0.2, 0.6], [-1.0, 0.1, 0.0, 0.6]],
}


def world(seed=1, machine=BACKHOE):
    rng = np.random.default_rng(seed)
    relief = Relief(rng.uniform(0, 0.3, (20, 30)), (2.0, -3.0), 0.3)
    return ArmWorld(
        SPHERES,
        boxes=[[[5, -1, 0.5], [6, 1, 2]], [[-1, 4, 0], [2, 5, 1.7]]],
        balls=[[4, 4, 1, 0.8], [5, 3, 2, 0.5]],
        relief=relief if seed else None,
        own={
            "swing": [[[-1, -1, -1], [0.2, 0.5, 0.7]]],
            "undercarriage": [[[-2, -1.2, 0], [2, 1.2, 0.8]]],
        },
        margin=0.1,
        machine=machine,
    )


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("machine", [BACKHOE, variants.scaled(0.8)])
def test_the_compiled_checker_says_what_the_plain_one_says(seed, machine):
    one = world(seed, machine)
    q = np.random.default_rng(0).uniform(one.lower - 0.05, one.upper + 0.05, (4000, 4))
    free = engine.all_free(one.numbers, q)
    assert 0.2 < free.mean() < 0.7
    within = ((q >= one.lower) & (q <= one.upper)).all(axis=1)
    assert (free == (within & (one.clearance(q) >= one.margin))).all()


def test_the_compiled_search_goes_the_way_of_the_plain_one():
    one, same = world(), 0
    q = np.random.default_rng(2).uniform(one.lower, one.upper, (100, 4))
    q = q[one.is_free(q)]
    for k in range(12):
        logs, paths = [Log(), Log()], []
        for log, checker in zip(logs, (one.is_free, lambda q: one.is_free(q)), strict=True):
            given = {"step": 0.3, "resolution": 0.05, "seed": k, "budget": 300, "log": log}
            try:
                found = rrt_connect(q[k], q[k + 12], checker, one.lower, one.upper, **given)
            except NoPath as error:
                found = str(error)
            paths.append(found)
        if isinstance(paths[0], str):
            assert paths[0] == paths[1]
        else:
            np.testing.assert_array_equal(*paths)
            same += 1
            n = np.ceil(np.linalg.norm(np.diff(paths[0], axis=0), axis=1) / 0.05)
            assert logs[0].evaluations >= n.sum()
        assert (logs[0].points == logs[1].points).all()
        assert (logs[0].edges == logs[1].edges).all()
        assert logs[0].evaluations <= logs[1].evaluations
    assert same >= 10


def test_the_trees_make_room_when_they_are_large():
    """A wall with a small door: more nodes than there was room for at first."""
    calls = []

    def is_free(points):
        calls.append(len(points))
        wall = np.abs(points[:, 0]) < 0.05
        return ~wall | (np.abs(points[:, 1] - 0.83) < 0.06)

    log = Log()
    given = {"step": 0.1, "resolution": 0.02, "seed": 0, "log": log}
    path = rrt_connect([-0.9, -0.9], [0.9, -0.9], is_free, [-1, -1], [1, 1], **given)
    assert len(log.points) > 300 and sum(calls) == log.evaluations
    middle = path[np.abs(path[:, 0]) < 0.05]
    assert (np.abs(middle[:, 1] - 0.83) < 0.06).all()


def test_bounds_wider_than_the_joints_do_not_lead_beyond_them():
    one = world()
    q = np.random.default_rng(3).uniform(one.lower, one.upper, (60, 4))
    q = q[one.is_free(q)]
    path = rrt_connect(q[0], q[1], one.is_free, one.lower - 1, one.upper + 1, seed=1)
    assert (path >= one.lower).all() and (path <= one.upper).all()


def test_nearest_is_the_same_in_both():
    rng = np.random.default_rng(0)
    from backhoe.planning.search import arm_loops

    for _ in range(20):
        tree, place = rng.normal(size=(30, 4)), rng.normal(size=4)
        assert arm_loops.nearest(tree, 25, place) == grow.nearest(tree, 25, place)
