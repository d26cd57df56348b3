"""Does a filter know how wrong it is? Its errors measured in its own standard deviations.

NEES needs the truth and so a simulation; NIS and whiteness need the measurements alone. For a
consistent filter both are chi-square distributed, with the state's and the measurement's dimension
as degrees of freedom.

Reference: Bar-Shalom, Li and Kirubarajan 2001, section 5.4.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import indices, wrap_components
from backhoe.basics.inputs import real_array
from backhoe.localisation.kalman.arguments import covariance, finite
from backhoe.localisation.kalman.arguments import probability as _probability


class Whiteness(NamedTuple):
    """lags (L,), correlation of the normalised innovations at them (L,), and its bound."""

    lags: NDArray
    correlation: NDArray
    bound: float


def nees(errors: ArrayLike, covariances: ArrayLike, angles: Sequence[int] = ()) -> NDArray:
    """Normalised estimation error squared, e^T P^-1 e.

    Args:
        errors: truth minus estimate, shape (..., n).
        covariances: what the filter says of them, shape (..., n, n); leading axes as the errors'.
        angles: components that are angles, wrapped first [rad].

    Returns:
        Shape (...); n on average for a consistent filter.

    Raises:
        ValueError: shapes that do not fit, numbers that are not finite, or a covariance that is not
            positive definite.
    """
    return _squared(errors, covariances, angles, "errors", "covariances")


def nis(innovations: ArrayLike, S: ArrayLike, angles: Sequence[int] = ()) -> NDArray:
    """Normalised innovation squared, y^T S^-1 y.

    Args:
        innovations: shape (..., m).
        S: their covariance by the filter, shape (..., m, m).
        angles: components that are angles, wrapped first [rad].

    Returns:
        Shape (...); m on average for a consistent filter.

    Raises:
        ValueError: as for `nees`.
    """
    return _squared(innovations, S, angles, "innovations", "S")


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

    for name, value in (("dof", dof), ("runs", runs)):
        if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < 1:
            raise ValueError(f"{name} must be a positive integer, got {value!r}")
    tail = (1 - _probability(probability)) / 2
    low, high = 2 * gammaincinv(dof * runs / 2, [tail, 1 - tail]) / runs
    return float(low), float(high)


def share_inside(values: ArrayLike, band: tuple[float, float]) -> float:
    """Share of the values inside a band, its ends included.

    Args:
        values: any shape, such as the average NEES of each instant.
        band: low, high.

    Returns:
        From 0 to 1.

    Raises:
        ValueError: no values, not finite, or the band is not in order.
    """
    values = real_array(values, "values must be numbers")
    if values.size == 0:
        raise ValueError("values must hold at least one number, got none")
    low, high = finite(band, (2,), "band")
    if not low < high:
        raise ValueError(f"band must be (low, high), got {band!r}")
    values = finite(values, values.shape, "values")
    return float(np.mean((values >= low) & (values <= high)))


def whiteness(innovations: ArrayLike, S: ArrayLike, lags: int = 20) -> Whiteness:
    """Correlation in time of a filter's innovations, each divided by its standard deviation.

    What a filter has understood leaves no pattern in its innovations: of these correlations about
    95 % should be within the bound.

    Args:
        innovations: of K instants, shape (..., K, m), of one run or many.
        S: their covariances, shape (..., K, m, m).
        lags: how far apart in instants, 1 ... lags.

    Returns:
        Whiteness(lags (L,), correlation (L,), bound = 1.96 / sqrt(samples)).

    Raises:
        ValueError: shapes that do not fit, or fewer than lags + 1 instants.
    """
    y, S = _pair(innovations, S, "innovations", "S")
    if y.ndim < 2 or not 1 <= lags < y.shape[-2]:
        raise ValueError(
            f"innovations must be (..., K, m) with K above lags, got shape {y.shape} and {lags}"
        )
    white = np.linalg.solve(_roots(S, "S"), y[..., None])[..., 0]
    power = np.mean(white**2)
    steps = np.arange(1, lags + 1)
    correlation = [np.mean(white[..., k:, :] * white[..., :-k, :]) / power for k in steps]
    return Whiteness(steps, np.array(correlation), float(1.96 / np.sqrt(white.size)))


def ellipse(mean: ArrayLike, P: ArrayLike, probability: float = 0.95, points: int = 60) -> NDArray:
    """Outline of the region that holds a plane Gaussian with a probability.

    Args:
        mean: centre, shape (2,).
        P: covariance, shape (2, 2).
        probability: of being inside.
        points: on the outline, the last as the first.

    Returns:
        Shape (points, 2).

    Raises:
        ValueError: wrong shapes, P no covariance, probability not between 0 and 1.
    """
    mean, P = finite(mean, (2,), "mean"), covariance(P, 2, "P")
    radius = np.sqrt(-2 * np.log1p(-_probability(probability)))
    variances, axes = np.linalg.eigh(P)
    turn = np.linspace(0, 2 * np.pi, points)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    return mean + radius * (circle * np.sqrt(np.maximum(variances, 0))) @ axes.T


def _squared(
    errors: ArrayLike, covariances: ArrayLike, angles: Sequence[int], one: str, other: str
) -> NDArray:
    e, P = _pair(errors, covariances, one, other)
    if len(angles):
        e = e.copy()
        wrap_components(e, indices("angles", angles, e.shape[-1]))
    scaled = np.linalg.solve(_roots(P, other), e[..., None])[..., 0]
    return np.sum(scaled**2, axis=-1)


def _pair(e: ArrayLike, P: ArrayLike, one: str, other: str) -> tuple[NDArray, NDArray]:
    e, P = real_array(e, f"{one} must be numbers"), real_array(P, f"{other} must be numbers")
    if e.ndim < 1 or P.shape != (*e.shape, e.shape[-1]):
        raise ValueError(
            f"{one} and {other} must have shapes (..., n) and (..., n, n), got {e.shape} and "
            f"{P.shape}"
        )
    return finite(e, e.shape, one), P


def _roots(P: NDArray, name: str) -> NDArray:
    transposed = np.swapaxes(P, -1, -2)
    scale = np.abs(P).max(initial=0.0)
    if not np.isfinite(P).all() or np.abs(P - transposed).max(initial=0.0) > 1e-9 * scale:
        raise ValueError(f"{name} must be finite and symmetric")
    try:
        return np.linalg.cholesky(P)
    except np.linalg.LinAlgError as error:
        raise ValueError(f"{name} must be positive definite, and one is not") from error
