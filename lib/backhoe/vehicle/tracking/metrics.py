"""How well a vehicle kept to its path.

The four metrics of D'Angelo 2022, section 5.2, with the distance to the nearest point of the
polyline, its segments included, where the source takes the nearest of many samples of it. The mean
and the standard deviation are over the given points, as in the source: over time, if the points
are samples of a run. What those four cannot see, being late and the effort, is in `assessment`.
"""

from __future__ import annotations

from typing import NamedTuple

from numpy.typing import ArrayLike

from backhoe.vehicle.tracking.polyline import distances, length


class Metrics(NamedTuple):
    """Distances to the reference path, and how long the way was.

    Attributes:
        d_mean, d_std, d_max: mean, standard deviation (of the population: divided by N) and
            largest value of the distances [m].
        d_ratio: length of the actual way / length of the reference [1].
    """

    d_mean: float
    d_std: float
    d_max: float
    d_ratio: float


def metrics(actual: ArrayLike, reference: ArrayLike) -> Metrics:
    """The source's four metrics of a driven way.

    Source: D'Angelo 2022, section 5.2; distances to the polyline instead of to its samples.

    Args:
        actual: where the vehicle was, shape (N, 2), N >= 1 [m].
        reference: the way-points, shape (M, 2), M >= 2 [m].

    Returns:
        Metrics(d_mean, d_std, d_max [m], d_ratio [1]).

    Raises:
        ValueError: not finite numbers of those shapes, a reference of one point or of length 0.
    """
    d = distances(actual, reference)
    whole = length(reference)
    if whole == 0:
        raise ValueError("reference must go somewhere: all its points are the same")
    return Metrics(float(d.mean()), float(d.std()), float(d.max()), length(actual) / whole)
