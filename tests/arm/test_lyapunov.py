"""Kelly's function, its derivative and the inequalities, on thousands of random states."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from backhoe.arm import dynamics, lyapunov
from backhoe.arm.lyapunov import State
from backhoe.arm.pid import ARM_GAINS, Gains
from backhoe.lessons import published
from backhoe.lessons.lyapunov_pid import inequalities
from backhoe.machine import BACKHOE, replace
from oracles import Lagrangian

PRINTED = published.load("mastalli_2013_eq_333")
KP, KI, KD = GAINS = Gains(*(np.array(PRINTED[name]) for name in ("K_p", "K_i", "K_d")))
ALPHA = 1.5
COUNT = 4000
FLOATING = replace(BACKHOE, gravity=0.0)


@pytest.fixture
def rng():
    return np.random.default_rng(31)


@pytest.fixture
def state(rng):
    """Over all angles."""
    goal = rng.uniform(-np.pi, np.pi, (COUNT, 4))
    spread = rng.uniform(0.01, 2.0, (3, COUNT, 1))
    return State(*(spread * rng.normal(size=(3, COUNT, 4))), goal)


@pytest.fixture(scope="module")
def over_all_angles():
    return lyapunov.constants(domain="torus")


def random_gain(rng, low=1e4, high=2e6):
    """A positive definite matrix with eigenvalues in the range and random axes."""
    axes = np.linalg.qr(rng.normal(size=(4, 4)))[0]
    gain = axes @ np.diag(rng.uniform(low, high, 4)) @ axes.T
    return (gain + gain.T) / 2


def random_gains(rng):
    return Gains(*(random_gain(rng) for _ in range(3)))


def moved(state, rates, t):
    """The state a time t later, along its rates."""
    return State(*(x + t * rate for x, rate in zip(state[:3], rates, strict=True)), state.goal)


# closed loop


def test_nothing_moves_and_v_is_zero_at_rest_in_the_goal(rng):
    goal, still = rng.uniform(-3, 3, (20, 4)), np.zeros(4)
    state = State(still, still, still, goal)
    for rate in lyapunov.closed_loop_rate(state, GAINS, ALPHA):
        np.testing.assert_allclose(rate, 0.0, atol=1e-12)
    V = lyapunov.function(state, GAINS, ALPHA)
    np.testing.assert_allclose(V, 0.0, atol=1e-9)


def test_the_rest_integral_of_the_controller_is_the_origin():
    goal = np.array([0.3, 0.2, -0.4, 0.9])
    held = dynamics.gravity_torque(goal) / KI
    state = lyapunov.closed_loop_state(goal, np.zeros(4), held, goal, GAINS, ALPHA)
    np.testing.assert_allclose(state[:3], 0.0, atol=1e-15)
    np.testing.assert_array_equal(state.goal, goal)


def test_closed_loop_rate_is_the_pid_seen_in_other_coordinates(rng):
    q, dq, integral, goal = rng.normal(size=(4, 200, 4))
    tau = KP * (goal - q) - KD * dq + KI * integral
    ddq = dynamics.forward_dynamics(q, dq, tau)
    h = 1e-6

    def state_at(t):
        return lyapunov.closed_loop_state(
            q + t * dq, dq + t * ddq, integral + t * (goal - q), goal, GAINS, ALPHA
        )

    rates = lyapunov.closed_loop_rate(state_at(0.0), GAINS, ALPHA)
    for ahead, behind, rate in zip(state_at(h)[:3], state_at(-h)[:3], rates, strict=True):
        np.testing.assert_allclose((ahead - behind) / (2 * h), rate, rtol=1e-6, atol=1e-6)


def test_matrix_gains_give_what_their_diagonals_give(state):
    lists = lyapunov.function(state, GAINS, ALPHA)
    matrices = lyapunov.function(state, Gains(*map(np.diag, GAINS)), ALPHA)
    np.testing.assert_array_equal(lists, matrices)


# (3.8), (3.18)


def test_derivative_is_the_slope_of_v_along_the_flow(state):
    rates = lyapunov.closed_loop_rate(state, GAINS, ALPHA)
    h = 1e-5

    def V(t):
        return lyapunov.function(moved(state, rates, t), GAINS, ALPHA)

    slope = (8 * (V(h) - V(-h)) - (V(2 * h) - V(-2 * h))) / (12 * h)
    exact = lyapunov.derivative(state, GAINS, ALPHA)
    assert np.max(np.abs(slope - exact) / (1 + np.abs(exact))) < 1e-4
    assert np.median(np.abs(slope - exact) / (1 + np.abs(exact))) < 1e-7


def test_derivative_agrees_with_a_complex_step_through_the_symbolic_lagrangian(rng):
    arm, h = Lagrangian(), 1e-30
    Kp, Ki, Kd = gains = random_gains(rng)

    def V(w, error, dq, goal):
        M, *_, here = arm.terms(goal - error, dq)
        *_, g, _, there = arm.terms(goal, 0 * dq)
        form = w @ Ki @ w / ALPHA + ALPHA * error @ Kd @ error + dq @ M @ dq
        form += -2 * ALPHA * error @ M @ dq + error @ (Kp - Ki / ALPHA) @ error
        return form / 2 + here - there + error @ g

    for _ in range(20):
        w, error, dq, goal = state = State(*rng.normal(size=(4, 4)))
        M, centrifugal, g, *_ = arm.terms(goal - error, dq)
        *_, there, _, _ = arm.terms(goal, 0 * dq)
        tau = (Kp - Ki / ALPHA) @ error - Kd @ dq + Ki @ w / ALPHA + there
        rates = ALPHA * error - dq, -dq, np.linalg.solve(M, tau - centrifugal - g)
        slope = V(*moved(state, rates, 1j * h)[:3], goal + 0j).imag / h
        exact = lyapunov.derivative(state, gains, ALPHA)
        np.testing.assert_allclose(exact, slope, rtol=1e-9)
        plain = lyapunov.function(state, gains, ALPHA)
        np.testing.assert_allclose(plain, V(w, error, dq, goal), rtol=1e-9)
        ours = lyapunov.closed_loop_rate(state, gains, ALPHA)
        for rate, expected in zip(ours, rates, strict=True):
            np.testing.assert_allclose(rate, expected, rtol=1e-8)


def test_v_falls_along_a_motion_by_the_integral_of_its_derivative():
    alpha, goal, zero = 0.5, np.array([0.5, 0.2, -0.3, 0.8]), np.zeros(4)
    start = lyapunov.closed_loop_state(goal - 0.3, zero, zero, goal, ARM_GAINS, alpha)

    def rate(t, x):
        state = State(*x[:12].reshape(3, 4), goal)
        moving = lyapunov.closed_loop_rate(state, ARM_GAINS, alpha)
        return np.concatenate([*moving, [lyapunov.derivative(state, ARM_GAINS, alpha)]])

    times, x0 = np.linspace(0, 4, 100), np.concatenate([*start[:3], [0.0]])
    run = solve_ivp(rate, (0, 4), x0, "DOP853", times, rtol=1e-8, atol=1e-9)
    along = State(*run.y[:12].reshape(3, 4, -1).transpose(0, 2, 1), goal)
    V = lyapunov.function(along, ARM_GAINS, alpha)
    assert (np.diff(V) < 0).all()
    assert V[-1] < 0.5 * V[0]
    np.testing.assert_allclose(V - V[0], run.y[12], rtol=1e-6, atol=1e-3)


def test_the_terms_of_the_derivative_sum_to_it(state):
    terms = lyapunov.derivative_terms(state, GAINS, ALPHA)
    whole = lyapunov.derivative(state, GAINS, ALPHA)
    np.testing.assert_allclose(terms.sum(axis=-1), whole)
    still = lyapunov.derivative_terms(state._replace(dq=0 * state.dq), GAINS, ALPHA)
    np.testing.assert_array_equal(still[:, [0, 2]], 0.0)


def test_without_gravity_the_gravity_term_is_zero(state):
    terms = lyapunov.derivative_terms(state, GAINS, ALPHA, machine=FLOATING)
    np.testing.assert_allclose(terms[:, 3], 0.0, atol=1e-6)


# (3.9) to (3.16)


def test_v_is_above_its_quadratic_part_when_stiffness_outweighs_gravity(
    state, rng, over_all_angles
):
    for _ in range(5):
        Ki = random_gain(rng, 1e3, 1e5)
        Kp = Ki / ALPHA + random_gain(rng, 1.0001 * over_all_angles.kg, 1e6)
        gains = Gains(Kp, Ki, random_gain(rng))
        V = lyapunov.function(state, gains, ALPHA)
        assert (V >= inequalities.quadratic_part(state, gains, ALPHA)).all()


def test_v_can_be_below_its_quadratic_part_when_gravity_outweighs_stiffness(state):
    weak = Gains(np.full(4, 2e4), np.full(4, 2e3), KD)
    V = lyapunov.function(state, weak, ALPHA)
    assert (V < inequalities.quadratic_part(state, weak, ALPHA)).any()


def test_the_second_derivative_of_the_potential_term_is_stiffness_plus_gravity_slope(rng):
    goal, error = rng.uniform(-2, 2, (2, 50, 4))
    still, h = np.zeros(4), 1e-3
    Kp, Ki, _ = gains = Gains(random_gain(rng), random_gain(rng), KD)
    basis = np.eye(4)

    def term(e):
        state = State(still, e, still, goal)
        V = lyapunov.function(state, gains, ALPHA)
        return V - inequalities.quadratic_part(state, gains, ALPHA)

    curved = np.empty((50, 4, 4))
    for i in range(4):
        for j in range(4):
            a, b = h * basis[i], h * basis[j]
            around = term(error + a + b) - term(error + a - b)
            around -= term(error - a + b) - term(error - a - b)
            curved[:, i, j] = around / (4 * h * h)
    expected = Kp - Ki / ALPHA + lyapunov.gravity_slope(goal - error)
    np.testing.assert_allclose(curved, expected, atol=1e-5 * np.abs(expected).max())


def test_every_term_of_v_is_above_its_bound(state, rng, over_all_angles):
    for _ in range(5):
        gains = random_gains(rng)
        terms = inequalities.quadratic_terms(state, gains, ALPHA)
        bounds = inequalities.quadratic_term_bounds(state, gains, ALPHA, over_all_angles)
        assert (terms >= bounds).all()
        part = inequalities.quadratic_part(state, gains, ALPHA)
        np.testing.assert_allclose(part, (terms.sum(-1) + terms[:, 3]) / 2)
        below = inequalities.lower_bound(state, gains, ALPHA, over_all_angles)
        assert (part >= below).all()


def test_lower_bound_is_the_printed_quadratic_form(rng, over_all_angles):
    c, state = over_all_angles, State(*rng.normal(size=(3, 4)), np.zeros(4))
    matrix = np.array(
        [
            [KI.min() / ALPHA**2, 0, 0],
            [0, KD.min(), -c.lambda_max],
            [0, -c.lambda_max, c.lambda_min / ALPHA],
        ]
    )
    sizes = np.linalg.norm(state[:3], axis=1)
    below = inequalities.lower_bound(state, GAINS, ALPHA, c)
    assert below == pytest.approx(ALPHA / 2 * sizes @ matrix @ sizes)


# (3.19) to (3.22)


def test_every_term_of_the_derivative_is_below_its_bound(state, rng, over_all_angles):
    for _ in range(5):
        gains = random_gains(rng)
        terms = lyapunov.derivative_terms(state, gains, ALPHA)
        bounds = inequalities.derivative_term_bounds(state, gains, ALPHA, over_all_angles)
        assert (terms <= bounds).all()
        below = inequalities.derivative_bound(state, gains, ALPHA, over_all_angles)
        np.testing.assert_allclose(below, bounds.sum(axis=-1))


def test_the_weights_count_the_error_and_not_the_speed(over_all_angles):
    c, error = over_all_angles, np.array([[0.3, 0.0, 0.0, 0.4], [0.0, 0.0, 0.0, 0.0]])
    W11, W22 = inequalities.rate_weights(error, GAINS, ALPHA, c)
    assert W11 == pytest.approx(ALPHA * (372500 - c.kg) - 555000)
    expected = 365000 - ALPHA * (c.lambda_max + c.kc1 * np.array([0.5, 0.0]))
    np.testing.assert_allclose(W22, expected)


def test_the_coriolis_term_is_half_the_turning_of_m_towards_the_goal(rng):
    q, error, dq = rng.normal(size=(3, 300, 4))
    C_T = np.swapaxes(dynamics.coriolis_matrix(q, dq), -1, -2)
    left = np.einsum("ni,nij,nj->n", error, C_T, dq)
    D = np.einsum("nk,nkij->nij", error, dynamics.mass_matrix_derivative(q))
    np.testing.assert_allclose(left, np.einsum("ni,nij,nj->n", dq, D, dq) / 2, rtol=1e-9, atol=1e-6)


# A.2 to A.10


def test_the_mass_matrix_stays_within_its_eigenvalues(rng, over_all_angles):
    q, x = rng.uniform(-np.pi, np.pi, (COUNT, 4)), rng.normal(size=(COUNT, 4))
    M = dynamics.mass_matrix(q)
    size = np.linalg.norm(x, axis=-1)
    form = np.einsum("ni,nij,nj->n", x, M, x)
    assert (form >= over_all_angles.lambda_min * size**2).all()
    assert (form <= over_all_angles.lambda_max * size**2).all()
    moved = np.linalg.norm((M @ x[..., None])[..., 0], axis=-1)
    assert (moved <= over_all_angles.lambda_max * size).all()
    assert over_all_angles.lambda_max <= 4 * np.abs(M).max()


def test_the_mass_matrix_and_the_coriolis_matrix_change_no_faster_than_their_recipes(rng):
    x, y, v, w, z = rng.uniform(-np.pi, np.pi, (5, COUNT, 4))
    step, q = 1e-4, rng.uniform(-np.pi, np.pi, (20000, 4))
    k_M = 16 * np.abs(dynamics.mass_matrix_derivative(q)).max()
    ahead = [lyapunov.christoffel(q + step * e) for e in np.eye(4)]
    behind = [lyapunov.christoffel(q - step * e) for e in np.eye(4)]
    k_C2 = 64 * np.abs(np.array(ahead) - np.array(behind)).max() / (2 * step)
    k_C1 = lyapunov.constants(domain="torus", recipe="printed").kc1

    def size(vector):
        return np.linalg.norm(vector, axis=-1)

    turned = (dynamics.mass_matrix(x) - dynamics.mass_matrix(y)) @ z[..., None]
    assert (size(turned[..., 0]) <= k_M * size(x - y) * size(z)).all()
    change = (dynamics.coriolis_matrix(x, z) - dynamics.coriolis_matrix(y, v)) @ w[..., None]
    allowed = k_C1 * size(z - v) * size(w) + k_C2 * size(x - y) * size(w) * size(z)
    assert (size(change[..., 0]) <= allowed).all()


def test_gravity_takes_no_work_round_a_way_and_has_bounded_energy_and_torque(rng):
    x, y = rng.uniform(-np.pi, np.pi, (2, COUNT, 4))
    nodes, weights = np.polynomial.legendre.leggauss(40)
    way = x + (nodes[:, None, None] + 1) / 2 * (y - x)
    power = (dynamics.gravity_torque(way) * (y - x)).sum(axis=-1) / 2
    work = weights @ power

    def height(q):
        return dynamics.energy(q, np.zeros(4))[1]

    np.testing.assert_allclose(work, height(y) - height(x), rtol=1e-8, atol=1e-3)
    boom, stick, bucket = BACKHOE.links
    of_bucket = bucket.mass * bucket.com_radius
    of_stick = of_bucket + stick.mass * stick.com_radius + bucket.mass * stick.length
    beyond = (stick.mass + bucket.mass) * boom.length
    levers = BACKHOE.gravity * np.array(
        [of_stick + boom.mass * boom.com_radius + beyond, of_stick, of_bucket]
    )
    middle = (height(x) + height(x + np.pi * np.eye(4)[1])) / 2
    np.testing.assert_allclose(middle, middle[0])
    assert (work + height(x) >= middle - levers[0]).all()
    assert (np.abs(dynamics.gravity_torque(x)[:, 1:]) <= levers).all()


def test_the_coriolis_matrix_is_bilinear_symmetric_and_made_of_christoffel_symbols(rng):
    q, x, y, z = rng.normal(size=(4, 200, 4))

    def C(first, second):
        return (dynamics.coriolis_matrix(q, first) @ second[..., None])[..., 0]

    np.testing.assert_allclose(C(x, y), C(y, x), atol=1e-7)
    np.testing.assert_allclose(C(z + 0.7 * x, y), C(z, y) + 0.7 * C(x, y), atol=1e-7)
    symbols = lyapunov.christoffel(q)
    np.testing.assert_allclose(np.einsum("ni,nkij,nj->nk", x, symbols, y), C(x, y), atol=1e-7)
    np.testing.assert_allclose(symbols, np.swapaxes(symbols, -1, -2))


def test_the_gravity_slope_is_the_derivative_of_the_gravity_torque(rng):
    q, h = rng.uniform(-3, 3, (100, 4)), 1e-5
    slope = np.stack(
        [
            (dynamics.gravity_torque(q + h * e) - dynamics.gravity_torque(q - h * e)) / (2 * h)
            for e in np.eye(4)
        ],
        axis=-1,
    )
    np.testing.assert_allclose(lyapunov.gravity_slope(q), slope, atol=1e-3)


# bad input


def test_leading_axes_are_kept():
    state = State(np.zeros((3, 1, 4)), np.zeros((5, 4)), np.zeros((3, 1, 4)), np.zeros(4))
    assert lyapunov.function(state, GAINS, ALPHA).shape == (3, 5)
    assert lyapunov.derivative(state, GAINS, ALPHA).shape == (3, 5)
    rates = lyapunov.closed_loop_rate(state, GAINS, ALPHA)
    assert [rate.shape for rate in rates] == [(3, 5, 4)] * 3
    assert inequalities.quadratic_terms(state, GAINS, ALPHA).shape == (3, 5, 4)
    made = lyapunov.closed_loop_state(state.w, state.dq, state.error, state.goal, GAINS, ALPHA)
    assert [part.shape for part in made] == [(3, 5, 4)] * 4


@pytest.mark.parametrize(
    ("gain", "complaint"),
    [
        ([1.0, 2.0, 3.0], r"K_p must be 4 gains .* got shape \(3,\)"),
        ([1.0, 2.0, np.nan, 4.0], "K_p must be finite"),
        ([1.0, 2.0, -3.0, 4.0], "K_p must be positive definite.* stick is -3"),
        ([1.0, 0.0, 3.0, 4.0], "K_p must be positive definite.* boom is 0"),
        (np.eye(4) + np.eye(4, k=1), "K_p must be symmetric"),
        (np.diag([1.0, 1.0, 1.0, -2.0]), "smallest eigenvalue is -2"),
        ("many", "K_p must be numbers"),
    ],
)
def test_a_gain_that_is_none_is_refused(gain, complaint):
    with pytest.raises(ValueError, match=complaint):
        lyapunov.function(State(*np.zeros((4, 4))), GAINS._replace(kp=gain), ALPHA)
    with pytest.raises(ValueError, match=complaint):
        lyapunov.check_gains(GAINS._replace(kp=gain))


@pytest.mark.parametrize("alpha", [0.0, -1.0, np.nan, np.inf, True, "1", None])
def test_alpha_must_be_a_positive_number(alpha):
    with pytest.raises(ValueError, match=r"alpha must be one number above 0 \[1/s\]"):
        lyapunov.derivative(State(*np.zeros((4, 4))), GAINS, alpha)


def test_states_that_do_not_fit_are_refused():
    rest = State(*np.zeros((4, 4)))
    with pytest.raises(ValueError, match="error must end in 4 joints"):
        lyapunov.function(rest._replace(error=np.zeros(3)), GAINS, ALPHA)
    with pytest.raises(ValueError, match="leading axes must fit"):
        unequal = rest._replace(w=np.zeros((2, 4)), error=np.zeros((3, 4)))
        lyapunov.function(unequal, GAINS, ALPHA)
    with pytest.raises(ValueError, match="integral must be finite"):
        lyapunov.closed_loop_state(*rest[:2], rest.dq + np.nan, rest.goal, GAINS, ALPHA)


def test_rows_in_an_order_of_one_s_own_are_no_state_and_no_gains():
    with pytest.raises(TypeError, match=r"state must be a State, got tuple.*w, error, dq, goal"):
        lyapunov.function((np.zeros(4),) * 4, GAINS, ALPHA)
    with pytest.raises(TypeError, match=r"gains must be a Gains, got tuple.*kp=.*ki=.*kd="):
        lyapunov.derivative(State(*np.zeros((4, 4))), (KP, KD, KI), ALPHA)
    with pytest.raises(TypeError, match="gains must be a Gains"):
        lyapunov.check_gains((KP, KD, KI))
