"""The update of a Kalman filter, equation by equation, in NumPy.

Source: Mastalli 2013, eqs. (4.15)-(4.21). The filters compute the same in `engine`; a test holds
them together.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import residual
from backhoe.basics.inputs import numbers, positive, real_numbers, whole


def gain(P: ArrayLike, H: ArrayLike, R: ArrayLike) -> NDArray:
    """K = P H^T (H P H^T + R)^-1.

    Source: Mastalli 2013, eq. (4.17).

    Args:
        P: covariance of the prediction, shape (..., n, n) [products of x's own units].
        H: shape (..., m, n) [z's units a unit of x].
        R: covariance of the measurement's noise, shape (..., m, m) [products of z's own units].

    Returns:
        K, shape (..., n, m) [x's units a unit of z].

    Raises:
        ValueError: not numbers, or shapes that do not fit.
        numpy.linalg.LinAlgError: H P H^T + R is singular.
    """
    P, H, R = _matrices(P=P, H=H, R=R)
    HP = H @ P
    return _transposed(np.linalg.solve(HP @ _transposed(H) + R, HP))


def joseph(P: ArrayLike, K: ArrayLike, H: ArrayLike, R: ArrayLike) -> NDArray:
    """(I - K H) P (I - K H)^T + K R K^T: the covariance of the error after x + K y, for any K.

    Source: Mastalli 2013, eq. (4.19), second line.

    Args:
        P, H, R: as for `gain`, shapes (..., n, n), (..., m, n), (..., m, m).
        K: any gain, shape (..., n, m).

    Returns:
        Shape (..., n, n), symmetric.

    Raises:
        ValueError: not numbers, or shapes that do not fit.
    """
    P, K, H, R = _matrices(P=P, K=K, H=H, R=R)
    A = np.eye(P.shape[-1]) - K @ H
    return A @ P @ _transposed(A) + K @ R @ _transposed(K)


def short_form(P: ArrayLike, K: ArrayLike, H: ArrayLike) -> NDArray:
    """(I - K H) P, which is the same only for the gain of (4.17).

    Source: Mastalli 2013, eq. (4.19), last line. Arguments, result and errors as for `joseph`.
    """
    P, K, H = _matrices(P=P, K=K, H=H)
    return (np.eye(P.shape[-1]) - K @ H) @ P


def update(
    x: ArrayLike, P: ArrayLike, z: ArrayLike, H: ArrayLike, R: ArrayLike
) -> tuple[NDArray, NDArray]:
    """State and covariance after a measurement, whose innovation is z - H x.

    Source: Mastalli 2013, eqs. (4.16), (4.17) and (4.19).

    Args:
        x: prediction, shape (n,) [its own units].
        P, H, R: as for `gain`, shapes (n, n), (m, n), (m, m).
        z: measurement, shape (m,) [its own units].

    Returns:
        x, shape (n,), and its covariance, shape (n, n).

    Raises:
        ValueError: not numbers, or shapes that do not fit.
        numpy.linalg.LinAlgError: H P H^T + R is singular.
    """
    K = gain(P, H, R)
    x, z = numbers(x, "x", K.shape[:1]), numbers(z, "z", K.shape[1:])
    return x + K @ (z - np.asarray(H) @ x), joseph(P, K, H, R)


def information_update(
    x: ArrayLike, P: ArrayLike, z: ArrayLike, H: ArrayLike, R: ArrayLike
) -> tuple[NDArray, NDArray]:
    """The state of greatest probability given prediction and measurement, by information.

    Source: Mastalli 2013, eq. (4.15): (H^T R^-1 H + P^-1)^-1 (P^-1 x + H^T R^-1 z). Arguments,
    results and errors as for `update`; P and R must both have an inverse.
    """
    P, H, R = _matrices(P=P, H=H, R=R)
    x, z = numbers(x, "x", P.shape[:1]), numbers(z, "z", R.shape[:1])
    weighted = H.T @ np.linalg.inv(R)
    known = np.linalg.inv(P)
    covariance = np.linalg.inv(weighted @ H + known)
    return covariance @ (known @ x + weighted @ z), covariance


def transition(A: ArrayLike, dt: float, order: int | None = 1) -> NDArray:
    """F = I + A dt + (A dt)^2 / 2 + ..., the step that belongs to the rate A.

    Source: Mastalli 2013, eqs. (4.20) and (4.21), which take A itself for F.

    Args:
        A: df/dx of a rate f, shape (n, n) [units of x a unit of x and second].
        dt: positive [s].
        order: of the last term; None for the whole series, exp(A dt).

    Returns:
        Shape (n, n).

    Raises:
        ValueError: A is not square or not finite, dt not positive, order not 1 or more.
    """
    A, dt = numbers(A, "A", ("n", "n")), positive(dt, "dt", "s")
    numbers(A, "A", 2 * A.shape[:1])
    if order is None:
        from scipy.linalg import expm

        return expm(A * dt)
    F = term = np.eye(len(A))
    for k in range(1, whole(order, "order", least=1) + 1):
        term = term @ A * (dt / k)
        F = F + term
    return F


def numerical_jacobian(
    function: Callable[[NDArray], ArrayLike], x: ArrayLike, angles: Sequence[int] = ()
) -> NDArray:
    """Derivative of function(x) by central differences, to about 1e-9 of its scale.

    Args:
        function: takes shape (..., n), returns shape (..., m), each in its own units.
        x: where, shape (..., n).
        angles: components of function(x) that are angles, which may jump by a turn [rad].

    Returns:
        Shape (..., m, n): row i is the gradient of component i.

    Raises:
        ValueError: x is not a vector of numbers, or function returns no vector.
    """
    x = numbers(x, "x", (..., "n"))
    columns = []
    for i in range(x.shape[-1]):
        step = np.zeros_like(x)
        step[..., i] = 6e-6 * np.maximum(1.0, np.abs(x[..., i]))
        ahead, behind = x + step, x - step
        rise = residual(np.atleast_1d(function(ahead)), np.atleast_1d(function(behind)), angles)
        if rise.shape[:-1] != x.shape[:-1]:
            raise ValueError(f"function must return (..., m) for {x.shape}, got {rise.shape}")
        columns.append(rise / (ahead - behind)[..., i, None])
    return np.stack(columns, axis=-1)


def _matrices(**named: ArrayLike) -> list[NDArray]:
    found = {name: real_numbers(value, name) for name, value in named.items()}
    n, m = found["P"].shape[-1:], found["H"].shape[-2:-1]
    wanted = {"P": n + n, "H": m + n, "K": n + m, "R": m + m}
    for name, matrix in found.items():
        if matrix.ndim < 2 or matrix.shape[-2:] != wanted[name]:
            raise ValueError(
                f"P, H, K and R must be (n, n), (m, n), (n, m) and (m, m); {name} has shape "
                f"{matrix.shape}, where P and H ask for {wanted[name]}"
            )
    return list(found.values())


def _transposed(matrix: NDArray) -> NDArray:
    return np.swapaxes(matrix, -1, -2)
