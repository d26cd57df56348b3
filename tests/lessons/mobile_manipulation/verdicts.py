"""What decides each verdict on the slides of Sasig and Chicaiza: properties, printed forms."""

from functools import cache
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation

from backhoe.lessons.mobile_manipulation import printed
from backhoe.whole_body import (
    SLIDES,
    SlidesRobot,
    jacobian,
    length_weights,
    manipulability,
    manipulability_gradient,
    minimum_norm,
    steer_clear,
    wanted_velocity,
)

_ROBOT = SlidesRobot(0.3, 0.5, 0.6, 0.4)


def _postures(count=12, seed=1):
    return np.random.default_rng(seed).uniform(-1.2, 1.2, (count, 6))


def _hand(q, robot=SLIDES):
    """By rotations, one link after another; for one posture or many."""
    q = np.atleast_2d(q)
    arm = np.zeros((len(q), 3))
    for length, lift in ((robot.l2, q[:, 4]), (robot.l3, q[:, 4] + q[:, 5])):
        turn = Rotation.from_euler("ZY", np.stack([q[:, 3], -lift], axis=-1))
        arm += turn.apply([length, 0, 0])
    arm += [robot.a, 0, robot.h]
    moved = Rotation.from_euler("Z", q[:, 2:3].copy()).apply(arm)
    moved[:, :2] += q[:, :2]
    return moved


def _model(q, robot):
    """The slides' geometric model, for complex numbers too."""
    x, y, theta, q1, q2, q3 = q
    r = robot.l2 * np.cos(q2) + robot.l3 * np.cos(q2 + q3)
    z = robot.h + robot.l2 * np.sin(q2) + robot.l3 * np.sin(q2 + q3)
    c, s, ahead, aside = np.cos(theta), np.sin(theta), robot.a + r * np.cos(q1), r * np.sin(q1)
    return np.array([x + ahead * c - aside * s, y + ahead * s + aside * c, z])


def _rates(q, v):
    """How the coordinates change: the platform drives along its heading."""
    drive = v[..., :1] * np.stack([np.cos(q[..., 2]), np.sin(q[..., 2])], axis=-1)
    return np.concatenate([drive, v[..., 1:]], axis=-1)


def _moved(q, v, T, pieces=4):
    """After T with steady velocities, by Simpson's rule, for many robots."""
    for _ in range(pieces):
        dt = T / pieces
        a = _rates(q, v)
        b = _rates(q + dt / 2 * a, v)
        q = q + dt / 6 * (a + 4 * b + _rates(q + dt * b, v))
    return q


# Platform and arm


def platform_is_where_the_drawing_has_it(position):
    """a ahead of the axle's middle, along the heading."""
    for x, y, theta, a in np.random.default_rng(2).uniform(-1, 1, (10, 4)):
        back = np.asarray(position(x, y, theta, abs(a)))
        apart = Rotation.from_euler("Z", -theta).apply([*(back[:2] - [x, y]), 0])
        assert np.allclose([*apart[:2], back[2]], [abs(a), 0, theta])


def platform_position(x, y, theta, a):
    return np.array([x + a * np.cos(theta), y + a * np.sin(theta), theta])


def platform_position_behind(x, y, theta, a):
    return np.array([x - a * np.cos(theta), y - a * np.sin(theta), theta])


def platform_moves_so(S):
    for theta, a, u, omega in np.random.default_rng(3).uniform(-1, 1, (10, 4)):

        def place(t, theta=theta, a=a, u=u, omega=omega):
            h = t * 1j
            return (
                platform_position(
                    h * u * np.cos(theta), h * u * np.sin(theta), theta + h * omega, a
                ).imag
                / t
            )

        assert np.allclose(S(theta, a) @ [u, omega], place(1e-30), atol=1e-12)


def platform_jacobian(theta, a):
    c, s = np.cos(theta), np.sin(theta)
    return np.array([[c, -a * s], [s, a * c], [0, 1]])


def platform_jacobian_with_a_sideways(theta, a):
    c, s = np.cos(theta), np.sin(theta)
    return np.array([[c, a * s], [s, -a * c], [0, 1]])


def arm_reaches_there(position):
    for q in _postures():
        whole = np.r_[0, 0, 0, q[3:]]
        assert np.allclose(position(q[3:], _ROBOT), _hand(whole, _ROBOT)[0] - [_ROBOT.a, 0, 0])


def arm_position(q, robot):
    return _model(np.r_[0, 0, 0, q], robot) - [robot.a, 0, 0]


def arm_position_with_q3_from_the_ground(q, robot):
    return arm_position(np.r_[q[:2], q[2] - q[1]], robot)


def arm_moves_so(S):
    """A complex step of the geometric model."""
    for q in _postures():
        columns = [arm_position(q[3:] + 1e-30j * one, _ROBOT).imag / 1e-30 for one in np.eye(3)]
        assert np.allclose(S(q[3:], _ROBOT), np.stack(columns, axis=-1), atol=1e-13)


def arm_jacobian(q, robot):
    (C1, C2, C23), (S1, S2, S23) = (
        f(np.array([q[0], q[1], q[1] + q[2]])) for f in (np.cos, np.sin)
    )
    l2, l3 = robot.l2, robot.l3
    return np.array(
        [
            [-l2 * C2 * S1 - l3 * C23 * S1, -l2 * C1 * S2 - l3 * S23 * C1, -l3 * S23 * C1],
            [l2 * C1 * C2 + l3 * C23 * C1, -l3 * S23 * S1 - l2 * S1 * S2, -l3 * S23 * S1],
            [0, l3 * C23 + l2 * C2, l3 * C23],
        ]
    )


def arm_jacobian_with_a_plus(q, robot):
    return arm_jacobian(q, robot) * [[1, 1, 1], [1, -1, 1], [1, 1, 1]]


# Platform and arm together


def hand_is_there(position):
    for q in _postures():
        assert np.allclose(position(q, _ROBOT), _hand(q, _ROBOT)[0])


def robot_position(q, robot):
    return _model(q, robot)


def robot_position_without_a(q, robot):
    return _model(q, robot) - robot.a * np.array([np.cos(q[2]), np.sin(q[2]), 0])


def hand_moves_so(J):
    """A complex step of the geometric model along the ways that the platform can go."""
    for q in _postures():
        ways = [_rates(q, one) for one in np.eye(5)]
        columns = [_model(q + 1e-30j * way, _ROBOT).imag / 1e-30 for way in ways]
        wanted, rows = np.stack(columns, axis=-1), J(q, _ROBOT)
        for row, values in rows.items():
            assert np.allclose(values, wanted[row], atol=1e-13)


def _rows(form, rows):
    def of(q, robot):
        J = form(q, robot)
        return {row: J[row] for row in rows}

    return of


first_and_third_row = _rows(jacobian, (0, 2))
printed_first_and_third_row = _rows(printed.robot_jacobian, (0, 2))
first_and_third_row_without_a = _rows(
    lambda q, robot: jacobian(q, SlidesRobot(0.0, robot.h, robot.l2, robot.l3)), (0, 2)
)
second_row = _rows(jacobian, (1,))
printed_second_row = _rows(printed.robot_jacobian, (1,))


# (1) to (5)


def hand_goes_where_its_velocity_says(velocity):
    for q in _postures():
        v = np.random.default_rng(4).normal(size=5)
        moved = _hand(_moved(q, v, 1e-4))[0] - _hand(_moved(q, v, -1e-4))[0]
        assert np.allclose(velocity(q, v), moved / 2e-4, atol=1e-6)


def velocity_of_the_hand(q, v):
    return jacobian(q, SLIDES) @ v


def velocity_without_the_heading(q, v):
    return jacobian(np.r_[q[:2], 0, q[3:]], SLIDES) @ v


def step_errs_by_the_square_of_the_period(step):
    for q in _postures():
        v, errors = np.random.default_rng(5).normal(size=5), []
        for T in (0.02, 0.01):
            found = step(_hand(q)[0], jacobian(q, SLIDES) @ v, T)
            errors.append(np.linalg.norm(found - _hand(_moved(q, v, T))[0]))
        assert 3.5 < errors[0] / errors[1] < 4.5


def euler_step(h, rate, T):
    return h + T * rate


def euler_step_without_the_period(h, rate, T):
    return h + rate


def error_after_the_step_is_none(target):
    h, goal, next_goal = np.random.default_rng(6).normal(size=(3, 3))
    assert np.allclose(next_goal - target(h, goal, next_goal), 0)


def next_goal_itself(h, goal, next_goal):
    return next_goal


def goal_of_now(h, goal, next_goal):
    return goal


def error_after_the_step_is_w_times_that_before(target):
    h, goal, next_goal = np.random.default_rng(7).normal(size=(3, 3))
    W = np.array([0.1, 0.5, 0.9])
    assert np.allclose(next_goal - target(h, goal, next_goal, W), W * (goal - h))


def next_place(h, goal, next_goal, W):
    return next_goal - W * (goal - h)


def next_place_with_a_plus(h, goal, next_goal, W):
    return next_goal + W * (goal - h)


def euler_robot_reaches_the_place_of_4(b):
    h, goal, next_goal = np.random.default_rng(8).normal(size=(3, 3))
    W, T = np.array([0.1, 0.5, 0.9]), 0.05
    assert np.allclose(h + T * b(h, goal, next_goal, W, T), next_place(h, goal, next_goal, W))


def b_of_5(h, goal, next_goal, W, T):
    return (next_goal - W * (goal - h) - h) / T


def b_without_the_period(h, goal, next_goal, W, T):
    return next_goal - W * (goal - h) - h


# The solution


def velocities_are_the_least(solve):
    for q in _postures():
        J, b = jacobian(q, SLIDES), np.random.default_rng(9).normal(size=3)
        assert np.allclose(solve(J, b), np.linalg.lstsq(J, b, rcond=None)[0])


def least_solution(A, b):
    return A.T @ np.linalg.inv(A @ A.T) @ b


def first_columns_alone(A, b):
    return np.r_[0, 0, np.linalg.solve(A[:, 2:], b)]


def solution_exists_where_it_says(exists):
    """Of A x = b for every b: SciPy's least squares leaves nothing over."""
    upright = np.array([0, 0, 0.3, 0.4, np.pi / 2, 0.0])
    for q in (*_postures(), upright):
        A = jacobian(q, SLIDES)
        left = [np.linalg.norm(A @ np.linalg.lstsq(A, b, rcond=1e-12)[0] - b) for b in np.eye(3)]
        assert exists(A) == (max(left) < 1e-9)


def rows_are_independent(A):
    return np.linalg.matrix_rank(A) == A.shape[0]


def fewer_rows_than_columns(A):
    return A.shape[0] < A.shape[1]


def all_solutions_are_there_and_nothing_else(general):
    rng = np.random.default_rng(10)
    for q in _postures():
        J, b = jacobian(q, SLIDES), rng.normal(size=3)
        found = np.array([general(J, b, rng.normal(size=5)) for _ in range(12)])
        assert np.allclose(found @ J.T, b)
        assert np.linalg.matrix_rank(found - found[0], tol=1e-9) == 2
        assert np.allclose(general(J, b, np.zeros(5)), np.linalg.lstsq(J, b, rcond=None)[0])


def general_solution(J, b, v0):
    inverse = J.T @ np.linalg.inv(J @ J.T)
    return inverse @ b + (np.eye(5) - inverse @ J) @ v0


def general_solution_with_the_other_projector(J, b, v0):
    inverse = J.T @ np.linalg.inv(J @ J.T)
    return inverse @ b + inverse @ J @ v0


# The error


def errors_shrink_without_turning_for_these_alone(gains):
    low, high = gains
    for w in np.linspace(-1.4, 1.4, 57):
        e = [1.0]
        for _ in range(3):
            e.append(w * e[-1])
        shrinks = all(0 < after < before for before, after in pairwise(e))
        assert shrinks == (low < w < high)


GAINS, GAINS_UP_TO_TWO = (0.0, 1.0), (0.0, 2.0)


def _tracking(W, T, seconds=30.0, tau=0.0, euler=False, path=None):
    """Errors of the hand [m] at the end of each step, on a sine or a path of one's own."""
    path = path or (lambda t: np.array([0.6 + 0.2 * t, 0.25 * np.sin(0.8 * t), 0.6]))
    q = np.array([0, 0, 0, 0, 1.2, -1.6])
    h, v, errors = _hand(q)[0], np.zeros(5), []
    for k in range(round(seconds / T)):
        goal, after = path(k * T), path((k + 1) * T)
        J = jacobian(q, SLIDES)
        wanted = minimum_norm(J, wanted_velocity(h, goal, after, W, T))
        if euler:
            h = h + T * J @ wanted
            q = _moved(q, wanted, T)
        else:
            for _ in range(4 if tau else 1):
                share = np.exp(-T / 4 / tau) if tau else 0.0
                v = wanted + share * (v - wanted)
                q = _moved(q, v, T / 4 if tau else T, 1 if tau else 4)
            h = _hand(q)[0]
        errors.append(after - h)
    return np.array(errors)


def errors_are_those_of_the_euler_robot(error):
    for w in (0.3, 0.7):
        found = _tracking(w, 0.1, 3.0, euler=True)
        n = np.arange(1, len(found) + 1)
        start = np.array([0.6, 0, 0.6]) - _hand(np.array([0, 0, 0, 0, 1.2, -1.6]))[0]
        assert np.allclose(found, [error(w, k) * start for k in n], atol=1e-12)


def power_of_the_gain(w, n):
    return w**n


def gain_times_the_steps(w, n):
    return w * n


@cache
def _left(W, T):
    errors = _tracking(W, T)[round(20 / T) :]
    return np.sqrt((errors**2).sum(axis=1).mean())


def error_left_falls_with_the_period_to_this_power(power):
    """On the robot itself, which follows a curve in a step: rms over the last ten seconds."""
    for W in (0.3, 0.9):
        coarse, fine = _left(W, 0.1), _left(W, 0.05)
        assert coarse > 1e-5
        assert abs(np.log2(coarse / fine) - power) < 0.15


POWER, NOTHING_IS_LEFT = 2.0, np.inf


def robot_with_drives_errs_so(error):
    """Drives with a time constant of two periods, one direction, a goal that stands."""
    w, T, tau = 0.3, 0.1, 0.2
    e, v, found = 1.0, 0.0, []
    for _ in range(12):
        wanted, share = (1 - w) * e / T, np.exp(-T / tau)
        e -= wanted * T + (v - wanted) * tau * (1 - share)
        v = wanted + (v - wanted) * share
        found.append(e)
    assert np.allclose([error(w, n, T, tau) for n in range(1, 13)], found, atol=1e-9)


def error_of_a_lagging_robot(w, n, T, tau):
    a = np.exp(-T / tau)
    step = np.array([[1 - (1 - w) * (1 - tau / T * (1 - a)), -tau * (1 - a)],
                     [(1 - w) / T * (1 - a), a]])  # fmt: skip
    return (np.linalg.matrix_power(step, n) @ [1.0, 0.0])[0]


def error_if_velocities_were_as_told(w, n, T, tau):
    return w**n


def gain_near_this_end_is_quick(end):
    """Steps until the error is a hundredth, on the robot itself."""
    steps = {}
    for name, w in (("near 0", 0.05), ("near 1", 0.95)):
        errors = np.linalg.norm(
            _tracking(w, 0.02, 8.0, path=lambda t: np.array([0.5, 0.1, 0.7])), axis=1
        )
        steps[name] = int(np.argmax(errors < errors[0] / w / 100))
    assert 0 < steps[end] < min(n for name, n in steps.items() if name != end) / 5


QUICK_END, SLOW_END = "near 0", "near 1"


# Manipulability


def it_is_the_product_of_the_singular_values(w):
    for q in _postures():
        J = jacobian(q, SLIDES)
        assert np.isclose(w(J), np.prod(np.linalg.svd(J, compute_uv=False)), atol=1e-12)


def root_of_the_determinant(J):
    return np.sqrt(np.linalg.det(J @ J.T))


def root_of_the_other_determinant(J):
    return np.sqrt(np.abs(np.linalg.det(J.T @ J)))


def it_is_zero_where_a_stretched_arm_has_lost_a_direction(w):
    q = _postures(200)
    q[:, 5] = 0.0
    assert np.max([w(one) for one in q]) < 1e-12


def w_of_the_arm(q):
    return manipulability(jacobian(q, SLIDES)[:, 2:])


def w_of_the_whole_robot(q):
    return manipulability(jacobian(q, SLIDES))


def prefers_the_same_posture_in_metres_and_in_feet(gradient):
    feet = SlidesRobot(*(np.array([SLIDES.a, SLIDES.h, SLIDES.l2, SLIDES.l3]) / 0.3048))
    for q in _postures():
        here, there = gradient(q, SLIDES), gradient(q, feet)
        assert np.allclose(here / np.linalg.norm(here), there / np.linalg.norm(there), atol=1e-9)


def gradient_with_a_length(q, robot):
    return manipulability_gradient(q, robot, "whole", length_weights(robot))


def gradient_of_metres_and_radians(q, robot):
    return manipulability_gradient(q, robot, "whole")


def can_be_changed_at_will_where_w_says_so(rows):
    """All that the Jacobian with these rows moves, at postures where w is above zero."""
    for q in _postures():
        c, s = np.cos(q[2]), np.sin(q[2])
        axes = SLIDES.axes(q[3:])
        turning = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.c_[np.zeros(3), [0, 0, 1], axes]
        J = {"position": jacobian(q, SLIDES), "orientation": turning}
        stacked = np.vstack([J[row] for row in rows])
        assert (w_of_the_whole_robot(q) > 1e-6) == (np.linalg.matrix_rank(stacked) == len(stacked))


POSITION, POSITION_AND_ORIENTATION = ("position",), ("position", "orientation")


# Obstacles: distance d, bearing alpha to the left, r


def turns_away_from_what_is_ahead(omega):
    for alpha in (0.0, 0.1, 0.7, 1.4):
        assert omega(0.4, alpha, 1.0) * omega(0.4, -alpha, 1.0) < 0 or alpha == 0
        assert abs(omega(0.4, alpha, 1.0)) > 0.01


def _mended(d, alpha, r):
    q, post = np.zeros(6), d * np.array([[np.cos(alpha), np.sin(alpha)]])
    return steer_clear(q, post, within=r, brake=1.0, turn=1.0, robot=SLIDES)


def omega_mended(d, alpha, r):
    return _mended(d, alpha, r)[1]


def slows_a_platform_that_drives_at_an_obstacle(u):
    """A repulsion: what is ahead pushes back, the more the nearer, with a gain above zero."""
    for alpha in (0.0, 0.3, -1.0):
        assert u(0.2, alpha, 1.0) < u(0.6, alpha, 1.0) < 0


def u_mended(d, alpha, r):
    return _mended(d, alpha, r)[0]


def has_an_end_at_r_and_abeam(terms):
    for d, alpha in ((1.0, 0.2), (1.5, 0.0), (3.0, -1.0), (0.4, 2.0), (0.4, -3.0)):
        assert np.allclose(terms(d, alpha, 1.0), 0, atol=1e-12)
    assert np.linalg.norm(terms(0.4, 0.3, 1.0)) > 0.1


def terms_mended(d, alpha, r):
    return _mended(d, alpha, r)[:2]


def printed_terms(d, alpha, r):
    return printed.u_obs(d, alpha, r), printed.omega_obs(d, alpha, r)


def it_says_all_that_the_terms_need(given):
    assert {"k_omega", "k_u", "r", "sign of alpha"} <= given


ALL_THAT_THE_TERMS_NEED = {"k_omega", "k_u", "r", "sign of alpha"}
PRINTED_OF_THE_TERMS = set()


# The conclusions, and the experiments


def it_says_all_that_a_run_needs(given):
    needed = {"T0", "W", "path", "secondary gain", "a", "h", "l2", "l3"}
    assert needed <= given


ALL_THAT_A_RUN_NEEDS = {"T0", "W", "path", "secondary gain", "a", "h", "l2", "l3"}
PRINTED_OF_THE_RUNS = set()


def needs_velocities_as_large_as_one_over_the_distance(posture):
    """The hand's worst direction, nearer and nearer to the singularity."""
    largest = []
    for away in (1e-1, 1e-2, 1e-3):
        J = jacobian(posture(away), SLIDES)
        ways = np.linalg.svd(J)[0].T
        largest.append(max(np.linalg.norm(minimum_norm(J, way)) for way in ways))
    assert largest[1] > 5 * largest[0] and largest[2] > 5 * largest[1]


def nearly_upright(away):
    return np.array([0, 0, 0.3, 0.4, np.pi / 2 - away, 0.0])


def stretched_ahead(away):
    return np.array([0, 0, 0.3, 0.4, 0.3, away])


def _with(task, seconds=60.0, T=0.1, W=0.3):
    """w of six arms while their hands go along a sine, over the largest that the arm can have."""
    bent = [[0.3, 0.8, -1.0], [0, 1.2, -1.6], [-0.5, 1.0, -1.3], [0.2, 0.3, 0.9], [0, 0.9, -0.6]]
    q = np.array([[0, 0, 0, *arm] for arm in bent], float)
    start, found = _hand(q), []

    def path(t):
        return start + np.array([0.1 * t, 0.15 * np.sin(0.4 * t), 0])

    for k in range(round(seconds / T)):
        J = jacobian(q, SLIDES)
        b = wanted_velocity(_hand(q), path(k * T), path((k + 1) * T), W, T)
        q = _moved(q, minimum_norm(J, b, task(q)), T, 2)
        found.append(manipulability(J[..., 2:]))
    return np.array(found) / 0.032


def arms_stay_bent_at_every_instant(task):
    w = _with(task)
    assert (w > 0.5 * w[0]).all() and (w[-1] > 0.6).all()


def ascent_of_the_arms_own_w(q):
    return np.insert(10 * manipulability_gradient(q, SLIDES), [0, 0], 0, axis=-1)


def ascent_of_w_as_printed(q):
    return np.insert(manipulability_gradient(q, SLIDES, "whole"), [0, 0], 0, axis=-1)


def hand_can_follow_at_these_heights(reached):
    """The arm's own bound: the hand is at most l2 + l3 above or below the shoulder."""
    angles = np.random.default_rng(11).uniform(-np.pi, np.pi, (20000, 3))
    z = _hand(np.c_[np.zeros((20000, 3)), angles])[:, 2]
    for height in (0.0, 0.4, 0.9, 1.2, -0.5):
        assert reached(height) == (z.min() - 1e-3 < height < z.max() + 1e-3)


def heights_of_the_arm(z):
    return abs(z - SLIDES.h) < SLIDES.l2 + SLIDES.l3


def any_height(z):
    return True


def passes_a_post_dead_ahead(avoid):
    """Platform of 0.25 m, post of 0.05 m; the hand goes straight over it."""
    q, T = np.array([0, 0, 0, 0, 1.2, -1.6]), 0.1
    start = _hand(q)[0]
    on = np.array([0.02, 0, 0])
    for k in range(150):
        b = wanted_velocity(_hand(q)[0], start + k * on, start + (k + 1) * on, 0.3, T)
        d, alpha = np.hypot(1.5 - q[0], q[1]), np.arctan2(-q[1], 1.5 - q[0]) - q[2]
        alpha = (alpha + np.pi) % (2 * np.pi) - np.pi
        v0 = np.r_[avoid(d, alpha), 0.3 * (np.array([0, 1.2, -1.6]) - q[3:])]
        q = _moved(q, minimum_norm(jacobian(q, SLIDES), b, v0), T)
        assert np.hypot(1.5 - q[0], q[1]) > 0.3
    assert q[0] > 1.5


def avoiding_as_mended(d, alpha):
    return _mended(max(d - 0.3, 0.0), alpha, 0.7)[:2] * [0.2, 4.0]


def avoiding_as_printed(d, alpha):
    if d >= 1.0:
        return np.zeros(2)
    return np.array([printed.u_obs(d, alpha, 1.0, -0.5), printed.omega_obs(d, alpha, 1.0, -2.0)])


class _Counted(float):
    """A number that counts multiplications and divisions."""

    count = 0

    def _times(self, other):
        _Counted.count += 1
        return _Counted(float(self) * float(other))

    def _plus(self, other):
        return _Counted(float(self) + float(other))

    __mul__ = __rmul__ = _times
    __add__ = __radd__ = _plus


def step_takes_no_more_multiplications(most: int):
    """J J^T, its solution by Cramer's rule, J^T y, for the slides' robot, counted one by one."""
    J = [[_Counted(x) for x in row] for row in jacobian(_postures(1)[0], SLIDES)]
    b = [_Counted(x) for x in (0.1, -0.2, 0.05)]
    _Counted.count = 0
    A = [[sum((x * y for x, y in zip(r, s, strict=True)), _Counted(0)) for s in J] for r in J]

    def minor(i, j):
        (p, q), (r, s) = ([A[k][m] for m in range(3) if m != j] for k in range(3) if k != i)
        return p * s + (q * r) * -1.0

    cofactors = [[minor(i, j) * (-1.0) ** (i + j) for j in range(3)] for i in range(3)]
    det = sum((A[0][j] * cofactors[0][j] for j in range(3)), _Counted(0))
    y = [sum((cofactors[i][j] * b[i] for i in range(3)), _Counted(0)) * (1 / det) for j in range(3)]
    v = [sum((J[i][k] * y[i] for i in range(3)), _Counted(0)) for k in range(5)]
    assert np.allclose(v, np.linalg.lstsq(np.array(J, float), np.array(b, float), rcond=None)[0])
    assert _Counted.count <= most < 1000


MULTIPLICATIONS, TOO_FEW = 111, 110
