"""Loops over very many postures, compiled by Numba from the same `terms`.

Imported on first use: Numba takes half a second to load, and each loop a second or two to compile
the first time ever; the result stays in Numba's cache on disk.
"""

from __future__ import annotations

from math import cos, sin

from numba import njit

from backhoe.arm.dynamics import terms

_vectors = njit(terms.vectors)
_inertias = njit(terms.inertias)
_newton_euler = njit(terms.newton_euler)


@njit
def _vectors_at(arm, q):
    p2 = q[1] + arm.o2
    p3 = p2 + (q[2] + arm.o3)
    p4 = p3 + (q[3] + arm.o4)
    return _vectors(arm, cos(p2), sin(p2), cos(p3), sin(p3), cos(p4), sin(p4))


@njit(cache=True, nogil=True)
def mass_matrices(arm, q, M):
    """Fill M (n, 4, 4) for the postures q (n, 4)."""
    for i in range(len(q)):
        M11, M22, M23, M24, M33, M34, M44 = _inertias(arm, _vectors_at(arm, q[i]))
        M[i, 0, 0] = M11
        M[i, 0, 1] = M[i, 0, 2] = M[i, 0, 3] = 0.0
        M[i, 1, 0] = M[i, 2, 0] = M[i, 3, 0] = 0.0
        M[i, 1, 1] = M22
        M[i, 1, 2] = M[i, 2, 1] = M23
        M[i, 1, 3] = M[i, 3, 1] = M24
        M[i, 2, 2] = M33
        M[i, 2, 3] = M[i, 3, 2] = M34
        M[i, 3, 3] = M44


@njit(cache=True, nogil=True)
def inverse_dynamics(arm, q, dq, ddq, tau):
    """Fill tau (n, 4) for the motions q, dq, ddq (n, 4)."""
    for i in range(len(q)):
        v, w, a = _vectors_at(arm, q[i]), dq[i], ddq[i]
        tau[i] = _newton_euler(arm, v, w[0], w[1], w[2], w[3], a[0], a[1], a[2], a[3])
