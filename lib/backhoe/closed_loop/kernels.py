"""One closed loop, compiled: the sampled law, and the arm between two samples.

The equation of motion is `dynamics.terms`, compiled here once more so that it becomes part of the
loop. Vectors of the four joints are tuples, which the compiler keeps in registers.
"""

from __future__ import annotations

from math import cos, exp, sin

import numpy as np
from numba import njit

from backhoe.dynamics import terms
from backhoe.dynamics.terms import Vectors

PID, PID_GRAVITY, COMPUTED_TORQUE = range(3)
"""The laws of `run`."""

ERRORS, PEAK_ERRORS, LAST_ERRORS, PEAK_TORQUES, EFFORTS, SATURATED, OVERRUNS = range(7)
"""Rows of the measures that `run` fills in."""

_inner = njit(error_model="numpy")

_newton_euler = _inner(terms.newton_euler)
_inertias = _inner(terms.inertias)
_gravity_torques = _inner(terms.gravity_torques)
_solve = _inner(terms.solve_inertias)

_TANH_IS_ONE = 20.0
_SMALL_TURN = 0.01
_BEND, _SHARE, _MOST_STEPS = 8.0, 0.05, 63


@njit(cache=True, nogil=True, error_model="numpy")
def run(plant, model, law, gains, reference, start, sampling, log_every, log, measures):
    """Follow a reference once.

    Args:
        plant: the arm that moves: its `Arm` and an array (6, 4) of viscous friction [N m s/rad],
            Coulomb friction [N m], torque limit [N m], lower and upper joint limit [rad], and in
            the last row [0] the speed that smooths Coulomb friction [rad/s].
        model: the `Arm` that the law believes in.
        law: PID, PID_GRAVITY or COMPUTED_TORQUE.
        gains: kp, ki, kd, shape (3, 4).
        reference: q, dq, ddq, shape (3, n, 4) [rad, rad/s, rad/s^2].
        start: q, dq and integral of the error, shape (3, 4) [rad, rad/s, rad s].
        sampling: dt [s], samples between two readings of the joints, 1 for a derivative from
            measured speeds or 0 from differences, filter time of the latter [s], and the error
            [rad] and speed [rad/s] from which on the run counts as diverged.
        log_every, log: every which sample goes into log (m, 3, 4): q, dq, torque; m may be 0.
        measures: filled in, shape (7, 4).

    Returns:
        Samples that were taken: n, or fewer for a run that diverged.
    """
    arm, numbers = plant
    dt, hold, measured, filter_time, largest_error, largest_speed = sampling
    integral, rate, last = start[2].copy(), np.zeros(4), np.zeros(4)
    wanted, given = np.zeros(4), np.zeros(4)
    q, dq = _tuple(start[0]), _tuple(start[1])
    q_seen, dq_seen = q, dq
    samples = reference.shape[1]
    for i in range(samples):
        if i % hold == 0:
            q_seen, dq_seen = q, dq
        for k in range(4):
            error = reference[0, i, k] - q_seen[k]
            if measured:
                rate[k] = reference[1, i, k] - dq_seen[k]
            elif i > 0:
                rate[k] = (filter_time * rate[k] + (error - last[k])) / (filter_time + dt)
            last[k] = error
            wanted[k] = gains[0, k] * error + gains[1, k] * (integral[k] + error * dt)
            wanted[k] += gains[2, k] * rate[k]
        _add_model(model, law, q_seen, dq_seen, reference[2, i], wanted)
        for k in range(4):
            limit = numbers[2, k]
            given[k] = min(max(wanted[k], -limit), limit)
            if given[k] == wanted[k] or wanted[k] * last[k] <= 0:
                integral[k] += last[k] * dt
        _measure(reference[0, i], q, wanted, given, numbers, i < samples - 1, measures)
        if i % log_every == 0 and i // log_every < len(log):
            for k in range(4):
                log[i // log_every, 0, k] = q[k]
                log[i // log_every, 1, k] = dq[k]
                log[i // log_every, 2, k] = given[k]
        if _diverged(reference[0, i], q, dq, given, largest_error, largest_speed):
            return i
        if i < samples - 1:
            q, dq = _advance(arm, numbers, _tuple(given), q, dq, dt)
    return samples


@_inner
def _tuple(row):
    return row[0], row[1], row[2], row[3]


@_inner
def _add_model(model, law, q, dq, ddq_ref, wanted):
    """What the law takes from its model of the arm, added to or made of the PID's output."""
    if law == PID:
        return
    v = _vectors(model, _turns(model, q))
    if law == PID_GRAVITY:
        g2, g3, g4 = _gravity_torques(model, v)
        wanted[1] += g2
        wanted[2] += g3
        wanted[3] += g4
        return
    a1, a2, a3, a4 = wanted[0], wanted[1], wanted[2], wanted[3]
    tau = _newton_euler(
        model,
        v,
        dq[0],
        dq[1],
        dq[2],
        dq[3],
        ddq_ref[0] + a1,
        ddq_ref[1] + a2,
        ddq_ref[2] + a3,
        ddq_ref[3] + a4,
    )
    for k in range(4):
        wanted[k] = tau[k]


@_inner
def _measure(q_ref, q, wanted, given, numbers, applied, measures):
    for k in range(4):
        error = q_ref[k] - q[k]
        measures[ERRORS, k] += error * error
        measures[PEAK_ERRORS, k] = max(measures[PEAK_ERRORS, k], abs(error))
        measures[LAST_ERRORS, k] = error
        measures[PEAK_TORQUES, k] = max(measures[PEAK_TORQUES, k], abs(given[k]))
        measures[EFFORTS, k] += applied * given[k] * given[k]
        measures[SATURATED, k] += applied * (given[k] != wanted[k])
        outside = max(numbers[3, k] - q[k], q[k] - numbers[4, k])
        measures[OVERRUNS, k] = max(measures[OVERRUNS, k], outside)


@_inner
def _diverged(q_ref, q, dq, given, largest_error, largest_speed):
    """Also true where a number is no longer finite: every comparison with NaN is false."""
    for k in range(4):
        small = abs(q_ref[k] - q[k]) < largest_error and abs(dq[k]) < largest_speed
        if not (small and abs(given[k]) < np.inf):
            return True
    return False


@_inner
def _advance(arm, numbers, tau, q, dq, dt):
    """One sample with the torque held, in steps short enough for Coulomb friction's bend."""
    turns = _turns(arm, q)
    a = _acceleration(arm, numbers, tau, turns, dq)
    steps = _steps(numbers, dq, a, dt)
    q, dq = _rk4(arm, numbers, tau, q, dq, turns, a, dt / steps)
    for _ in range(steps - 1):
        turns = _turns(arm, q)
        a = _acceleration(arm, numbers, tau, turns, dq)
        q, dq = _rk4(arm, numbers, tau, q, dq, turns, a, dt / steps)
    return q, dq


@_inner
def _steps(numbers, dq, a, dt):
    """How many steps keep the change of a speed, where friction bends, to a share of the bend."""
    steps = 1
    for k in range(4):
        change = abs(a[k]) * dt
        if numbers[1, k] > 0 and abs(dq[k]) < _BEND * numbers[5, 0] + change:
            steps = max(steps, int(min(change / (_SHARE * numbers[5, 0]), _MOST_STEPS)) + 1)
    return steps


@_inner
def _rk4(arm, numbers, tau, q, dq, turns, a1, h):
    """The classical Runge-Kutta step with the torque held."""
    w2 = _ahead(dq, h / 2, a1)
    a2 = _acceleration(arm, numbers, tau, _turned(arm, q, turns, h / 2, dq), w2)
    w3 = _ahead(dq, h / 2, a2)
    a3 = _acceleration(arm, numbers, tau, _turned(arm, q, turns, h / 2, w2), w3)
    w4 = _ahead(dq, h, a3)
    a4 = _acceleration(arm, numbers, tau, _turned(arm, q, turns, h, w3), w4)
    return _weighted(q, h, dq, w2, w3, w4), _weighted(dq, h, a1, a2, a3, a4)


@_inner
def _ahead(x, h, rate):
    return x[0] + h * rate[0], x[1] + h * rate[1], x[2] + h * rate[2], x[3] + h * rate[3]


@_inner
def _weighted(x, h, k1, k2, k3, k4):
    return (
        x[0] + h / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0]),
        x[1] + h / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1]),
        x[2] + h / 6 * (k1[2] + 2 * k2[2] + 2 * k3[2] + k4[2]),
        x[3] + h / 6 * (k1[3] + 2 * k2[3] + 2 * k3[3] + k4[3]),
    )


@_inner
def _acceleration(arm, numbers, tau, turns, dq):
    v = _vectors(arm, turns)
    bias = _newton_euler(arm, v, dq[0], dq[1], dq[2], dq[3], 0.0, 0.0, 0.0, 0.0)
    return _solve(
        _inertias(arm, v),
        tau[0] - bias[0] - _friction(numbers, 0, dq[0]),
        tau[1] - bias[1] - _friction(numbers, 1, dq[1]),
        tau[2] - bias[2] - _friction(numbers, 2, dq[2]),
        tau[3] - bias[3] - _friction(numbers, 3, dq[3]),
    )


@_inner
def _friction(numbers, k, speed):
    return numbers[0, k] * speed + numbers[1, k] * _tanh(speed / numbers[5, 0])


@_inner
def _tanh(x):
    """To the last bit or two of 1: what is lost near 0 is 1e-16 of the Coulomb friction."""
    if x > _TANH_IS_ONE:
        return 1.0
    if x < -_TANH_IS_ONE:
        return -1.0
    return 1.0 - 2.0 / (exp(2.0 * x) + 1.0)


@_inner
def _vectors(arm, turns):
    c2, s2, c3, s3, c4, s4 = turns
    return Vectors(
        arm.L2 * c2,
        arm.L2 * s2,
        arm.L3 * c3,
        arm.L3 * s3,
        arm.along2 * c2 - arm.across2 * s2,
        arm.along2 * s2 + arm.across2 * c2,
        arm.along3 * c3 - arm.across3 * s3,
        arm.along3 * s3 + arm.across3 * c3,
        arm.along4 * c4 - arm.across4 * s4,
        arm.along4 * s4 + arm.across4 * c4,
    )


@_inner
def _turns(arm, q):
    """Cosines and sines of the links' pitch angles."""
    p2 = q[1] + arm.o2
    p3 = p2 + (q[2] + arm.o3)
    p4 = p3 + (q[3] + arm.o4)
    return cos(p2), sin(p2), cos(p3), sin(p3), cos(p4), sin(p4)


@_inner
def _turned(arm, q, turns, h, rate):
    """`_turns` of q + h rate, from those of q by the series of a small turn, exact in doubles."""
    d2 = h * rate[1]
    d3 = d2 + h * rate[2]
    d4 = d3 + h * rate[3]
    if max(abs(d2), abs(d3), abs(d4)) > _SMALL_TURN:
        return _turns(arm, _ahead(q, h, rate))
    c2, s2, c3, s3, c4, s4 = turns
    c2, s2 = _turned_by(c2, s2, d2)
    c3, s3 = _turned_by(c3, s3, d3)
    c4, s4 = _turned_by(c4, s4, d4)
    return c2, s2, c3, s3, c4, s4


@_inner
def _turned_by(c, s, d):
    dd = d * d
    cosine = 1.0 - dd / 2 * (1.0 - dd / 12 * (1.0 - dd / 30))
    sine = d * (1.0 - dd / 6 * (1.0 - dd / 20 * (1.0 - dd / 42)))
    return c * cosine - s * sine, s * cosine + c * sine
