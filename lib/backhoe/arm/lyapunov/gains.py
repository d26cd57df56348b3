"""Gains as the positive definite matrices that the analysis works with."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.pid import Gains
from backhoe.basics.inputs import instance, numbers
from backhoe.machine import JOINTS

_SYMMETRY = 1e-12


def gain_matrices(gains: Gains) -> Gains:
    """The three gains as matrices, shape (4, 4) each [units of `gains`].

    Raises:
        ValueError: as for `gain_matrix`.
        TypeError: they are no Gains.
    """
    instance(gains, "gains", Gains, "give pid.Gains(kp=..., ki=..., kd=...)")
    names = ("K_p", "K_i", "K_d")
    return Gains(*(gain_matrix(gain, name) for gain, name in zip(gains, names, strict=True)))


def gain_matrix(gain: ArrayLike, name: str) -> NDArray:
    """A gain as a symmetric positive definite matrix.

    Args:
        gain: one gain a joint, shape (4,), or a symmetric matrix, shape (4, 4).
        name: what the error message calls it, such as "K_p".

    Returns:
        The matrix, shape (4, 4) [unit of `gain`].

    Raises:
        ValueError: another shape, a value that is not finite, not symmetric, not positive definite.
    """
    values = numbers(gain, name)
    if values.shape not in ((4,), (4, 4)):
        raise ValueError(
            f"{name} must be 4 gains ({', '.join(JOINTS)}) or a matrix (4, 4), "
            f"got shape {values.shape}"
        )
    if values.ndim == 1:
        if (values <= 0).any():
            joint = JOINTS[int(np.argmin(values))]
            raise ValueError(
                f"{name} must be positive definite: every gain above 0, "
                f"but that of the {joint} is {values.min():g}"
            )
        return np.diag(values)
    if np.abs(values - values.T).max() > _SYMMETRY * np.abs(values).max():
        raise ValueError(f"{name} must be symmetric, got {values.tolist()}")
    lowest = np.linalg.eigvalsh(values)[0]
    if lowest <= 0:
        raise ValueError(
            f"{name} must be positive definite, but its smallest eigenvalue is {lowest:g}"
        )
    return values
