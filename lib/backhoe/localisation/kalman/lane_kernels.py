"""The arithmetic of `kernels` for N filters side by side, compiled into vector instructions.

Each element of a matrix is a row with one place for each filter: P has shape (n, n, N). A sum over
elements is then a few passes over rows, which is several times as fast as one filter after the
other.
"""

from __future__ import annotations

import numpy as np
from numba import njit

_compiled = njit(cache=True, nogil=True, error_model="numpy")


@_compiled
def propagate(F, P, Q, P_new):
    """P_new becomes F P F^T + Q, exactly symmetric; all of shape (n, n, N)."""
    n = len(P)
    FP = np.zeros(P.shape)
    _multiply(F, P, FP)
    for i in range(n):
        for j in range(i + 1):
            P_new[i, j] = Q[i, j]
            for s in range(n):
                _add(P_new[i, j], FP[i, s], F[j, s])
            P_new[j, i] = P_new[i, j]


@_compiled
def correct(x, P, y, H, R, x_new, P_new, S, K, nis):
    """Update x (n, N), P (n, n, N) with the innovations y (m, N) of a sensor H (m, n, N).

    Args:
        R: shape (m, m, N).
        x_new, P_new, S, K, nis: filled in, shapes (n, N), (n, n, N), (m, m, N), (n, m, N), (N,);
            nis is nan for an S that is not positive definite.
    """
    m, n = H.shape[:2]
    HP = np.zeros(H.shape)
    _multiply(H, P, HP)
    for i in range(m):
        for j in range(i + 1):
            S[i, j] = R[i, j]
            for s in range(n):
                _add(S[i, j], HP[i, s], H[j, s])
            S[j, i] = S[i, j]
    L = _cholesky(S)
    for j in range(n):
        for i in range(m):
            K[j, i] = HP[i, j]
        _solve(L, K[j])
    w = y.copy()
    _solve(L, w)
    nis[:] = 0.0
    for i in range(m):
        _add(nis, y[i], w[i])
    for j in range(n):
        x_new[j] = x[j]
        for i in range(m):
            _add(x_new[j], K[j, i], y[i])
    _joseph(P, K, H, R, P_new)


@_compiled
def _joseph(P, K, H, R, P_new):
    m, n = H.shape[:2]
    A, AP, KR = np.zeros(P.shape), np.zeros(P.shape), np.zeros(K.shape)
    for i in range(n):
        A[i, i] = 1.0
        for j in range(n):
            for s in range(m):
                _subtract(A[i, j], K[i, s], H[s, j])
    _multiply(A, P, AP)
    _multiply(K, R, KR)
    P_new[:] = 0.0
    for i in range(n):
        for j in range(i + 1):
            for s in range(n):
                _add(P_new[i, j], AP[i, s], A[j, s])
            for s in range(m):
                _add(P_new[i, j], KR[i, s], K[j, s])
            P_new[j, i] = P_new[i, j]


@_compiled
def _cholesky(S):
    m = len(S)
    L = np.zeros(S.shape)
    for j in range(m):
        L[j, j] = S[j, j]
        for s in range(j):
            _subtract(L[j, j], L[j, s], L[j, s])
        L[j, j] = np.sqrt(L[j, j])
        for i in range(j + 1, m):
            L[i, j] = S[i, j]
            for s in range(j):
                _subtract(L[i, j], L[i, s], L[j, s])
            L[i, j] /= L[j, j]
    return L


@_compiled
def _solve(L, w):
    """w, shape (m, N), becomes (L L^T)^-1 w."""
    m = len(L)
    for i in range(m):
        for s in range(i):
            _subtract(w[i], L[i, s], w[s])
        w[i] /= L[i, i]
    for i in range(m - 1, -1, -1):
        for s in range(i + 1, m):
            _subtract(w[i], L[s, i], w[s])
        w[i] /= L[i, i]


@_compiled
def _multiply(A, B, AB):
    for i in range(AB.shape[0]):
        for j in range(AB.shape[1]):
            for s in range(len(B)):
                _add(AB[i, j], A[i, s], B[s, j])


@_compiled
def _add(total, a, b):
    for k in range(len(total)):
        total[k] += a[k] * b[k]


@_compiled
def _subtract(total, a, b):
    for k in range(len(total)):
        total[k] -= a[k] * b[k]
