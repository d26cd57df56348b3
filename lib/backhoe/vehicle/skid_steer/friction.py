"""Friction between wheel and ground: Coulomb, viscous, smooth and linear, and where they agree.

All give the size of the friction force, positive against a positive slip velocity.

Source: D'Angelo 2022, section 2.3.1. Its text calls Coulomb's law "static friction": it is the
friction of sliding. The linear law (2.11) is the tangent of the smooth one at v = 0 and holds for
|v| << 1/k_s only, while the smooth law resembles Coulomb's for |v| >> 1/k_s only: with k_s >> 1, as
the source asks, the linear law holds for creeping alone.
"""

from __future__ import annotations

from math import atan, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import not_negative, numbers, positive


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
    v, normal = numbers(v, "v"), _pressing(normal)
    mu, viscous = not_negative(mu, "mu"), not_negative(viscous, "viscous", "N s/m")
    return mu * normal * np.sign(v) + viscous * v


def smooth_sign(v: ArrayLike, k_s: float) -> NDArray:
    """The sign of v made smooth, (2/pi) arctan(k_s v).

    Source: D'Angelo 2022, eq. (2.10).

    Args:
        v: slip velocity, shape (...) [m/s].
        k_s: steepness [s/m].

    Returns:
        Shape (...), between -1 and 1 [1].

    Raises:
        ValueError: a value is not a finite number, or k_s is not positive.
    """
    return 2 / pi * np.arctan(positive(k_s, "k_s", "s/m") * numbers(v, "v"))


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
    return not_negative(mu, "mu") * _pressing(normal) * smooth_sign(v, k_s)


def slope(mu: float, k_s: float) -> float:
    """K of the linear law: the smooth law's slope at v = 0 over the normal force [s/m].

    Source: D'Angelo 2022, eq. (2.11), K = mu_c k_s 2/pi.

    Raises:
        ValueError: mu is negative, k_s is not positive, or one is not a finite number.
    """
    return 2 / pi * not_negative(mu, "mu") * positive(k_s, "k_s", "s/m")


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
    return _pressing(normal) * slope(mu, k_s) * numbers(v, "v")


def overestimate(v: ArrayLike, k_s: float) -> NDArray:
    """How many times the smooth force the linear law gives, k_s v / arctan(k_s v).

    Args:
        v: slip velocity, shape (...) [m/s].
        k_s: steepness [s/m].

    Returns:
        Shape (...), 1 at v = 0 and more beside it [1].

    Raises:
        ValueError: a value is not a finite number, or k_s is not positive.
    """
    x = positive(k_s, "k_s", "s/m") * numbers(v, "v")
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
    k_s, error = positive(k_s, "k_s", "s/m"), positive(error, "error")
    low, high = 0.0, pi / 2 * (1 + error)
    for _ in range(60):
        x = (low + high) / 2
        low, high = (x, high) if x <= (1 + error) * atan(x) else (low, x)
    return low / k_s


def _pressing(normal: ArrayLike) -> NDArray:
    normal = numbers(normal, "normal")
    if (normal < 0).any():
        raise ValueError(f"normal must not be negative: the ground does not pull, got {normal}")
    return normal
