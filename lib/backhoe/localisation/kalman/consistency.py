"""Does a filter know how wrong it is? Its errors measured in its own standard deviations.

NEES needs the truth and so a simulation; NIS needs the measurements alone. For a consistent filter
both are chi-square distributed, with the state's and the measurement's dimension as degrees of
freedom.

Reference: Bar-Shalom, Li and Kirubarajan 2001, section 5.4.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import residual
from backhoe.basics.inputs import covariance, number, numbers, real_numbers, whole


def nees(errors: ArrayLike, covariances: ArrayLike, angles: Sequence[int] = ()) -> NDArray:
    """Normalised estimation error squared, e^T P^-1 e.

    Args:
        errors: truth minus estimate, shape (..., n) [own units].
        covariances: what the filter says of them, shape (..., n, n) [products of those units].
        angles: components that are angles, wrapped first [rad].

    Returns:
        Shape (...) [1]; n on average for a consistent filter.

    Raises:
        ValueError: shapes that do not fit, numbers that are not finite, or a covariance that is not
            positive definite.
    """
    e, L = _factored(errors, covariances, angles, "errors", "covariances")
    return np.sum(np.linalg.solve(L, e[..., None])[..., 0] ** 2, axis=-1)  # P = L L^T


def nis(innovations: ArrayLike, S: ArrayLike, angles: Sequence[int] = ()) -> NDArray:
    """Normalised innovation squared, y^T S^-1 y.

    Args:
        innovations: shape (..., m) [own units].
        S: their covariance by the filter, shape (..., m, m) [products of those units].
        angles: components that are angles, wrapped first [rad].

    Returns:
        Shape (...) [1]; m on average for a consistent filter.

    Raises:
        ValueError: as for `nees`.
    """
    y, L = _factored(innovations, S, angles, "innovations", "S")
    return np.sum(np.linalg.solve(L, y[..., None])[..., 0] ** 2, axis=-1)  # S = L L^T


def chi_square_band(dof: int, runs: int = 1, probability: float = 0.95) -> tuple[float, float]:
    """Where the average of NEES or NIS over independent runs lies with a probability.

    Args:
        dof: degrees of freedom, n for NEES and m for NIS.
        runs: M independent runs.
        probability: of being between low and high, the same on either side.

    Returns:
        low, high.

    Raises:
        ValueError: dof or runs not positive integers, probability not between 0 and 1.
    """
    from scipy.special import gammaincinv

    dof, runs = whole(dof, "dof", least=1), whole(runs, "runs", least=1)
    tail = (1 - _share(probability)) / 2
    low, high = 2 * gammaincinv(dof * runs / 2, [tail, 1 - tail]) / runs
    return float(low), float(high)


def share_inside(values: ArrayLike, band: tuple[float, float]) -> float:
    """Share of the values inside a band, its ends included.

    Args:
        values: any shape (...), such as the average NEES of each instant [own unit].
        band: low, high.

    Returns:
        From 0 to 1.

    Raises:
        ValueError: no values, not finite, or the band is not in order.
    """
    values = numbers(values, "values")
    if values.size == 0:
        raise ValueError("values must hold at least one number, got none")
    low, high = numbers(band, "band", (2,))
    if not low < high:
        raise ValueError(f"band must be (low, high), got {band!r}")
    return float(np.mean((values >= low) & (values <= high)))


def ellipse(mean: ArrayLike, P: ArrayLike, probability: float = 0.95, points: int = 60) -> NDArray:
    """Outline of the region that holds a plane Gaussian with a probability.

    Args:
        mean: centre, shape (2,) [own units].
        P: covariance, shape (2, 2) [products of those units].
        probability: of being inside.
        points: on the outline, the last as the first.

    Returns:
        Shape (points, 2).

    Raises:
        ValueError: wrong shapes, P no covariance, probability not between 0 and 1.
    """
    mean, P = numbers(mean, "mean", (2,)), covariance(P, "P", 2)
    radius = np.sqrt(-2 * np.log1p(-_share(probability)))
    variances, axes = np.linalg.eigh(P)
    turn = np.linspace(0, 2 * np.pi, points)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    return mean + radius * (circle * np.sqrt(np.maximum(variances, 0))) @ axes.T


def _factored(
    e: ArrayLike, P: ArrayLike, angles: Sequence[int], one: str, other: str
) -> tuple[NDArray, NDArray]:
    """e with its angles wrapped, and the lower triangle L of P = L L^T."""
    e, P = numbers(e, one), real_numbers(P, other)
    if e.ndim < 1 or P.shape != (*e.shape, e.shape[-1]):
        raise ValueError(
            f"{one} and {other} must have shapes (..., n) and (..., n, n), got {e.shape} and "
            f"{P.shape}"
        )
    asymmetry = np.abs(numbers(P, other) - np.swapaxes(P, -1, -2)).max(initial=0.0)
    if asymmetry > 1e-9 * np.abs(P).max(initial=0.0):
        raise ValueError(f"{other} must be symmetric")
    try:
        return residual(e, 0 * e, angles), np.linalg.cholesky(P)
    except np.linalg.LinAlgError as error:
        raise ValueError(f"{other} must be positive definite, and one is not") from error


def _share(probability: float) -> float:
    return number(probability, "probability", above=0, below=1)
