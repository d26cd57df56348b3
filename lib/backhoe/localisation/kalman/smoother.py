"""The Rauch-Tung-Striebel smoother: each state in the light of all measurements, also later ones.

    C = P F^T P_prior^-1,   x_s = x + C (x_s,next - x_prior),   P_s = P + C (P_s,next - P_prior) C^T

It walks back over what a Kalman or extended Kalman filter has kept.

Reference: Rauch, Tung and Striebel 1965.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import residual
from backhoe.basics.inputs import real_array
from backhoe.localisation.kalman.arguments import finite
from backhoe.localisation.kalman.history import History


class Smoothed(NamedTuple):
    """x (..., K+1, n), P (..., K+1, n, n), and the gains C (..., K, n, n)."""

    x: NDArray
    P: NDArray
    gain: NDArray


def rts_smoother(
    x: ArrayLike | History,
    P: ArrayLike | None = None,
    x_prior: ArrayLike | None = None,
    P_prior: ArrayLike | None = None,
    F: ArrayLike | None = None,
    *,
    angles: Sequence[int] | None = None,
) -> Smoothed:
    """Smooth a run, or many side by side.

    Args:
        x: a `History`, which has all that follows; or the filter's estimates, shape (..., K+1, n).
        P: their covariances, shape (..., K+1, n, n).
        x_prior, P_prior: the predictions of instants 1 ... K and their covariances, shapes
            (..., K, n), (..., K, n, n).
        F: Jacobians of the steps to them, shape (..., K, n, n).
        angles: components of the state that are angles; None: as the history's filter has it.

    Returns:
        Smoothed(x, P, gain). The last instant is the filter's.

    Raises:
        ValueError: shapes that do not fit, or a P_prior that is singular.
    """
    if isinstance(x, History):
        if P is not None:
            raise ValueError("give a History, or the arrays x, P, x_prior, P_prior and F; not both")
        angles = x._filter.angles if angles is None else angles
        x, P, x_prior, P_prior, F = x.x, x.P, x.x_prior, x.P_prior, x.F
    x, P, x_prior, P_prior, F = _checked(x=x, P=P, x_prior=x_prior, P_prior=P_prior, F=F)
    try:
        back = np.linalg.solve(P_prior, F @ P[..., :-1, :, :])
    except np.linalg.LinAlgError as error:
        raise ValueError("P_prior must be positive definite: give every state some Q") from error
    gain = np.swapaxes(back, -1, -2)
    x, P = x.copy(), P.copy()
    for k in range(x.shape[-2] - 2, -1, -1):
        C = gain[..., k, :, :]
        ahead = residual(x[..., k + 1, :], x_prior[..., k, :], () if angles is None else angles)
        x[..., k, :] += (C @ ahead[..., None])[..., 0]
        more = C @ (P[..., k + 1, :, :] - P_prior[..., k, :, :]) @ np.swapaxes(C, -1, -2)
        P[..., k, :, :] += (more + np.swapaxes(more, -1, -2)) / 2
    return Smoothed(x, P, gain)


def _checked(**named: ArrayLike | None) -> list[NDArray]:
    missing = [name for name, value in named.items() if value is None]
    if missing:
        raise ValueError(f"{', '.join(missing)} must be given beside x, or a History alone")
    arrays = {name: real_array(value, f"{name} must be numbers") for name, value in named.items()}
    shape = arrays["x"].shape
    if len(shape) < 2 or shape[-2] < 2:
        raise ValueError(f"x must have shape (..., K+1, n) with K at least 1, got {shape}")
    lead, K, n = shape[:-2], shape[-2] - 1, shape[-1]
    wanted = {
        "x": shape,
        "P": (*shape, n),
        "x_prior": (*lead, K, n),
        "P_prior": (*lead, K, n, n),
        "F": (*lead, K, n, n),
    }
    return [finite(arrays[name], wanted[name], name) for name in arrays]
