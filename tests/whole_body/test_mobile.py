"""Mobile manipulators: Jacobians, least velocities, null spaces, limits."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import minimize

from backhoe.whole_body import (
    BACKHOE,
    SLIDES,
    SlidesRobot,
    damping_near_singularity,
    hand,
    jacobian,
    joint_bounds,
    limited_velocity,
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


def test_without_a_limit_in_the_way_the_task_is_done_in_full(rng):
    J, b = jacobian(postures(rng, BACKHOE)), rng.normal(size=3) / 10
    v, s = limited_velocity(J, b, np.full(6, -50.0), np.full(6, 50.0), small=1e-9)
    assert s == pytest.approx(1, abs=1e-6)
    assert_allclose(v, minimum_norm(J, b), atol=1e-5)


def test_a_limit_scales_the_whole_task_and_keeps_its_direction(rng):
    for _ in range(50):
        J, b = jacobian(postures(rng, BACKHOE)), rng.normal(size=3)
        top = rng.uniform(0.05, 0.4, 6)
        A, c = rng.normal(size=(2, 6)), rng.uniform(0.01, 0.2, 2)
        v, s = limited_velocity(J, b, -top, top, A=A, c=c)
        assert_allclose(J @ v, s * b, atol=1e-9)
        assert (np.abs(v) <= top).all() and (A @ v <= c + 1e-9).all() and 0 <= s <= 1


def test_the_programme_is_solved_as_another_solver_solves_it(rng):
    for _ in range(10):
        J, b, top = jacobian(postures(rng, BACKHOE)), rng.normal(size=3), rng.uniform(0.1, 0.5, 6)
        v0 = rng.normal(size=6) / 10
        v, s = limited_velocity(J, b, -top, top, preferred=v0, small=0.01)

        def cost(x, v0=v0):
            return (1 - x[6]) ** 2 + 0.01 * ((x[:6] - v0) ** 2).sum()

        other = minimize(
            cost,
            np.zeros(7),
            method="SLSQP",
            bounds=[*zip(-top, top, strict=True), (0, 1)],
            constraints={"type": "eq", "fun": lambda x, J=J, b=b: J @ x[:6] - x[6] * b},
            options={"maxiter": 500, "ftol": 1e-14},
        )
        assert other.success
        assert_allclose([*v, s], other.x, atol=2e-5)
        assert cost(np.r_[v, s]) <= other.fun + 1e-9


def test_limits_that_exclude_each_other_are_named():
    J, b, top = np.eye(3, 5), np.ones(3), np.ones(5)
    with pytest.raises(ValueError, match=r"row 1 of A allows at most -9, .* at least -1"):
        limited_velocity(J, b, -top, top, A=np.eye(5)[:2], c=[1.0, -9.0])
    with pytest.raises(
        ValueError, match=r"lower must not be above upper, got 2\.0 and 1.0 for vel"
    ):
        limited_velocity(J, b, 2 * np.eye(5)[3], top)


def test_joint_bounds_keep_the_angles_in_range(rng):
    low, high, fastest = np.array([-1.0, 0.0]), np.array([1.0, 0.5]), np.array([2.0, 1.0])
    for q in rng.uniform(low, high, (100, 2)):
        for bound in joint_bounds(q, low, high, fastest, 0.1):
            assert (np.abs(bound) <= fastest).all()
            assert (q + 0.1 * bound >= low - 1e-12).all() and (
                q + 0.1 * bound <= high + 1e-12
            ).all()
    lower, upper = joint_bounds([2.0, 0.2], low, high, fastest, 0.1)
    assert lower[0] == upper[0] == -2.0


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


def test_a_robot_that_is_none_is_told():
    with pytest.raises(TypeError, match="robot must be SLIDES, BACKHOE"):
        jacobian(np.zeros(7), "backhoe")
