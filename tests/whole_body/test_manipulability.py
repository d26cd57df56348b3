"""How easily the hand moves: arm and whole apart, metres and radians, gradients, ellipsoids."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from backhoe.arm import kinematics
from backhoe.whole_body import (
    BACKHOE,
    SLIDES,
    SlidesRobot,
    characteristic_length,
    ellipsoid,
    jacobian,
    length_weights,
    manipulability,
    manipulability_gradient,
    minimum_norm,
)

ROBOTS = pytest.mark.parametrize("robot", [SLIDES, BACKHOE], ids=["slides", "backhoe"])
PARTS = pytest.mark.parametrize("part", ["arm", "whole"])


@pytest.fixture
def rng():
    return np.random.default_rng(12)


def postures(rng, robot, *shape):
    return rng.uniform(-1.2, 1.2, (*shape, 3 + robot.joints))


def w_of(part, robot, q, weights):
    J = jacobian(q, robot)
    first = 0 if part == "whole" else 2
    return manipulability(J[..., first:], None if weights is None else weights[first:])


@ROBOTS
def test_it_is_the_root_of_the_determinant(robot, rng):
    J, weights = jacobian(postures(rng, robot, 4, 5), robot), rng.uniform(0.2, 5, 2 + robot.joints)
    assert_allclose(manipulability(J), np.sqrt(np.linalg.det(J @ np.swapaxes(J, -1, -2))))
    squared = np.linalg.det(J / weights @ np.swapaxes(J, -1, -2))
    assert_allclose(manipulability(J, weights), np.sqrt(squared))


def test_that_of_the_whole_robot_is_blind_to_a_stretched_arm(rng):
    q = np.concatenate([postures(rng, SLIDES, 500)[:, :5], np.zeros((500, 1))], axis=1)
    J = jacobian(q, SLIDES)
    assert manipulability(J[..., 2:]).max() < 1e-12 < 0.01 < np.median(manipulability(J))


@ROBOTS
@PARTS
@pytest.mark.parametrize("weighted", [False, True], ids=["plain", "weighted"])
def test_the_gradient_is_that_of_finite_differences(robot, part, weighted, rng):
    weights = rng.uniform(0.2, 5, 2 + robot.joints) if weighted else None
    q, steps = postures(rng, robot, 3, 5), 1e-5 * np.eye(3 + robot.joints)[3:]
    ahead, back = (
        np.stack([w_of(part, robot, q + way * step, weights) for step in steps], axis=-1)
        for way in (1, -1)
    )
    found = manipulability_gradient(q, robot, part, weights)
    assert found.shape == (3, 5, robot.joints)
    assert_allclose(found, (ahead - back) / 2e-5, rtol=1e-6, atol=1e-6)


def slides_w(q2, q3, robot):
    """Of the slides' arm, by hand: l2 l3 sin(q3) times the distance from the shoulder's axis."""
    r = robot.l2 * np.cos(q2) + robot.l3 * np.cos(q2 + q3)
    return robot.l2 * robot.l3 * np.sin(q3) * r


@pytest.mark.parametrize("q3", [-1.0, 1.0, 1e-6, 1e-9, -1e-12])
def test_the_arms_gradient_is_a_complex_step_of_its_formula_up_to_a_singularity(q3):
    robot, q2 = SlidesRobot(0.1, 0.3, 0.5, 0.4), 0.4
    found = manipulability_gradient([0, 0, 0.3, 0.7, q2, q3], robot)
    signed = slides_w(q2, q3, robot)
    assert w_of("arm", robot, [0, 0, 0.3, 0.7, q2, q3], None) == pytest.approx(
        abs(signed), rel=1e-3
    )
    by_q2 = slides_w(q2 + 1e-30j, q3, robot).imag / 1e-30
    by_q3 = slides_w(q2, q3 + 1e-30j, robot).imag / 1e-30
    assert_allclose(found, np.sign(signed) * np.array([0, by_q2, by_q3]), rtol=1e-4, atol=1e-13)


def stretched(robot):
    """A posture with all links of the arm in a line."""
    q = np.array([0, 0, 0.2, 0.5, 0.7, *np.zeros(robot.joints - 2)])
    for joint in range(2, robot.joints):  # turn what follows a hinge into the line of its link
        arm = q[3:]
        levers = np.cross(robot.axes(arm).T[1:], robot.reach_jacobian(arm).T[1:])  # hand to hinges
        before = levers[joint - 1] - levers[joint - 2]
        after = (levers[joint] if joint < robot.joints - 1 else 0) - levers[joint - 1]
        axis = robot.axes(arm)[:, joint]
        q[3 + joint] -= np.arctan2(axis @ np.cross(before, after), before @ after)
    return q


@ROBOTS
def test_on_a_singularity_the_gradient_is_zero_and_w_grows_either_way(robot):
    q = stretched(robot)
    assert w_of("arm", robot, q, None) < 1e-12
    assert_allclose(manipulability_gradient(q, robot), 0, atol=1e-12)
    for bent in (1e-3, -1e-3):
        step = np.zeros(3 + robot.joints)
        step[5] = bent
        assert w_of("arm", robot, q + step, None) > 1e-5


@ROBOTS
def test_the_length_is_the_root_mean_square_of_the_levers(robot, rng):
    q = np.zeros((200_000, 3 + robot.joints))
    q[:, 3:] = rng.uniform(-np.pi, np.pi, (len(q), robot.joints))
    levers = jacobian(q, robot)[..., 1:]
    assert characteristic_length(robot) == pytest.approx(
        np.sqrt((levers**2).sum(axis=-2).mean()), rel=3e-3
    )
    assert characteristic_length(robot, q[0]) == pytest.approx(
        np.sqrt((levers[0] ** 2).sum(axis=-2).mean())
    )


def test_the_length_of_the_slides_robot_by_hand():
    robot = SlidesRobot(0.3, 0.5, 0.6, 0.4)
    out = (0.6**2 + 0.4**2) / 2  # mean square of the distance from the shoulder's axis
    squares = [0.3**2 + out, out, 0.6**2 + 0.4**2, 0.4**2]  # omega, q1, q2, q3
    assert characteristic_length(robot) == pytest.approx(np.sqrt(np.mean(squares)))


def scaled(robot, k):
    return SlidesRobot(*(k * np.array([robot.a, robot.h, robot.l2, robot.l3])))


def test_with_the_length_w_is_the_same_in_metres_and_in_feet_and_without_it_is_not(rng):
    q, feet = postures(rng, SLIDES, 20), scaled(SLIDES, 1 / 0.3048)
    in_feet = q.copy()
    in_feet[:, :2] /= 0.3048

    def of(q, robot, part, weights):
        return w_of(part, robot, q, weights(robot)), manipulability_gradient(
            q, robot, part, weights(robot)
        )

    def plain(robot):
        return None

    for part in ("arm", "whole"):
        for a, b in zip(
            of(q, SLIDES, part, length_weights),
            of(in_feet, feet, part, length_weights),
            strict=True,
        ):
            assert_allclose(a, b, atol=1e-12)
    here, there = of(q, SLIDES, "whole", plain)[1], of(in_feet, feet, "whole", plain)[1]
    along = (here * there).sum(-1) / np.linalg.norm(here, axis=-1) / np.linalg.norm(there, axis=-1)
    assert along.min() < 0.9  # another direction, not only another number


def test_least_velocities_with_the_length_are_the_same_in_feet(rng):
    q, feet = postures(rng, SLIDES), scaled(SLIDES, 1 / 0.3048)
    b = rng.normal(size=3)
    v = minimum_norm(jacobian(q, SLIDES), b, weights=length_weights(SLIDES))
    w = minimum_norm(jacobian(q, feet), b / 0.3048, weights=length_weights(feet))
    assert_allclose(w * [0.3048, 1, 1, 1, 1], v, atol=1e-12)
    assert_allclose(length_weights(SLIDES, 0.5), [1, 0.25, 0.25, 0.25, 0.25])


@ROBOTS
def test_the_ellipsoid_is_where_unit_velocities_bring_the_hand(robot, rng):
    J = jacobian(postures(rng, robot, 6), robot)
    found = ellipsoid(J)
    assert_allclose(manipulability(J), found.axes.prod(axis=-1))
    inverse = np.linalg.inv(J @ np.swapaxes(J, -1, -2))
    on_it = found.surface(9).reshape(6, -1, 3)
    assert_allclose(np.einsum("ipk,ikl,ipl->ip", on_it, inverse, on_it), 1)
    for J_one, one in zip(J, inverse, strict=True):
        v = rng.normal(size=(500, 2 + robot.joints))
        moved = (v / np.linalg.norm(v, axis=1, keepdims=True)) @ J_one.T
        assert (np.einsum("pk,kl,pl->p", moved, one, moved) <= 1 + 1e-12).all()
    entries = np.take_along_axis(
        found.directions, np.abs(found.directions).argmax(-2)[..., None, :], -2
    )
    assert (np.diff(found.axes) <= 0).all() and (entries > 0).all()


def test_two_rows_give_its_shadow(rng):
    J = jacobian(postures(rng, BACKHOE))
    shadow, solid = ellipsoid(J[[0, 2]]).surface(181), ellipsoid(J).surface(181)[..., [0, 2]]
    assert shadow.shape == (181, 2)
    for way in ([1, 0], [0, 1], [0.6, 0.8]):
        assert (shadow @ way).max() == pytest.approx((solid @ way).max(), rel=1e-3)


def test_the_ellipsoid_of_forces_is_its_inverse(rng):
    J = kinematics.jacobian(postures(rng, BACKHOE)[3:])[:3]
    fast, strong = ellipsoid(J), ellipsoid(J).forces()
    assert_allclose(strong.axes, 1 / fast.axes[::-1])
    for length, way in zip(strong.axes, strong.directions.T, strict=True):
        assert np.linalg.norm(J.T @ (length * way)) == pytest.approx(1)  # torques J^T f


class TwoJoints:
    """An arm too short of joints for three directions."""

    joints = 2

    def reach(self, q):
        return SLIDES.reach(np.insert(q, 2, 0.5, axis=-1))

    def reach_jacobian(self, q):
        return SLIDES.reach_jacobian(np.insert(q, 2, 0.5, axis=-1))[..., :2]

    def axes(self, q):
        return SLIDES.axes(np.insert(q, 2, 0.5, axis=-1))[..., :2]


class FlatAxes(SlidesRobot):
    """Its axes are given as angles by mistake."""

    def axes(self, q):
        return q


def test_a_robot_of_ones_own_with_two_joints_has_a_whole_but_no_arm(rng):
    robot, q = TwoJoints(), rng.uniform(-1, 1, (4, 5))
    steps = 1e-5 * np.eye(5)[3:]
    slopes = [
        (w_of("whole", robot, q + s, None) - w_of("whole", robot, q - s, None)) / 2e-5
        for s in steps
    ]
    found = manipulability_gradient(q, robot, "whole")
    assert_allclose(found, np.stack(slopes, axis=-1), atol=1e-7)


def test_what_cannot_be_drawn_is_told():
    flat = ellipsoid(jacobian([0, 0, 0, 0, 0.7, 0.0], SLIDES)[:, 2:])._replace(axes=np.zeros(3))
    with pytest.raises(ValueError, match="axes must be finite"):
        flat.forces().surface()
    with pytest.raises(ValueError, match="only 2 or 3 axes can be drawn, got 4"):
        ellipsoid(np.eye(4)).surface()
    with pytest.raises(ValueError, match="weights must be positive"):
        manipulability(np.eye(3), [1, 0, 1])
    with pytest.raises(ValueError, match="part must be one of arm, whole"):
        manipulability_gradient(np.zeros(7), part="legs")
    with pytest.raises(ValueError, match="q must have a posture or more"):
        characteristic_length(SLIDES, np.zeros((0, 6)))
    with pytest.raises(ValueError, match="axes of the robot"):
        manipulability_gradient(np.zeros(6), FlatAxes())
    with pytest.raises(ValueError, match="more equations"):
        manipulability_gradient(np.zeros(5), TwoJoints())
    with pytest.raises(ValueError, match="length"):
        length_weights(SLIDES, -1.0)
