"""Dead reckoning: integration, sums, the group of poses, orders of convergence."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from backhoe.localisation import odometry
from backhoe.localisation.odometry import METHODS, RULES, streaming

START = np.array([1.0, -2.0, 0.4])
MOTION = odometry.winding()
speeds = st.floats(-3.0, 3.0)


def solved(v, omega, dt, pose0=START):
    """Poses at the ends of intervals with held speeds, by SciPy, interval after interval."""
    poses = [np.array(pose0)]
    for speed, turning, time in zip(v, omega, np.broadcast_to(dt, len(v)), strict=True):

        def rate(_, pose, speed=speed, turning=turning):
            return [speed * np.cos(pose[2]), speed * np.sin(pose[2]), turning]

        end = solve_ivp(rate, (0, time), poses[-1], method="DOP853", rtol=1e-12, atol=1e-12)
        poses.append(end.y[:, -1])
    return np.array(poses)


def test_exact_is_what_scipy_finds_for_held_speeds_and_uneven_steps():
    rng = np.random.default_rng(1)
    v, omega, dt = rng.normal(size=(3, 20))
    omega[4] = 0.0
    dt = 0.05 + np.abs(dt)
    np.testing.assert_allclose(
        odometry.integrate(START, v, omega, dt, "exact"), solved(v, omega, dt), atol=1e-9
    )


def test_rk4_is_the_classical_rule_and_bilinear_is_heuns():
    rng = np.random.default_rng(2)
    v, omega = rng.normal(size=(2, 30))

    def rate(pose, k):
        return np.array([v[k] * np.cos(pose[2]), v[k] * np.sin(pose[2]), omega[k]])

    by_rk4, by_heun, dt = [START], [START], 0.3
    for k in range(30):
        x = by_rk4[-1]
        k1 = rate(x, k)
        k2 = rate(x + dt / 2 * k1, k)
        k3 = rate(x + dt / 2 * k2, k)
        by_rk4.append(x + dt / 6 * (k1 + 2 * k2 + 2 * k3 + rate(x + dt * k3, k)))
        x = by_heun[-1]
        by_heun.append(x + dt / 2 * (rate(x, k) + rate(x + dt * rate(x, k), k)))
    np.testing.assert_allclose(odometry.integrate(START, v, omega, dt, "rk4"), by_rk4, atol=1e-13)
    np.testing.assert_allclose(
        odometry.integrate(START, v, omega, dt, "bilinear"), by_heun, atol=1e-13
    )


def test_euler_and_midpoint_take_the_heading_at_the_start_and_in_the_middle():
    poses = odometry.integrate([0, 0, 0.5], [2.0], [0.8], 0.5, "euler")
    np.testing.assert_allclose(poses[1], [np.cos(0.5), np.sin(0.5), 0.9], rtol=1e-15)
    poses = odometry.integrate([0, 0, 0.5], [2.0], [0.8], 0.5, "midpoint")
    np.testing.assert_allclose(poses[1], [np.cos(0.7), np.sin(0.7), 0.9], rtol=1e-15)


@pytest.mark.parametrize(
    ("method", "order"), [("euler", 1), ("midpoint", 2), ("bilinear", 2), ("rk4", 4)]
)
def test_order_of_each_method_for_held_speeds(method, order):
    errors, steps = [], np.array([16, 32, 64])
    truth = odometry.se2_exp([6.0, 0.0, 4.0])
    for n in steps:
        end = odometry.integrate(np.zeros(3), np.full(n, 1.5), np.ones(n), 4 / n, method)[-1]
        errors.append(np.hypot(*(end - truth)[:2]))
    assert odometry.order(4 / steps, errors) == pytest.approx(order, abs=0.03)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("rule", RULES)
def test_order_of_each_method_for_sampled_speeds_that_vary(method, rule):
    def estimate(t, v, omega):
        return odometry.from_samples(np.zeros(3), t, v, omega, rule=rule, method=method)

    order = odometry.order(*odometry.final_errors(estimate, (200, 400, 800, 1600)))
    expected = 2 if rule == "trapezoid" and method != "euler" else 1
    assert order == pytest.approx(expected, abs=0.03)


def test_the_trapezoid_of_the_rates_is_the_bilinear_rule_solved():
    t = MOTION.instants(80)
    v, omega = MOTION.v(t), MOTION.omega(t)
    robot = odometry.differential(0.35, 2.0)
    u = robot.wheel_speeds(np.stack([v, 0 * v, omega], axis=-1))
    np.testing.assert_allclose(
        odometry.from_samples(START, t, v, omega, method="bilinear"),
        streaming.run(streaming.bilinear, robot.rate, t, u, START),
        atol=1e-10,
    )


def test_the_winding_motion_is_what_its_speeds_lead_to():
    def rate(t, pose):
        return [MOTION.v(t) * np.cos(pose[2]), MOTION.v(t) * np.sin(pose[2]), MOTION.omega(t)]

    t = np.linspace(0, MOTION.duration, 9)
    found = solve_ivp(rate, t[[0, -1]], [0, 0, 0], t_eval=t, rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(MOTION.pose(t), found.y.T, atol=1e-7)


def test_the_heading_is_not_wrapped():
    poses = odometry.integrate(np.zeros(3), np.zeros(100), np.ones(100), 1.0)
    assert poses[-1, 2] == pytest.approx(100.0)


@given(speeds, speeds, st.floats(0.01, 2.0))
def test_a_held_twist_moves_as_its_matrix_exponential(v, omega, time):
    generator = time * np.array([[0, -omega, v], [omega, 0, 0], [0, 0, 0]])
    pose = odometry.integrate(np.zeros(3), [v], [omega], time)[1]
    np.testing.assert_allclose(odometry.se2_matrix(pose), expm(generator), atol=1e-10)


@pytest.mark.parametrize("omega", [0.0, 1e-300, 1e-12, 1e-8, -1e-5, 1e-3, -2.0])
def test_the_arc_is_safe_at_any_turning_speed(omega):
    from mpmath import mp, mpf

    with mp.workdps(60):
        w = mpf(omega) if omega else mpf("1e-40")
        x, y = 5 * mp.sin(2 * w) / (2 * w), 5 * (1 - mp.cos(2 * w)) / (2 * w)
    pose = odometry.integrate(np.zeros(3), [2.5], [omega], 2.0)[1]
    np.testing.assert_allclose(pose[:2], [float(x), float(y)], rtol=3e-16, atol=1e-30)


def test_going_back_the_way_one_came_ends_where_it_began():
    rng = np.random.default_rng(3)
    v, omega = rng.normal(size=(2, 4, 50))
    there = odometry.integrate(START, v, omega, 0.1)
    back = odometry.integrate(there[:, -1], -v[:, ::-1], -omega[:, ::-1], 0.1)
    np.testing.assert_allclose(back[:, ::-1], there, atol=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_batches_are_the_same_as_one_after_another(method):
    rng = np.random.default_rng(4)
    v, omega, poses0 = (
        rng.normal(size=(2, 3, 40)),
        rng.normal(size=(2, 3, 40)),
        rng.normal(size=(2, 3, 3)),
    )
    dt = rng.uniform(0.01, 0.2, 40)
    together = odometry.integrate(poses0, v, omega, dt, method)
    assert together.shape == (2, 3, 41, 3)
    for i in np.ndindex(2, 3):
        alone = odometry.integrate(poses0[i], v[i], omega[i], dt, method)
        np.testing.assert_allclose(together[i], alone, atol=1e-14)


@pytest.mark.parametrize("method", METHODS)
def test_advance_repeated_is_integrate(method):
    rng = np.random.default_rng(5)
    distance, turn = rng.normal(size=(2, 20))
    pose, poses = START, [START]
    for d, a in zip(distance, turn, strict=True):
        pose = odometry.advance(pose, d, a, method)
        poses.append(pose)
    np.testing.assert_allclose(
        odometry.integrate(START, distance, turn, 1.0, method), poses, atol=1e-13
    )


def test_sums_are_rectangles_and_trapezoids_on_uneven_steps():
    t = np.array([0.0, 0.5, 2.0, 2.25])
    v = np.array([[1.0, 2.0, -1.0, 4.0], [0.0, 1.0, 1.0, 1.0]])
    np.testing.assert_allclose(odometry.euler_sum(t, v, 10.0)[0], [10, 11, 9.5, 10.5])
    np.testing.assert_allclose(odometry.bilinear_sum(t, v)[0], [0, 0.75, 1.5, 1.875])
    np.testing.assert_allclose(odometry.bilinear_sum(t, v, [1.0, 2.0])[:, 0], [1.0, 2.0])


def test_constant_steps_give_the_sums_of_3_and_5():
    v, dt = np.random.default_rng(10).normal(size=40), 0.03
    t = dt * np.arange(40)
    euler, bilinear = [0.0], [0.0]
    for k in range(1, 40):
        euler.append(euler[-1] + v[k] * dt)
        bilinear.append(bilinear[-1] + (v[k] + v[k - 1]) * dt / 2)
    np.testing.assert_allclose(odometry.euler_sum(t, v), euler, atol=1e-14)
    np.testing.assert_allclose(odometry.bilinear_sum(t, v), bilinear, atol=1e-14)


@pytest.mark.parametrize(("rule", "order"), [("euler_sum", 1), ("bilinear_sum", 2)])
def test_order_of_the_sums_on_steps_that_vary(rule, order):
    rng = np.random.default_rng(11)
    shares = np.sort(rng.uniform(0, 1, 39))
    coarse = 3.0 * np.r_[0, shares, 1]
    errors, steps = [], 2.0 ** -np.arange(5)
    for halvings in range(5):
        t = np.interp(np.linspace(0, 40, 40 * 2**halvings + 1), np.arange(41), coarse)
        errors.append(abs(getattr(odometry, rule)(t, np.exp(t))[-1] - np.expm1(3.0)))
    assert odometry.order(steps, errors) == pytest.approx(order, abs=0.05)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([0, 0], [1], [1], 0.1), r"pose0 must end in 3 values \(x, y, psi\), got shape \(2,\)"),
        ((START, [1, 2], [1], 0.1), r"v and omega must be alike, got shapes \(2,\), \(1,\)"),
        ((START, 1.0, 1.0, 0.1), r"v must end in N values, got shape \(\)"),
        ((np.zeros((2, 3)), [1], [1], 0.1), r"pose0 must be \(3,\) for velocities of shape \(1,\)"),
        ((START, [1, np.nan], [1, 1], 0.1), "v must be finite, got nan at index 1"),
        ((START, ["a"], [1], 0.1), "v must be numbers"),
        ((START, [1], [1], 0.0), "dt must be above 0 s, got 0.0"),
        ((START, [1, 1], [1, 1], [0.1, -0.1]), "do the times run backwards"),
        (
            (START, [1, 1], [1, 1], [0.1, 0.1, 0.1]),
            r"one for each of 2 intervals, got shape \(3,\)",
        ),
        ((START, [1], [1], 0.1, "Euler"), "must be one of euler, midpoint, .*got 'Euler'"),
        ((START, [1], [1], 0.1, None), "must be one of"),
    ],
)
def test_integrate_refuses_what_it_cannot_integrate(arguments, message):
    with pytest.raises(ValueError, match=message):
        odometry.integrate(*arguments)


@pytest.mark.parametrize(
    ("t", "v", "message"),
    [
        ([0, 1], [1, 2, 3], r"must end in 2 samples, one for each time, got shape \(3,\)"),
        ([0, 1, 1], [1, 2, 3], "1.0 s at index 1 is followed by 1.0 s"),
        ([0], [1], "2 or more times"),
        ([0, np.inf], [1, 2], "t must be finite"),
        ([0, 1], [1, np.nan], "finite, got nan"),
    ],
)
def test_samples_must_fit_their_times(t, v, message):
    with pytest.raises(ValueError, match=message):
        odometry.bilinear_sum(t, v)
    with pytest.raises(ValueError, match=message):
        odometry.from_samples(START, t, v, v)


def test_more_bad_input_is_named():
    with pytest.raises(ValueError, match="rule must be one of left, right, trapezoid, got 'both'"):
        odometry.from_samples(START, [0, 1], [1, 1], [0, 0], rule="both")
    with pytest.raises(ValueError, match="method must be one of"):
        odometry.from_samples(START, [0, 1], [1, 1], [0, 0], method="best")
    with pytest.raises(ValueError, match="x0 must be one position"):
        odometry.euler_sum([0, 1], [1, 1], [0, 0])


@pytest.mark.parametrize(
    ("steps", "errors", "message"),
    [
        ([1, 2], [1, 2, 3], r"errors must have shape \(2,\), got shape \(3,\)"),
        ([1], [1], "above 0, 2 or more"),
        ([1, 2], [0, 1], "above 0, 2 or more: an error of 0 has no order"),
    ],
)
def test_an_order_needs_errors_that_are_not_zero(steps, errors, message):
    with pytest.raises(ValueError, match=message):
        odometry.order(steps, errors)


def test_final_errors_wants_poses_from_the_estimator():
    with pytest.raises(
        ValueError, match=r"the estimator's poses must end in 3 values \(x, y, psi\)"
    ):
        odometry.final_errors(lambda t, v, omega: v)
    with pytest.raises(ValueError, match="steps must be one whole number at least 1, got 0"):
        odometry.final_errors(lambda t, v, omega: START, [0])
    with pytest.raises(ValueError, match="duration must be one number above 0"):
        odometry.winding(duration=0)


def test_a_motion_may_start_from_rest():
    motion = odometry.winding(turning=0.3, frequency=0.5, swing=-0.6)
    assert motion.omega(0.0) == pytest.approx(0.0) and motion.v(0.0) == pytest.approx(0.0)
