"""Mobile manipulators: Jacobians, least velocities, null spaces, limits."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from backhoe.machine import variants
from backhoe.whole_body import (
    BACKHOE,
    SLIDES,
    Excavator,
    SlidesRobot,
    damping_near_singularity,
    hand,
    jacobian,
    minimum_norm,
    null_projector,
    wanted_velocity,
)

ROBOTS = pytest.mark.parametrize("robot", [SLIDES, BACKHOE], ids=["slides", "backhoe"])


@pytest.fixture
def rng():
    return np.random.default_rng(12)


def postures(rng, robot, *shape):
    return rng.uniform(-1.2, 1.2, (*shape, 3 + robot.joints))


def slides_hand(x, y, theta, q1, q2, q3, robot=SLIDES):
    """The slides' geometric model as printed, for complex numbers too."""
    c, s = np.cos, np.sin
    h_ax = robot.l2 * c(q2) * c(q1) + robot.l3 * c(q2 + q3) * c(q1)
    h_ay = robot.l2 * c(q2) * s(q1) + robot.l3 * c(q2 + q3) * s(q1)
    h_az = robot.h + robot.l2 * s(q2) + robot.l3 * s(q2 + q3)
    return np.array(
        [
            x + (robot.a + h_ax) * c(theta) - h_ay * s(theta),
            y + (robot.a + h_ax) * s(theta) + h_ay * c(theta),
            h_az,
        ]
    )


def rates(q, v):
    """How the coordinates change: the platform drives along its heading."""
    return np.r_[v[0] * np.cos(q[2]), v[0] * np.sin(q[2]), v[1:]]


def test_the_hand_is_where_the_slides_say(rng):
    robot = SlidesRobot(0.3, 0.5, 0.6, 0.4)
    for q in postures(rng, robot, 20):
        assert_allclose(hand(q, robot), slides_hand(*q, robot=robot), atol=1e-12)


def test_the_slides_jacobian_is_a_complex_step_of_their_model(rng):
    for q in postures(rng, SLIDES, 20):
        columns = [slides_hand(*(q + 1e-30j * rates(q, unit))).imag / 1e-30 for unit in np.eye(5)]
        assert_allclose(jacobian(q, SLIDES), np.stack(columns, axis=-1), atol=1e-14)


@ROBOTS
def test_the_hand_moves_as_the_jacobian_says(robot, rng):
    for q in postures(rng, robot, 10):
        v, dt = rng.normal(size=2 + robot.joints), 1e-5
        moved = hand(q + dt * rates(q, v), robot) - hand(q - dt * rates(q, v), robot)
        assert_allclose(jacobian(q, robot) @ v, moved / (2 * dt), atol=1e-8)


@ROBOTS
def test_many_postures_at_once(robot, rng):
    q = postures(rng, robot, 3, 2)
    one_by_one = [[jacobian(x, robot) for x in row] for row in q]
    assert_allclose(jacobian(q, robot), one_by_one, atol=1e-14)
    assert jacobian(q, robot).shape == (3, 2, 3, 2 + robot.joints)
    assert_allclose(hand(q, robot), [[hand(x, robot) for x in row] for row in q], atol=1e-14)


@ROBOTS
def test_the_least_velocity_is_that_of_the_pseudo_inverse(robot, rng):
    J, b = jacobian(postures(rng, robot, 4, 5), robot), rng.normal(size=(4, 5, 3))
    v = minimum_norm(J, b)
    assert_allclose(v, np.einsum("...ij,...j->...i", np.linalg.pinv(J), b), atol=1e-10)


@ROBOTS
def test_a_preferred_velocity_is_projected(robot, rng):
    J = jacobian(postures(rng, robot), robot)
    b, v0 = rng.normal(size=3), rng.normal(size=2 + robot.joints)
    v = minimum_norm(J, b, v0)
    assert_allclose(v, np.linalg.pinv(J) @ b + null_projector(J) @ v0, atol=1e-11)
    assert_allclose(J @ v, b, atol=1e-12)


def test_weights_make_the_weighted_sum_least(rng):
    J, b, v0 = jacobian(postures(rng, BACKHOE)), rng.normal(size=3), rng.normal(size=6)
    weights = rng.uniform(0.2, 5, 6)
    v = minimum_norm(J, b, v0, weights=weights)
    assert_allclose(J @ v, b, atol=1e-11)
    for _ in range(20):
        other = v + null_projector(J) @ rng.normal(size=6)
        assert (weights * (v - v0) ** 2).sum() <= (weights * (other - v0) ** 2).sum()


def test_damping_solves_the_regularised_problem(rng):
    J, b = jacobian(postures(rng, SLIDES), SLIDES), rng.normal(size=3)
    v = minimum_norm(J, b, damping=0.3)
    assert_allclose(v, np.linalg.solve(J.T @ J + 0.09 * np.eye(5), J.T @ b), atol=1e-12)


def test_dependent_rows_are_refused_and_named_and_damping_helps():
    J = np.stack([np.eye(3, 5), np.eye(3, 5)])
    J[1, 2] = J[1, 0] + 2 * J[1, 1]
    b = np.ones((2, 3))
    with pytest.raises(ValueError, match=r"rows of J must not depend .* at \(1,\).*damping"):
        minimum_norm(J, b)
    assert np.isfinite(minimum_norm(J, b, damping=0.01)).all()


def nearly_singular(rng, size, *leading):
    """J (..., 3, 6) whose singular values are 2, 1 and `size`, and its left singular vectors."""
    left = np.linalg.qr(rng.normal(size=(*leading, 3, 3)))[0]
    right = np.linalg.qr(rng.normal(size=(*leading, 6, 3)))[0]
    return left * [2.0, 1.0, size] @ np.swapaxes(right, -1, -2), left


@pytest.mark.parametrize("size", [1.0, 1e-2, 1e-4, 1e-6, 4e-7])
def test_near_a_singularity_the_task_is_done_exactly_still(size, rng):
    for _ in range(30):
        J, b, v0 = nearly_singular(rng, size)[0], rng.normal(size=3), rng.normal(size=6)
        v = minimum_norm(J, b, v0)
        assert_allclose(J @ v, b, atol=3e-15 * np.linalg.norm(v) + 1e-14)
        wanted = v0 + np.linalg.pinv(J, rcond=1e-13) @ (b - J @ v0)
        assert_allclose(v, wanted, atol=1e-13 / size**2)


@pytest.mark.parametrize(("threshold", "largest"), [(0.1, 0.1), (0.2, 0.03), (0.05, 0.4)])
def test_damping_only_near_a_singularity(threshold, largest, rng):
    size = np.geomspace(1e-9, 1, 400)
    J = np.stack([nearly_singular(rng, s)[0] for s in size])
    damping = damping_near_singularity(J, threshold, largest)
    assert (damping[size >= threshold * 1.0001] == 0).all()
    near = size < threshold
    assert_allclose(damping[near] ** 2 / largest**2, 1 - (size[near] / threshold) ** 2, atol=1e-7)
    b = rng.normal(size=(400, 3))
    v = minimum_norm(J, b, damping=damping)
    bound = max(1 / threshold, 1 / largest)
    assert (np.linalg.norm(v, axis=-1) <= bound * np.linalg.norm(b, axis=-1)).all()
    missing = np.linalg.norm(np.einsum("kij,kj->ki", J, v) - b, axis=-1)
    assert missing[~near].max() < 1e-12 < 1e-3 < missing[0]
    one = minimum_norm(J[3], b[3], damping=float(damping[3]))
    assert_allclose(v[3], one, rtol=1e-12)


def test_a_damping_for_each_state_needs_their_shape():
    with pytest.raises(ValueError, match=r"damping must be one number or one a matrix, .*\(3,\)"):
        minimum_norm(np.ones((2, 3, 6)), np.ones((2, 3)), damping=np.ones(3))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda J, b, v0: minimum_norm(J * np.nan, b), "J must be finite"),
        (lambda J, b, v0: minimum_norm(J, b * [1, np.inf, 1]), r"b must be finite.*index 1"),
        (lambda J, b, v0: minimum_norm(J, b, v0 * np.nan), "preferred must be finite"),
        (lambda J, b, v0: minimum_norm(J, b, damping=np.nan), "damping must be finite"),
        (lambda J, b, v0: minimum_norm(J, b, damping=-0.1), "damping must be 0 or more, got -0.1"),
        (lambda J, b, v0: minimum_norm(J, b, damping=True), "damping must be"),
        (lambda J, b, v0: minimum_norm(J * 1e200, b), "of a size that can be squared"),
        (lambda J, b, v0: minimum_norm(J + 1j, b), "J must be numbers"),
        (lambda J, b, v0: minimum_norm(J[0], b), "J must be a matrix"),
        (lambda J, b, v0: minimum_norm(J[:0], b[:0]), "J must be a matrix"),
        (lambda J, b, v0: minimum_norm(J, b[None]), r"b must .*3 rows of J.*\(1, 3\)"),
        (lambda J, b, v0: minimum_norm(J, b, np.ones(5)), "preferred must"),
        (lambda J, b, v0: damping_near_singularity(J, 0, 1), "threshold must"),
        (lambda J, b, v0: damping_near_singularity(J, 1, -1), "largest must"),
    ],
)
def test_bad_numbers_are_told_whichever_way_they_come(call, message, rng):
    J, b, v0 = rng.normal(size=(3, 6)), np.ones(3), np.ones(6)
    with pytest.raises(ValueError, match=message):
        call(J, b, v0)


def test_any_array_of_numbers_will_do(rng):
    J, b = rng.normal(size=(4, 3, 6)), rng.normal(size=(4, 3))
    v = minimum_norm(J, b)
    turned = np.asfortranarray(J), J.astype(">f8"), J.tolist(), np.concatenate([J, J], -1)[..., :6]
    for other in turned:
        assert_allclose(minimum_norm(other, b), v, rtol=1e-12)
    still = J.copy()
    still.flags.writeable = False
    assert_allclose(minimum_norm(still, b), v, rtol=1e-12)
    assert minimum_norm(J[:0], b[:0]).shape == (0, 6)
    assert null_projector(J[:0]).shape == (0, 6, 6)


def test_the_projector_of_a_singular_j_takes_only_what_moves_the_hand(rng):
    for _ in range(20):
        J, _ = nearly_singular(rng, 1e-13)
        N = null_projector(J)
        assert_allclose(np.trace(N), 4, atol=1e-12)
        assert_allclose(J @ N, 0, atol=1e-12)
        assert_allclose(null_projector(J * 1e-200), N, atol=1e-4)


@ROBOTS
def test_the_projector_moves_everything_but_the_hand(robot, rng):
    J = jacobian(postures(rng, robot, 6), robot)
    N = null_projector(J)
    assert_allclose(J @ N, 0, atol=1e-12)
    assert_allclose(N @ N, N, atol=1e-12)
    assert_allclose(N, np.swapaxes(N, -1, -2), atol=1e-12)
    assert_allclose(np.trace(N, axis1=-2, axis2=-1), robot.joints - 1)


def test_the_error_shrinks_by_w_with_a_robot_that_obeys(rng):
    q, W, T = postures(rng, SLIDES), np.array([0.2, 0.5, 0.9]), 0.1
    h = hand(q, SLIDES)
    goal = np.add(h, [0.1, -0.2, 0.05])
    for next_goal in (goal + 0.01, goal - 0.02):
        v = minimum_norm(jacobian(q, SLIDES), wanted_velocity(h, goal, next_goal, W, T))
        h_next = h + T * jacobian(q, SLIDES) @ v
        assert_allclose(next_goal - h_next, W * (goal - h), atol=1e-14)


@pytest.mark.parametrize("W", [1.0, -0.1, [0.5, 1.2, 0.5]])
def test_gains_that_do_not_shrink_the_error_are_refused(W):
    with pytest.raises(ValueError, match="W must be at least 0 and below 1"):
        wanted_velocity(np.zeros(3), np.zeros(3), np.zeros(3), W, 0.1)


def test_a_gain_of_zero_brings_the_hand_there_in_one_step(rng):
    h, goal, next_goal = rng.normal(size=(3, 3))
    assert_allclose(h + 0.1 * wanted_velocity(h, goal, next_goal, 0, 0.1), next_goal, atol=1e-15)


def test_a_path_that_jumps_is_told_with_its_step():
    goals = np.cumsum(np.full((6, 3), 0.01), axis=0)
    wanted_velocity(goals[:-1], goals[:-1], goals[1:], 0.5, 0.1, fastest=0.2)
    goals[4:] += [0.0, 0.3, 0.0]
    with pytest.raises(
        ValueError, match=r"at most 0.02 m from goal, got 0.3103 m in step 3.*jumps"
    ):
        wanted_velocity(goals[:-1], goals[:-1], goals[1:], 0.5, 0.1, fastest=0.2)
    with pytest.raises(ValueError, match=r"got 0.3103 m: the path jumps"):
        wanted_velocity(goals[3], goals[3], goals[4], 0.5, 0.1, fastest=0.2)
    wanted_velocity(goals[3], goals[3], goals[4], 0.5, 0.1)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: jacobian(np.zeros(6)), r"q must .*7 .*x, y, theta and 4 joints"),
        (lambda: hand([np.nan] * 6, SLIDES), "q must be finite"),
        (lambda: minimum_norm(np.eye(4, 3), np.ones(4)), "more equations"),
        (lambda: minimum_norm(np.eye(3, 4), np.ones(2)), "b must"),
        (lambda: minimum_norm(np.eye(3, 4), np.ones(3), weights=-np.ones(4)), "weights must be p"),
        (lambda: SlidesRobot(l2=0), "SlidesRobot.l2"),
    ],
)
def test_bad_input_is_told(call, message):
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize("robot", ["backhoe", None, SlidesRobot, 3])
def test_a_robot_that_is_none_is_told(robot):
    with pytest.raises(TypeError, match="robot must be SLIDES, BACKHOE"):
        jacobian(np.zeros(7), robot)


class Rail:
    """A robot of one's own: one link that turns about an upright post on the platform."""

    joints = 1

    def reach(self, q):
        return np.stack([2 * np.cos(q[..., 0]), 2 * np.sin(q[..., 0]), 0 * q[..., 0] + 1], axis=-1)

    def reach_jacobian(self, q):
        return np.stack([-2 * np.sin(q), 2 * np.cos(q), 0 * q], axis=-2)

    def axes(self, q):
        return np.broadcast_to([[0.0], [0], [1]], (*q.shape[:-1], 3, 1))


OTHERS = {
    "short slides": SlidesRobot(0.0, 0.9, 0.2, 0.7),
    "loaded": Excavator(variants.loaded(800.0)),
    "small": Excavator(variants.scaled(0.5)),
    "other reading": Excavator(variants.reading([-10.0, 5.0, 30.0, -20.0])),
    "own": Rail(),
}


@pytest.mark.parametrize("name", OTHERS)
def test_the_jacobian_of_other_robots(name, rng):
    robot = OTHERS[name]
    for q in postures(rng, robot, 10):
        v, dt = rng.normal(size=2 + robot.joints), 1e-5
        moved = hand(q + dt * rates(q, v), robot) - hand(q - dt * rates(q, v), robot)
        assert_allclose(jacobian(q, robot) @ v, moved / (2 * dt), atol=1e-8)
    q = postures(rng, robot, 2, 3)
    assert_allclose(jacobian(q, robot)[1, 2], jacobian(q[1, 2], robot), atol=1e-14)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"reach": lambda q: np.zeros(2)}, r"reach of the robot must .*\(3,\), got shape \(2,\)"),
        ({"reach": lambda q: np.full(3, np.nan)}, "reach of the robot must be finite"),
        ({"reach_jacobian": lambda q: np.eye(3)}, r"reach_jacobian of the robot must .*\(3, 1\)"),
        ({"joints": 1.5}, "joints of the robot must be one whole number"),
    ],
)
def test_a_robot_that_gives_something_else_is_told(change, message):
    robot = Rail()
    vars(robot).update(change)
    with pytest.raises(ValueError, match=message):
        jacobian(np.zeros(4), robot)


@pytest.mark.parametrize("bend", [0.0, 1e-15])
def test_an_upright_arm_has_lost_a_direction(bend):
    """The sine of a right angle's rounding is no lever: 3e-17 would ask for 1e15 rad/s."""
    J = jacobian([0, 0, 0, 0.3, np.pi / 2, bend], SLIDES)
    with pytest.raises(ValueError, match="depend on each other"):
        minimum_norm(J, [0, 0, 0.1])
    with pytest.raises(ValueError, match="depend on each other"):
        minimum_norm([[1, 0, 0], [0, 0, 0]], [1, 1])
    assert np.abs(minimum_norm(J, [0, 0, 0.1], damping=0.05)).max() <= 1.0


def test_velocities_of_any_number_of_rows_are_wanted_alike():
    h, goal, after = np.arange(4.0), np.full(4, 2.0), np.full(4, 2.5)
    W = np.array([0.0, 0.2, 0.5, 0.9])
    each = [
        wanted_velocity(h[k : k + 1], goal[k : k + 1], after[k : k + 1], W[k], 0.1)
        for k in range(4)
    ]
    assert_allclose(wanted_velocity(h, goal, after, W, 0.1), np.concatenate(each))
    with pytest.raises(ValueError, match="one a direction"):
        wanted_velocity(h, goal, after, W[:3], 0.1)
