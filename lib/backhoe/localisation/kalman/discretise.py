"""From a continuous system to the step that a filter in samples needs.

    dx/dt = A x + G w,  w white of intensity Q_c   ->   x_k = F x_{k-1} + d,  d ~ N(0, Q)

Sources: Mastalli 2013, eqs. (4.20)-(4.21), which take A itself for F; Van Loan 1978 for Q.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array
from backhoe.localisation.kalman.arguments import covariance, duration, finite


def transition(A: ArrayLike, dt: float, order: int | None = 1) -> NDArray:
    """F = I + A dt + (A dt)^2 / 2 + ..., the step that belongs to the rate A.

    Args:
        A: df/dx of a rate f, shape (n, n) [1/s].
        dt: positive [s].
        order: of the last term; None for the whole series, exp(A dt).

    Returns:
        Shape (n, n).

    Raises:
        ValueError: A is not square or not finite, dt not positive, order not 1 or more.
    """
    A, dt = _square(A), duration(dt)
    if order is None:
        from scipy.linalg import expm

        return expm(A * dt)
    if isinstance(order, bool) or not isinstance(order, int | np.integer) or order < 1:
        raise ValueError(f"order must be an integer of at least 1, or None, got {order!r}")
    F = term = np.eye(len(A))
    for k in range(1, order + 1):
        term = term @ A * (dt / k)
        F = F + term
    return F


def discrete_noise(A: ArrayLike, G: ArrayLike, Qc: ArrayLike, dt: float) -> tuple[NDArray, NDArray]:
    """F and Q of one step under white noise, by Van Loan's one matrix exponential.

    Args:
        A: shape (n, n) [1/s].
        G: how the noise enters, shape (n, k).
        Qc: intensity of the noise, shape (k, k) [unit of w squared, times s].
        dt: positive [s].

    Returns:
        F = exp(A dt) and Q = integral of exp(A s) G Qc G^T exp(A s)^T over 0 ... dt, (n, n) each.

    Raises:
        ValueError: shapes that do not fit, numbers not finite, Qc no covariance, dt not positive.
    """
    from scipy.linalg import expm

    A, dt = _square(A), duration(dt)
    G = real_array(G, "G must be numbers")
    n = len(A)
    if G.ndim != 2 or len(G) != n:
        raise ValueError(f"G must have shape ({n}, k), got shape {G.shape}")
    Qc = covariance(Qc, G.shape[1], "Qc")
    blocks = np.block([[-A, G @ Qc @ G.T], [np.zeros((n, n)), A.T]]) * dt
    series = expm(blocks)
    F = series[n:, n:].T
    Q = F @ series[:n, n:]
    return F, (Q + Q.T) / 2


def _square(A: ArrayLike) -> NDArray:
    A = real_array(A, "A must be numbers")
    if A.ndim != 2 or A.shape[0] != A.shape[1] or A.size == 0:
        raise ValueError(f"A must be square, shape (n, n), got shape {A.shape}")
    return finite(A, A.shape, "A")
