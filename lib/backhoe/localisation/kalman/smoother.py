"""The Rauch-Tung-Striebel smoother: each state in the light of all measurements, also later ones.

    C = P F^T P_prior^-1,   x_s = x + C (x_s,next - x_prior),   P_s = P + C (P_s,next - P_prior) C^T

It walks back over what a Kalman or extended Kalman filter has kept.

Reference: Rauch, Tung and Striebel 1965.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.angles import residual
from backhoe.basics.inputs import instance
from backhoe.localisation.kalman.history import History


class Smoothed(NamedTuple):
    """x (..., K+1, n), P (..., K+1, n, n), and the gains C (..., K, n, n) [the filter's units]."""

    x: NDArray
    P: NDArray
    gain: NDArray


def rts_smoother(history: History) -> Smoothed:
    """Smooth a run, or many side by side.

    Args:
        history: of the filter; the components of its state that are angles are wrapped.

    Returns:
        States, shape (..., K+1, n), in the filter's own units, covariances, shape (..., K+1, n, n),
        and gains. The last instant is the filter's.

    Raises:
        TypeError: no history.
        ValueError: an empty history, or a P_prior that is singular.
    """
    instance(history, "history", History)
    x, P, x_prior, P_prior, F = history.x, history.P, history.x_prior, history.P_prior, history.F
    try:
        back = np.linalg.solve(P_prior, F @ P[..., :-1, :, :])
    except np.linalg.LinAlgError as error:
        raise ValueError("P_prior must be positive definite: give every state some Q") from error
    gain = np.swapaxes(back, -1, -2)
    for k in range(x.shape[-2] - 2, -1, -1):
        C = gain[..., k, :, :]
        ahead = residual(x[..., k + 1, :], x_prior[..., k, :], history.angles)
        x[..., k, :] += (C @ ahead[..., None])[..., 0]
        more = C @ (P[..., k + 1, :, :] - P_prior[..., k, :, :]) @ np.swapaxes(C, -1, -2)
        P[..., k, :, :] += (more + np.swapaxes(more, -1, -2)) / 2
    return Smoothed(x, P, gain)
