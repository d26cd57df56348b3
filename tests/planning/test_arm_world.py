"""The arm among obstacles: never nearer than it says, against meshes, planes and closed forms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from backhoe.arm.kinematics import forward_kinematics
from backhoe.machine import BACKHOE, JOINTS, variants
from backhoe.mission.hauling import arm_world
from backhoe.planning.search import ArmWorld, LevelWorld, Relief, few_spheres, pitch
from backhoe.simulation.scene import LOADING
from backhoe.view.appearance import truck_boxes, visuals

DOT = {link: [[0.0, 0.0, 0.0, 0.1]] for link in JOINTS[1:]}
DEEP = Relief(np.full((2, 2), -100.0), (0.0, 0.0), 1.0)


def random_q(count, machine=BACKHOE, seed=0):
    return np.random.default_rng(seed).uniform(machine.lower, machine.upper, (count, 4))


def corners(q, machine):
    """Corners of the meshes of boom, stick and bucket, posed, shape (k, 3) [m]."""
    placed = []
    for link, frame in zip(JOINTS[1:], ("boom", "stick", "tip"), strict=True):
        T = forward_kinematics(q, frame, machine)
        own = np.concatenate([part.vertices for part in visuals(machine)[link]])
        placed.append(own @ T[:3, :3].T + T[:3, 3])
    return np.concatenate(placed)


@pytest.mark.parametrize("machine", [BACKHOE, variants.scaled(0.8)])
def test_few_spheres_hold_the_meshes_so_the_gap_is_no_more_than_theirs(machine):
    world = arm_world(machine=machine)
    some = random_q(15, machine)
    for q, said in zip(some, world.clearance(some), strict=True):
        points = corners(q, machine)
        assert said < 0 or points[:, 2].min() > 0
        gaps = []
        for low, high in truck_boxes(LOADING.truck):
            out = np.clip(points, low, high) - points
            gaps.append(np.linalg.norm(out, axis=1).min())
        assert said <= min(gaps) + 1e-9


def test_fewer_spheres_hold_all_of_the_given_ones():
    rng = np.random.default_rng(1)
    given = np.c_[rng.normal(size=(200, 3)) * [3, 1, 1], rng.uniform(0.01, 0.2, 200)]
    sizes = []
    for count in (1, 3, 8, 20):
        few = few_spheres(given, count)
        apart = np.linalg.norm(given[:, None, :3] - few[:, :3], axis=-1)
        held = few[:, 3] - apart - given[:, 3:]
        assert len(few) <= count and held.max(axis=1).min() > -1e-12
        sizes.append(few[:, 3].max())
    assert (np.diff(sizes) < 0).all() and sizes[-1] < sizes[0] / 2
    assert_allclose(few_spheres(given[:1], 4), given[:1])


def test_the_gap_to_a_ball_and_a_box_is_that_of_their_surfaces():
    q = random_q(20)
    tip = forward_kinematics(q)[:, :3, 3]
    for k in range(20):
        ball = ArmWorld(DOT, balls=[[*tip[k] + [3.0, 0.0, 4.0], 1.5]], relief=DEEP)
        box = ArmWorld(DOT, [[tip[k] + [0.3, 20.0, 0.4], tip[k] + [1, 30.0, 1]]], relief=DEEP)
        all_three = ball.middles(q[k])
        there = np.linalg.norm(all_three - tip[k] - [3.0, 0.0, 4.0], axis=1).min() - 1.6
        assert ball.clearance(q[k]) == pytest.approx(there)
        ways = tip[k] + [0.3, 20.0, 0.4] - all_three
        ways = np.where((ways < 0) & (ways > -0.7), 0, ways)
        assert box.clearance(q[k]) <= np.linalg.norm(ways, axis=1).max()


def test_over_a_plane_slope_the_bound_is_the_distance_itself():
    a, b = 0.3, -0.2
    x, y = np.meshgrid(np.arange(-20, 21.0), np.arange(-20, 21.0))
    world = ArmWorld(DOT, relief=Relief(a * x + b * y - 9, (-20.0, -20.0), 1.0))
    q = random_q(50)
    u, v, h = np.moveaxis(world.middles(q), -1, 0)
    true = (h - a * u - b * v + 9) / np.sqrt(1 + a * a + b * b) - 0.1
    assert_allclose(world.clearance(q), true.min(axis=1), atol=1e-9)


def test_beyond_its_border_the_ground_goes_on_as_high_as_there():
    world = ArmWorld(DOT, relief=Relief(np.full((3, 4), 0.7), (100.0, 100.0), 0.5))
    level = ArmWorld(DOT)
    q = random_q(10)
    assert_allclose(world.clearance(q), level.clearance(q) - 0.7)


def test_stick_and_bucket_are_held_off_the_body_and_the_boom_is_not():
    everywhere = [[[-30, -30, -30], [30, 30, 30]]]
    boom = {**DOT, "stick": np.empty((0, 4)), "bucket": np.empty((0, 4))}
    q = random_q(3)
    for part in ("undercarriage", "swing"):
        assert (ArmWorld(DOT, own={part: everywhere}, relief=DEEP).clearance(q) < 0).all()
    with pytest.raises(ValueError, match="stick"):
        ArmWorld(boom, relief=DEEP)
    far = [[[-3.0, -0.5, -1.5], [-1.0, 2.0, 1.5]]]  # behind the boom's joint, in the house's frame
    near = ArmWorld(DOT, own={"swing": far}, relief=DEEP).clearance(q)
    turned = q + np.eye(4)[0]
    assert_allclose(near, ArmWorld(DOT, own={"swing": far}, relief=DEEP).clearance(turned))


def test_a_posture_is_free_within_limits_and_beyond_the_margin():
    q = random_q(200)
    world = ArmWorld(DOT, margin=0.5)
    assert (world.is_free(q) == (world.clearance(q) >= 0.5)).all()
    assert not world.is_free(np.r_[0, 0, 0, world.upper[3] + 1e-6])
    assert world.is_free(q.reshape(10, 20, 4)).shape == (10, 20)


def test_a_level_bucket_keeps_its_pitch_whatever_the_other_joints_do():
    world = arm_world()
    level = LevelWorld(world, np.radians(-172))
    p = random_q(300)[:, :3]
    q = level.joints(p)
    T = forward_kinematics(q)
    assert_allclose(np.cos(np.radians(-172)), np.hypot(T[:, 0, 0], T[:, 1, 0]) * -1, atol=1e-12)
    assert_allclose(T[:, 2, 0], np.sin(np.radians(-172)), atol=1e-12)
    assert (level.is_free(p) == world.is_free(q)).all()
    assert 0 < level.is_free(p).mean() < world.is_free(np.c_[p, np.zeros(300)]).mean() + 1
    assert_allclose(pitch(q), np.radians(-172))


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: ArmWorld({"boom": [[0, 0, 0, 1]]}), "spheres must have boom, stick, bucket"),
        (lambda: ArmWorld({**DOT, "boom": [[0, 0, 0, -1]]}), "least radius of spheres of boom"),
        (lambda: ArmWorld(DOT, [[[1, 0, 0], [0, 1, 1]]]), "lower corner first"),
        (lambda: ArmWorld(DOT, [[0, 0, 0]]), "boxes must"),
        (lambda: ArmWorld(DOT, balls=[[0, 0, 0]]), "balls must"),
        (lambda: ArmWorld(DOT, own={"cab": []}), "undercarriage and swing"),
        (lambda: ArmWorld(DOT, margin=-1), "margin"),
        (lambda: ArmWorld(DOT, relief=Relief([[0, np.nan]] * 2, (0, 0), 1)), "heights"),
        (lambda: ArmWorld(DOT, relief=Relief([[0, 1]], (0, 0), 1)), "rows and columns"),
        (lambda: ArmWorld(DOT).is_free([0, 0, 0]), "joints"),
        (lambda: ArmWorld(DOT).clearance([np.nan] * 4), "finite"),
        (lambda: LevelWorld(ArmWorld(DOT), np.inf), "pitch"),
        (lambda: LevelWorld(ArmWorld(DOT), 0).joints([0, 0]), "swing, boom, stick"),
        (lambda: few_spheres([[0, 0, 0, 1]], 0), "count"),
    ],
)
def test_bad_input_is_named(make, words):
    with pytest.raises(ValueError, match=words):
        make()


@pytest.mark.parametrize("make", [lambda: ArmWorld([]), lambda: LevelWorld(None, 0.0)])
def test_a_wrong_kind_is_a_type_error(make):
    with pytest.raises(TypeError):
        make()
