"""The arm between two samples, for the runs of a block side by side, compiled.

Each loop over the lanes becomes vector instructions: five times as fast as one run after the other.
It takes all rows in one flat array, constant distances between them, lanes counted from 0, and
functions that are inlined. Runs do not touch each other: their numbers are the same in any company.

The equation of motion is `dynamics.terms`, the choice of steps that of `plain`, both compiled in.
"""

from __future__ import annotations

from math import cos, sin

from numba import njit

from backhoe.arm.closed_loop import plain
from backhoe.arm.closed_loop.rows import (
    A_FIRST,
    A_KEPT,
    ABREAST,
    LANE,
    LANES,
    NET,
    PAYLOAD,
    Q_KEPT,
    ROWS,
    SHIFT,
    STEPS,
    SUM_A,
    SUM_V,
    TAU,
    TURNS,
    W_KEPT,
    A,
    H,
    Q,
    V,
    W,
)
from backhoe.arm.closed_loop.task import COULOMB_SMOOTHING
from backhoe.arm.dynamics import terms
from backhoe.arm.dynamics.terms import Arm

call = njit(error_model="numpy")
inline = njit(error_model="numpy", forceinline=True)

vectors = inline(terms.vectors)
newton_euler = inline(terms.newton_euler)
gravity_torques = inline(terms.gravity_torques)
_inertias = inline(terms.inertias)
_solve = inline(terms.solve_inertias)
_steps = inline(plain.steps)


@call
def advance(S, T, arm, friction, reference, settling, dt, lanes, wide):
    """One sample with the torque held, in more steps where Coulomb friction bends.

    All take the steps that suit the reference, then those that need more start again in T.
    """
    common = _steps(reference[1], reference[2], plain.NO_FRICTION, settling, dt)
    copy_rows(S, Q, Q_KEPT, 8, wide)
    for j in range(wide):
        S[H * LANES + j] = dt / common
    for part in range(common):
        _rk4(S, arm, friction, wide)
        if part == 0:
            copy_rows(S, A_FIRST, A_KEPT, 4, wide)
    again, most = 0, 0
    for j in range(lanes):
        steps = _steps(four(S, W_KEPT, j), four(S, A_KEPT, j), friction[1], settling, dt)
        if steps > common:
            for row in range(ROWS):
                T[row * LANES + again] = S[row * LANES + j]
            T[STEPS * LANES + again] = steps
            T[LANE * LANES + again] = j
            again, most = again + 1, max(most, steps)
    if again == 0:
        return
    wide = min(-(-again // ABREAST) * ABREAST, LANES)
    copy_rows(T, Q_KEPT, Q, 8, wide)
    compute_turns(T, arm, wide)
    for part in range(most):
        for j in range(wide):
            steps = T[STEPS * LANES + j]
            T[H * LANES + j] = dt / steps if part < steps else 0.0
        _rk4(T, arm, friction, wide)
    compute_turns(T, arm, wide)
    for j in range(again):
        for row in range(TURNS + 6):
            S[row * LANES + int(T[LANE * LANES + j])] = T[row * LANES + j]


@inline
def four(S, row, j):
    return (
        S[row * LANES + j],
        S[(row + 1) * LANES + j],
        S[(row + 2) * LANES + j],
        S[(row + 3) * LANES + j],
    )


@call
def _rk4(S, arm, friction, lanes):
    """The classical Runge-Kutta step with the torque held, as long as each run's row says."""
    smoothing = 1.0 / COULOMB_SMOOTHING
    for row in range(4):
        for j in range(lanes):
            S[(A + row) * LANES + j] = S[(V + row) * LANES + j] = 0.0
            S[(SUM_A + row) * LANES + j] = S[(SUM_V + row) * LANES + j] = 0.0
    for stage in range(4):
        ahead = 0.0 if stage == 0 else 1.0 if stage == 3 else 1 / 2
        weight = 1 / 6 if stage in (0, 3) else 1 / 3
        for k in range(4):
            viscous, coulomb = friction[0, k], friction[1, k]
            for j in range(lanes):
                h = S[H * LANES + j]
                c, b = ahead * h, weight * h
                S[(SHIFT + k) * LANES + j] = c * S[(V + k) * LANES + j]
                w = S[(W + k) * LANES + j] + c * S[(A + k) * LANES + j]
                S[(V + k) * LANES + j] = w
                S[(SUM_V + k) * LANES + j] += b * w
                taken = viscous * w + coulomb * _tanh(smoothing * w)
                S[(NET + k) * LANES + j] = S[(TAU + k) * LANES + j] - taken
        for j in range(lanes):
            d2 = S[(SHIFT + 1) * LANES + j]
            d3 = d2 + S[(SHIFT + 2) * LANES + j]
            d4 = d3 + S[(SHIFT + 3) * LANES + j]
            c2, s2 = _turned(S[(TURNS + 0) * LANES + j], S[(TURNS + 1) * LANES + j], d2)
            c3, s3 = _turned(S[(TURNS + 2) * LANES + j], S[(TURNS + 3) * LANES + j], d3)
            c4, s4 = _turned(S[(TURNS + 4) * LANES + j], S[(TURNS + 5) * LANES + j], d4)
            loaded = _loaded(arm, S[PAYLOAD * LANES + j])
            v = vectors(loaded, c2, s2, c3, s3, c4, s4)
            bias = newton_euler(loaded, v, *four(S, V, j), 0.0, 0.0, 0.0, 0.0)
            a1, a2, a3, a4 = _solve(
                _inertias(loaded, v),
                S[(NET + 0) * LANES + j] - bias[0],
                S[(NET + 1) * LANES + j] - bias[1],
                S[(NET + 2) * LANES + j] - bias[2],
                S[(NET + 3) * LANES + j] - bias[3],
            )
            S[(A + 0) * LANES + j] = a1
            S[(A + 1) * LANES + j] = a2
            S[(A + 2) * LANES + j] = a3
            S[(A + 3) * LANES + j] = a4
        for k in range(4):
            for j in range(lanes):
                b = weight * S[H * LANES + j]
                S[(SUM_A + k) * LANES + j] += b * S[(A + k) * LANES + j]
        if stage == 0:
            copy_rows(S, A, A_FIRST, 4, lanes)
    for row in range(4):
        for j in range(lanes):
            S[(Q + row) * LANES + j] += S[(SUM_V + row) * LANES + j]
            S[(W + row) * LANES + j] += S[(SUM_A + row) * LANES + j]
    for link in range(3):
        for j in range(lanes):
            d = S[(SUM_V + 1) * LANES + j]
            d = d + S[(SUM_V + 2) * LANES + j] if link > 0 else d
            d = d + S[(SUM_V + 3) * LANES + j] if link > 1 else d
            c, s = S[(TURNS + 2 * link) * LANES + j], S[(TURNS + 2 * link + 1) * LANES + j]
            c, s = _turned(c, s, d)
            S[(TURNS + 2 * link) * LANES + j] = c
            S[(TURNS + 2 * link + 1) * LANES + j] = s


@call
def compute_turns(S, arm, lanes):
    for j in range(lanes):
        p2 = S[(Q + 1) * LANES + j] + arm.o2
        p3 = p2 + (S[(Q + 2) * LANES + j] + arm.o3)
        p4 = p3 + (S[(Q + 3) * LANES + j] + arm.o4)
        S[(TURNS + 0) * LANES + j], S[(TURNS + 1) * LANES + j] = cos(p2), sin(p2)
        S[(TURNS + 2) * LANES + j], S[(TURNS + 3) * LANES + j] = cos(p3), sin(p3)
        S[(TURNS + 4) * LANES + j], S[(TURNS + 5) * LANES + j] = cos(p4), sin(p4)


@inline
def copy_rows(S, source, target, rows, lanes):
    for row in range(rows):
        for j in range(lanes):
            S[(target + row) * LANES + j] = S[(source + row) * LANES + j]


@inline
def _loaded(arm, load):
    """The arm with a point mass at the bucket's centre of mass, as `variants.loaded`."""
    return Arm(*arm[:-1], arm.m_bu + load)


@inline
def _turned(c, s, d):
    """Cosine and sine of an angle that is larger by a small d: its series, exact in doubles."""
    dd = d * d
    cosine = 1 - dd * (1 / 2) * (1 - dd * (1 / 12) * (1 - dd * (1 / 30) * (1 - dd * (1 / 56))))
    sine = 1 - dd * (1 / 6) * (1 - dd * (1 / 20) * (1 - dd * (1 / 42) * (1 - dd * (1 / 72))))
    sine = d * sine
    return c * cosine - s * sine, s * cosine + c * sine


@inline
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
