"""What decides each verdict on the thesis's Lyapunov PID: forms, properties, likely misprints.

Pinocchio gives M, g, the potential energy and the accelerations, SciPy and finite differences the
rest. A function that a row names as right or as printed bears the number of its item.
"""

import numpy as np
import pinocchio as pin
from scipy.integrate import quad_vec
from scipy.linalg import block_diag, expm
from scipy.optimize import differential_evolution, minimize, root
from scipy.signal import lfilter

from backhoe.arm import closed_loop, dynamics, lyapunov, movement
from backhoe.arm.lyapunov import State
from backhoe.arm.lyapunov.candidate import potential_term
from backhoe.arm.lyapunov.conditions import route_named
from backhoe.arm.lyapunov.gains import gain_matrices
from backhoe.arm.pid import ARM_GAINS, PID, DigitalPID, Gains
from backhoe.lessons import published
from backhoe.lessons.lyapunov_pid import inequalities, printed
from backhoe.machine import BACKHOE, JOINTS, replace
from oracles import pinocchio_model

EQ_333, TABLE_31 = (published.load(f"mastalli_2013_{name}") for name in ("eq_333", "table_31"))
NUMBERS = published.load("mastalli_2013_arm_constants")
gains_333 = Gains(*(np.array(EQ_333[name]) for name in ("K_p", "K_i", "K_d")))
MODEL, FLOATING = pinocchio_model(), replace(BACKHOE, gravity=0.0)
DATA, ALPHA, STILL = MODEL.createData(), 1.5, np.zeros(4)
ARM = lyapunov.constants(domain="torus")


def _rows(of_one):
    """A function of joint vectors, row by row."""

    def of_rows(*rows):
        return np.array([of_one(*row) for row in zip(*map(np.atleast_2d, rows), strict=True)])

    return of_rows


_mass = _rows(lambda q: pin.crba(MODEL, DATA, q).copy())
_gravity = _rows(lambda q: pin.computeGeneralizedGravity(MODEL, DATA, q).copy())
_height = _rows(lambda q: pin.computePotentialEnergy(MODEL, DATA, q))
_torque = _rows(lambda q, dq, ddq: pin.rnea(MODEL, DATA, q, dq, ddq).copy())
_acceleration = _rows(lambda q, dq, tau: pin.aba(MODEL, DATA, q, dq, tau).copy())


def _by_posture(f, q, step=1e-5):
    """The derivative of f by each joint, shape (n, 4, ...)."""
    return np.stack([(f(q + d) - f(q - d)) / (2 * step) for d in step * np.eye(4)], axis=1)


def _symbols(q):
    """Christoffel symbols C_kij from differences of the mass matrix."""
    dM = _by_posture(_mass, q)
    return (np.swapaxes(dM, 1, 2) + np.einsum("njki->nkij", dM) - dM) / 2


def _size(x):
    return np.linalg.norm(x, axis=-1)


def _unit(rng, *shape):
    x = rng.normal(size=shape)
    return x / np.linalg.norm(x, axis=-1, keepdims=True)


def _form(x, A, y):
    return np.einsum("...i,...ij,...j->...", x, A, y)


def _symmetric(rng, low, high):
    """A symmetric matrix with these ends of its spectrum and random axes."""
    axes = np.linalg.qr(rng.normal(size=(4, 4)))[0]
    return (axes * [low, *rng.uniform(low, high, 2), high]) @ axes.T


def _gains(rng):
    return Gains(*(_symmetric(rng, *ends) for ends in ((4e5, 2e6), (2e4, 3e5), (3e5, 2e6))))


def _in_the_box(rng, count):
    return rng.uniform(BACKHOE.lower, BACKHOE.upper, (count, 4))


def _ends(A):
    return np.linalg.eigvalsh(A)[..., [0, -1]].T


_rng = np.random.default_rng(51)
Q = _rng.uniform(-np.pi, np.pi, (200, 4))
M = _mass(Q)
W, ERROR, DQ = _rng.normal(size=(3, 200, 4)) * 10 ** _rng.uniform(-1.5, 0.5, (3, 200, 1))
STATE, GAINS = State(W, ERROR, DQ, Q + ERROR), _gains(_rng)


def _function(state, gains, alpha):
    """V of (3.8) from Pinocchio's energies."""
    (w, error, dq, goal), (Kp, Ki, Kd) = state, gains
    inertia = _mass(goal - error)
    V = _form(w, Ki, w) / alpha + alpha * _form(error, Kd, error) + _form(dq, inertia, dq)
    V += _form(error, Kp - Ki / alpha, error) - 2 * alpha * _form(error, inertia, dq)
    return V / 2 + _height(goal - error) - _height(goal) + (error * _gravity(goal)).sum(-1)


def _rates(state, gains, alpha):
    """How w, q~ and dq change under the PID, by Pinocchio."""
    (w, error, dq, goal), (Kp, Ki, Kd) = state, gains
    torque = error @ Kp - dq @ Kd + (w - error) / alpha @ Ki + _gravity(goal)
    return alpha * error - dq, -dq, _acceleration(goal - error, dq, torque)


def _change(f, state, rates, step=1e-6):
    """How fast f of the state changes along the rates."""

    def later(t):
        moved = (x + t * rate for x, rate in zip(state[:3], rates, strict=True))
        return f(State(*moved, state.goal))

    return (later(step) - later(-step)) / (2 * step)


def _slope(gains):
    """dV/dt in the random states."""
    return _change(lambda state: _function(state, gains, ALPHA), STATE, _rates(STATE, gains, ALPHA))


# (3.1) to (3.4) controller and arm


def answers_a_sine_with_its_frequency_response(pid, speed=2.0, dt=1e-3):
    law, t = pid(*gains_333), dt * np.arange(1000)
    torque = [
        law(
            np.sin(speed * x) * np.ones(4), speed * np.cos(speed * x) * np.ones(4), STILL, STILL, dt
        )
        for x in t
    ]
    kp, ki, kd = gains_333
    response = kp + 1j * speed * kd + ki / (1j * speed)
    expected = (np.exp(1j * speed * t)[:, None] * response).imag + ki / speed
    assert np.allclose(torque, expected, atol=2 * dt * ki.max())


class pid_with_derivative_of_the_integral(PID):
    def __call__(self, q_ref, dq_ref, q, dq, dt):
        return super().__call__(q_ref, q_ref - q, q, dq, dt)


def motion_32(q, dq, ddq):
    turned = (dynamics.coriolis_matrix(q, dq) @ dq[..., None])[..., 0]
    return (dynamics.mass_matrix(q) @ ddq[..., None])[..., 0] + turned + dynamics.gravity_torque(q)


def motion_with_the_reaction_of_gravity(q, dq, ddq):
    return motion_32(q, dq, ddq) - 2 * dynamics.gravity_torque(q)


def needs_the_torque_of_newton_and_euler(motion):
    assert np.allclose(motion(Q, DQ, W), _torque(Q, DQ, W), rtol=1e-9, atol=1e-4)


def memory_of_the_pid(integral, error, rate, gains, dt=1e-6):
    pid = PID(*gains)
    pid.integral = integral.tolist()
    torque = pid(error, rate, STILL, STILL, dt)
    return torque, (pid.integral - integral) / dt


def memory_33(integral, error, rate, gains):
    kp, ki, kd = gains
    return kp * error + kd * rate + ki * integral, error


def memory_of_the_rate(integral, error, rate, gains):
    return memory_33(integral, error, rate, gains)[0], rate


def remembers_the_integral_of_31(memory, t=1.3):
    frequency, (kp, ki, kd) = np.arange(1.0, 5.0), gains_333
    error, rate = np.cos(frequency * t), -frequency * np.sin(frequency * t)
    past = quad_vec(lambda s: np.cos(frequency * s), 0, t)[0]
    torque, growth = memory(past, error, rate, gains_333)
    assert np.allclose(torque, kp * error + ki * past + kd * rate, rtol=1e-5)
    assert np.allclose(growth, error)


def moving_goal_loop(integral, error, rate, q_d, dq_d, ddq_d, gains):
    kp, ki, kd = gains
    torque = kp * error + ki * integral + kd * rate
    return error, rate, ddq_d - dynamics.forward_dynamics(q_d - error, dq_d - rate, torque)


def loop_34(integral, error, rate, q_d, dq_d, ddq_d, gains):
    (kp, ki, kd), q, dq = gains, q_d - error, dq_d - rate
    turned = (dynamics.coriolis_matrix(q, dq) @ dq[..., None])[..., 0]
    bracket = kp * error + kd * rate + ki * integral - turned - dynamics.gravity_torque(q)
    inverse = np.linalg.inv(dynamics.mass_matrix(q))
    return error, rate, ddq_d - (inverse @ bracket[..., None])[..., 0]


def loop_with_the_goal_standing_still(integral, error, rate, q_d, dq_d, ddq_d, gains):
    return loop_34(integral, error, rate, q_d, dq_d, 0 * ddq_d, gains)


def moves_by_the_torque_of_the_pid(loop):
    (kp, ki, kd), rng = gains_333, np.random.default_rng(56)
    q_d, dq_d, ddq_d = rng.normal(size=(3, 200, 4))
    dxi, rate, ddq = loop(W, ERROR, DQ, q_d, dq_d, ddq_d, gains_333)
    assert np.array_equal(dxi, ERROR) and np.array_equal(rate, DQ)
    found = _torque(q_d - ERROR, dq_d - DQ, ddq_d - ddq)
    assert np.allclose(found, kp * ERROR + ki * W + kd * DQ, rtol=1e-9, atol=1e-3)


# (3.5) to (3.7) the closed loop


def closed_loop_rate_35(z, error, dq, goal, gains):
    dw, rate, ddq = lyapunov.closed_loop_rate(State(z + error, error, dq, goal), gains, 1.0)
    return dw - rate, rate, ddq


def moves_by_a_torque_that_damps(rate):
    Kp, Ki, Kd = GAINS
    dz, error, ddq = rate(W, ERROR, DQ, STATE.goal, GAINS)
    assert np.allclose(dz, ERROR) and np.allclose(error, -DQ)
    expected = ERROR @ Kp - DQ @ Kd + W @ Ki + _gravity(STATE.goal)
    assert np.allclose(_torque(Q, DQ, ddq), expected, rtol=1e-9, atol=1e-3)


def state_36(q, dq, integral, goal, gains, alpha):
    z, one, no = integral - dynamics.gravity_torque(goal) / gains.ki, np.eye(4), np.zeros((4, 4))
    change = np.block([[alpha * one, one, no], [no, one, no], [no, no, one]])
    x = np.concatenate(np.broadcast_arrays(z, goal - q, dq), axis=-1) @ change.T
    return State(*np.split(x, 3, axis=-1), goal)


def state_with_alpha_before_the_error(q, dq, integral, goal, gains, alpha):
    w, error, dq, goal = state_36(q, dq, integral, goal, gains, alpha)
    return State(w / alpha + (alpha - 1 / alpha) * error, error, dq, goal)


def rests_at_zero_and_moves_as_37_says(state, step=1e-4):
    goal = np.array([0.3, 0.2, -0.4, 0.9])
    at_rest = state(goal, STILL, _gravity(goal)[0] / gains_333.ki, goal, gains_333, ALPHA)
    assert np.allclose(at_rest[:3], 0, atol=1e-12)
    ahead, behind = (
        state(Q + h * DQ, DQ, W + h * (goal - Q), goal, gains_333, ALPHA) for h in (step, -step)
    )
    dw, error = (
        np.subtract(*pair) / (2 * step) for pair in zip(ahead[:2], behind[:2], strict=True)
    )
    assert np.allclose(dw, ALPHA * (goal - Q) - DQ) and np.allclose(error, -DQ)


def lets_small_deviations_die_out(rate, step=1e-6):
    x = step * np.eye(12).reshape(12, 3, 4).transpose(1, 0, 2)
    for goal in Q[:20]:
        ahead, behind = (
            np.concatenate(rate(State(*way, goal), gains_333, ALPHA), axis=-1) for way in (x, -x)
        )
        assert np.linalg.eigvals((ahead - behind).T / (2 * step)).real.max() < 0


def rate_without_the_weight_at_the_goal(state, gains, alpha):
    dw, error, ddq = lyapunov.closed_loop_rate(state, gains, alpha)
    inertia = dynamics.mass_matrix(state.goal - state.error)
    return dw, error, ddq - np.linalg.solve(inertia, dynamics.gravity_torque(state.goal))


def rests_nowhere_but_in_the_origin(rate):
    starts = np.random.default_rng(57).normal(size=(10, 12))
    for goal, start in zip(Q[:10], starts, strict=True):

        def left(x, goal=goal):
            return np.concatenate(rate(State(*x.reshape(3, 4), goal), gains_333, ALPHA))

        found = root(left, start, tol=1e-12)
        assert np.abs(left(found.x)).max() < 1e-6 and np.abs(found.x).max() < 1e-6


# (3.8) to (3.13) the function V and its floor


def falls_along_every_motion(V):
    rng = np.random.default_rng(58)
    w, error, dq = rng.normal(size=(3, 300, 4)) * np.array([0.3, 0.2, 0.5])[:, None, None]
    goal = _in_the_box(rng, 300)
    state, gains = State(w, error, dq, goal), Gains(*map(np.diag, gains_333))
    slope = _change(lambda s: V(s, gains, ALPHA), state, _rates(state, gains, ALPHA))
    assert (slope < 0).all() and (V(state, gains, ALPHA) > 0).all()
    assert np.allclose(V(State(STILL, STILL, STILL, goal), gains, ALPHA), 0, atol=1e-6)


def term_with_the_lever_turned_round(error, goal, stiffness, machine):
    lever = (error * dynamics.gravity_torque(goal)).sum(-1)
    return potential_term(error, goal, stiffness, machine) - 2 * lever


def is_the_work_of_springs_and_of_the_weight_that_is_new(term):
    """Against springs and against g(goal - s q~) less g(goal) on the way, by Gauss's rule."""
    K, (places, weights) = GAINS.kp - GAINS.ki / ALPHA, np.polynomial.legendre.leggauss(40)
    at_goal, work = _gravity(STATE.goal), _form(ERROR, K, ERROR) / 2
    for s, weight in zip((1 + places) / 2, weights / 2, strict=True):
        work += weight * (ERROR * (at_goal - _gravity(STATE.goal - s * ERROR))).sum(-1)
    assert np.allclose(term(ERROR, STATE.goal, K, BACKHOE), work, rtol=1e-6, atol=1e-2)


def gradient_310(error, goal, gains, alpha):
    Kp, Ki, _ = gains
    lighter = dynamics.gravity_torque(goal) - dynamics.gravity_torque(goal - error)
    return error @ (Kp - Ki / alpha) + lighter


def is_39_or_its_derivative(expression):
    def term(error):
        K = GAINS.kp - GAINS.ki / ALPHA
        lever = (error * _gravity(STATE.goal)).sum(-1)
        height = _height(STATE.goal - error) - _height(STATE.goal)
        return (_form(error, K, error) / 2 + height + lever)[:, None]

    found = expression(ERROR, STATE.goal, GAINS, ALPHA)
    slope = _by_posture(term, ERROR)[..., 0]
    expected = (np.broadcast_to(term(ERROR), (200, 4)), slope)
    assert any(np.allclose(found, one, rtol=1e-4, atol=1.0) for one in expected)


def _hessian(error, goal, gains, alpha):
    return lyapunov.gravity_slope(goal - error) + gains.kp - gains.ki / alpha


step_311 = gradient_310, _hessian
printed_step_311 = printed.term_310, _hessian


def second_is_the_derivative_of_the_first(step):
    first, second = (lambda e, f=f: f(e, STATE.goal, GAINS, ALPHA) for f in step)
    assert np.allclose(_by_posture(first, ERROR), second(ERROR), rtol=1e-4, atol=1.0)


def stiff_enough_312(gains, alpha, constants):
    return lyapunov.check_gains(gains, constants=constants).alpha_low < alpha


def printed_stiff_enough_312(gains, alpha, constants):
    return printed.kp_condition_312(gains.kp, gains.ki, constants)


def leaves_stiffness_in_every_posture(condition):
    rng, slope, passed = np.random.default_rng(52), _by_posture(_gravity, Q), 0
    for alpha in 10 ** rng.uniform(-2, 1, 100):
        gains = _gains(rng)._replace(ki=_symmetric(rng, 1e4, 1e5))
        if condition(gains, alpha, ARM):
            passed += 1
            assert np.linalg.eigvalsh(gains.kp - gains.ki / alpha + slope).min() > 0
    assert passed > 10


def alpha_313(gains, constants):
    return lyapunov.check_gains(gains, constants=constants).alpha_low


def printed_alpha_313(gains, constants):
    (softest, _), (_, strongest) = map(_ends, (gains.kp, gains.ki))
    return strongest / (softest - constants.kg)


def alpha_with_the_weakest_integral(gains, constants):
    return printed_alpha_313(gains, constants) * _ends(gains.ki)[0] / _ends(gains.ki)[1]


def is_the_least_alpha_that_leaves_stiffness(bound):
    """Whatever the axes of K_p, K_i and of a slope of gravity no steeper than k_g."""
    low = bound(GAINS, ARM)
    (softest, stiffest), (weakest, strongest) = map(_ends, (GAINS.kp, GAINS.ki))
    rng = np.random.default_rng(53)
    for _ in range(50):
        K = _symmetric(rng, softest, stiffest)
        K -= _symmetric(rng, weakest, strongest) / (1.001 * low)
        assert _ends(K + _symmetric(rng, -ARM.kg, ARM.kg))[0] > 0
    assert softest - strongest / (0.999 * low) - ARM.kg < 0


# (3.14) to (3.17) V is positive


def quadratic_314(state, gains, alpha):
    (w, error, dq, goal), (_, Ki, Kd) = state, gains
    inertia, none = dynamics.mass_matrix(goal - error), np.zeros((len(w), 4, 4))
    Ki, Kd = (np.broadcast_to(gain, inertia.shape) for gain in (Ki, Kd))
    rows = (
        (Ki / alpha, none, none),
        (none, alpha * Kd, -alpha * inertia),
        (none, -alpha * inertia, inertia),
    )
    P = np.concatenate([np.concatenate(row, axis=-1) for row in rows], axis=-2)
    x = np.concatenate([w, error, dq], axis=-1)
    return _form(x, P, x) / 2


def quadratic_with_the_cross_term_turned_round(state, gains, alpha):
    return quadratic_314(state._replace(dq=-state.dq), gains, alpha)


def is_below_v_and_reached_without_error(quadratic):
    assert _ends(GAINS.kp - GAINS.ki / ALPHA)[0] > ARM.kg
    assert (quadratic(STATE, GAINS, ALPHA) <= _function(STATE, GAINS, ALPHA)).all()
    there = State(W, 0 * ERROR, DQ, Q)
    assert np.allclose(quadratic(there, GAINS, ALPHA), _function(there, GAINS, ALPHA))


def bounds_with_the_lightest_motion_in_the_cross_term(state, gains, alpha, constants):
    bounds = inequalities.quadratic_term_bounds(state, gains, alpha, constants)
    return bounds * [1, 1, 1, constants.lambda_min / constants.lambda_max]


def bounds_the_terms_of_v_from_below(bounds):
    found = bounds(STATE, GAINS, ALPHA, ARM)
    terms = [_form(W, GAINS.ki, W) / ALPHA, ALPHA * _form(ERROR, GAINS.kd, ERROR)]
    terms += [_form(DQ, M, DQ), -ALPHA * _form(ERROR, M, DQ)]
    assert (found <= np.stack(terms, axis=-1)).all()
    axis = np.linalg.eigh(GAINS.ki)[1][:, 0]
    weakest = bounds(State(axis, STILL, STILL, STILL), GAINS, ALPHA, ARM)
    assert np.isclose(weakest[0], _form(axis, GAINS.ki, axis) / ALPHA)


def lower_bound_316(state, gains, alpha, constants):
    sizes = np.stack([_size(x) for x in state[:3]], axis=-1)
    ki, kd = (_ends(gain)[0] for gain in (gains.ki, gains.kd))
    cross = -constants.lambda_max
    P = [[ki / alpha**2, 0, 0], [0, kd, cross], [0, cross, constants.lambda_min / alpha]]
    return alpha / 2 * _form(sizes, np.array(P), sizes)


def lower_bound_with_alpha_once(state, gains, alpha, constants):
    ki = _ends(gains.ki)[0] * _size(state.w) ** 2 / 2
    return lower_bound_316(state, gains, alpha, constants) + ki * (1 - 1 / alpha)


def is_below_v_and_reached_by_the_weakest_integral(bound):
    assert (bound(STATE, GAINS, ALPHA, ARM) <= _function(STATE, GAINS, ALPHA)).all()
    only = State(np.tile(np.linalg.eigh(GAINS.ki)[1][:, 0], (1, 1)), STILL, STILL, STILL)
    only = State(*np.broadcast_arrays(*only))
    assert np.allclose(bound(only, GAINS, ALPHA, ARM), _function(only, GAINS, ALPHA))


def alpha_317(gains, constants):
    return lyapunov.check_gains(gains, constants=constants).alpha_high


def printed_alpha_317(gains, constants):
    return printed.alpha_high_317(gains.kd, constants)


def alpha_with_the_heaviest_motion_once(gains, constants):
    return printed_alpha_317(gains, constants) * constants.lambda_max


def is_where_the_form_of_316_stops_being_positive(bound):
    for q, inertia in zip(Q[:20], M, strict=False):
        light, heavy = _ends(inertia)
        alpha, weak = bound(GAINS, lyapunov.constants(q)), _ends(GAINS.kd)[0]
        for share, sign in ((0.999, 1), (1.001, -1)):
            P = np.array([[weak, -heavy], [-heavy, light / (share * alpha)]])
            assert sign * np.linalg.det(P) > 0


# (3.18) to (3.24) V falls


def derivative_318(state, gains, alpha):
    (_, error, dq, goal), (Kp, Ki, Kd) = state, gains
    q = goal - error
    turning = np.swapaxes(dynamics.coriolis_matrix(q, dq), -1, -2)
    lighter = dynamics.gravity_torque(goal) - dynamics.gravity_torque(q)
    damping = _form(dq, Kd - alpha * dynamics.mass_matrix(q), dq)
    springs, gravity = _form(error, alpha * Kp - Ki, error), (error * lighter).sum(-1)
    return -damping - springs - alpha * _form(error, turning, dq) - alpha * gravity


def derivative_without_the_transposition(state, gains, alpha):
    turning = dynamics.coriolis_matrix(state.goal - state.error, state.dq)
    other = np.swapaxes(turning, -1, -2) - turning
    return derivative_318(state, gains, alpha) + alpha * _form(state.error, other, state.dq)


def is_the_slope_of_v_along_the_motion(derivative):
    assert np.allclose(derivative(STATE, GAINS, ALPHA), _slope(GAINS), rtol=1e-3, atol=10.0)


def bounds_with_the_strongest_damper(state, gains, alpha, constants):
    bounds = inequalities.derivative_term_bounds(state, gains, alpha, constants)
    more = np.subtract(*_ends(gains.kd)) * _size(state.dq) ** 2
    return bounds + np.stack([more, 0 * more, 0 * more, 0 * more], axis=-1)


def _terms_of_the_slope(gains, alpha):
    """The four terms of (3.18); C by how M changes towards the goal."""
    step = 1e-6
    turn = (_mass(Q + step * ERROR) - _mass(Q - step * ERROR)) / (2 * step)
    damping = -_form(DQ, gains.kd - alpha * M, DQ)
    springs = -_form(ERROR, alpha * gains.kp - gains.ki, ERROR)
    gravity = -alpha * (ERROR * (_gravity(STATE.goal) - _gravity(Q))).sum(-1)
    return np.stack([damping, springs, -alpha * _form(DQ, turn, DQ) / 2, gravity], axis=-1)


def bounds_the_terms_of_the_slope_from_above(bounds):
    rng = np.random.default_rng(54)
    for gains in [_gains(rng) for _ in range(20)]:
        assert (_terms_of_the_slope(gains, ALPHA) <= bounds(STATE, gains, ALPHA, ARM)).all()


def derivative_bound_320(state, gains, alpha, constants):
    weights = inequalities.rate_weights(state.error, gains, alpha, constants)
    sizes = np.stack([_size(state.error), _size(state.dq)], axis=-1)
    return -(sizes**2 * np.stack(np.broadcast_arrays(*weights), axis=-1)).sum(-1)


def derivative_bound_with_the_weights_exchanged(state, gains, alpha, constants):
    W11, W22 = inequalities.rate_weights(state.error, gains, alpha, constants)
    return -W22 * _size(state.error) ** 2 - W11 * _size(state.dq) ** 2


def is_above_the_slope_of_v(bound):
    stiff, less_damped = GAINS._replace(kp=3 * GAINS.kp), GAINS._replace(kd=GAINS.kd / 2)
    for gains in (GAINS, stiff, less_damped):
        slope = _slope(gains)
        assert (bound(STATE, gains, ALPHA, ARM) >= slope - 1e-3 * np.abs(slope)).all()


def weight_321(gains, alpha, constants):
    return inequalities.rate_weights(STILL, gains, alpha, constants)[0]


def printed_weight_321(gains, alpha, constants):
    return alpha * (_ends(gains.kp)[0] - constants.kg) - _ends(gains.ki)[1]


def weight_with_alpha_before_the_integral(gains, alpha, constants):
    return printed_weight_321(gains, alpha, constants) + (1 - alpha) * _ends(gains.ki)[1]


def is_the_least_stiffness_in_the_slope(weight):
    """Of alpha K_p - K_i less alpha times a slope of gravity, whatever their axes."""
    least = weight(GAINS, ALPHA, ARM)
    (softest, stiffest), (weakest, strongest) = map(_ends, (GAINS.kp, GAINS.ki))
    rng = np.random.default_rng(55)
    for _ in range(50):
        K = ALPHA * _symmetric(rng, softest, stiffest) - _symmetric(rng, weakest, strongest)
        assert _ends(K + ALPHA * _symmetric(rng, -ARM.kg, ARM.kg))[0] >= least
    assert np.isclose(least, ALPHA * (softest - ARM.kg) - strongest)


def weight_322(state, gains, alpha, constants):
    return inequalities.rate_weights(state.error, gains, alpha, constants)[1]


HEAVY = np.linalg.eigh(M)[1][..., -1]
TURN = -np.einsum("ni,nkij,nj->nk", HEAVY, _by_posture(_mass, Q), HEAVY)
TURN /= _size(TURN)[:, None]


def is_below_the_damping_that_is_left(weight):
    """Of slow motions with large errors, about one posture, where its constants are sharp."""
    gains = Gains(*np.diag([1e6, 1e5, 1e6]) @ np.ones((3, 4)))
    for q, heavy, turn in zip(Q[:50], HEAVY, TURN, strict=False):
        state, dM = State(STILL, 3 * turn, 1e-3 * heavy, q + 3 * turn), _by_posture(_mass, q[None])
        D = np.einsum("k,kij->ij", state.error, dM[0])
        left = np.diag(gains.kd) - ALPHA * (_mass(q)[0] - D / 2)
        W22 = weight(state, gains, ALPHA, lyapunov.constants(q))
        assert _form(state.dq, left, state.dq) >= W22 * 1e-6 * (1 - 1e-6)


def alphas_323(state, gains, constants):
    scalar, gains = route_named("scalar"), gain_matrices(gains)
    high = scalar.alpha_decay(gains, constants, _size(state.error))
    return scalar.alpha_low(gains, constants), high


def are_where_spring_and_damper_are_used_up(limits):
    """The spring by gravity and K_i, the damper by M and by Coriolis torques at that error."""
    state, size = State(STILL, STILL + 0.2, STILL + 0.1, STILL), 0.4
    low, high = limits(state, gains_333, ARM)
    assert np.isclose(low * (gains_333.kp.min() - ARM.kg), gains_333.ki.max())
    assert np.isclose(high * (ARM.lambda_max + ARM.kc1 * size), gains_333.kd.min())


def within_324(state, gains, constants):
    low = lyapunov.check_gains(gains, constants=constants).alpha_low
    return inequalities.rate_weights(state.error, gains, low, constants)[1] > 0


def lets_v_fall_wherever_it_says(within):
    """Without gravity, at alpha = 1, where dampers are made for errors of 0.5 rad."""
    said = []
    for q, inertia, heavy, turn in zip(Q[:30], M, HEAVY, TURN, strict=False):
        c = lyapunov.constants(q, machine=FLOATING).replace(kg=0.0)
        gains = Gains(*np.outer([9e5, 9e5, c.lambda_max + 0.5 * c.kc1], np.ones(4)))
        for far in (0.01, 0.49, 5.0, 30.0):
            state = State(STILL, far * turn, 0.1 * heavy, q + far * turn)
            said.append(within(state, gains, c))
            D = np.einsum("k,kij->ij", state.error, _by_posture(_mass, q[None])[0])
            left = gains.kd[0] - _form(heavy, inertia - D / 2, heavy)
            assert left >= 0 or not said[-1]
    assert np.mean(said) >= 0.5


def with_a_weaker_strongest_integral(gains):
    return gains._replace(ki=np.minimum(gains.ki, gains.ki.max() / 2))


def with_a_weaker_weakest_integral(gains):
    return gains._replace(ki=np.where(gains.ki == gains.ki.min(), gains.ki / 2, gains.ki))


def widens_the_region(change):
    """The most error for which a damper outweighs M and Coriolis torques, as (3.24) mended."""

    def region(gains):
        low = gains.ki.max() / (gains.kp.min() - ARM.kg)
        return (gains.kd.min() / low - ARM.lambda_max) / ARM.kc1

    assert region(change(gains_333)) > region(gains_333)


# (3.25) to (3.30) conditions on gains


def conditions_by_extremes(gains, constants):
    try:
        return lyapunov.check_gains(gains, constants=constants).holds
    except ValueError:  # a gain is not positive
        return False


def _alphas(gains, c):
    """The ends of (3.13) and (3.17)."""
    low = gains.ki.max() / (gains.kp.min() - c.kg)
    return low, c.lambda_min * gains.kd.min() / c.lambda_max**2


def conditions_325(gains, constants):
    low, high = _alphas(gains, constants)
    return low < high


def conditions_with_the_extremes_of_m_exchanged(gains, constants):
    low, high = _alphas(gains, constants)
    return low < high * (constants.lambda_max / constants.lambda_min) ** 3


def conditions_326(gains, constants):
    return gains.kp.min() > constants.kg and conditions_325(gains, constants)


def conditions_with_springs_that_only_push(gains, constants):
    return gains.kp.min() > 0 and conditions_325(gains, constants)


def conditions_327(gains, constants):
    return gains.ki.min() > 0 and conditions_326(gains, constants)


def conditions_that_allow_a_negative_integral(gains, constants):
    return gains.ki.max() > 0 and conditions_326(gains, constants)


def _alpha_exists(gains, c):
    """Whether (3.12) and the 3 x 3 form of (3.16) can be positive together, tried on a grid."""
    alpha = np.geomspace(1e-6, 1e4, 4000)
    P, none = np.zeros((len(alpha), 3, 3)), np.zeros(len(alpha))
    P[:, 0, 0], P[:, 1, 1] = gains.ki.min() / alpha**2, gains.kd.min()
    P[:, 1, 2] = P[:, 2, 1] = none - c.lambda_max
    P[:, 2, 2] = c.lambda_min / alpha
    positive = np.linalg.eigvalsh(P)[:, 0] > 0
    return (positive & (gains.kp.min() - gains.ki.max() / alpha > c.kg)).any()


def _agree(conditions, *, weak=False, negative=False):
    rng, c, said = np.random.default_rng(59), lyapunov.constants(Q[0]), []
    for _ in range(60):
        kp = c.kg * (1 + rng.uniform(0.1, 5, 4) * (rng.choice([-0.15, 1]) if weak else 1))
        ki = rng.uniform(1, 2, 4) * 10 ** rng.uniform(2, 5)
        ki[0] *= -1 if negative and rng.random() < 0.3 else 1
        kd = rng.uniform(1, 2, 4) * abs(ki.max() / (kp.min() - c.kg)) * c.ratio
        kd *= 10 ** rng.uniform(-1.5, 1)
        more, less = (_alpha_exists(Gains(kp, ki, kd * share), c) for share in (1.02, 0.98))
        said.append(conditions(Gains(kp, ki, kd), c))
        assert said[-1] or not less
        assert more or not said[-1]
    assert 0 < sum(said) < 60


def say_where_stiff_springs_leave_an_alpha(conditions):
    _agree(conditions)


def say_where_springs_leave_an_alpha(conditions):
    _agree(conditions, weak=True)


def say_where_gains_leave_an_alpha(conditions):
    _agree(conditions, weak=True, negative=True)


def conditions_without_norms(gains, constants):
    return lyapunov.check_gains(gains, constants=constants, route="exact").holds


def reject_no_loop_whose_deviations_die_out(conditions):
    """Eigenvalues of M^-1 [K_p + dg/dq, K_d, K_i] about 200 postures."""
    kp, ki, kd = map(np.diag, gains_333)
    for inertia, slope in zip(M, _by_posture(_gravity, Q), strict=True):
        A = np.eye(12, k=4)
        A[8:] = -np.linalg.solve(inertia, np.hstack([ki, kp + slope, kd]))
        assert np.linalg.eigvals(A).real.max() < 0
    assert conditions(gains_333, ARM)


# (3.28) the digital PID


def digital_pid(e, K, Ti, Td, dt):
    pid = DigitalPID.from_ideal(K, Ti, Td, dt, derivative_of="error")
    return np.array([pid(x, 0.0) for x in e])


def digital_pid_328(e, K, Ti, Td, dt):
    u = [K * e[0]]
    for k in range(1, len(e)):
        total = sum(e[i] * dt for i in range(1, k + 1))
        u.append(K * (e[k] + total / Ti + Td * (e[k] - e[k - 1]) / dt))
    return np.array(u)


def digital_pid_without_the_present_error(e, K, Ti, Td, dt):
    return digital_pid_328(e, K, Ti, Td, dt) - K * dt / Ti * np.concatenate([[0], e[1:]])


def is_its_transfer_function(pid, K=1.7, Ti=0.8, Td=0.15, dt=0.01):
    e = np.concatenate([[0], np.random.default_rng(60).normal(size=150).cumsum()])
    lag = Td / dt
    once = lfilter(K * np.array([1 + dt / Ti + lag, -1 - 2 * lag, lag]), [1, -1], e)
    assert np.allclose(pid(e, K, Ti, Td, dt), once)


# (3.31), (3.32), A.1: constants of the arm


def kg_by_recipe(q):
    return lyapunov.constants(q, recipe="printed").kg


def kg_331(q):
    return 4 * np.abs(lyapunov.gravity_slope(q)).max()


def kg_of_one_entry(q):
    return kg_331(q) / 4


def bounds_how_gravity_changes(constant):
    for q, slope in zip(Q[:50], _by_posture(_gravity, Q[:50]), strict=True):
        assert constant(q[None]) >= np.linalg.norm(slope, 2) * (1 - 1e-6)


def kc1_by_recipe(q):
    return lyapunov.constants(q, recipe="printed").kc1


def kc1_332(q):
    return 16 * np.abs(lyapunov.christoffel(q)).max()


def kc1_of_one_entry(q):
    return kc1_332(q) / 16


def bounds_products_of_two_speeds(constant):
    x = _unit(np.random.default_rng(61), 500, 4)
    for q, symbols in zip(Q[:50], _symbols(Q[:50]), strict=True):
        turned = _size(np.einsum("ni,kij,nj->nk", x, symbols, x)).max()
        assert constant(q[None]) >= turned * (1 - 1e-6)


def beta_a3(q):
    return 4 * np.abs(dynamics.mass_matrix(q)).max()


def beta_of_one_entry(q):
    return beta_a3(q) / 4


def largest_eigenvalue(q):
    return lyapunov.constants(q).lambda_max


def bounds_the_eigenvalues_of_m(constant):
    for q, inertia in zip(Q[:50], M, strict=False):
        assert constant(q[None]) >= _ends(inertia)[1] * (1 - 1e-9)


def k_m_a4(q):
    return 16 * np.abs(dynamics.mass_matrix_derivative(q)).max()


def k_m_of_one_entry(q):
    return k_m_a4(q) / 16


def bounds_how_m_changes(constant):
    ways = _unit(np.random.default_rng(62), 200, 4)
    for q, dM in zip(Q[:50], _by_posture(_mass, Q[:50]), strict=True):
        changes = np.linalg.norm(np.einsum("nk,kij->nij", ways, dM), 2, axis=(1, 2))
        assert constant(q[None]) >= changes.max() * (1 - 1e-6)


def momentum_a5(x, y):
    return ARM.lambda_max * _size(y)


def momentum_by_the_angles(x, y):
    return ARM.lambda_max * _size(x)


def bounds_the_momentum(bound):
    for y in (DQ, 100 * DQ, HEAVY):
        assert (bound(Q, y) >= _size((M @ y[..., None])[..., 0])).all()


def coriolis_with_the_same_torque(q, dq):
    """Mdot dq less half the derivative of dq M dq: as good for (3.2), another matrix."""
    dM = dynamics.mass_matrix_derivative(q)
    turn = np.einsum("...k,...kij->...ij", dq, dM)
    return turn - np.einsum("...kij,...j->...ki", dM, dq) / 2


def is_symmetric_and_linear_in_its_two_speeds(coriolis):
    def C(x, y):
        return (coriolis(Q, x) @ y[..., None])[..., 0]

    by_pinocchio = _torque(Q, DQ, 0 * Q) - _gravity(Q)
    assert np.allclose(C(DQ, DQ), by_pinocchio, rtol=1e-6, atol=1e-3)
    assert np.allclose(C(W, DQ), C(DQ, W), atol=1e-3)
    assert np.allclose(C(W + 0.7 * ERROR, DQ), C(W, DQ) + 0.7 * C(ERROR, DQ), atol=1e-3)


_STEEPEST = 64 * np.abs(_by_posture(lyapunov.christoffel, Q)).max()


def change_a9(x, y, z, v, w):
    sizes = _size(w) * _size(z)
    return ARM.kc1 * _size(z - v) * _size(w) + _STEEPEST * _size(x - y) * sizes


def change_whatever_the_first_speed(x, y, z, v, w):
    return ARM.kc1 * _size(z - v) * _size(w) + _STEEPEST * _size(x - y) * _size(w)


def bounds_how_coriolis_torques_change(bound):
    y, here = Q + 0.1 * ERROR, _symbols(Q)
    there = _symbols(y)
    for z, v in ((DQ, W), (DQ, DQ), (1e3 * DQ, 1e3 * DQ)):
        left = np.einsum("nkij,ni,nj->nk", here, z, ERROR)
        left -= np.einsum("nkij,ni,nj->nk", there, v, ERROR)
        assert (bound(Q, y, z, v, ERROR) >= _size(left)).all()


def least_height_a12():
    return _over_all_angles(lambda q: dynamics.energy(q, np.zeros(4))[1])


def largest_height():
    return -_over_all_angles(lambda q: -dynamics.energy(q, np.zeros(4))[1])


def _over_all_angles(cost):
    """The least value over boom, stick and bucket, by SciPy."""
    return differential_evolution(
        lambda x: cost(np.pad(x.T, ((0, 0), (1, 0)))), [(-np.pi, np.pi)] * 3, seed=3, tol=1e-9,
        vectorized=True, updating="deferred", polish=False,
    ).fun  # fmt: skip


def is_below_start_and_work_on_every_way(least):
    (places, weights), (x, y), found = np.polynomial.legendre.leggauss(40), (Q, Q[::-1]), least()
    work = sum(
        weight / 2 * (_gravity(x + (1 + s) / 2 * (y - x)) * (y - x)).sum(-1)
        for s, weight in zip(places, weights, strict=True)
    )
    ends = work + _height(x)
    assert np.allclose(ends, _height(y), rtol=1e-6)
    assert (found <= ends).all()
    lowest = minimize(lambda q: _height(q)[0], [0, -np.pi / 2, 0, 0], tol=1e-9).fun
    assert np.isclose(found, lowest, rtol=1e-5)


def gravity_change_a13(x, y):
    return ARM.kg * _size(x - y)


def gravity_change_by_the_square(x, y):
    return ARM.kg * _size(x - y) ** 2


def bounds_how_gravity_differs(bound):
    for y in (Q[::-1], Q + 0.1 * ERROR):
        assert (bound(Q, y) >= _size(_gravity(Q) - _gravity(y))).all()


def largest_gravity_a14():
    return -_over_all_angles(lambda q: -_size(dynamics.gravity_torque(q)))


def largest_gravity_of_one_joint():
    return -_over_all_angles(lambda q: -np.abs(dynamics.gravity_torque(q)).max(-1))


def is_the_largest_torque_of_gravity(constant):
    largest = -_over_all_angles(lambda q: -_size(_gravity(q)))
    assert constant() >= largest * (1 - 1e-6)


# (3.33), (3.34), Table 3.1 and the numbers of section 3.4.1

printings_333 = EQ_333, TABLE_31
one_printing = EQ_333, EQ_333


def print_the_same_gains(printings):
    first, second = printings
    assert all(first[name] == second[name] for name in ("K_p", "K_d", "K_i"))


def obey_the_bound_printed_below_them(damping):
    assert min(damping) > NUMBERS["conclusions"]["K_d_above"]


_RATIOS = np.array([heavy**2 / light for light, heavy in map(_ends, M)])
damping_334 = printed.kd_bound_334(gains_333.kp, gains_333.ki, ARM)


def is_as_much_as_sampled_postures_ask(damping):
    """By the third line of (3.30), with k_g no more than the slope in one of them."""
    kg = np.linalg.norm(_by_posture(_gravity, Q), 2, axis=(1, 2)).max()
    low = gains_333.ki.max() / (gains_333.kp.min() - kg)
    assert low * _RATIOS.max() <= damping < 1.5 * low * _RATIOS.max()


def loading_34(seed):
    return movement.loading(dt=0.01)


def some_movement_34(seed):
    """A movement of which all that is printed is true: its phases, and its fastest speed."""
    times, fastest = NUMBERS["movement"]["phases"], NUMBERS["movement"]["largest_speed_deg"]
    way = np.random.default_rng(seed).uniform(-0.2, 0.2, (4, 4))
    way[:, 0] += [-1, 1, -1, 1]
    top = movement.from_postures(times, way, 0.01, rest=[1, 2]).speed.max()
    return movement.from_postures(times, way * np.radians(fastest) / top, 0.01, rest=[1, 2])


def is_one_movement_with_the_printed_speed(move):
    first, second = move(1), move(2)
    for one in (first, second):
        fastest = np.degrees(_size(np.diff(one.q, axis=0) / one.dt)).max()
        assert abs(fastest - NUMBERS["movement"]["largest_speed_deg"]) < 0.2
        rows = np.round(np.array(NUMBERS["movement"]["phases"]) / one.dt).astype(int)
        assert np.abs(one.dq[rows]).max() < 1e-9
    assert np.allclose(first.q, second.q)


kg_341 = lyapunov.constants().kg


def bounds_how_gravity_changes_in_the_box(kg):
    q = _in_the_box(np.random.default_rng(63), 200)
    assert kg >= np.linalg.norm(_by_posture(_gravity, q), 2, axis=(1, 2)).max()


kc1_341 = lyapunov.constants(recipe="printed").kc1


def is_the_recipe_of_332_in_the_box(kc1):
    q = _in_the_box(np.random.default_rng(64), 200)
    assert kc1 >= 16 * np.abs(_symbols(q)).max()


ratio_38 = lyapunov.constants().ratio


def is_a_ratio_that_some_posture_has(ratio):
    assert ratio >= _RATIOS.min()


bound_3_4_1 = np.degrees(
    printed.bound_324(
        gains_333, ARM.replace(kg=NUMBERS["gravity"]["k_g"], kc1=NUMBERS["coriolis"]["k_C1"])
    )
)


def follows_from_324_with_some_posture_s_inertia(bound):
    """From the printed gains and constants, and the lightest of sampled postures."""
    kp, ki, kd = gains_333
    kg, kc1 = NUMBERS["gravity"]["k_g"], NUMBERS["coriolis"]["k_C1"]
    lightest = min(_ends(inertia)[1] for inertia in M)
    assert bound <= np.degrees((kd.min() * (kp.min() - kg) / ki.max() - lightest) / kc1)


# sections 3.4 and 3.4.1: the loop as it was run


def die_out_from_millisecond_to_millisecond(gains, dt=0.001):
    """By the matrix exponential, about sampled postures of the joint box."""
    kp, ki, kd = map(np.diag, gains)
    q = _in_the_box(np.random.default_rng(65), 100)
    for inertia, slope in zip(_mass(q), _by_posture(_gravity, q), strict=True):
        A = np.zeros((12, 12))
        A[:4, 4:8], A[4:8, 8:] = np.eye(4), np.linalg.inv(inertia)
        A[4:8, :4] = -A[4:8, 8:] @ slope
        held = expm(A * dt)[:8]
        sample = block_diag(held[:, :8], np.eye(4))
        sample[:8] -= held[:, 8:] @ np.hstack([kp + dt * ki, kd, ki])
        sample[8:, :4] = dt * np.eye(4)
        assert np.abs(np.linalg.eigvals(sample)).max() < 1


def stay_bounded_along_the_loading_movement(gains):
    run = closed_loop.simulate(gains, movement.loading(), settled=True)
    assert not run.diverged.any()


state_at_1_khz = {}
state_at_100_hz = {"state_every": 10, "rate": "difference"}


def asks_for_about_the_torque_that_the_movement_needs(state):
    move = movement.loading()
    needed = np.abs(_torque(move.q[::100], move.dq[::100], move.ddq[::100])[:, 1]).max()
    run = closed_loop.simulate(ARM_GAINS, move, settled=True, **state)
    assert run.peak_torque[0, 1] < 1.2 * needed


def keep_within_two_degrees_clear_of_the_limits(gains):
    move = movement.loading(dt=5e-4)
    assert ((move.q > BACKHOE.lower) & (move.q < BACKHOE.upper)).all()
    run = closed_loop.simulate(gains, move, settled=True)
    assert run.peak_error[0].max() < np.radians(2)


hardest_311 = "boom", 2
printed_hardest_311 = "stick", 2


def names_the_joint_with_the_largest_torque(hardest):
    (name, number), move = hardest, movement.loading(dt=0.1)
    torques = np.abs(_torque(move.q, move.dq, move.ddq)).max(axis=0)
    assert number - 1 == torques.argmax() and JOINTS[number - 1] == name
