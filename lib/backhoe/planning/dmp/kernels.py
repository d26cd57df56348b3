"""Gaussian kernels along a movement, their weights by regression, and the function that they make.

f(s) = sum(w_i psi_i) s / sum(psi_i): (6.5) and (6.6) of Mastalli 2013. The kernels are functions
of the phase, psi_i = exp(-h_i (s - c_i)^2), their centres even in the phase or in time, or
functions of time itself. Few kernels count at a sample: only those are kept.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics import inputs
from backhoe.planning.dmp.phase import END_PHASE, phase

SPACINGS = ("exponential", "uniform", "time")
FITS = ("lwr", "ridge")


@dataclass(frozen=True)
class Kernels:
    """Kernels along a movement.

    Attributes:
        count: how many.
        width: standard deviation of each over the distance to the next centre.
        spacing: "exponential": functions of the phase with centres even in time; "uniform":
            functions of the phase, even in phase; "time": functions of time, even in time.
        end_phase: phase at the end of the movement.

    Raises:
        ValueError: fewer than 2 kernels, a width not positive, an unknown spacing.
    """

    count: int = 100
    width: float = 1.2
    spacing: str = "exponential"
    end_phase: float = END_PHASE

    def __post_init__(self) -> None:
        inputs.whole(self.count, "kernels", least=2, most=10_000)
        inputs.positive(self.width, "width")
        inputs.choice(self.spacing, "spacing", SPACINGS)
        inputs.number(self.end_phase, "end_phase", above=0.0, below=1.0)

    @property
    def centres(self) -> NDArray:
        """c_i, in order of time, shape (count,): phases, or shares of the duration [1]."""
        if self.spacing == "uniform":
            return np.linspace(1.0, self.end_phase, self.count)
        even = np.linspace(0.0, 1.0, self.count)
        return even if self.spacing == "time" else phase(even, 1.0, self.end_phase)

    @property
    def sharpness(self) -> NDArray:
        """h_i of psi_i = exp(-h_i (s - c_i)^2), shape (count,) [1]."""
        apart = np.abs(np.diff(self.centres))
        return 0.5 / (self.width * np.append(apart, apart[-1])) ** 2

    def basis(self, share: ArrayLike) -> Basis:
        """The kernels at shares of the duration that rise from 0 to 1, shape (m,) [1]; kept for the
        next call with the same."""
        share = inputs.numbers(share, "share", ("m",))
        return _basis(self, share.tobytes())


@dataclass(frozen=True, eq=False)
class Basis:
    """Kernels at m samples; those that count at sample k are values[offsets[k]:offsets[k + 1]],
    of the kernels from first[k] on.

    Attributes:
        s: phases, shape (m,) [1].
        first, offsets: whole numbers, shapes (m,) and (m + 1,) [1].
        values: s psi_i / sum(psi) in a row, shape (kept,) [1].
        totals: sum(psi), shape (m,) [1].
        count: of all kernels.
        inverses: what `solver` keeps, shapes (count, count) [1].
    """

    s: NDArray
    first: NDArray
    offsets: NDArray
    values: NDArray
    totals: NDArray
    count: int
    inverses: dict[float, NDArray] = field(default_factory=dict)

    def mixed(self, weights: NDArray) -> NDArray:
        """f at each sample, shape (m, d), for weights (count, d), of their unit."""
        from backhoe.planning.dmp import engine

        weights, d = _in_fours(weights)
        f = np.empty((len(self.s), weights.shape[1]))
        engine.mixed(self.first, self.offsets, self.values, weights, f)
        return f[:, :d]

    def dense(self) -> NDArray:
        """F_i(s) of (6.6), shape (m, count) [1]."""
        table = np.zeros((len(self.s), self.count))
        rows = np.repeat(np.arange(len(self.s)), np.diff(self.offsets))
        columns = np.arange(len(self.values)) - self.offsets[rows] + self.first[rows]
        table[rows, columns] = self.values
        return table

    def weighed(self, y: NDArray, by: NDArray) -> NDArray:
        """sum of value times `by` times y over the samples, shape (count, d) [unit of y]; `by`, of
        shape (m,) [1], is `totals` for s psi_i itself."""
        from backhoe.planning.dmp import engine

        y, d = _in_fours(y)
        sums = np.zeros((self.count, y.shape[1]))
        engine.weighed(self.first, self.offsets, self.values, by, y, sums)
        return sums[:, :d]

    @cached_property
    def squares(self) -> NDArray:
        """sum of s^2 psi_i over the samples, shape (count, 1) [1]."""
        return self.weighed(self.s[:, None], self.totals)

    @cached_property
    def gram(self) -> NDArray:
        """Mean of F_i F_j over the samples, shape (count, count) [1]."""
        from backhoe.planning.dmp import engine

        sums = np.zeros((self.count, self.count))
        engine.products(self.first, self.offsets, self.values, sums)
        return (sums + np.triu(sums, 1).T) / len(self.s)

    def solver(self, ridge: float) -> NDArray:
        """Inverse of gram + ridge, shape (count, count) [1], kept for the next fit."""
        if ridge not in self.inverses:
            self.inverses[ridge] = np.linalg.inv(self.gram + ridge * np.eye(self.count))
        return self.inverses[ridge]


def _in_fours(table: NDArray) -> tuple[NDArray, int]:
    """The table, shape (m, d), with columns of zeros up to the next four, and d."""
    m, d = table.shape
    if d % 4 == 0:
        return np.ascontiguousarray(table), d
    wide = np.zeros((m, d + -d % 4))
    wide[:, :d] = table
    return wide, d


@lru_cache(maxsize=16)
def _basis(kernels: Kernels, share: bytes) -> Basis:
    from backhoe.planning.dmp import engine

    u = np.frombuffer(share)
    s = phase(u, 1.0, kernels.end_phase)
    place = u if kernels.spacing == "time" else s
    centres, widths = kernels.centres, kernels.sharpness
    first, counts = np.empty(len(u), np.int64), np.empty(len(u), np.int64)
    engine.reach(place, centres, widths, first, counts)
    offsets = np.concatenate([[0], np.cumsum(counts)])
    values, totals = np.empty(offsets[-1]), np.empty(len(u))
    engine.kernels(place, s, centres, widths, first, offsets, values, totals)
    return Basis(s, first, offsets, values, totals, kernels.count)


def fit(bases: list[Basis], targets: list[NDArray], method: str, ridge: float) -> NDArray:
    """Weights with which the kernels give the targets of all demonstrations together.

    "lwr", locally weighted regression: each weight alone, w_i = sum(psi_i s f) / sum(psi_i s^2),
    (B.7) of Mastalli 2013 with psi_i as its weights. "ridge": all together, the least sum of
    squares and ridge times the squared weights.

    Args:
        bases: of each demonstration.
        targets: f at its samples, shapes (m, d) [any unit].
        method: "lwr" or "ridge".
        ridge: for a mean over the samples; unused by "lwr".

    Returns:
        Weights, shape (count, d), of the targets' unit.
    """
    if method == "lwr":
        above = sum(one.weighed(y, one.totals) for one, y in zip(bases, targets, strict=True))
        below = sum(one.squares for one in bases)
        return above / np.where(below > 0, below, 1.0)
    pairs = zip(bases, targets, strict=True)
    right = sum(one.weighed(y, np.full(len(y), 1 / len(y))) for one, y in pairs)
    if len(bases) == 1:
        return bases[0].solver(ridge) @ right
    square = sum(one.gram for one in bases)
    return np.linalg.solve(square + ridge * len(bases) * np.eye(len(square)), right)
