"""All states of a run from all its measurements in one system of equations.

The sum of all squared residuals, each in its own standard deviations, has one minimum. What the
Kalman filter says of the last state and the smoother of every state must be that.

Source: Mastalli 2013, eqs. (4.13)-(4.15), for the whole history instead of one step.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import covariance, numbers


def least_squares(
    F: ArrayLike,
    H: ArrayLike,
    Q: ArrayLike,
    R: ArrayLike,
    z: ArrayLike,
    x0: ArrayLike,
    P0: ArrayLike,
) -> tuple[NDArray, NDArray]:
    """States of greatest probability given the start and every measurement.

    Args:
        F: transition, shape (n, n); x and z have their own units.
        H: sensor, shape (m, n).
        Q, R: covariances of the noises, positive definite, shapes (n, n), (m, m).
        z: measurements of instants 1 ... K, shape (K, m).
        x0, P0: start and its covariance, positive definite, shapes (n,), (n, n).

    Returns:
        States, shape (K+1, n), and the covariance of each, shape (K+1, n, n).

    Raises:
        ValueError: shapes that do not fit, or a covariance that is not positive definite.
    """
    x0, z = numbers(x0, "x0", ("n",), meaning="the start"), numbers(z, "z", ("K", "m"))
    n, (K, m) = len(x0), z.shape
    F, H = numbers(F, "F", (n, n)), numbers(H, "H", (m, n))
    Q, R, P0 = (
        np.linalg.inv(covariance(value, name, size, definite=True))
        for value, name, size in ((Q, "Q", n), (R, "R", m), (P0, "P0", n))
    )
    information, weighted = np.zeros((K + 1, n, K + 1, n)), np.zeros((K + 1, n))
    information[0, :, 0], weighted[0] = P0, P0 @ x0
    for k in range(1, K + 1):
        information[k - 1, :, k - 1] += F.T @ Q @ F
        information[k - 1, :, k] -= F.T @ Q
        information[k, :, k - 1] -= Q @ F
        information[k, :, k] += Q + H.T @ R @ H
        weighted[k] += H.T @ R @ z[k - 1]
    size = (K + 1) * n
    inverse = np.linalg.inv(information.reshape(size, size))
    spread = inverse.reshape(K + 1, n, K + 1, n)
    every = np.arange(K + 1)
    return (inverse @ weighted.ravel()).reshape(K + 1, n), spread[every, :, every]
