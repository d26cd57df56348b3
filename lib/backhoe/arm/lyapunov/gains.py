"""Gains and the other arguments of the analysis, checked once."""

from __future__ import annotations

from math import isfinite
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array
from backhoe.machine import JOINTS

_SYMMETRY = 1e-12


def gain_matrix(gain: ArrayLike, name: str) -> NDArray:
    """A gain as a symmetric positive definite matrix.

    Args:
        gain: one gain a joint, shape (4,), or a symmetric matrix, shape (4, 4).
        name: what the error message calls it, such as "K_p".

    Returns:
        The matrix, shape (4, 4), in the unit of `gain`.

    Raises:
        ValueError: another shape, a value that is not finite, not symmetric, not positive definite.
    """
    values = real_array(gain, f"{name} must be numbers for the 4 joints ({', '.join(JOINTS)})")
    if values.shape not in ((4,), (4, 4)):
        raise ValueError(
            f"{name} must be 4 gains ({', '.join(JOINTS)}) or a matrix (4, 4), "
            f"got shape {values.shape}"
        )
    if not np.isfinite(values).all():
        raise ValueError(f"{name} must be finite, got {values.tolist()}")
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


def positive(value: float, name: str, unit: str) -> float:
    """`value` as a float.

    Args:
        value: a number.
        name, unit: how the error message calls it and what it is measured in.

    Raises:
        ValueError: not a positive finite number.
    """
    good = isinstance(value, Real) and not isinstance(value, bool) and isfinite(value) and value > 0
    if not good:
        raise ValueError(f"{name} must be a positive number in {unit}, got {value!r}")
    return float(value)
