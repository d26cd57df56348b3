"""The update of a Kalman filter, equation by equation, in NumPy.

Source: Mastalli 2013, eqs. (4.15)-(4.19). The filters compute the same in `kernels`; a test holds
them together.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import residual
from backhoe.basics.inputs import numbers, real_array


def gain(P: ArrayLike, H: ArrayLike, R: ArrayLike) -> NDArray:
    """K = P H^T (H P H^T + R)^-1.

    Source: Mastalli 2013, eq. (4.17).

    Args:
        P: covariance of the prediction, shape (..., n, n).
        H: shape (..., m, n).
        R: covariance of the measurement's noise, shape (..., m, m).

    Returns:
        K, shape (..., n, m).

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
        P: shape (..., n, n).
        K: any gain, shape (..., n, m).
        H, R: shape (..., m, n), (..., m, m).

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

    Source: Mastalli 2013, eq. (4.19), last line.

    Args:
        P: shape (..., n, n).
        K: shape (..., n, m).
        H: shape (..., m, n).

    Returns:
        Shape (..., n, n).

    Raises:
        ValueError: not numbers, or shapes that do not fit.
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
        P: its covariance, shape (n, n) [products of those units].
        z: measurement, shape (m,) [its own units].
        H, R: shape (m, n), (m, m) [z's units a unit of x, products of z's units].

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

    Source: Mastalli 2013, eq. (4.15): (H^T R^-1 H + P^-1)^-1 (P^-1 x + H^T R^-1 z).

    Args:
        x: prediction, shape (n,).
        P: its covariance, positive definite, shape (n, n).
        z: measurement, shape (m,).
        H, R: shape (m, n), (m, m).

    Returns:
        x, shape (n,), and its covariance (H^T R^-1 H + P^-1)^-1, shape (n, n).

    Raises:
        ValueError: not numbers, or shapes that do not fit.
        numpy.linalg.LinAlgError: P or R is singular.
    """
    P, H, R = _matrices(P=P, H=H, R=R)
    x, z = real_array(x, "x must be numbers"), real_array(z, "z must be numbers")
    weighted = H.T @ np.linalg.inv(R)
    known = np.linalg.inv(P)
    covariance = np.linalg.inv(weighted @ H + known)
    return covariance @ (known @ x + weighted @ z), covariance


def numerical_jacobian(
    function: Callable[[NDArray], ArrayLike], x: ArrayLike, angles: Sequence[int] = ()
) -> NDArray:
    """Derivative of function(x) by central differences, to about 1e-9 of its scale.

    Args:
        function: takes shape (n,), returns shape (m,).
        x: where, shape (n,).
        angles: components of function(x) that are angles, which may jump by a turn.

    Returns:
        Shape (m, n): row i is the gradient of component i.

    Raises:
        ValueError: x is not a vector of numbers, or function returns no vector.
    """
    x = real_array(x, "x must be numbers")
    if x.ndim != 1:
        raise ValueError(f"x must be one point, shape (n,), got shape {x.shape}")
    columns = []
    for i, step in enumerate(6e-6 * np.maximum(1.0, np.abs(x))):
        ahead, behind = x.copy(), x.copy()
        ahead[i], behind[i] = x[i] + step, x[i] - step
        rise = residual(np.atleast_1d(function(ahead)), np.atleast_1d(function(behind)), angles)
        if rise.ndim != 1:
            raise ValueError(f"function must return a vector, got shape {rise.shape}")
        columns.append(rise / (ahead[i] - behind[i]))
    return np.stack(columns, axis=-1)


def _matrices(**named: ArrayLike) -> list[NDArray]:
    found = {name: real_array(value, f"{name} must be numbers") for name, value in named.items()}
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
