"""The arithmetic of a filter's step for N filters side by side, compiled; `equations` is plain.

Each element of a matrix is a row with one place for each filter: P has shape (n, n, N). A sum over
elements is then a few passes over rows, which makes vector instructions; one filter is N = 1, where
a call of NumPy would cost more than the sums in it.
"""

from __future__ import annotations

import numpy as np
from numba import njit

_compiled = njit(cache=True, nogil=True, error_model="numpy")


@_compiled
def propagate(F, P, Q, P_new):
    """P_new becomes F P F^T + Q, exactly symmetric; all of shape (n, n, N)."""
    FP = np.zeros(P.shape)
    _add_product(F, P, FP)
    P_new[:] = Q
    _add_symmetric(FP, F, P_new)


@_compiled
def correct(x, P, y, H, R, x_new, P_new, S, K, nis):
    """Update x (n, N), P (n, n, N) with the innovations y (m, N) of a sensor H (m, n, N).

    Args:
        R: shape (m, m, N).
        x_new, P_new, S, K, nis: filled in, shapes (n, N), (n, n, N), (m, m, N), (n, m, N), (N,);
            nis is nan or infinite for an S that is not positive definite.
    """
    m, n, N = H.shape
    HP_y = np.zeros((m, n + 1, N))
    _add_product(H, P, HP_y)
    S[:] = R
    _add_symmetric(HP_y, H, S)
    HP_y[:, n] = y
    _solve(root(S), HP_y)
    nis[:] = 0.0
    x_new[:] = x
    for i in range(m):
        for k in range(N):
            nis[k] += y[i, k] * HP_y[i, n, k]
        for j in range(n):
            for k in range(N):
                K[j, i, k] = HP_y[i, j, k]
                x_new[j, k] += HP_y[i, j, k] * y[i, k]
    _joseph(P, K, H, R, P_new)


@_compiled
def propagate_one(x, F, P, Q, P_new):
    """As `propagate` for one filter, x (n,), P (n, n): whether x and P_new can be true."""
    n = len(P)
    shape = (n, n, 1)
    propagate(F.reshape(shape), P.reshape(shape), Q.reshape(shape), P_new.reshape(shape))
    total = 0.0
    for i in range(n):
        if P_new[i, i] < 0.0:
            return False
        total += x[i] + P_new[i].sum()
    return np.isfinite(total)


@_compiled
def correct_one(x, P, y, H, R, x_new, P_new, S, K):
    """As `correct` for one filter, all without the last axis: the NIS."""
    m, n = H.shape
    nn, mm, nis = (n, n, 1), (m, m, 1), np.empty(1)
    correct(
        x.reshape((n, 1)),
        P.reshape(nn),
        y.reshape((m, 1)),
        H.reshape((m, n, 1)),
        R.reshape(mm),
        x_new.reshape((n, 1)),
        P_new.reshape(nn),
        S.reshape(mm),
        K.reshape((n, m, 1)),
        nis,
    )
    return nis[0]


@_compiled
def root(P):
    """Lower triangular L with L L^T = P, both of shape (n, n, N).

    A variance of zero has a zero column; a negative pivot beyond rounding leaves nan.
    """
    n, _, N = P.shape
    L = np.zeros(P.shape)
    for j in range(n):
        for i in range(j, n):
            for k in range(N):
                L[i, j, k] = P[i, j, k]
            for s in range(j):
                for k in range(N):
                    L[i, j, k] -= L[i, s, k] * L[j, s, k]
            for k in range(N):
                if i > j:
                    L[i, j, k] = L[i, j, k] / L[j, j, k] if L[j, j, k] > 0.0 else 0.0
                elif L[j, j, k] > 1e-15 * P[j, j, k]:
                    L[j, j, k] = np.sqrt(L[j, j, k])
                else:
                    L[j, j, k] = 0.0 if L[j, j, k] >= -1e-9 * _scale(P, k) else np.nan
    return L


@_compiled
def _scale(P, k):
    """Largest variance of filter k."""
    largest = 0.0
    for i in range(len(P)):
        largest = max(largest, P[i, i, k])
    return largest


@_compiled
def _joseph(P, K, H, R, P_new):
    A, AP, KR = np.zeros(P.shape), np.zeros(P.shape), np.zeros(K.shape)
    _add_product(K, H, A)
    for i in range(len(A)):
        for j in range(len(A)):
            for k in range(A.shape[2]):
                A[i, j, k] = (1.0 if i == j else 0.0) - A[i, j, k]
    _add_product(A, P, AP)
    _add_product(K, R, KR)
    P_new[:] = 0.0
    _add_symmetric(AP, A, P_new)
    _add_symmetric(KR, K, P_new)


@_compiled
def _solve(L, w):
    """w, shape (m, c, N), becomes (L L^T)^-1 w."""
    m, columns, N = w.shape
    for c in range(columns):
        for i in range(m):
            for s in range(i):
                for k in range(N):
                    w[i, c, k] -= L[i, s, k] * w[s, c, k]
            for k in range(N):
                w[i, c, k] /= L[i, i, k]
        for i in range(m - 1, -1, -1):
            for s in range(i + 1, m):
                for k in range(N):
                    w[i, c, k] -= L[s, i, k] * w[s, c, k]
            for k in range(N):
                w[i, c, k] /= L[i, i, k]


@_compiled
def _add_product(A, B, C):
    """C += A B."""
    for i in range(A.shape[0]):
        for j in range(B.shape[1]):
            for s in range(A.shape[1]):
                for k in range(C.shape[2]):
                    C[i, j, k] += A[i, s, k] * B[s, j, k]


@_compiled
def _add_symmetric(A, B, C):
    """C += A B^T, known to be symmetric: one half is computed; A may have more columns."""
    for i in range(A.shape[0]):
        for j in range(i + 1):
            for s in range(B.shape[1]):
                for k in range(C.shape[2]):
                    C[i, j, k] += A[i, s, k] * B[j, s, k]
            for k in range(C.shape[2]):
                C[j, i, k] = C[i, j, k]
