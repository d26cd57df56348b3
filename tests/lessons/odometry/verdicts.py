"""What decides each verdict on the guide's and the thesis's odometry, and likely misprints."""

import numpy as np
import sympy
from scipy.integrate import solve_ivp
from scipy.interpolate import PPoly
from scipy.linalg import expm
from scipy.optimize import fsolve

from backhoe.lessons.odometry import printed
from backhoe.localisation import odometry
from backhoe.localisation.odometry import streaming
from backhoe.machine import BACKHOE
from backhoe.vehicle.tracks import tracks_twist

RNG = np.random.default_rng(6)
UNEVEN, EVEN = np.cumsum(RNG.uniform(0.05, 0.4, 30)), np.linspace(0.0, 3.0, 31)
SAMPLES = RNG.normal(size=30), RNG.normal(size=31)
ROBOT, RING = odometry.differential(0.35, 2.0), odometry.omni(0.05, 0.2)
RADIUS, GAUGE = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge
STARTS = RNG.uniform((-5, -5, -7), (5, 5, 7), (10, 3))
HELD = RNG.uniform((-1.5, -1.2), (1.5, 1.2), (10, 2))


def _is_the_area(position, t, v, heights):
    """Of lines through `heights` (start, end of each step), from t[0], by SciPy."""
    start, end = heights
    area = PPoly([(end - start) / np.diff(t), start], t).antiderivative()
    assert np.allclose(position(t, v), area(t), rtol=0, atol=1e-12)


def _recursion(increment):
    """x_k = x_{k-1} + increment(v_k, v_{k-1}, delta_k) from 0, in a loop."""

    def position(t, v):
        x = [0.0]
        for k in range(1, len(t)):
            x.append(x[-1] + increment(v[k], v[k - 1], t[k] - t[k - 1]))
        return np.array(x)

    return position


# PUCP (1) to (5): a speed, added up


def begins_where_the_movement_begins(position):
    t = np.linspace(0.0, 2.0, 401)
    assert np.allclose(position(t, np.cos(t), 3.0), 3.0 + np.sin(t), rtol=0, atol=1e-5)


def is_the_area_of_rectangles_as_high_as_the_newer_sample(position):
    v = SAMPLES[0]
    _is_the_area(position, UNEVEN, v, (v[1:], v[1:]))


def on_even_steps_is_the_area_of_such_rectangles(position):
    v = SAMPLES[1]
    _is_the_area(position, EVEN, v, (v[1:], v[1:]))


def is_the_area_below_lines_from_sample_to_sample(position):
    v = SAMPLES[0]
    _is_the_area(position, UNEVEN, v, (v[:-1], v[1:]))


def on_even_steps_is_the_area_below_such_lines(position):
    v = SAMPLES[1]
    _is_the_area(position, EVEN, v, (v[:-1], v[1:]))


position_2 = _recursion(lambda v, old, delta: v * delta)
position_2_with_the_older_sample = _recursion(lambda v, old, delta: old * delta)
position_3 = _recursion(lambda v, old, delta: v * EVEN[1])
position_3_without_the_step = _recursion(lambda v, old, delta: v)
position_4 = _recursion(lambda v, old, delta: (v + old) * delta / 2)
position_4_with_the_difference = _recursion(lambda v, old, delta: (v - old) * delta / 2)
position_5 = _recursion(lambda v, old, delta: (v + old) * EVEN[1] / 2)
position_5_without_the_half = _recursion(lambda v, old, delta: (v + old) * EVEN[1])


# PUCP (6) to (9): wheels, and steps with their Jacobian


def each_rim_goes_as_fast_as_its_place(rate, step=1e-6):
    """Three places on a ring, moved with the pose for a moment, along the rims."""
    angles = np.radians((0.0, 120.0, 240.0))

    def places(pose):
        return pose[0] + 1j * pose[1] + 0.2 * np.exp(1j * (angles + pose[2]))

    for pose, u in zip(STARTS, STARTS[::-1], strict=True):
        dx = np.asarray(rate(pose, u))
        moved = (places(pose + step * dx) - places(pose - step * dx)) / (2 * step)
        along = 1j * np.exp(1j * (angles + pose[2]))
        assert np.allclose((moved * along.conj()).real, 0.05 * u, atol=1e-8)


rate_of_the_ring = RING.rate


def rate_6(pose, u):
    return RING.jacobian(pose[2]) @ u


def rate_6_with_the_jacobian_of_the_body(pose, u):
    return RING.body @ u


def _adds_up(step, heights):
    """One axis after another, with a constant Jacobian, against areas by SciPy."""
    J, u = STARTS[:3, :2], np.stack((SAMPLES[1], np.cos(EVEN)), axis=-1)
    state, x = streaming.State(EVEN[0], np.zeros(3), u[0]), [np.zeros(3)]
    for t, sample in zip(EVEN[1:], u[1:], strict=True):
        state = step(state, t, sample, lambda x, u: J @ u)
        x.append(state.x)
    for axis, v in enumerate((u @ J.T).T):
        _is_the_area(lambda t, v, axis=axis: np.array(x)[:, axis], EVEN, v, heights(v))


def adds_up_rectangles_of_each_rate(step):
    _adds_up(step, lambda v: (v[1:], v[1:]))


def adds_up_trapezoids_of_each_rate(step):
    _adds_up(step, lambda v: (v[:-1], v[1:]))


def _step(increment):
    def step(state, t, u, f):
        x = state.x + (t - state.t) * increment(f(state.x, u), f(state.x, state.u))
        return streaming.State(t, x, u)

    return step


step_7 = _step(lambda new, old: new)
step_7_with_the_older_sample = _step(lambda new, old: old)
step_8 = _step(lambda new, old: (new + old) / 2)
step_8_without_the_half = _step(lambda new, old: new + old)


def leads_round_a_circle(rate, v=0.6, omega=0.3):
    u = np.array([v - omega, v + omega]) / 0.35
    way = solve_ivp(lambda _, x: rate(x, u), (0, 20), np.zeros(3), rtol=1e-10, atol=1e-10).y
    assert np.allclose(np.hypot(way[0], way[1] - v / omega), v / omega, atol=1e-6)
    assert np.isclose(way[2, -1], 20 * omega)


rate_of_two_wheels = ROBOT.rate


def rate_9(x, u):
    v, omega = 0.35 * (u[1] + u[0]) / 2, 0.35 * (u[1] - u[0]) / 2.0
    return np.array([v * np.cos(x[2]), v * np.sin(x[2]), omega])


def rate_9_of_the_samples_alone(x, u):
    return rate_9(np.zeros(3), u)


# PUCP (10), (11): what x_k is made of


def _gives_the_root(rule, new, old):
    """Of x_k = x_{k-1} + T (new f(x_k, u_k) + old f(x_{k-1}, u_{k-1})), whatever x_k was before."""
    u_old, u = np.array([2.0, 3.5]), np.array([3.0, 1.0])
    for x in STARTS:
        state, before = streaming.State(0.0, x, u_old), old * ROBOT.rate(x, u_old)

        def gap(x_k, state=state, before=before):
            return state.x + 0.2 * (new * ROBOT.rate(x_k, u) + before) - x_k

        for guess in (x, x + 1.0):
            found = rule(guess, state, 0.2, u, ROBOT.rate)
            assert np.allclose(found, fsolve(gap, x, xtol=1e-13), atol=1e-9)


def gives_the_root_of_10_whatever_x_k_was_before(rule):
    _gives_the_root(rule, 1.0, 0.0)


def gives_the_root_of_11_whatever_x_k_was_before(rule):
    _gives_the_root(rule, 0.5, 0.5)


def solved_10(_, state, t, u, f):
    return streaming.implicit_euler(state, t, u, f).x


def solved_11(_, state, t, u, f):
    return streaming.bilinear(state, t, u, f).x


# PUCP Algorithms 1 to 4


def _run(step):
    return lambda f, t, u: streaming.run(step, f, t, u, np.zeros(3))


def _linear_run(step):
    return lambda J, t, u: streaming.run(step, streaming.linear(J), t, u, np.zeros(len(J)))


euler_from_the_first_sample_on = _linear_run(streaming.euler)
heun_from_the_first_sample_on = _linear_run(streaming.heun)
implicit_euler_run, heun_run = _run(streaming.implicit_euler), _run(streaming.heun)


def does_not_care_when_the_clock_was_started(algorithm):
    J, u = np.eye(1), SAMPLES[1][:, None]
    assert np.allclose(algorithm(J, EVEN + 1000.0, u), algorithm(J, EVEN, u))


def counts_from_its_first_sample_on_with_order_2(algorithm):
    errors = []
    for n in (100, 200):
        t = np.linspace(0, 2, n + 1)[1:]
        end = algorithm(np.eye(1), t, np.cos(t)[:, None])[-1, 0]
        errors.append(abs(end - (np.sin(2) - np.sin(t[0]))))
    assert 3.8 < errors[0] / errors[1] < 4.2


def _winding(n):
    """Instants, wheel speeds and the true end of a drive whose speeds vary, from rest."""
    t = np.linspace(0, 20, n + 1)

    def speeds(t):
        return np.stack((0.6 * np.sin(0.4 * t) + 0.1 * t, 0.4 * np.sin(0.7 * t)), axis=-1)

    def rate(t, x):
        v, omega = speeds(t)
        return [v * np.cos(x[2]), v * np.sin(x[2]), omega]

    end = solve_ivp(rate, (0, 20), np.zeros(3), method="DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
    v, omega = speeds(t).T
    return t, np.stack((v - omega, v + omega), axis=-1) / 0.35, end


def _errors(algorithm, steps=(200, 400)):
    found = []
    for n in steps:
        t, u, end = _winding(n)
        found.append(np.hypot(*(algorithm(ROBOT.rate, t, u)[-1] - end)[:2]))
    return np.array(found)


def each_estimate_fulfils_10(algorithm):
    t, u, _ = _winding(100)
    x = algorithm(ROBOT.rate, t, u)
    assert np.allclose(x[1:], x[:-1] + np.diff(t)[:, None] * ROBOT.rate(x[1:], u[1:]), atol=1e-9)


def has_order_2_from_rest(algorithm):
    errors = _errors(algorithm)
    assert 3.6 < errors[0] / errors[1] < 4.4


def gets_better_when_sampled_faster(algorithm):
    errors = _errors(algorithm, (200, 400, 800))
    assert (errors[:-1] > 1.8 * errors[1:]).all()


def algorithm_3_of_the_body_alone(f, t, u):
    return printed.algorithm_3(lambda x, u: f(np.zeros(3), u), t, u)


def rules_for_a_constant_jacobian():
    return _linear_run(streaming.euler), _linear_run(streaming.heun)


def printed_rules_for_a_constant_jacobian():
    return printed.algorithm_1, printed.algorithm_2


def rules_of_which_one_forgets_the_half():
    return printed.algorithm_1, lambda *given: 2 * printed.algorithm_2(*given)


def both_give_nearly_the_same_for_short_steps(rules):
    gaps = []
    for n in (100, 200, 400):
        t = np.linspace(0, 2, n + 1)
        ends = [rule(np.eye(1), t, np.cos(t)[:, None])[-1, 0] for rule in rules()]
        gaps.append(abs(np.subtract(*ends)))
    assert gaps[0] < 0.03 and np.allclose(np.divide(gaps[:-1], gaps[1:]), 2, atol=0.05)


# Mastalli (4.1) to (4.3) and Algorithm 1: one step with held speeds


def _arc(pose, v, omega, T):
    """The end by SciPy's exponential of the twist, psi counted through."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    start = np.array([[c, -s, pose[0]], [s, c, pose[1]], [0.0, 0.0, 1.0]])
    end = start @ expm(T * np.array([[0.0, -omega, v], [omega, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    return np.append(end[:2, 2], pose[2] + omega * T)


def _advance(method):
    return lambda pose, v, omega, T: odometry.advance(pose, v * T, omega * T, method)


euler_step, midpoint_step, exact_step = map(_advance, ("euler", "midpoint", "exact"))


def goes_along_the_tangent_at_the_start(step, moment=1e-6):
    for pose, (v, omega) in zip(STARTS, HELD, strict=True):
        ends = (_arc(pose, v, omega, T) for T in (moment, -moment))
        tangent = np.subtract(*ends) / (2 * moment)
        assert np.allclose(step(pose, v, omega, 0.5), pose + 0.5 * tangent, atol=1e-7)


def _held_errors(step):
    """Distance from the end of the arc of 4 s after 50 and 100 steps."""
    end, errors = _arc(np.zeros(3), 1.5, 1.0, 4.0), []
    for n in (50, 100):
        poses = printed.roll_out(step, np.zeros(3), np.full(n, 1.5), np.ones(n), T=4 / n)
        errors.append(np.hypot(*(poses[-1] - end)[:2]))
    return np.array(errors)


def has_order_2_on_an_arc(step):
    errors = _held_errors(step)
    assert 3.8 < errors[0] / errors[1] < 4.2


def is_the_arc_itself(step):
    for pose, (v, omega) in zip(STARTS, HELD, strict=True):
        assert np.allclose(step(pose, v, omega, 0.5), _arc(pose, v, omega, 0.5), atol=1e-10)


def euler_and_runge_kutta():
    return euler_step, midpoint_step


def printed_euler_and_runge_kutta():
    return printed.step_41, printed.step_42


def the_second_rule_is_better_on_an_arc(rules):
    first, second = map(_held_errors, rules())
    assert (second < first).all()


EXACT_STEP_STRAIGHT_AHEAD, EXACT_STEP_AS_THE_FOOTNOTE_SAYS = sympy.Integer(1), sympy.oo


def is_the_limit_of_the_chord_over_the_way(limit):
    h = sympy.Symbol("h")
    assert sympy.limit(sympy.sin(h) / h, h, 0) == limit


def goes_along_the_arc_of_its_belts(step):
    for pose, (v, omega) in zip(STARTS, HELD, strict=True):
        sides = (v + omega * GAUGE / 2) / RADIUS, (v - omega * GAUGE / 2) / RADIUS
        end = step(pose, *sides, r=RADIUS, gauge=GAUGE, T=0.5)
        assert np.allclose(end, _arc(pose, v, omega, 0.5), atol=1e-10)


def step_of_the_tracks(pose, Omega_r, Omega_l, r, gauge, T):
    v, omega = tracks_twist(Omega_l, Omega_r, gauge=gauge)
    return exact_step(pose, v, omega, T)
