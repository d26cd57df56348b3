"""Closed loops of the arm side by side, compiled: the sampled law, and what is measured of it.

`plain` is the same law for one run, to be read; `step_engine` moves the arm from one sample to the
next and says why the loops look as they do.
"""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numba import njit

from backhoe.arm.closed_loop.rows import (
    ABREAST,
    INTEGRAL,
    KD,
    KI,
    KP,
    LANES,
    LAST,
    PAYLOAD,
    Q_SEEN,
    RATE,
    ROWS,
    TAU,
    W_SEEN,
    WANTED,
    Q,
    W,
)
from backhoe.arm.closed_loop.step_engine import (
    advance,
    call,
    compute_turns,
    copy_rows,
    four,
    gravity_torques,
    inline,
    newton_euler,
    vectors,
)

PID, PID_GRAVITY, COMPUTED_TORQUE = range(3)
"""The laws of `run`."""

ERRORS, PEAK_ERRORS, LAST_ERRORS, PEAK_TORQUES, EFFORTS, SATURATED, OVERRUNS = range(7)
"""Rows, times four joints, of the measures that `run` fills in."""

_REFRESH = 16
"""Samples after which cosines and sines are computed anew instead of turned on."""


@njit(cache=True, nogil=True, error_model="numpy")
def run(loop, runs, log, measures):
    """Follow a reference with some runs at once.

    Args:
        loop: the `Loop` that all runs share.
        runs: kp, ki, kd, q, dq, integral of the error of each run at the start, and its payload in
            the first place of the last row, shape (n, 7, 4), n at most `LANES`.
        log: the `Log` of what is recorded.
        measures: filled in, shape (n, 7, 4).

    Returns:
        Samples that each run took: m, or fewer if it diverged, shape (n,).
    """
    arm, model, law, friction, limit, lower, upper, reference, settling, sampling = loop
    dt, hold, measured, filter_time, largest_error, largest_speed = sampling
    samples = reference.shape[1]
    lanes = len(runs)
    S, T = np.zeros(ROWS * LANES), np.zeros(ROWS * LANES)
    M = np.zeros(28 * LANES)
    run_of = np.arange(lanes)
    taken = np.full(lanes, samples)
    _begin(S, runs)
    for i in range(samples):
        wide = min(-(-lanes // ABREAST) * ABREAST, LANES)
        if i % _REFRESH == 0:
            compute_turns(S, arm, wide)
        if i % hold == 0:
            copy_rows(S, Q, Q_SEEN, 8, wide)
        _feed_back(S, reference[:, i], measured, filter_time, dt, i, wide)
        if law != PID:
            _add_model(S, model, law, reference[2, i], lanes)
        _saturate(S, limit, dt, wide)
        _measure(S, M, reference[0, i], lower, upper, i < samples - 1, wide)
        if i % log.every == 0:
            _write(S, log, run_of, i // log.every, lanes)
        if _all_fine(S, reference[0, i], largest_error, largest_speed, lanes) < lanes:
            for j in range(lanes - 1, -1, -1):
                if not _fine(S, reference[0, i], largest_error, largest_speed, j):
                    taken[run_of[j]] = i
                    lanes = _drop(S, M, run_of, measures, j, lanes)
        if lanes == 0:
            break
        if i < samples - 1:
            advance(S, T, arm, friction, reference[:, i], settling[i], dt, lanes, wide)
    for j in range(lanes - 1, -1, -1):
        _drop(S, M, run_of, measures, j, j + 1)
    return taken


@call
def _begin(S, runs):
    for j in range(len(runs)):
        for k in range(4):
            S[(KP + k) * LANES + j] = runs[j, 0, k]
            S[(KI + k) * LANES + j] = runs[j, 1, k]
            S[(KD + k) * LANES + j] = runs[j, 2, k]
            S[(Q + k) * LANES + j] = runs[j, 3, k]
            S[(W + k) * LANES + j] = runs[j, 4, k]
            S[(INTEGRAL + k) * LANES + j] = runs[j, 5, k]
        S[PAYLOAD * LANES + j] = runs[j, 6, 0]


@call
def _drop(S, M, run_of, measures, j, lanes):
    """Take the measures of a run that ends, and let the last lane have its place."""
    for row in range(28):
        measures[run_of[j], row // 4, row % 4] = M[row * LANES + j]
        M[row * LANES + j] = M[row * LANES + lanes - 1]
    for row in range(ROWS):
        S[row * LANES + j] = S[row * LANES + lanes - 1]
    run_of[j] = run_of[lanes - 1]
    return lanes - 1


@call
def _feed_back(S, reference, measured, filter_time, dt, i, lanes):
    """What the PID wants, before its model and the limit."""
    for k in range(4):
        q_ref, w_ref = reference[0, k], reference[1, k]
        for j in range(lanes):
            error = q_ref - S[(Q_SEEN + k) * LANES + j]
            if measured:
                rate = w_ref - S[(W_SEEN + k) * LANES + j]
            else:
                change = error - S[(LAST + k) * LANES + j]
                rate = (filter_time * S[(RATE + k) * LANES + j] + change) / (filter_time + dt)
                rate = rate if i > 0 else 0.0
            S[(RATE + k) * LANES + j] = rate
            S[(LAST + k) * LANES + j] = error
            total = S[(INTEGRAL + k) * LANES + j] + error * dt
            wanted = S[(KP + k) * LANES + j] * error + S[(KI + k) * LANES + j] * total
            S[(WANTED + k) * LANES + j] = wanted + S[(KD + k) * LANES + j] * rate


@call
def _add_model(S, model, law, ddq_ref, lanes):
    """What the law takes from its model of the arm, added to or made of the PID's output."""
    for j in range(lanes):
        p2 = S[(Q_SEEN + 1) * LANES + j] + model.o2
        p3 = p2 + (S[(Q_SEEN + 2) * LANES + j] + model.o3)
        p4 = p3 + (S[(Q_SEEN + 3) * LANES + j] + model.o4)
        v = vectors(model, cos(p2), sin(p2), cos(p3), sin(p3), cos(p4), sin(p4))
        if law == PID_GRAVITY:
            g2, g3, g4 = gravity_torques(model, v)
            S[(WANTED + 1) * LANES + j] += g2
            S[(WANTED + 2) * LANES + j] += g3
            S[(WANTED + 3) * LANES + j] += g4
        else:
            tau = newton_euler(
                model,
                v,
                *four(S, W_SEEN, j),
                ddq_ref[0] + S[(WANTED + 0) * LANES + j],
                ddq_ref[1] + S[(WANTED + 1) * LANES + j],
                ddq_ref[2] + S[(WANTED + 2) * LANES + j],
                ddq_ref[3] + S[(WANTED + 3) * LANES + j],
            )
            for k in range(4):
                S[(WANTED + k) * LANES + j] = tau[k]


@call
def _saturate(S, limits, dt, lanes):
    """The torque within its limit; the integral goes on unless that pushes further out."""
    for k in range(4):
        limit = limits[k]
        for j in range(lanes):
            wanted, error = S[(WANTED + k) * LANES + j], S[(LAST + k) * LANES + j]
            torque = min(max(wanted, -limit), limit)
            goes_on = (torque == wanted) | (wanted * error <= 0)
            old = S[(INTEGRAL + k) * LANES + j]
            S[(INTEGRAL + k) * LANES + j] = old + error * dt if goes_on else old
            S[(TAU + k) * LANES + j] = torque


@call
def _measure(S, M, q_ref, lower, upper, applied, lanes):
    weight = 1.0 if applied else 0.0
    for k in range(4):
        least, most, reference = lower[k], upper[k], q_ref[k]
        for j in range(lanes):
            q, torque = S[(Q + k) * LANES + j], S[(TAU + k) * LANES + j]
            error = reference - q
            outside = max(least - q, q - most)
            limited = weight if torque != S[(WANTED + k) * LANES + j] else 0.0
            M[(4 * ERRORS + k) * LANES + j] += error * error
            M[(4 * PEAK_ERRORS + k) * LANES + j] = max(
                M[(4 * PEAK_ERRORS + k) * LANES + j], abs(error)
            )
            M[(4 * LAST_ERRORS + k) * LANES + j] = error
            M[(4 * PEAK_TORQUES + k) * LANES + j] = max(
                M[(4 * PEAK_TORQUES + k) * LANES + j], abs(torque)
            )
            M[(4 * EFFORTS + k) * LANES + j] += weight * (torque * torque)
            M[(4 * SATURATED + k) * LANES + j] += limited
            M[(4 * OVERRUNS + k) * LANES + j] = max(M[(4 * OVERRUNS + k) * LANES + j], outside)


@call
def _write(S, log, run_of, row, lanes):
    for j in range(lanes):
        of = log.of[run_of[j]]
        if of >= 0:
            for k in range(4):
                log.rows[of, row, 0, k] = S[(Q + k) * LANES + j]
                log.rows[of, row, 1, k] = S[(W + k) * LANES + j]
                log.rows[of, row, 2, k] = S[(TAU + k) * LANES + j]


@inline
def _fine(S, q_ref, largest_error, largest_speed, j):
    """False also where a number is no longer finite: every comparison with NaN is false."""
    fine = True
    for k in range(4):
        fine &= abs(q_ref[k] - S[(Q + k) * LANES + j]) < largest_error
        fine &= abs(S[(W + k) * LANES + j]) < largest_speed
        fine &= abs(S[(TAU + k) * LANES + j]) < np.inf
    return fine


@call
def _all_fine(S, q_ref, largest_error, largest_speed, lanes):
    count = 0
    for j in range(lanes):
        count += _fine(S, q_ref, largest_error, largest_speed, j)
    return count
