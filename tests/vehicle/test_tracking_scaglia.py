"""Scaglia's three trackers: what each is derived from, and how its errors die away."""

from math import cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from backhoe.basics.angles import wrap
from backhoe.lessons.path_tracking import printed
from backhoe.vehicle import tracking
from backhoe.vehicle.tracking import (
    Goal,
    ScagliaLinear,
    ScagliaRungeKutta,
    ScagliaTaylor,
    arc,
)

T0 = 0.1
SPEED = 0.5
PATH = np.array([[0.0, 0.0], [1.0, 0.0]])
angles = st.floats(-20.0, 20.0)
ways = st.floats(-3.0, 3.0)


def goal_at(x, y, speed=SPEED):
    return Goal(np.array([x, y]), np.array([x, y]), speed, PATH, T0)


def off_axis(dx, dy, theta):
    """Leave out goals too near, and those behind or at the side, where rounding picks the turn."""
    assume(hypot(dx, dy) > 0.01)
    turn = abs(wrap(np.arctan2(dy, dx) - theta))
    assume(turn < pi - 1e-6 and abs(turn - pi / 2) > 1e-6)


def driven(pose, v, omega, time=T0):
    """The unicycle integrated by DOP853: an oracle for `arc` and for what lands on the goal."""

    def rate(t, p):
        return [v * cos(p[2]), v * sin(p[2]), omega]

    return solve_ivp(rate, (0, time), pose, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]


@pytest.mark.parametrize("omega", [0.0, 1e-9, 0.7, -8.0, 40.0])
def test_the_arc_is_the_unicycle_integrated(omega):
    pose = [0.3, -0.4, 2.0]
    np.testing.assert_allclose(arc(pose, 1.3, omega, T0), driven(pose, 1.3, omega), atol=1e-11)


@given(ways, ways, angles)
def test_taylor_with_the_heading_in_v_makes_the_cost_least(dx, dy, theta):
    off_axis(dx, dy, theta)
    k_squared = (1.0, 0.015, 2.0, 0.03)
    gains = printed.gains_614(k_squared, T0)
    theta = wrap(theta)
    V, W = ScagliaTaylor(*gains, optimum=True)([0, 0, theta], [0, 0], goal_at(dx, dy), T0)
    behind = np.arctan2(dy, dx) - theta
    theta += 2 * pi * round(behind / (2 * pi))

    def cost(u):
        return printed.cost_612(u[0], u[1], (0, 0, theta), (dx, dy), T0, k_squared)

    best = np.array([V, W])
    slopes = [(cost(best + e) - cost(best - e)) / 2 for e in np.eye(2)]
    np.testing.assert_allclose(slopes, 0.0, atol=1e-9 * (1 + abs(V) + abs(W)) ** 2)
    V_printed, W_printed = ScagliaTaylor(*gains)([0, 0, theta], [0, 0], goal_at(dx, dy), T0)
    assert cost([V_printed, W_printed]) >= cost([V, W]) - 1e-12


def test_the_printed_v_costs_more_than_the_minimum_and_drives_on_with_the_goal_at_its_side():
    V_printed, _ = ScagliaTaylor()([0, 0, 0], [0, 0], goal_at(0.0, 1.0), T0)
    V_least, _ = ScagliaTaylor(optimum=True)([0, 0, 0], [0, 0], goal_at(0.0, 1.0), T0)
    assert V_printed == pytest.approx(0.4 * 1.0 / T0)
    assert V_least == pytest.approx(0.0, abs=1e-15)
    k = (1.0, 0.015, 1.0, 0.015)
    costs = [printed.cost_612(V, 0.0, (0, 0, 0), (0.0, 1.0), T0, k) for V in (V_printed, V_least)]
    assert costs[0] > 1.1 * costs[1]


def test_sympy_finds_the_optimum_of_the_cost():
    sp = pytest.importorskip("sympy")
    V, W, dx, dy, th, thd, T, k1, k2, k3, k4 = sp.symbols("V W dx dy th thd T k1 k2 k3 k4")
    J = (
        k1 * ((dx - V * sp.cos(th) * T) ** 2 + (dy - V * sp.sin(th) * T) ** 2)
        + k2 * V**2
        + k3 * (thd - th - W * T) ** 2
        + k4 * W**2
    )
    best = sp.solve([J.diff(V), J.diff(W)], [V, W], dict=True)[0]
    kv2, kw2 = k1 / (k1 + k2 / T**2), k3 / (k3 + k4 / T**2)
    assert sp.simplify(best[V] - kv2 * (dx * sp.cos(th) + dy * sp.sin(th)) / T) == 0
    assert sp.simplify(best[W] - kw2 * (thd - th) / T) == 0


def test_ten_times_heavier_is_a_matter_of_the_sample_time():
    assert tracking.weight_ratio(0.4, 0.2582) == pytest.approx(10.0, rel=1e-3)
    assert tracking.weight_ratio(0.4, 0.1) == pytest.approx(66.7, rel=1e-3)
    assert tracking.weight_ratio(0.4, 0.01) == pytest.approx(6667, rel=1e-3)
    ratio = tracking.weight_ratio(0.3, 0.05)
    np.testing.assert_allclose(printed.gains_614((ratio, 1, ratio, 1), 0.05), 0.3)


@given(ways, ways, angles)
def test_one_sample_of_linear_interpolation_ends_on_the_goal(dx, dy, theta):
    pose, goal = [0.5, -1.0, theta], (0.5 + dx, dy - 1.0)
    V, W = ScagliaLinear(1.0, 1.0)(pose, [0, 0], goal_at(*goal), T0)
    far = hypot(goal[0] - 0.5, goal[1] + 1.0)
    if far < tracking.scaglia_taylor.STILL:
        assert (V, W) == (0.0, 0.0)
    else:
        end = arc(pose, V, W, T0)
        np.testing.assert_allclose(end[:2], goal, atol=2e-14 * (1 + abs(theta)))
        assert abs(V) <= pi / 2 * far / T0 * (1 + 1e-12)


def test_linear_interpolation_lands_on_the_goal_in_an_independent_integration_too():
    for dx, dy, theta in [(0.1, 0.02, 0.3), (-0.3, 0.4, 0.0), (0.0, 0.5, 7.0), (-1.0, 0.0, 0.0)]:
        V, W = ScagliaLinear(1.0, 1.0)([0, 0, theta], [0, 0], goal_at(dx, dy), T0)
        np.testing.assert_allclose(driven([0, 0, theta], V, W)[:2], [dx, dy], atol=1e-10)


def test_taylor_misses_a_goal_that_linear_interpolation_meets():
    V, W = ScagliaTaylor(1.0, 1.0)([0, 0, 0], [0, 0], goal_at(0.1, 0.1), T0)
    assert np.hypot(*(arc([0, 0, 0], V, W, T0)[:2] - [0.1, 0.1])) > 0.04


def test_linear_interpolation_steers_the_arc_of_pure_pursuit():
    for dx, dy in [(0.3, 0.1), (0.1, -0.4), (0.5, 0.0)]:
        V, W = ScagliaLinear(1.0, 1.0)([0, 0, 0], [0, 0], goal_at(dx, dy), T0)
        assert W / V == pytest.approx(2 * dy / (dx**2 + dy**2))


def test_a_goal_behind_is_driven_to_backwards():
    V, W = ScagliaLinear(1.0, 1.0)([0, 0, 0], [0, 0], goal_at(-0.2, 0.0), T0)
    assert (V, W) == (pytest.approx(-2.0), pytest.approx(0.0, abs=1e-12))


@pytest.mark.parametrize(
    "tracker",
    [ScagliaTaylor(), ScagliaTaylor(optimum=True), ScagliaLinear(), ScagliaRungeKutta()],
)
def test_on_the_goal_the_heading_is_kept(tracker):
    assert tracker([1.0, 2.0, 3.0], [0.0, 0.0], goal_at(1.0, 2.0), T0) == (0.0, 0.0)
    _, W = tracker([1.0, 2.0, 3.0], [0.0, 0.0], goal_at(1.0 - 1e-9, 2.0), T0)
    assert W == 0.0


@given(ways, ways, angles, st.integers(-3, 3))
def test_whole_turns_of_the_heading_change_nothing(dx, dy, theta, turns):
    off_axis(dx, dy, theta)
    for tracker in (ScagliaTaylor(), ScagliaLinear(), ScagliaRungeKutta()):
        once = tracker([0, 0, theta], [0.0, 0.0], goal_at(dx, dy), T0)
        again = tracker([0, 0, theta + 2 * pi * turns], [0.0, 0.0], goal_at(dx, dy), T0)
        np.testing.assert_allclose(again, once, atol=1e-9)


def modes(tracker, behind):
    """Eigenvalues of one sample about a straight trajectory, by differences.

    The state is (way behind the reference, lateral error, heading, V_n, W_n) and the plant the
    exact unicycle that is given the command and keeps it for the sample.
    """

    def step(s):
        pose = [-s[0], s[1], s[2]]
        V, W = tracker(pose, s[3:], goal_at(SPEED * T0, 0.0), T0)
        x, y, theta = arc(pose, V, W, T0)
        return np.array([SPEED * T0 - x, y, theta, V, W])

    steady = np.array([behind, 0.0, 0.0, SPEED, 0.0])
    np.testing.assert_allclose(step(steady), steady, atol=1e-12)
    h = 1e-6
    columns = [(step(steady + h * e) - step(steady - h * e)) / (2 * h) for e in np.eye(5)]
    return np.linalg.eigvals(np.column_stack(columns))


def assert_among(values, expected):
    for value in np.atleast_1d(expected):
        assert np.min(np.abs(values - value)) < 1e-5, (value, values)


@pytest.mark.parametrize(("kv", "kw"), [(0.4, 0.4), (0.7, 0.2), (1.0, 1.0)])
def test_the_modes_of_linear_interpolation(kv, kw):
    found = modes(ScagliaLinear(kv, kw), SPEED * T0 * (1 / kv - 1))
    lateral = np.roots([1, -(2 - kw * kv - 2 * kw), 1 - 2 * kw + kw * kv])
    assert_among(found, [1 - kv, *lateral])
    if kv == kw == 1:
        assert np.abs(found).max() == pytest.approx(1.0), "the heading swings for ever"
    else:
        assert np.abs(found).max() < 0.95


@pytest.mark.parametrize(("kv", "kw"), [(0.4, 0.4), (0.7, 0.2), (1.0, 1.0)])
def test_the_modes_of_taylor(kv, kw):
    found = modes(ScagliaTaylor(kv, kw), SPEED * T0 * (1 / kv - 1))
    lateral = np.roots([1, -(2 - kw * kv / 2 - kw), 1 - kw + kw * kv / 2])
    assert_among(found, [1 - kv, *lateral])
    assert np.abs(found).max() < 0.95


@pytest.mark.parametrize("weight", [0.5, 0.6, 0.75, 1.0])
@pytest.mark.parametrize("kv", [0.2, 0.4, 1.0])
def test_the_modes_of_runge_kutta_are_those_of_speed_modes(kv, weight):
    found = modes(ScagliaRungeKutta(kv, 0.5, weight=weight), SPEED * T0 * (1 / kv - 1))
    assert_among(found, tracking.speed_modes(kv, weight))


@pytest.mark.parametrize("weight", [0.5, 0.75, 1.0])
def test_old_and_new_turn_rate_together_close_a_share_of_the_turn(weight):
    theta, direction, kw = 0.4, 1.1, 0.3
    tracker = ScagliaRungeKutta(kw=kw, weight=weight)
    goal = goal_at(2 * cos(direction), 2 * sin(direction))
    for omega in (-0.7, 0.0, 0.5):
        _, W = tracker((0.0, 0.0, theta), (0.0, omega), goal, T0)
        together = weight * W + (1 - weight) * kw * omega
        assert together * T0 == pytest.approx(kw * (direction - theta))


@pytest.mark.parametrize("kv", [0.1, 0.4, 1.0])
def test_the_printed_trapezoid_rings_for_ever_where_the_speed_is_a_ramp(kv):
    np.testing.assert_allclose(
        sorted(tracking.speed_modes(kv, 0.5, motion="ramp").real), [-1.0, 1 - kv], atol=1e-12
    )


@pytest.mark.parametrize("kv", [0.1, 0.4, 1.0])
def test_the_printed_trapezoid_grows_where_the_command_is_obeyed_at_once(kv):
    grown = tracking.speed_modes(kv, 0.5)[0]
    assert grown == pytest.approx(-kv - np.sqrt(kv**2 + 1))
    assert abs(grown) > 1


def test_a_lag_of_the_vehicle_damps_the_printed_trapezoid():
    largest = [abs(tracking.speed_modes(0.4, 0.5, lag=lag)[0]) for lag in (0.0, 0.3, 0.5, 2.0, 10)]
    assert largest[0] > 1 and largest[1] > 1
    assert max(largest[2:]) < 1


@pytest.mark.parametrize("lag", [0.0, 0.2, 1.0, 5.0])
@pytest.mark.parametrize("kv", [0.2, 0.4, 0.7])
def test_three_quarters_for_the_end_damp_every_mode(kv, lag):
    assert np.abs(tracking.speed_modes(kv, 0.75, lag=lag)).max() < 0.92
    assert np.abs(tracking.speed_modes(kv, 0.75, motion="ramp")).max() < 0.92


def test_the_factor_of_the_ringing_is_minus_one_minus_w_over_w():
    for weight in (0.5, 0.6, 0.75, 0.9):
        tracker = ScagliaRungeKutta(0.4, weight=weight)
        V, _ = tracker([0, 0, 0], [0.5, 0], goal_at(0.05, 0), T0)
        faster, _ = tracker([0, 0, 0], [0.6, 0], goal_at(0.05, 0), T0)
        assert (faster - V) / 0.1 == pytest.approx(-(1 - weight) / weight)


def straight_run(tracker, samples, ramp):
    """Speeds along a straight trajectory from rest, the speed a ramp in the sample or held."""
    x, V, speeds = 0.0, 0.0, []
    for k in range(samples):
        U, W = tracker([x, 0, 0], [V, 0], goal_at(SPEED * T0 * (k + 1), 0.0), T0)
        assert W == pytest.approx(0.0, abs=1e-12)
        x += T0 * (U + V) / 2 if ramp else T0 * U
        V = U
        speeds.append(V)
    return np.array(speeds)


@pytest.mark.parametrize(("kv", "pair"), [(1.0, (1.0, 0.0)), (0.4, (0.625, 0.375))])
def test_from_rest_the_printed_speed_alternates_around_the_wanted_one(kv, pair):
    speeds = straight_run(ScagliaRungeKutta.printed(kv), 60, ramp=True)
    np.testing.assert_allclose(speeds[-2:], speeds[-4:-2], atol=1e-9)
    np.testing.assert_allclose(sorted(speeds[-2:]), sorted(pair), atol=1e-9)


@pytest.mark.parametrize("ramp", [True, False])
def test_from_rest_the_repaired_speed_settles(ramp):
    speeds = straight_run(ScagliaRungeKutta(), 60, ramp)
    np.testing.assert_allclose(speeds[-5:], SPEED, atol=1e-9)


def test_the_repaired_tracker_brakes_where_the_printed_one_turns_round():
    state = [0, 0, 0], [1.0, 0.0], goal_at(0.01, 0.0), T0
    V_printed, W_printed = ScagliaRungeKutta.printed()(*state)
    V, W = ScagliaRungeKutta(weight=0.5)(*state)
    assert V_printed > 0 and abs(W_printed) == pytest.approx(0.5 * 2 / T0 * pi)
    assert V == pytest.approx(-V_printed) and W == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ScagliaTaylor(0.0), "kv2 must be one number above 0 and at most 1"),
        (lambda: ScagliaTaylor(kw2=1.1), "kw2 must be one number"),
        (lambda: ScagliaLinear(np.nan), "kv must be one number"),
        (lambda: ScagliaLinear(kw=[0.4]), "kw must be one number"),
        (
            lambda: ScagliaRungeKutta(weight=0.4),
            "weight must be one number at least 0.5 and at most 1",
        ),
        (lambda: ScagliaRungeKutta("a"), "kv must be one number"),
        (lambda: tracking.weight_ratio(1.0, 0.1), "k2 must be one number above 0 and below 1"),
        (lambda: tracking.weight_ratio(0.4, 0.0), "T0 must be one number above 0"),
        (lambda: tracking.speed_modes(0.4, motion="jump"), "motion must be"),
        (lambda: tracking.speed_modes(0.4, lag=-1.0), "lag must be one number at least 0"),
        (lambda: tracking.speed_modes(0.4, lag=1.0, motion="ramp"), 'lag must be 0 with "ramp"'),
    ],
)
def test_gains_out_of_range_are_named(make, message):
    with pytest.raises(ValueError, match=message):
        make()
