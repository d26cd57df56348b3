"""What D'Angelo prints in chapters 5 to 7 and 9, judged."""

import numpy as np
import pytest

from backhoe.lessons import published
from backhoe.lessons.path_tracking import printed
from backhoe.vehicle import tracking

T0 = 0.1
sp = pytest.importorskip("sympy")


def goal_at(x, y):
    return tracking.Goal(np.array([x, y]), np.array([x, y]), 0.5, np.eye(2), T0)


def test_613_is_the_tracker_where_no_angle_needs_wrapping():
    rng = np.random.default_rng(6)
    for theta, x, y in rng.uniform(-1.5, 1.5, (50, 3)):
        expected = printed.taylor_613((0, 0, theta), (abs(x), y), T0)
        found = tracking.ScagliaTaylor()([0, 0, theta], [0, 0], goal_at(abs(x), y), T0)
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)


def test_913_as_printed_solves_to_a_denominator_that_can_vanish():
    V, dx, dy, th, T, k1, k2 = sp.symbols("V dx dy th T k1 k2")
    miss = (dx - V * sp.cos(th) * T) * sp.cos(th) * T + (dy - V * sp.sin(th) * T) * sp.sin(th) * T
    as_printed = sp.solve(k1 * 2 * miss + k2 * 2 * V, V)[0]
    right = sp.solve(-k1 * 2 * miss + k2 * 2 * V, V)[0]
    ahead = dx * sp.cos(th) + dy * sp.sin(th)
    assert sp.simplify(as_printed - k1 * T * ahead / (k1 * T**2 - k2)) == 0
    assert sp.simplify(right - k1 * T * ahead / (k1 * T**2 + k2)) == 0


def test_614_gains_lie_between_0_and_1():
    rng = np.random.default_rng(7)
    for k in rng.uniform(0.01, 10, (50, 4)):
        assert all(0 < gain < 1 for gain in printed.gains_614(k, T0))


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
