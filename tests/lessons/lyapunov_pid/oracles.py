"""What proves the references of lesson 03: torques that balance, conditions at their limits."""

import numpy as np
from numpy.testing import assert_allclose
from scipy.signal import lfilter

from backhoe.arm import dynamics, lyapunov
from backhoe.machine import BACKHOE

STILL = np.zeros(4)

EQUAL = {
    "3.1": {"ki is never negative": "an integral gain is positive"},
    "3.5": {
        f"{name} is never negative": "a bound, an inertia, or made of such and a gain: positive"
        for name in ("value 1 of the result", "kg", "kc1", "lambda_min", "lambda_max")
    },
    "3.6": {
        f"{name} is never negative": "a gain, a time, or made of both: positive"
        for name in ("the result", "kd", "dt")
    },
}


def rest_by_newton_and_euler(answer, q_goal, ki):
    """K_i times the integral is the torque with which bodies at rest push each other."""
    held = dynamics.inverse_dynamics(q_goal, STILL, STILL)
    assert_allclose(ki * answer, held, rtol=1e-9, atol=1e-6)


def torque_of_the_controller(answer, state, gains, alpha):
    """The acceleration needs, by Newton and Euler, the torque that the PID itself gives."""
    w, error, dq, goal = state
    dw, derror, ddq = answer
    integral = (w - error) / alpha + dynamics.gravity_torque(goal) / gains.ki
    torque = gains.kp * error + gains.ki * integral + gains.kd * derror
    needed = dynamics.inverse_dynamics(goal - error, dq, ddq)
    assert_allclose(needed, torque, rtol=1e-9, atol=1e-3)
    assert_allclose(derror + dq, 0, atol=1e-12)
    assert_allclose((dw - derror) / alpha, error, rtol=1e-12)


def blocks_and_the_work_of_gravity(answer, state, gains, alpha):
    """The block matrix of (3.8) as it stands, and its potential as work on the way to the goal."""
    w, error, dq, goal = state
    M, zero = dynamics.mass_matrix(goal - error), np.zeros((4, 4))
    springs, damping = np.diag(gains.kp - gains.ki / alpha), alpha * np.diag(gains.kd)
    P = np.block(
        [
            [np.diag(gains.ki / alpha), zero, zero],
            [zero, springs + damping, -alpha * M],
            [zero, -alpha * M, M],
        ]
    )
    x = np.concatenate([w, error, dq])
    places, weights = np.polynomial.legendre.leggauss(20)
    on_the_way = dynamics.gravity_torque(goal - np.outer((1 + places) / 2, error))
    lighter = dynamics.gravity_torque(goal) - on_the_way
    assert_allclose(answer, x @ P @ x / 2 + weights @ lighter @ error / 2, rtol=1e-9, atol=1e-6)


def stretch_by_differences(answer, postures):
    """No small step of a posture changes gravity by more than k_g a radian, and one does by it."""
    step, found = 1e-5, []
    for q in postures:
        ahead, behind = (dynamics.gravity_torque(q + d * np.eye(4)) for d in (step, -step))
        slope = (ahead - behind) / (2 * step)
        found.append(np.sqrt(np.linalg.eigvalsh(slope @ slope.T)[-1]))
    assert_allclose(answer, max(found), rtol=1e-6)


def conditions_become_equations(answer, gains, kg, kc1, lambda_min, lambda_max):
    """W11 of (3.21) and the form of (3.16) vanish at the two alphas, W22 of (3.22) at the error."""
    (kp, ki, kd), (low, high, region) = gains, answer
    assert_allclose(low * (kp.min() - kg), ki.max(), rtol=1e-9)
    form = [[high * kd.min(), -high * lambda_max], [-high * lambda_max, lambda_min]]
    assert high > 0 and abs(np.linalg.eigvalsh(form)[0]) < 1e-9 * lambda_min
    assert_allclose(low * (lambda_max + kc1 * region), kd.min(), rtol=1e-9)


def speed_turns_round_and_keeps_its_size(answer, q, kd, dt):
    """With that factor one sample turns the speed of the fastest motion from v to -v."""
    one_sample = np.eye(4) - dt * answer * np.linalg.inv(dynamics.mass_matrix(q)) * kd
    assert_allclose(np.sort(np.linalg.eigvals(one_sample).real)[0], -1, rtol=1e-9)
    assert answer > 0


def demands_in_random_states(answer):
    """Drives, surprise and memory by hand; speeds that shrink; the exact conditions on alpha."""
    kp, ki, kd = answer
    rng = np.random.default_rng(37)
    assert all((gain > 0).all() for gain in answer)
    assert (0.05 * kp <= BACKHOE.torque_limit * (1 + 1e-9)).all()
    assert 54e3 <= kp[1] * np.radians(1) * (1 + 1e-9)
    assert (kp <= 10 * ki * (1 + 1e-9)).all()
    q = rng.uniform(BACKHOE.lower, BACKHOE.upper, (500, 4))
    M = dynamics.mass_matrix(q)
    assert np.abs(np.linalg.eigvals(np.eye(4) - 0.01 * np.linalg.inv(M) * kd)).max() < 1
    error = rng.normal(size=(500, 4))
    error *= rng.uniform(0, 0.5, (500, 1)) / np.linalg.norm(error, axis=1, keepdims=True)
    heavier = M - np.einsum("nk,nkij->nij", error, dynamics.mass_matrix_derivative(q)) / 2
    least = np.linalg.eigvals(np.linalg.solve(np.diag(kp) + lyapunov.gravity_slope(q), np.diag(ki)))
    most = [np.linalg.eigvals(inertia / kd).real.max() for inertia in (M, heavier)]
    assert least.real.max() * max(most) < 1


def least_overshoot_of_two_integrals(answer, kp, ki, kd, dt, limit):
    """Each loop has that one of the old and the new integral which overshoots the limit less."""
    _overshoot(answer, kp, ki, kd, dt, limit, 0.0)


def least_overshoot_with_a_filtered_speed(answer, kp, ki, kd, dt, limit, filter_time):
    """The same, with the speed through SciPy's recursive filter, its weights by their sum."""
    _overshoot(answer, kp, ki, kd, dt, limit, filter_time)


def _overshoot(answer, kp, ki, kd, dt, limit, filter_time):
    rng, n = np.random.default_rng(38), len(kp)
    time = dt * np.arange(150)[:, None]
    reference = np.sign(np.sin(40 * time + rng.uniform(0, 6, n))) + rng.uniform(-1, 1, n) * time
    measured = 0.3 * np.sin(20 * time + rng.uniform(0, 6, n)) + 0.2
    rate = rng.uniform(-1, 1, reference.shape)
    new = dt / (filter_time + dt)
    speed = lfilter([new], [1, new - 1], np.diff(measured, axis=0) / dt, axis=0)
    damping = kd * np.vstack([np.zeros(n), rate[1:] - speed])
    rows = reference, rate, measured
    outputs = [answer(*map(np.copy, sample)) for sample in zip(*rows, strict=True)]
    for k in range(n):
        integral = 0.0
        for error, damped, output in zip(
            reference - measured, damping, np.array(outputs), strict=True
        ):
            free = kp[k] * error[k] + damped[k]
            both = integral, integral + ki[k] * dt * error[k]
            over = [max(abs(free + one) - limit[k], 0.0) for one in both]
            integral = both[int(over[1] <= over[0])]
            assert_allclose(output[k], min(max(free + integral, -limit[k]), limit[k]), atol=1e-9)
