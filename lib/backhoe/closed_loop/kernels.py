"""Up to `LANES` closed loops side by side, compiled: the sampled law and the arm between samples.

Every quantity of a joint is a row with one place for each run, and each row is worked through by a
loop that the compiler turns into vector instructions; that is five times as fast as one run after
the other. It needs all rows in one flat array, constant distances between them, and functions that
are inlined. Runs do not touch each other: their numbers are the same in any company.

The equation of motion is `dynamics.terms`, compiled into the loop.
"""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numba import njit

from backhoe.dynamics import terms
from backhoe.dynamics.terms import Arm

LANES = 16
"""Runs in a block."""

PID, PID_GRAVITY, COMPUTED_TORQUE = range(3)
"""The laws of `run`."""

ERRORS, PEAK_ERRORS, LAST_ERRORS, PEAK_TORQUES, EFFORTS, SATURATED, OVERRUNS = range(7)
"""Rows, times four joints, of the measures that `run` fills in."""

# Rows of the state, four joints each where nothing else is said.
_Q, _W, _TAU = 0, 4, 8
_Q_SEEN, _W_SEEN, _INTEGRAL, _RATE, _LAST, _WANTED = 12, 16, 20, 24, 28, 32
_KP, _KI, _KD = 36, 40, 44
_TURNS = 48
"""Cosine and sine of the pitch of boom, stick and bucket: 6 rows."""
_A1, _A, _V, _SUM_V, _SUM_A, _Q_KEPT, _W_KEPT = 54, 58, 62, 66, 70, 74, 78
_SHIFT, _NET = 82, 86
_PAYLOAD = 90
ROWS = 91

_REFRESH = 16
"""Samples after which cosines and sines are computed anew instead of turned on."""

_LONGEST_TURN = 0.1
_BEND, _SHARE, _MOST_STEPS = 8.0, 0.05, 63

_call = njit(error_model="numpy")
_inline = njit(error_model="numpy", forceinline=True)

_vectors = _inline(terms.vectors)
_inertias = _inline(terms.inertias)
_newton_euler = _inline(terms.newton_euler)
_solve = _inline(terms.solve_inertias)
_gravity_torques = _inline(terms.gravity_torques)


@njit(cache=True, nogil=True, error_model="numpy")
def run(arm, numbers, model, law, runs, reference, sampling, log_every, log_of, logs, measures):
    """Follow a reference with some runs at once.

    Args:
        arm: the `Arm` that moves, without payload.
        numbers: viscous friction [N m s/rad], Coulomb friction [N m], torque limit [N m], lower and
            upper joint limit [rad], and in the last row the speed that smooths Coulomb friction
            [rad/s], shape (6, 4).
        model: the `Arm` that the law believes in.
        law: PID, PID_GRAVITY or COMPUTED_TORQUE.
        runs: kp, ki, kd, q, dq, integral of the error of each run at the start, and its payload in
            the first place of the last row, shape (n, 7, 4), n at most `LANES`.
        reference: q, dq, ddq, shape (3, m, 4) [rad, rad/s, rad/s^2].
        sampling: dt [s], samples between two readings of the joints, 1 for a derivative from
            measured speeds or 0 from differences, filter time of the latter [s], and the error
            [rad] and speed [rad/s] from which on a run counts as diverged.
        log_every, log_of, logs: every which sample of run i goes into logs[log_of[i]], shape
            (rows, 3, 4): q, dq, torque; -1 for none.
        measures: filled in, shape (n, 7, 4).

    Returns:
        Samples that each run took: m, or fewer if it diverged, shape (n,).
    """
    dt, hold, measured, filter_time, largest_error, largest_speed = sampling
    samples = reference.shape[1]
    lanes = len(runs)
    S, one = np.zeros(ROWS * LANES), np.zeros(ROWS * LANES)
    M = np.zeros(28 * LANES)
    run_of = np.arange(lanes)
    taken = np.full(lanes, samples)
    _begin(S, runs)
    for i in range(samples):
        if i % _REFRESH == 0:
            _compute_turns(S, arm, lanes)
        if i % hold == 0:
            _copy(S, _Q, _Q_SEEN, 8, lanes)
        _feed_back(S, reference[:, i], measured, filter_time, dt, i, lanes)
        if law != PID:
            _add_model(S, model, law, reference[2, i], lanes)
        _saturate(S, numbers, dt, lanes)
        _measure(S, M, reference[0, i], numbers, i < samples - 1, lanes)
        if i % log_every == 0:
            _log(S, logs, log_of, run_of, i // log_every, lanes)
        if _all_fine(S, reference[0, i], largest_error, largest_speed, lanes) < lanes:
            for j in range(lanes - 1, -1, -1):
                if not _fine(S, reference[0, i], largest_error, largest_speed, j):
                    taken[run_of[j]] = i
                    lanes = _drop(S, M, run_of, measures, j, lanes)
        if i < samples - 1:
            _advance(S, one, arm, numbers, dt, lanes)
    for j in range(lanes - 1, -1, -1):
        _drop(S, M, run_of, measures, j, j + 1)
    return taken


@_call
def _begin(S, runs):
    for j in range(len(runs)):
        for k in range(4):
            S[(_KP + k) * LANES + j] = runs[j, 0, k]
            S[(_KI + k) * LANES + j] = runs[j, 1, k]
            S[(_KD + k) * LANES + j] = runs[j, 2, k]
            S[(_Q + k) * LANES + j] = runs[j, 3, k]
            S[(_W + k) * LANES + j] = runs[j, 4, k]
            S[(_INTEGRAL + k) * LANES + j] = runs[j, 5, k]
        S[_PAYLOAD * LANES + j] = runs[j, 6, 0]


@_inline
def _copy(S, source, target, rows, lanes):
    for row in range(rows):
        for j in range(lanes):
            S[(target + row) * LANES + j] = S[(source + row) * LANES + j]


@_call
def _drop(S, M, run_of, measures, j, lanes):
    """Take the measures of a run that ends, and let the last lane have its place."""
    for row in range(28):
        measures[run_of[j], row // 4, row % 4] = M[row * LANES + j]
        M[row * LANES + j] = M[row * LANES + lanes - 1]
    for row in range(ROWS):
        S[row * LANES + j] = S[row * LANES + lanes - 1]
    run_of[j] = run_of[lanes - 1]
    return lanes - 1


@_call
def _feed_back(S, reference, measured, filter_time, dt, i, lanes):
    """What the PID wants, before its model and the limit."""
    for k in range(4):
        q_ref, w_ref = reference[0, k], reference[1, k]
        for j in range(lanes):
            error = q_ref - S[(_Q_SEEN + k) * LANES + j]
            if measured:
                rate = w_ref - S[(_W_SEEN + k) * LANES + j]
            else:
                change = error - S[(_LAST + k) * LANES + j]
                rate = (filter_time * S[(_RATE + k) * LANES + j] + change) / (filter_time + dt)
                rate = rate if i > 0 else 0.0
            S[(_RATE + k) * LANES + j] = rate
            S[(_LAST + k) * LANES + j] = error
            total = S[(_INTEGRAL + k) * LANES + j] + error * dt
            wanted = S[(_KP + k) * LANES + j] * error + S[(_KI + k) * LANES + j] * total
            S[(_WANTED + k) * LANES + j] = wanted + S[(_KD + k) * LANES + j] * rate


@_call
def _add_model(S, model, law, ddq_ref, lanes):
    """What the law takes from its model of the arm, added to or made of the PID's output."""
    for j in range(lanes):
        p2 = S[(_Q_SEEN + 1) * LANES + j] + model.o2
        p3 = p2 + (S[(_Q_SEEN + 2) * LANES + j] + model.o3)
        p4 = p3 + (S[(_Q_SEEN + 3) * LANES + j] + model.o4)
        v = _vectors(model, cos(p2), sin(p2), cos(p3), sin(p3), cos(p4), sin(p4))
        if law == PID_GRAVITY:
            g2, g3, g4 = _gravity_torques(model, v)
            S[(_WANTED + 1) * LANES + j] += g2
            S[(_WANTED + 2) * LANES + j] += g3
            S[(_WANTED + 3) * LANES + j] += g4
        else:
            tau = _newton_euler(
                model,
                v,
                S[(_W_SEEN + 0) * LANES + j],
                S[(_W_SEEN + 1) * LANES + j],
                S[(_W_SEEN + 2) * LANES + j],
                S[(_W_SEEN + 3) * LANES + j],
                ddq_ref[0] + S[(_WANTED + 0) * LANES + j],
                ddq_ref[1] + S[(_WANTED + 1) * LANES + j],
                ddq_ref[2] + S[(_WANTED + 2) * LANES + j],
                ddq_ref[3] + S[(_WANTED + 3) * LANES + j],
            )
            S[(_WANTED + 0) * LANES + j] = tau[0]
            S[(_WANTED + 1) * LANES + j] = tau[1]
            S[(_WANTED + 2) * LANES + j] = tau[2]
            S[(_WANTED + 3) * LANES + j] = tau[3]


@_call
def _saturate(S, numbers, dt, lanes):
    """The torque within its limit; the integral goes on unless that pushes further out."""
    for k in range(4):
        limit = numbers[2, k]
        for j in range(lanes):
            wanted, error = S[(_WANTED + k) * LANES + j], S[(_LAST + k) * LANES + j]
            given = min(max(wanted, -limit), limit)
            goes_on = (given == wanted) | (wanted * error <= 0)
            old = S[(_INTEGRAL + k) * LANES + j]
            S[(_INTEGRAL + k) * LANES + j] = old + error * dt if goes_on else old
            S[(_TAU + k) * LANES + j] = given


@_call
def _measure(S, M, q_ref, numbers, applied, lanes):
    weight = 1.0 if applied else 0.0
    for k in range(4):
        lower, upper, reference = numbers[3, k], numbers[4, k], q_ref[k]
        for j in range(lanes):
            q, given = S[(_Q + k) * LANES + j], S[(_TAU + k) * LANES + j]
            error, torque = reference - q, abs(given)
            outside = max(lower - q, q - upper)
            limited = weight if given != S[(_WANTED + k) * LANES + j] else 0.0
            M[(4 * ERRORS + k) * LANES + j] += error * error
            M[(4 * PEAK_ERRORS + k) * LANES + j] = max(
                M[(4 * PEAK_ERRORS + k) * LANES + j], abs(error)
            )
            M[(4 * LAST_ERRORS + k) * LANES + j] = error
            M[(4 * PEAK_TORQUES + k) * LANES + j] = max(
                M[(4 * PEAK_TORQUES + k) * LANES + j], torque
            )
            M[(4 * EFFORTS + k) * LANES + j] += weight * (given * given)
            M[(4 * SATURATED + k) * LANES + j] += limited
            M[(4 * OVERRUNS + k) * LANES + j] = max(M[(4 * OVERRUNS + k) * LANES + j], outside)


@_call
def _log(S, logs, log_of, run_of, row, lanes):
    for j in range(lanes):
        log = log_of[run_of[j]]
        if log >= 0:
            for k in range(4):
                logs[log, row, 0, k] = S[(_Q + k) * LANES + j]
                logs[log, row, 1, k] = S[(_W + k) * LANES + j]
                logs[log, row, 2, k] = S[(_TAU + k) * LANES + j]


@_inline
def _fine(S, q_ref, largest_error, largest_speed, j):
    """False also where a number is no longer finite: every comparison with NaN is false."""
    fine = True
    for k in range(4):
        fine &= abs(q_ref[k] - S[(_Q + k) * LANES + j]) < largest_error
        fine &= abs(S[(_W + k) * LANES + j]) < largest_speed
        fine &= abs(S[(_TAU + k) * LANES + j]) < np.inf
    return fine


@_call
def _all_fine(S, q_ref, largest_error, largest_speed, lanes):
    count = 0
    for j in range(lanes):
        count += _fine(S, q_ref, largest_error, largest_speed, j)
    return count


@_call
def _compute_turns(S, arm, lanes):
    for j in range(lanes):
        p2 = S[(_Q + 1) * LANES + j] + arm.o2
        p3 = p2 + (S[(_Q + 2) * LANES + j] + arm.o3)
        p4 = p3 + (S[(_Q + 3) * LANES + j] + arm.o4)
        S[(_TURNS + 0) * LANES + j], S[(_TURNS + 1) * LANES + j] = cos(p2), sin(p2)
        S[(_TURNS + 2) * LANES + j], S[(_TURNS + 3) * LANES + j] = cos(p3), sin(p3)
        S[(_TURNS + 4) * LANES + j], S[(_TURNS + 5) * LANES + j] = cos(p4), sin(p4)


@_call
def _advance(S, one, arm, numbers, dt, lanes):
    """One sample with the torque held, in shorter steps where Coulomb friction bends."""
    alone = min(lanes, 1)
    _copy(S, _Q, _Q_KEPT, 8, lanes)
    _rk4(S, arm, numbers, dt, lanes)
    for j in range(lanes):
        steps = _steps(S, numbers, dt, j)
        if steps > 1:
            for row in range(ROWS):
                one[row * LANES] = S[row * LANES + j]
            _copy(one, _Q_KEPT, _Q, 8, alone)
            for _ in range(steps):
                _compute_turns(one, arm, alone)
                _rk4(one, arm, numbers, dt / steps, alone)
            _compute_turns(one, arm, alone)
            for row in range(ROWS):
                S[row * LANES + j] = one[row * LANES]


@_inline
def _steps(S, numbers, dt, j):
    """Steps in which a speed changes by a share of the bend, and a link turns little."""
    most, turn = 0.0, 0.0
    for k in range(4):
        speed, change = abs(S[(_W_KEPT + k) * LANES + j]), abs(S[(_A1 + k) * LANES + j]) * dt
        bends = numbers[1, k] > 0 and speed < _BEND * numbers[5, 0] + change
        most = max(most, change / (_SHARE * numbers[5, 0]) if bends else 0.0)
        turn += speed + change
    most = max(most, turn * dt / _LONGEST_TURN)
    return int(min(most, _MOST_STEPS)) + 1


@_call
def _rk4(S, arm, numbers, h, lanes):
    """The classical Runge-Kutta step with the torque held."""
    smoothing = 1.0 / numbers[5, 0]
    for row in range(4):
        for j in range(lanes):
            S[(_A + row) * LANES + j] = S[(_V + row) * LANES + j] = 0.0
            S[(_SUM_A + row) * LANES + j] = S[(_SUM_V + row) * LANES + j] = 0.0
    for stage in range(4):
        c = 0.0 if stage == 0 else h if stage == 3 else h / 2
        b = h / 6 if stage in (0, 3) else h / 3
        for k in range(4):
            viscous, coulomb = numbers[0, k], numbers[1, k]
            for j in range(lanes):
                S[(_SHIFT + k) * LANES + j] = c * S[(_V + k) * LANES + j]
                w = S[(_W + k) * LANES + j] + c * S[(_A + k) * LANES + j]
                S[(_V + k) * LANES + j] = w
                S[(_SUM_V + k) * LANES + j] += b * w
                friction = viscous * w + coulomb * _tanh(smoothing * w)
                S[(_NET + k) * LANES + j] = S[(_TAU + k) * LANES + j] - friction
        for j in range(lanes):
            d2 = S[(_SHIFT + 1) * LANES + j]
            d3 = d2 + S[(_SHIFT + 2) * LANES + j]
            d4 = d3 + S[(_SHIFT + 3) * LANES + j]
            c2, s2 = _turned(S[(_TURNS + 0) * LANES + j], S[(_TURNS + 1) * LANES + j], d2)
            c3, s3 = _turned(S[(_TURNS + 2) * LANES + j], S[(_TURNS + 3) * LANES + j], d3)
            c4, s4 = _turned(S[(_TURNS + 4) * LANES + j], S[(_TURNS + 5) * LANES + j], d4)
            loaded = _loaded(arm, S[_PAYLOAD * LANES + j])
            v = _vectors(loaded, c2, s2, c3, s3, c4, s4)
            w1, w2 = S[(_V + 0) * LANES + j], S[(_V + 1) * LANES + j]
            w3, w4 = S[(_V + 2) * LANES + j], S[(_V + 3) * LANES + j]
            bias = _newton_euler(loaded, v, w1, w2, w3, w4, 0.0, 0.0, 0.0, 0.0)
            a1, a2, a3, a4 = _solve(
                _inertias(loaded, v),
                S[(_NET + 0) * LANES + j] - bias[0],
                S[(_NET + 1) * LANES + j] - bias[1],
                S[(_NET + 2) * LANES + j] - bias[2],
                S[(_NET + 3) * LANES + j] - bias[3],
            )
            S[(_A + 0) * LANES + j] = a1
            S[(_A + 1) * LANES + j] = a2
            S[(_A + 2) * LANES + j] = a3
            S[(_A + 3) * LANES + j] = a4
        for k in range(4):
            for j in range(lanes):
                S[(_SUM_A + k) * LANES + j] += b * S[(_A + k) * LANES + j]
        if stage == 0:
            _copy(S, _A, _A1, 4, lanes)
    for row in range(4):
        for j in range(lanes):
            S[(_Q + row) * LANES + j] += S[(_SUM_V + row) * LANES + j]
            S[(_W + row) * LANES + j] += S[(_SUM_A + row) * LANES + j]
    for link in range(3):
        for j in range(lanes):
            d = S[(_SUM_V + 1) * LANES + j]
            d = d + S[(_SUM_V + 2) * LANES + j] if link > 0 else d
            d = d + S[(_SUM_V + 3) * LANES + j] if link > 1 else d
            c, s = S[(_TURNS + 2 * link) * LANES + j], S[(_TURNS + 2 * link + 1) * LANES + j]
            c, s = _turned(c, s, d)
            S[(_TURNS + 2 * link) * LANES + j] = c
            S[(_TURNS + 2 * link + 1) * LANES + j] = s


@_inline
def _loaded(arm, load):
    """The arm with a point mass at the bucket's centre of mass, as `variants.loaded`."""
    return Arm(
        arm.g,
        arm.b1,
        arm.z1,
        arm.L2,
        arm.L3,
        arm.o2,
        arm.o3,
        arm.o4,
        arm.along2,
        arm.across2,
        arm.along3,
        arm.across3,
        arm.along4,
        arm.across4,
        arm.m_bo,
        arm.m_s,
        arm.m_bu + load,
        arm.I_yaw,
        arm.I_bo,
        arm.I_s,
        arm.I_bu,
    )


@_inline
def _turned(c, s, d):
    """Cosine and sine of an angle that is larger by a small d: its series, exact in doubles."""
    dd = d * d
    cosine = 1 - dd * (1 / 2) * (1 - dd * (1 / 12) * (1 - dd * (1 / 30) * (1 - dd * (1 / 56))))
    sine = 1 - dd * (1 / 6) * (1 - dd * (1 / 20) * (1 - dd * (1 / 42) * (1 - dd * (1 / 72))))
    sine = d * sine
    return c * cosine - s * sine, s * cosine + c * sine


@_inline
def _tanh(x):
    """tanh to 1e-14, by exp(2 x) = exp(x / 64)^128 and multiplication alone."""
    y = min(max(x, -20.0), 20.0) * (1 / 64)
    e = 1 + y * (1 / 12)
    e = 1 + y * (1 / 11) * e
    e = 1 + y * (1 / 10) * e
    e = 1 + y * (1 / 9) * e
    e = 1 + y * (1 / 8) * e
    e = 1 + y * (1 / 7) * e
    e = 1 + y * (1 / 6) * e
    e = 1 + y * (1 / 5) * e
    e = 1 + y * (1 / 4) * e
    e = 1 + y * (1 / 3) * e
    e = 1 + y * (1 / 2) * e
    e = 1 + y * e
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    return 1 - 2 / (e + 1)
