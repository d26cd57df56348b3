"""What D'Angelo prints in chapters 5 to 7 and 9, judged."""

import numpy as np
import pytest

from backhoe.lessons import published
from backhoe.lessons.path_tracking import printed
from backhoe.vehicle import tracking

T0 = 0.1
K = (1.0, 0.015, 2.0, 0.03)
sp = pytest.importorskip("sympy")


def goal_at(x, y):
    return tracking.Goal(np.array([x, y]), np.array([x, y]), 0.5, np.eye(2), T0)


def test_51_has_the_same_rho_and_lateral_error():
    rng = np.random.default_rng(5)
    for pose, a, b in zip(
        rng.normal(size=(50, 3)), rng.normal(size=(50, 2)), rng.normal(size=(50, 2)), strict=True
    ):
        rho, _, dy, _ = printed.pose_errors_51(pose, a, b)
        ours = tracking.pose_errors(pose, a, b)
        assert (ours.rho, ours.dy) == (pytest.approx(rho), pytest.approx(dy))


def test_51_alpha_asks_for_the_turn_that_the_lateral_error_forbids():
    _, _, dy, alpha = printed.pose_errors_51((0, 0, 0), (1, 0.1), (2, 1.1))
    assert dy > 0 > alpha
    ours = tracking.pose_errors((0, 0, 0), (1, 0.1), (2, 1.1))
    assert ours.alpha == pytest.approx(-alpha) == pytest.approx(np.pi / 4)


def test_51_angles_leave_a_turn_when_they_are_not_wrapped():
    _, beta, _, alpha = printed.pose_errors_51((0, 0, -3.0), (-1, 0.1), (-2, 0.2))
    assert beta > np.pi and alpha < -np.pi
    assert abs(tracking.pose_errors((0, 0, -3.0), (-1, 0.1), (-2, 0.2)).alpha) < 0.3


def test_61_to_64_the_first_order_step_is_an_approximation_and_no_equality():
    t = np.array([0.1, 0.05])
    errors = np.abs(np.exp(-t) - (1 - t))
    assert errors[0] > 1e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


def test_68_is_of_second_order_only_with_the_input_in_its_inner_rate():
    def h(y, u, t):
        return -y + u

    def slope(step):
        errors = []
        for T in (0.1, 0.05):
            exact = np.exp(-T) * 0.3 + (1 - np.exp(-T)) * 2.0
            errors.append(abs(step(T) - exact))
        return np.log2(errors[0] / errors[1])

    def as_printed(T):
        return printed.step_68(h, [0.3], 2.0, 2.0, 0.0, T)[0]

    def mended(T):
        y = np.array([0.3])
        return (y + T / 2 * (h(y, 2.0, 0) + h(y + T * h(y, 2.0, 0), 2.0, T)))[0]

    assert slope(mended) == pytest.approx(3.0, abs=0.1)
    assert slope(as_printed) == pytest.approx(2.0, abs=0.1)


def test_65_to_67_the_integrals_over_a_linear_heading_are_those_of_the_tracker():
    th, V, W, T, s = sp.symbols("theta V W T s", positive=True)
    dx = sp.integrate(V * sp.cos(th + W * s), (s, 0, T))
    dy = sp.integrate(V * sp.sin(th + W * s), (s, 0, T))
    chord = V * T * sp.sin(W * T / 2) / (W * T / 2)
    at = {th: 0.7, V: 1.2, W: 3.0, T: 0.4}
    for integral, trig in ((dx, sp.cos), (dy, sp.sin)):
        assert float((integral - chord * trig(th + W * T / 2)).subs(at)) == pytest.approx(0)
    place = [float(dx.subs(at)), float(dy.subs(at))]
    found = tracking.ScagliaLinear(1, 1)([0, 0, 0.7], [0, 0], goal_at(*place), 0.4)
    np.testing.assert_allclose(found, [1.2, 3.0])


def test_611_points_the_wrong_way_for_a_goal_on_the_left():
    assert printed.heading_611(-1.0, 0.0) == 0.0
    assert printed.heading_611(-1.0, 0.0, two_arguments=True) == pytest.approx(np.pi)
    V, W = printed.taylor_613((0, 0, np.pi), (-1, 0), T0)
    assert V < 0 and W == pytest.approx(-0.4 * np.pi / T0), "turns away from a goal ahead"
    assert tracking.ScagliaTaylor()([0, 0, np.pi], [0, 0], goal_at(-1, 0), T0) == (
        pytest.approx(4.0),
        pytest.approx(0.0),
    )


def test_613_is_the_tracker_where_no_angle_needs_wrapping():
    rng = np.random.default_rng(6)
    for theta, x, y in rng.uniform(-1.5, 1.5, (50, 3)):
        expected = printed.taylor_613((0, 0, theta), (abs(x), y), T0)
        found = tracking.ScagliaTaylor()([0, 0, theta], [0, 0], goal_at(abs(x), y), T0)
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)


def test_613_is_no_minimum_of_the_cost_and_the_heading_in_its_place_is():
    def slopes(u):
        h = 1e-5
        return np.array(
            [
                (
                    printed.cost_612(*(u + h * e), (0, 0, 0.3), (0.5, 0.6), T0, K)
                    - printed.cost_612(*(u - h * e), (0, 0, 0.3), (0.5, 0.6), T0, K)
                )
                / (2 * h)
                for e in np.eye(2)
            ]
        )

    gains = printed.gains_614(K, T0)
    goal = goal_at(0.5, 0.6)
    least = tracking.ScagliaTaylor(*gains, optimum=True)([0, 0, 0.3], [0, 0], goal, T0)
    np.testing.assert_allclose(slopes(np.array(least)), 0, atol=1e-7)
    as_printed = printed.taylor_613((0, 0, 0.3), (0.5, 0.6), T0, *gains)
    assert abs(slopes(np.array(as_printed))[0]) > 1e-2


def _symbols():
    return sp.symbols("V W dx dy th T k1 k2 k3 k4")


def test_913_lacks_minus_signs():
    pose, goal, u = (0.1, -0.2, 0.4), (0.5, 0.3), np.array([1.5, -0.7])
    h = 1e-6
    true = [
        (
            printed.cost_612(*(u + h * e), pose, goal, T0, K)
            - printed.cost_612(*(u - h * e), pose, goal, T0, K)
        )
        / (2 * h)
        for e in np.eye(2)
    ]
    as_printed = np.array(printed.gradient_913(*u, pose, goal, T0, K))
    spent = 2 * np.array([K[1], K[3]]) * u
    assert not np.allclose(as_printed, true, rtol=0.1)
    np.testing.assert_allclose(spent - (as_printed - spent), true, rtol=1e-6)


def test_913_as_printed_solves_to_a_denominator_that_can_vanish():
    V, _, dx, dy, th, T, k1, k2, _, _ = _symbols()
    miss = (dx - V * sp.cos(th) * T) * sp.cos(th) * T + (dy - V * sp.sin(th) * T) * sp.sin(th) * T
    as_printed = sp.solve(k1 * 2 * miss + k2 * 2 * V, V)[0]
    right = sp.solve(-k1 * 2 * miss + k2 * 2 * V, V)[0]
    ahead = dx * sp.cos(th) + dy * sp.sin(th)
    assert sp.simplify(as_printed - k1 * T * ahead / (k1 * T**2 - k2)) == 0
    assert sp.simplify(right - k1 * T * ahead / (k1 * T**2 + k2)) == 0


def test_614_gains_lie_between_0_and_1_and_are_those_of_the_cost():
    V, _, dx, dy, th, T, k1, k2, _, _ = _symbols()
    J = k1 * ((dx - V * sp.cos(th) * T) ** 2 + (dy - V * sp.sin(th) * T) ** 2) + k2 * V**2
    best = sp.solve(J.diff(V), V)[0]
    at = {dx: 0.3, dy: 0.2, th: 0.5, T: T0, k1: K[0], k2: K[1]}
    ahead = (0.3 * np.cos(0.5) + 0.2 * np.sin(0.5)) / T0
    assert printed.gains_614(K, T0)[0] == pytest.approx(float(best.subs(at)) / ahead)
    rng = np.random.default_rng(7)
    for k in rng.uniform(0.01, 10, (50, 4)):
        assert all(0 < gain < 1 for gain in printed.gains_614(k, T0))


def test_ten_times_is_0_4_for_one_sample_time_alone():
    assert printed.gains_614((10, 1, 10, 1), 0.2582)[0] == pytest.approx(0.4, abs=1e-4)
    assert printed.gains_614((10, 1, 10, 1), 0.1)[0] == pytest.approx(0.0909, abs=1e-4)
    assert printed.gains_614((10, 1, 10, 1), 0.01)[0] == pytest.approx(0.000999, abs=1e-6)


def test_71_is_the_trapezoid_solved_for_the_speed_at_its_end():
    rng = np.random.default_rng(8)
    for theta, V_n, W_n, dx, dy in rng.uniform(-1, 1, (50, 5)):
        V, W = printed.runge_kutta_71(
            (0, 0, theta), (V_n, W_n), (dx, dy), T0, 1.0, 1.0, two_arguments=True
        )
        theta_d = theta + T0 / 2 * (W + W_n)
        ends = [T0 / 2 * (V_n * f(theta) + V * f(theta_d)) for f in (np.cos, np.sin)]
        np.testing.assert_allclose(ends, [dx, dy], atol=1e-12)


def test_71_is_our_tracker_with_half_the_weight_for_each_end():
    rng = np.random.default_rng(9)
    tracker = tracking.ScagliaRungeKutta.printed()
    for theta, V_n, W_n, dx, dy in rng.uniform(-0.5, 0.5, (50, 5)):
        expected = printed.runge_kutta_71(
            (0, 0, theta), (V_n, W_n), (dx, dy), T0, two_arguments=True
        )
        turn = (expected[1] / 0.5 + W_n) * T0 / 2
        if abs(turn) < np.pi:
            found = tracker([0, 0, theta], [V_n, W_n], goal_at(dx, dy), T0)
            np.testing.assert_allclose(found, expected, rtol=1e-9)


def _speeds(kv, ramp, lag=0.0, samples=40, start=(0.0, 0.0)):
    (x, V), speeds = start, []
    for k in range(samples):
        U, _ = printed.runge_kutta_71(
            (x, 0, 0), (V, 0), (0.5 * T0 * (k + 1), 0), T0, kv, two_arguments=True
        )
        keeps = np.exp(-1 / lag) if lag else 0.0
        if ramp:
            x, V = x + T0 * (V + U) / 2, U
        else:
            x, V = x + T0 * (U + lag * (1 - keeps) * (V - U)), keeps * V + (1 - keeps) * U
        speeds.append(V)
    return np.array(speeds)


def test_71a_has_a_mode_that_never_dies_where_the_speed_ramps_as_its_derivation_supposes():
    np.testing.assert_allclose(np.sort(_speeds(1.0, ramp=True)[-2:]), [0.0, 1.0], atol=1e-9)
    np.testing.assert_allclose(np.sort(_speeds(0.4, ramp=True)[-2:]), [0.375, 0.625], atol=1e-9)


@pytest.mark.parametrize("kv", [0.2, 0.4, 1.0])
def test_71a_grows_where_the_vehicle_obeys_at_once_and_the_command_is_held(kv):
    behind = 0.5 * T0 * (1 / kv - 1)
    steady = _speeds(kv, ramp=False, start=(-behind, 0.5))
    np.testing.assert_allclose(steady[:5], 0.5, atol=1e-9)
    errors = _speeds(kv, ramp=False, start=(-behind, 0.5 + 1e-6), samples=12) - 0.5
    assert errors[-1] / errors[-2] == pytest.approx(-kv - np.sqrt(kv**2 + 1), rel=1e-2)


def test_71a_settles_on_a_vehicle_whose_speed_lags_by_a_sample():
    np.testing.assert_allclose(_speeds(0.4, ramp=False, lag=1.0)[-3:], 0.5, atol=1e-6)


def test_71c_with_one_argument_loses_the_half_plane():
    one = printed.runge_kutta_71((0, 0, np.pi), (0, 0), (-1, 0), T0)
    two = printed.runge_kutta_71((0, 0, np.pi), (0, 0), (-1, 0), T0, two_arguments=True)
    assert one[0] < 0 < two[0]
    assert abs(one[1]) > 10 and two[1] == pytest.approx(0.0)


@pytest.mark.parametrize("path", ["circle", "square", "figure_eight"])
def test_table_51_has_its_bold_marks_where_the_best_values_are(path):
    table = published.load("dangelo_2022_table_51")
    for metric, marked in table["bold"][path].items():
        bad = {kind: abs(table[kind][path][metric] - (metric == "d_ratio")) for kind in ("P", "PI")}
        best = [kind for kind, value in bad.items() if value == min(bad.values())]
        assert best == marked


def test_table_51_circle_is_shorter_than_its_ideal_so_the_approach_is_cut():
    ideal = 1 + 1 / (2 * np.pi)
    for table in ("dangelo_2022_table_51", "dangelo_2022_table_52"):
        data = published.load(table)
        for part in [data["P"], data["PI"]] if "P" in data else [data]:
            assert part["circle"]["d_ratio"] < ideal - 0.05
            assert part["circle"]["d_max"] == 1.5
