"""Friction between wheel and ground: Coulomb, viscous, smooth and linear, and where they agree.

All give the size of the friction force, positive against a positive slip velocity.

Source: D'Angelo 2022, section 2.3.1. Its text calls Coulomb's law "static friction": it is the
friction of sliding. The linear law (2.11) is the tangent of the smooth one at v = 0 and holds for
|v| << 1/k_s only, while the smooth law resembles Coulomb's for |v| >> 1/k_s only: with k_s >> 1, as
the source asks, no everyday speed lies where the linear law holds.
"""

from __future__ import annotations

from math import atan, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_array


def coulomb(v: ArrayLike, normal: ArrayLike, mu: float, viscous: float = 0.0) -> NDArray:
    """Coulomb and viscous friction, mu_c N sgn(v) + mu_v v.

    Source: D'Angelo 2022, eq. (2.8); with viscous = 0 eq. (2.9).

    Args:
        v: slip velocity, shape (...) [m/s].
        normal: force N that presses the surfaces together, shape (...) [N].
        mu: Coulomb coefficient [1].
        viscous: viscous coefficient [N s/m].

    Returns:
        Friction force, shape (...) [N].

    Raises:
        ValueError: a value is not a finite number, or normal or a coefficient is negative.
    """
    v, normal = _arguments(v, normal, mu=mu, viscous=viscous)
    return mu * normal * np.sign(v) + viscous * v


def smooth_sign(v: ArrayLike, k_s: float) -> NDArray:
    """The sign of v made smooth, (2/pi) arctan(k_s v).

    Source: D'Angelo 2022, eq. (2.10).

    Args:
        v: slip velocity, shape (...) [m/s].
        k_s: steepness [s/m].

    Returns:
        Shape (...), between -1 and 1.

    Raises:
        ValueError: a value is not a finite number, or k_s is not positive.
    """
    v, _ = _arguments(v, 0.0)
    return 2 / pi * np.arctan(_positive(k_s, "k_s") * v)


def smooth(v: ArrayLike, normal: ArrayLike, mu: float, k_s: float) -> NDArray:
    """Smooth Coulomb friction, mu_c N (2/pi) arctan(k_s v).

    Source: D'Angelo 2022, (2.10) in (2.9).

    Args:
        v, normal, mu: as for `coulomb`.
        k_s: steepness [s/m].

    Returns:
        Friction force, shape (...) [N].

    Raises:
        ValueError: as for `coulomb`, or k_s is not positive.
    """
    v, normal = _arguments(v, normal, mu=mu)
    return mu * normal * smooth_sign(v, k_s)


def slope(mu: float, k_s: float) -> float:
    """K of the linear law: the smooth law's slope at v = 0 over the normal force [s/m].

    Source: D'Angelo 2022, eq. (2.11), K = mu_c k_s 2/pi.

    Raises:
        ValueError: mu is negative, k_s is not positive, or one is not a finite number.
    """
    _arguments(0.0, 0.0, mu=mu)
    return 2 / pi * mu * _positive(k_s, "k_s")


def linear(v: ArrayLike, normal: ArrayLike, mu: float, k_s: float) -> NDArray:
    """Linear friction N K v: the tangent of `smooth` at v = 0, see `linear_range`.

    Source: D'Angelo 2022, eq. (2.11).

    Args:
        v, normal, mu, k_s: as for `smooth`.

    Returns:
        Friction force, shape (...) [N].

    Raises:
        ValueError: as for `smooth`.
    """
    v, normal = _arguments(v, normal, mu=mu)
    return normal * slope(mu, k_s) * v


def overestimate(v: ArrayLike, k_s: float) -> NDArray:
    """How many times the smooth force the linear law gives, k_s v / arctan(k_s v).

    Args:
        v: slip velocity, shape (...) [m/s].
        k_s: steepness [s/m].

    Returns:
        Shape (...), 1 at v = 0 and more beside it.

    Raises:
        ValueError: a value is not a finite number, or k_s is not positive.
    """
    v, _ = _arguments(v, 0.0)
    x = _positive(k_s, "k_s") * v
    return np.divide(x, np.arctan(x), out=np.ones_like(x), where=x != 0)


def linear_range(k_s: float, error: float = 0.1) -> float:
    """Slip velocity up to which the linear law exceeds the smooth one by no more than `error`.

    Args:
        k_s: steepness [s/m].
        error: share, 0.1 for 10 %.

    Returns:
        Speed [m/s]; for 10 % it is 0.56 / k_s.

    Raises:
        ValueError: k_s or error is not a positive number.
    """
    k_s, error = _positive(k_s, "k_s"), _positive(error, "error")
    low, high = 0.0, pi / 2 * (1 + error)
    for _ in range(60):
        x = (low + high) / 2
        low, high = (x, high) if x <= (1 + error) * atan(x) else (low, x)
    return low / k_s


def _arguments(v: ArrayLike, normal: ArrayLike, **coefficients: float) -> tuple[NDArray, NDArray]:
    v, normal = (real_array(x, f"{n} must be numbers") for x, n in ((v, "v"), (normal, "normal")))
    if not (np.isfinite(v).all() and np.isfinite(normal).all()):
        raise ValueError("slip velocity and normal force must be finite")
    if (normal < 0).any():
        raise ValueError(f"normal must not be negative: the ground does not pull, got {normal}")
    for name, value in coefficients.items():
        if not (np.ndim(value) == 0 and np.isfinite(value) and value >= 0):
            raise ValueError(f"{name} must be a number, 0 or more, got {value!r}")
    return v, normal


def _positive(value: float, name: str) -> float:
    if not (np.ndim(value) == 0 and np.isfinite(value) and value > 0):
        raise ValueError(f"{name} must be a positive number, got {value!r}")
    return float(value)
