"""The arithmetic of a filter's step for small matrices, compiled.

With so few numbers a call of NumPy costs more than the sums in it. `equations` says the same in
NumPy, and `lane_kernels` does it for many filters side by side.
"""

from __future__ import annotations

import numpy as np
from numba import njit

_compiled = njit(cache=True, nogil=True, error_model="numpy")


@_compiled
def propagate(x, F, P, Q, P_new):
    """P_new becomes F P F^T + Q, exactly symmetric, shape (n, n).

    Returns:
        Whether that and the state x, shape (n,), can be true.
    """
    _propagate(F, P, Q, np.empty(P.shape), P_new)
    return _possible(x, P_new)


@_compiled
def correct(x, P, y, H, R, x_new, P_new, S, K):
    """Update x (n,), P (n, n) with the innovation y (m,) of a sensor H (m, n), R (m, m).

    Args:
        x_new, P_new, S, K: filled in, shapes (n,), (n, n), (m, m), (n, m).

    Returns:
        The NIS, nan for an S that is not positive definite or numbers that are not finite.
    """
    return _correct(x, P, y, H, R, x_new, P_new, S, K, _work(H))


@_compiled
def root_all(P):
    """Lower triangular L with L L^T = P, shape (N, n, n); a variance of zero has a zero column.

    A negative pivot beyond rounding leaves nan.
    """
    L = np.zeros_like(P)
    n = P.shape[1]
    for k in range(len(P)):
        scale = 0.0
        for i in range(n):
            scale = max(scale, P[k, i, i])
        for j in range(n):
            pivot = P[k, j, j]
            for s in range(j):
                pivot -= L[k, j, s] ** 2
            if pivot < -1e-9 * scale:
                L[k, j, j] = np.nan
            elif pivot > 1e-15 * scale:
                L[k, j, j] = np.sqrt(pivot)
                for i in range(j + 1, n):
                    rest = P[k, i, j]
                    for s in range(j):
                        rest -= L[k, i, s] * L[k, j, s]
                    L[k, i, j] = rest / L[k, j, j]
    return L


@_compiled
def _possible(x, P):
    """Finite everywhere, no variance negative."""
    total = 0.0
    for i in range(len(x)):
        if P[i, i] < 0.0:
            return False
        total += x[i]
        for j in range(i + 1):
            total += P[i, j]
    return np.isfinite(total)


@_compiled
def _propagate(F, P, Q, FP, new):
    n = len(P)
    for i in range(n):
        for j in range(n):
            total = 0.0
            for s in range(n):
                total += F[i, s] * P[s, j]
            FP[i, j] = total
    for i in range(n):
        for j in range(i + 1):
            total = Q[i, j]
            for s in range(n):
                total += FP[i, s] * F[j, s]
            new[i, j] = total
            new[j, i] = total


@_compiled
def _work(H):
    m, n = H.shape
    return np.empty((m, n)), np.empty((m, m)), np.empty(m), np.empty((n, n)), np.empty((n, n))


@_compiled
def _correct(x, P, y, H, R, x_new, P_new, S, K, work):
    m, n = H.shape
    HP, L, w, A, AP = work
    for i in range(m):
        for j in range(n):
            total = 0.0
            for s in range(n):
                total += H[i, s] * P[s, j]
            HP[i, j] = total
    for i in range(m):
        for j in range(i + 1):
            total = R[i, j]
            for s in range(n):
                total += HP[i, s] * H[j, s]
            S[i, j] = total
            S[j, i] = total
    if not _cholesky(S, L):
        return np.nan
    for j in range(n):
        for i in range(m):
            w[i] = HP[i, j]
        _solve(L, w)
        for i in range(m):
            K[j, i] = w[i]
    for i in range(m):
        w[i] = y[i]
    _solve(L, w)
    nis = 0.0
    for i in range(m):
        nis += y[i] * w[i]
    for j in range(n):
        total = x[j]
        for i in range(m):
            total += K[j, i] * y[i]
        x_new[j] = total
    _joseph(P, K, H, R, A, AP, P_new)
    return nis


@_compiled
def _joseph(P, K, H, R, A, AP, P_new):
    m, n = H.shape
    for i in range(n):
        for j in range(n):
            total = 1.0 if i == j else 0.0
            for s in range(m):
                total -= K[i, s] * H[s, j]
            A[i, j] = total
    for i in range(n):
        for j in range(n):
            total = 0.0
            for s in range(n):
                total += A[i, s] * P[s, j]
            AP[i, j] = total
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for s in range(n):
                total += AP[i, s] * A[j, s]
            for s in range(m):
                for t in range(m):
                    total += K[i, s] * R[s, t] * K[j, t]
            P_new[i, j] = total
            P_new[j, i] = total


@_compiled
def _cholesky(S, L):
    m = len(S)
    for j in range(m):
        pivot = S[j, j]
        for s in range(j):
            pivot -= L[j, s] ** 2
        if not pivot > 0.0:
            return False
        L[j, j] = np.sqrt(pivot)
        for i in range(j + 1, m):
            rest = S[i, j]
            for s in range(j):
                rest -= L[i, s] * L[j, s]
            L[i, j] = rest / L[j, j]
    return True


@_compiled
def _solve(L, w):
    """w becomes (L L^T)^-1 w."""
    m = len(L)
    for i in range(m):
        for s in range(i):
            w[i] -= L[i, s] * w[s]
        w[i] /= L[i, i]
    for i in range(m - 1, -1, -1):
        for s in range(i + 1, m):
            w[i] -= L[s, i] * w[s]
        w[i] /= L[i, i]
