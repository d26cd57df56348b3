"""What is foreseen of a path: the nearest that can be reached by a dense map of the reach, speeds
by hand, margin and clearance by their own functions, sample by sample."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from backhoe.arm.kinematics import forward_kinematics, inverse_kinematics
from backhoe.machine import BACKHOE, JOINTS
from backhoe.perception.distance_field import DistanceField, clearance
from backhoe.planning.foresight import foresee, nearest_reachable
from backhoe.whole_body import stability

NARROW = replace(
    BACKHOE, swing=replace(BACKHOE.swing, joint=replace(BACKHOE.swing.joint, lower=-2.0, upper=0.3))
)
SHARE = np.linspace(0.0, 1.0, 61)[:, None]
INSIDE = (1 - SHARE) * [5.5, -1.0, 1.5, 0.2] + SHARE * [6.0, 1.0, 3.0, -0.4]
TIMES = 6.0 * SHARE[:, 0]


@pytest.fixture
def rng():
    return np.random.default_rng(1013)


@pytest.mark.parametrize("machine", [BACKHOE, NARROW], ids=["round", "narrow"])
def test_nothing_that_can_be_reached_is_nearer(rng, machine):
    path = np.c_[rng.uniform(-9, 9, (60, 3)), rng.uniform(-2, 3, 60)]
    nearest, q = nearest_reachable(path, machine)
    assert (q >= machine.lower - 1e-9).all() and (q <= machine.upper + 1e-9).all()
    np.testing.assert_allclose(forward_kinematics(q, "stick")[:, :3, 3], nearest[:, :3], atol=1e-9)
    np.testing.assert_array_equal(nearest[:, 3], np.clip(path[:, 3], *np.radians([-40, 120])))
    grid = [
        np.linspace(low, high, 50) for low, high in zip(machine.lower, machine.upper, strict=True)
    ][:3]
    postures = np.stack([*np.meshgrid(*grid), np.zeros((50, 50, 50))], axis=-1).reshape(-1, 4)
    reach = forward_kinematics(postures, "stick")[:, :3, 3]
    for point, found in zip(path[:, :3], nearest[:, :3], strict=True):
        dense = np.linalg.norm(reach - point, axis=1).min()
        assert dense - 0.6 <= np.linalg.norm(found - point) <= dense + 1e-9


def test_a_path_within_everything_is_left_as_it_is():
    seen = foresee(INSIDE, TIMES, margin=stability.margin)
    assert seen.ok and str(seen) == "nothing speaks against it"
    np.testing.assert_allclose(seen.nearest, INSIDE, atol=1e-12)
    np.testing.assert_allclose(seen.q, inverse_kinematics(INSIDE), atol=1e-12)
    assert seen.out_by.max() == 0.0


def test_straight_ahead_the_way_back_is_straight():
    """Of a point beyond the stretched arm the nearest lies on the line to the boom's joint."""
    far = np.array([[9.5, 0.0, 2.0, 0.0], [6.0, 0.0, 2.0, 3.0]])
    seen = foresee(far, [0.0, 60.0])
    joint = np.array([0.4 + 0.6241, 0.0, 1.1811 + 0.2756])
    way = far[0, :3] - joint
    angle = np.radians(60.0 - 88.1)  # the stick, stretched as far as it goes, from the boom's line
    longest = abs(5.1243 + 1.9129 * np.exp(1j * angle))
    expected = joint + longest * way / np.linalg.norm(way)
    np.testing.assert_allclose(seen.nearest[0, :3], expected, atol=1e-12)
    assert seen.out_by[0] == pytest.approx(np.linalg.norm(way) - longest)
    assert seen.bucket_out_by[1] == pytest.approx(3.0 - np.radians(120))
    assert not seen.ok
    assert f"out of reach by up to {seen.out_by[0]:.3f} m at 0.00 s" in str(seen)
    assert "the bucket is asked for 51.9 deg beyond its limit at 60.00 s" in str(seen)


def test_speeds_are_shares_of_each_joints_own_limit():
    q = np.array([-1.5, 0.4, 0.1, 0.2]) + np.outer(TIMES, [0.55, -0.07, 0.25, -0.15])
    path = np.c_[forward_kinematics(q, "stick")[:, :3, 3], q[:, 3]][:30]
    seen = foresee(path, TIMES[:30])
    expected = np.tile(np.array([0.55, 0.07, 0.25, 0.15]) / BACKHOE.speed_limit, (30, 1))
    np.testing.assert_allclose(seen.use, expected, rtol=1e-9)
    fast = foresee(path, 0.025)
    np.testing.assert_allclose(fast.use, 4 * expected, rtol=1e-9)
    worst = JOINTS[int(expected[0].argmax())]
    assert f"the {worst} would need {4 * expected.max():.2f} times" in str(fast)
    assert foresee(path, 0.1 * fast.use.max() / 4).ok  # as much longer as it says


def test_margin_is_that_of_each_moment():
    loaded = partial(stability.margin, load=900.0)
    t = TIMES / 6
    seen = foresee(INSIDE, t, margin=loaded, least_margin=3.0)
    dq = np.gradient(seen.q, t, axis=0)
    for k in (0, 17, 60):
        at = loaded(seen.q[k], dq[k], np.gradient(dq, t, axis=0)[k])
        assert seen.margin[k] == pytest.approx(at.distance) and seen.edge[k] == at.edge
    assert f"{seen.margin.min():.2f} m inside the {seen.edge[seen.margin.argmin()]}" in str(seen)


def test_clearance_is_the_fields(rng):
    occupied = np.zeros((40, 30, 30), dtype=bool)
    occupied[30, 12:20, :12] = True
    field = DistanceField(occupied, 0.25, [0.0, -3.5, 0.0])
    spheres = {"boom": [[-1.0, 0.1, 0.0, 0.3], [0.0, 0.0, 0.0, 0.35]], "tip": [[0, 0, 0, 0.2]]}
    seen = foresee(INSIDE, TIMES, field=field, spheres=spheres, least_clearance=5.0)
    for k in (0, 30, 60):
        poses = {frame: forward_kinematics(seen.q[k], frame) for frame in spheres}
        alone = clearance(field, spheres, poses, beyond=np.inf)
        assert seen.clearance[k] == pytest.approx(alone.distance)
    assert f"the arm is {seen.clearance.min():.2f} m from an obstacle" in str(seen)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: foresee(INSIDE[:, :3], TIMES), "path must"),
        (lambda: foresee(INSIDE, TIMES[:-1]), "one for each of 61"),
        (lambda: foresee(INSIDE, TIMES[::-1]), "times must rise"),
        (lambda: foresee(INSIDE[:1], [0.0]), "samples of the path"),
        (lambda: foresee(INSIDE * np.nan, TIMES), "path must be finite"),
        (lambda: foresee(INSIDE, 0.0), "times must be"),
        (lambda: foresee(INSIDE, TIMES, margin=3.0), "margin must be a function"),
        (lambda: foresee(INSIDE, TIMES, field=3.0, spheres={"tip": [[0] * 4]}), "field must"),
        (
            lambda: foresee(
                INSIDE, TIMES, field=DistanceField(np.zeros((2, 2, 2), bool), 1, [0] * 3)
            ),
            "needs spheres",
        ),
    ],
)
def test_bad_input_is_named(call, words):
    with pytest.raises((ValueError, TypeError), match=words):
        call()
