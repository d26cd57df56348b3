"""Integrators: order, stability, what they do to energy, and calm refusals."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from backhoe.arm import dynamics, integrate

FIRST_ORDER = [integrate.euler, integrate.trapezoid, integrate.rk4]
TAU = np.array([0, 114.3e3, -1.8e3, -3.2e3])
CASE_1 = np.r_[np.radians([0, 0, -10, 0]), np.zeros(4)]


def falling(t, q, dq):
    return dynamics.forward_dynamics(q, dq, TAU)


def spring(t, q, dq):
    return -q


def pendulum(t, q, dq):
    return -np.sin(q)


def terms(q):
    return (
        dynamics.mass_matrix(q),
        dynamics.mass_matrix_derivative(q),
        dynamics.gravity_torque(q) - TAU,
    )


def pendulum_terms(q):
    return np.eye(1), np.zeros((1, 1, 1)), np.sin(q)


def symplectic(x0, dt, steps):
    return integrate.symplectic_euler(pendulum_terms if len(x0) == 2 else terms, x0, dt, steps)


def errors(roll_out, x0, end, exact, steps=(40, 80, 160)):
    """Distance from the exact end state for every number of steps."""
    return np.array([np.abs(roll_out(x0, end / n, n).x[-1] - exact).max() for n in steps])


def observed_order(found):
    return np.log2(found[:-1] / found[1:])


def by_name(name):
    if name == "symplectic_euler":
        return lambda _: symplectic
    if name == "semi_implicit_euler":
        return lambda a: lambda *rest: integrate.semi_implicit_euler(a, *rest)
    return lambda a: lambda *rest: getattr(integrate, name)(integrate.motion(a), *rest)


ORDERS = [
    ("euler", 1),
    ("semi_implicit_euler", 1),
    ("symplectic_euler", 1),
    ("trapezoid", 2),
    ("rk4", 4),
]


@pytest.mark.parametrize(("name", "order"), ORDERS)
def test_order_of_convergence_on_a_pendulum(name, order):
    x0 = np.array([1.0, 0.5])
    f = integrate.motion(pendulum)
    exact = solve_ivp(f, (0, 2), x0, method="DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    found = errors(by_name(name)(pendulum), x0, 2.0, exact)
    np.testing.assert_allclose(observed_order(found), order, atol=0.15)


# The energies that the symplectic step is given know no time.
@pytest.mark.parametrize(("name", "order"), [o for o in ORDERS if o[0] != "symplectic_euler"])
def test_order_of_convergence_under_a_push_that_changes_with_time(name, order):
    def pushed(t, q, dq):
        return np.cos(3 * t) - q

    f = integrate.motion(pushed)
    exact = solve_ivp(f, (0, 2), [1.0, 0.5], method="DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    found = errors(by_name(name)(pushed), np.array([1.0, 0.5]), 2.0, exact)
    np.testing.assert_allclose(observed_order(found), order, atol=0.25)


@pytest.mark.parametrize(("name", "order"), ORDERS)
def test_order_of_convergence_on_the_falling_arm(name, order):
    f = integrate.motion(falling)
    exact = solve_ivp(f, (0, 0.5), CASE_1, method="DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    found = errors(by_name(name)(falling), CASE_1, 0.5, exact, steps=(10, 20, 40))
    np.testing.assert_allclose(observed_order(found), order, atol=0.25)


@pytest.mark.parametrize("roll_out", FIRST_ORDER)
def test_rate_that_depends_on_time(roll_out):
    result = roll_out(lambda t, x: np.array([3 * t**2]), [1.0], 0.01, 200)
    assert result.x[-1, 0] == pytest.approx(9.0, abs=0.07)
    assert result.t[-1] == pytest.approx(2.0)


def test_each_rule_makes_the_step_of_its_formula():
    x, dt = np.array([0.7, -0.3]), 0.1
    f = integrate.motion(pendulum)
    np.testing.assert_allclose(integrate.euler(f, x, dt, 1).x[1], x + dt * f(0, x))
    speed = x[1] - dt * np.sin(x[0])
    np.testing.assert_allclose(
        integrate.semi_implicit_euler(pendulum, x, dt, 1).x[1], [x[0] + dt * speed, speed]
    )
    new = integrate.trapezoid(f, x, dt, 1).x[1]
    np.testing.assert_allclose(new, x + dt / 2 * (f(0, x) + f(dt, new)), rtol=0, atol=1e-12)


def test_runge_kutta_step_of_a_linear_rate_is_the_taylor_polynomial():
    dt = 0.3
    expected = sum(dt**k / np.prod(np.arange(1, k + 1)) for k in range(5))
    assert integrate.rk4(lambda t, x: x, [1.0], dt, 1).x[1, 0] == pytest.approx(expected, rel=1e-15)


def test_energy_of_a_spring_grows_with_euler_and_is_kept_by_the_trapezoid():
    f, x0 = integrate.motion(spring), [1.0, 0.0]
    energy = {
        name: (by_name(name)(spring)(x0, 0.05, 2000).x ** 2).sum(axis=1) / 2
        for name, _ in ORDERS
        if name != "symplectic_euler"
    }
    assert (np.diff(energy["euler"]) > 0).all()
    np.testing.assert_allclose(energy["euler"][-1], 0.5 * (1 + 0.05**2) ** 2000)
    np.testing.assert_allclose(energy["trapezoid"], 0.5, rtol=1e-8)
    late, early = energy["semi_implicit_euler"][1000:], energy["semi_implicit_euler"][:1000]
    assert np.ptp(late) == pytest.approx(np.ptp(early), rel=0.01)
    assert np.ptp(late) < 0.05
    assert (np.diff(energy["rk4"]) < 0).all()
    assert energy["rk4"][-1] > 0.4999
    assert f(0.0, np.array(x0)).tolist() == [0.0, -1.0]


def test_trapezoid_step_of_a_decay_is_the_implicit_one():
    rate, dt = 15.0, 0.11
    factor = (1 - rate * dt / 2) / (1 + rate * dt / 2)
    result = integrate.trapezoid(lambda t, x: -rate * x, [1.0], dt, 5, max_iterations=200)
    np.testing.assert_allclose(result.x[:, 0], factor ** np.arange(6), atol=1e-11)
    alternating = integrate.euler(lambda t, x: -rate * x, [1.0], dt, 5).x[:, 0]
    assert (alternating[1::2] < 0).all()


def test_first_row_is_the_start_and_the_start_is_left_alone():
    x0 = np.array([1.0, 2.0])
    for roll_out in FIRST_ORDER:
        result = roll_out(integrate.motion(spring), x0, 0.1, 3)
        np.testing.assert_array_equal(result.x[0], [1.0, 2.0])
        assert result.x.shape == (4, 2)
        np.testing.assert_allclose(result.t, [0, 0.1, 0.2, 0.3])
    np.testing.assert_array_equal(x0, [1.0, 2.0])
    assert integrate.euler(integrate.motion(spring), x0, 0.1, 0).x.shape == (1, 2)


def test_rates_may_be_plain_lists():
    for roll_out in FIRST_ORDER:
        result = roll_out(lambda t, x: [x[1], -x[0]], [1.0, 0.0], 0.001, 1000)
        np.testing.assert_allclose(result.x[-1], [np.cos(1), -np.sin(1)], atol=1e-3)
    result = integrate.semi_implicit_euler(lambda t, q, dq: [-q[0]], [1.0, 0.0], 0.001, 1000)
    np.testing.assert_allclose(result.x[-1], [np.cos(1), -np.sin(1)], atol=1e-3)


def test_symplectic_euler_is_the_semi_implicit_one_where_the_mass_is_constant():
    x0 = np.array([2.0, 0.5])
    own = integrate.semi_implicit_euler(pendulum, x0, 0.1, 100).x
    np.testing.assert_allclose(symplectic(x0, 0.1, 100).x, own, atol=1e-12)


# What a step does to areas, and a long run to energy

FREE_START = np.r_[np.radians([0.0, -89.7, 93.9, -100.5]), np.zeros(4)]
OFFSETS = np.arange(-4, 5)
EIGHTH_ORDER = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
UNIT = 1e4  # of momentum [kg m^2/s], so that a change of angle and one of momentum are alike


def momentum(q, dq):
    return dynamics.mass_matrix(q) @ dq


def broken_area(roll_out, x0, dt=0.02):
    """Largest entry of J^T S J - S, where J is the derivative of one step in (q, p)."""

    def step(y):
        q, p = y[:4], UNIT * y[4:]
        q, dq = np.split(roll_out(np.r_[q, np.linalg.solve(dynamics.mass_matrix(q), p)], dt, 1), 2)
        return np.r_[q, momentum(q, dq) / UNIT]

    y = np.r_[x0[:4], momentum(*np.split(x0, 2)) / UNIT]
    h = 5e-3
    J = sum(
        weight * np.array([step(y + h * offset * e) for e in np.eye(8)]).T / h
        for offset, weight in zip(OFFSETS, EIGHTH_ORDER, strict=True)
        if weight
    )
    S = np.block([[np.zeros((4, 4)), np.eye(4)], [-np.eye(4), np.zeros((4, 4))]])
    return np.abs(J.T @ S @ J - S).max()


def test_only_the_step_in_momenta_keeps_areas_when_the_mass_matrix_turns():
    """The definition of symplectic, to rounding; (q, dq) instead of (q, p) breaks it."""
    x0 = np.r_[0.3, -0.4, 0.7, 0.2, 0.5, -0.6, 0.9, 1.1]
    kept = broken_area(lambda *a: integrate.symplectic_euler(terms, *a).x[-1], x0)
    lost = broken_area(lambda *a: integrate.semi_implicit_euler(falling, *a).x[-1], x0)
    assert kept < 1e-9
    assert lost > 1e-3


def change_of_energy(states):
    """Kinetic plus potential energy less that of the start [kJ]."""
    energy = np.add(*dynamics.energy(states[:, :4], states[:, 4:])) / 1e3
    return energy - energy[0]


def free_swing(t, q, dq):
    return dynamics.forward_dynamics(q, dq, np.zeros(4))


def test_semi_implicit_euler_gains_energy_in_a_free_swing_until_it_is_infinite():
    change = change_of_energy(integrate.semi_implicit_euler(free_swing, FREE_START, 0.02, 10_000).x)
    np.testing.assert_allclose(change[[500, 2500, 5000]], [1.06, 10.87, 23.71], atol=0.02)
    assert change[-1] > 100
    with pytest.raises(FloatingPointError, match=r"at t = 23\d"):
        integrate.semi_implicit_euler(free_swing, FREE_START, 0.02, 15_000)


def test_a_shorter_step_only_delays_the_wandering_of_semi_implicit_euler():
    change = change_of_energy(
        integrate.semi_implicit_euler(free_swing, FREE_START, 0.005, 20_000).x
    )
    assert np.abs(change[:2000]).max() < 0.5
    assert change[-1] < -4


def test_symplectic_euler_keeps_the_energy_of_the_free_swing_within_a_band_for_300_s():
    def free_terms(q):
        return (*terms(q)[:2], dynamics.gravity_torque(q))

    change = change_of_energy(integrate.symplectic_euler(free_terms, FREE_START, 0.02, 15_000).x)
    assert np.abs(change).max() < 2
    thirds = change[1:].reshape(3, -1)
    assert np.abs(thirds.mean(axis=1)).max() < 0.05


@pytest.mark.parametrize(("rule", "least"), [(integrate.trapezoid, -0.5), (integrate.rk4, -0.1)])
def test_trapezoid_and_runge_kutta_wander_little_in_300_s(rule, least):
    change = change_of_energy(rule(integrate.motion(free_swing), FREE_START, 0.02, 15_000).x)
    assert least < change.min() and change.max() < 0.1


def test_repetition_that_does_not_settle_says_so():
    with pytest.raises(ArithmeticError, match=r"did not settle in 50 repetitions at t = 0 s"):
        integrate.trapezoid(lambda t, x: -15.0 * x, [1.0], 0.3, 10)
    with pytest.raises(ArithmeticError, match=r"symplectic Euler rule did not settle in 50"):
        integrate.symplectic_euler(terms, np.r_[CASE_1[:4], 0, 9, 9, -9], 1.0, 1)


@pytest.mark.parametrize("roll_out", [integrate.euler, integrate.rk4])
def test_explosion_is_reported_with_its_time(roll_out):
    with pytest.raises(FloatingPointError, match=r"no longer finite at t = .* shorter than 1 s"):
        roll_out(lambda t, x: x**3, [10.0], 1.0, 100)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([1.0, np.nan], 0.1, 5), "x0 must be finite"),
        (
            ([[1.0, 2.0]], 0.1, 5),
            r"x0 must be one row of numbers, shape \(n,\), got shape \(1, 2\)",
        ),
        (([], 0.1, 5), r"x0 must be one row of numbers, shape \(n,\), got shape \(0,\)"),
        ((["a", "b"], 0.1, 5), "x0 must be numbers"),
        (([1.0, 2.0], 0.0, 5), r"dt must be one number above 0 \[s\], got 0.0"),
        (([1.0, 2.0], -0.1, 5), "dt must be one number above 0"),
        (([1.0, 2.0], "fast", 5), "dt must be one number above 0"),
        (([1.0, 2.0], 0.1, 2.5), "steps must be one whole number at least 0, got 2.5"),
        (([1.0, 2.0], 0.1, -1), "steps must be one whole number at least 0, got -1"),
    ],
)
@pytest.mark.parametrize("name", [name for name, _ in ORDERS])
def test_bad_arguments_are_refused(name, arguments, message):
    with pytest.raises(ValueError, match=message):
        by_name(name)(spring)(*arguments)


@pytest.mark.parametrize("roll_out", FIRST_ORDER)
def test_rate_of_another_shape_is_refused(roll_out):
    with pytest.raises(ValueError, match=r"must have the shape of the state, \(2,\), got \(1,\)"):
        roll_out(lambda t, x: [1.0], [1.0, 2.0], 0.1, 5)


def test_state_that_does_not_split_is_refused():
    with pytest.raises(ValueError, match="positions and as many speeds, got 3 values"):
        integrate.semi_implicit_euler(spring, [1.0, 2.0, 3.0], 0.1, 5)
    with pytest.raises(ValueError, match="positions and as many speeds, got 3 values"):
        integrate.symplectic_euler(pendulum_terms, [1.0, 2.0, 3.0], 0.1, 5)
