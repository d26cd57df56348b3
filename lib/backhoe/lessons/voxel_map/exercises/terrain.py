"""Exercises 9.7 to 9.9: a cell that follows the digging, a volume's deviation, distances."""

from __future__ import annotations

from math import isnan, sqrt

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.perception.distance_field import distance_transform

__all__ = ["EXERCISES"]


def cell_update(h: float, P: float, z: float, R: float, gate: float) -> tuple[float, float]:
    """A cell's height and variance after a measurement."""
    if isnan(h) or (z - h) ** 2 > gate**2 * (P + R):
        return z, R
    K = P / (P + R)
    return h + K * (z - h), (1 - K) * P


def _cells(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(60):
        h, P, R = rng.normal(), rng.uniform(1e-5, 4e-4), rng.uniform(1e-5, 4e-4)
        gate = rng.uniform(2.5, 5.0)
        side = 1 if rng.uniform() < 0.5 else -1
        step = (0.2, 0.9, 1.1, 4.0)[k % 4] * gate * side
        cases.append((h, P, h + step * sqrt(P + R), R, gate))
    return [*cases, (np.nan, np.nan, 0.7, 1e-4, 4.0), (np.nan, np.nan, -0.2, 3e-4, 3.0)]


def _gated(inside):
    """A wrong rule for what is no new cell."""

    def answer(h, P, z, R, gate):
        return (z, R) if isnan(h) else inside(h, P, z, R, gate)

    return answer


CELL = Exercise(
    number="9.7",
    title="A cell that follows the digging",
    reference=cell_update,
    cases=_cells,
    oracle="weighted_by_information_or_begun_anew",
    mistakes={
        "it averages for ever: beyond the gate begin anew, with z and R": _gated(
            lambda h, P, z, R, gate: cell_update(h, P, z, R, np.inf)
        ),
        "the gate forgets that z is uncertain too: compare with the root of P + R": _gated(
            lambda h, P, z, R, gate: cell_update(h, P, z, R, gate * sqrt(P / (P + R)))
        ),
        "soil comes as well as goes: take the size of z - h, not its sign": _gated(
            lambda h, P, z, R, gate: cell_update(h, P, z, R, gate if z < h else np.inf)
        ),
        "deviations and variances are mixed up: compare (z - h)^2 with gate^2 (P + R)": _gated(
            lambda h, P, z, R, gate: cell_update(h, P, z, R, sqrt(gate))
        ),
        "a cell begun anew is as uncertain as its one measurement, R: yours keeps the old P": (
            lambda h, P, z, R, gate: (
                (z, P) if abs(z - h) > gate * sqrt(P + R) else cell_update(h, P, z, R, gate)
            )
        ),
        "the gain is turned over: K = P / (P + R) is large where the map is unsure": _gated(
            lambda h, P, z, R, gate: (
                (z, R)
                if abs(z - h) > gate * sqrt(P + R)
                else (h + R / (P + R) * (z - h), P * R / (P + R))
            )
        ),
        "an unseen cell is NaN, and NaN compares with nothing: ask for it first": (
            lambda h, P, z, R, gate: (h, P) if isnan(h) else cell_update(h, P, z, R, gate)
        ),
    },
    hints=(
        "Three cases: never seen; further than the gate; else a Kalman step with one state.",
        "(z - h)^2 > gate^2 (P + R) gives z, R; else K = P / (P + R), h + K (z - h), (1 - K) P.",
    ),
    tested_on="60 cells, half of them dug or filled, and two that nobody had seen",
)


def volume_with_deviation(
    before: NDArray,
    after: NDArray,
    var_before: NDArray,
    var_after: NDArray,
    cell: float,
    lift: float,
) -> tuple[float, float]:
    """Volume dug and its standard deviation."""
    area = cell**2
    noise = area**2 * np.sum(var_before + var_after)
    common = 2 * (area * before.size * lift) ** 2
    return area * float(np.sum(before - after)), sqrt(noise + common)


def _two_scans(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for k in range(20):
        shape = tuple(rng.integers(3, 12, 2))
        before, dug = rng.normal(size=shape), (-1) ** (k // 2) * rng.uniform(-0.2, 0.6, shape)
        variances = rng.uniform(2e-5, 4e-4, (2, *shape))
        cases.append((before, before - dug, *variances, rng.uniform(0.05, 0.3), 0.0))
        cases[-1] = (*cases[-1][:5], rng.uniform(0.002, 0.02))
    return cases


def _spoilt(change):
    """A deviation made in another way, beside the right volume."""

    def answer(before, after, var_before, var_after, cell, lift):
        value, _ = volume_with_deviation(before, after, var_before, var_after, cell, lift)
        n, variances = before.size, (var_before, var_after)
        return value, change(cell**2, n, variances, lift)

    return answer


VOLUME = Exercise(
    number="9.8",
    title="A volume and how sure it is",
    reference=volume_with_deviation,
    cases=_two_scans,
    oracle="a_weighted_sum_by_its_whole_covariance",
    mistakes={
        "cells are taken to err independently: a lifted scan lifts them all at once": _spoilt(
            lambda a, n, v, lift: a * sqrt(np.sum(v) + 2 * n * lift**2)
        ),
        "the lift is not used: a scan's pose errs too": _spoilt(
            lambda a, n, v, lift: a * sqrt(np.sum(v))
        ),
        "both scans are lifted, each by its own: the lift counts twice in the variance": _spoilt(
            lambda a, n, v, lift: a * sqrt(np.sum(v) + (n * lift) ** 2)
        ),
        "variances add up, deviations do not: square, add, then take the root": _spoilt(
            lambda a, n, v, lift: a * (sqrt(np.sum(v)) + sqrt(2) * n * lift)
        ),
        "cells' deviations are added: that holds for errors in common only": _spoilt(
            lambda a, n, v, lift: a * sqrt(np.sum(np.sqrt(v)) ** 2 + 2 * (n * lift) ** 2)
        ),
        "noise of a difference adds up as well: the variances of both scans count": _spoilt(
            lambda a, n, v, lift: a * sqrt(np.sum(v[0]) + 2 * (n * lift) ** 2)
        ),
        "that is the variance: take its root": _spoilt(
            lambda a, n, v, lift: a**2 * (np.sum(v) + 2 * (n * lift) ** 2)
        ),
        "heights are summed without the area of a cell, cell^2": (
            lambda b, a, v, w, cell, lift: volume_with_deviation(b, a, v, w, 1.0, lift)
        ),
        "the area of a cell is cell^2": (
            lambda b, a, v, w, cell, lift: volume_with_deviation(b, a, v, w, sqrt(cell), lift)
        ),
        "soil dug is positive: before less after": (
            lambda b, a, v, w, cell, lift: volume_with_deviation(a, b, v, w, cell, lift)
        ),
    },
    hints=(
        "One part for what each cell does by itself, one for what all do together; add squares.",
        "cell^4 (sum of both variances) + 2 (cell^2 n lift)^2 is the variance.",
    ),
    tested_on="20 pairs of scans of 9 to 121 cells",
)


def _grids(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(15):
        occupied = rng.uniform(size=tuple(rng.integers(4, 15, 2))) < rng.uniform(0.03, 0.3)
        occupied[tuple(rng.integers(0, 4, 2))] = True
        cases.append((occupied, rng.uniform(0.05, 0.5)))
    return cases


def _chamfer(metric):
    def answer(occupied, cell):
        from scipy.ndimage import distance_transform_cdt

        return cell * distance_transform_cdt(~np.asarray(occupied), metric).astype(float)

    return answer


DISTANCES = Exercise(
    number="9.9",
    title="A distance field",
    reference=distance_transform,
    cases=_grids,
    oracle="all_pairs_of_voxels",
    mistakes={
        "steps along the axes are counted: the straight way is shorter": _chamfer("taxicab"),
        "that is the larger of the two ways along the axes: take the straight one": _chamfer(
            "chessboard"
        ),
        "distances are in voxels: times the cell": lambda occupied, cell: distance_transform(
            occupied
        ),
        "that is the square of the distance": (
            lambda occupied, cell: distance_transform(occupied, cell) ** 2
        ),
        "that is the way to the nearest free voxel: ask for the nearest occupied one": (
            lambda occupied, cell: distance_transform(~occupied, cell)
        ),
        "only along one axis: sweep the rows, then the columns of what they gave": (
            lambda occupied, cell: np.stack(
                [distance_transform(r[None], cell)[0] for r in occupied]
            )
        ),
        "within an obstacle the distance is 0": (
            lambda occupied, cell: distance_transform(occupied, cell, signed=True)
        ),
    },
    hints=(
        "np.argwhere(occupied) lists the occupied voxels; compare each voxel with all of them.",
        "Squares add up: the least (j - k)^2 along each row, then the least of (i - l)^2 + that.",
    ),
    tested_on="15 grids of 4 to 14 voxels a side",
)

EXERCISES = (CELL, VOLUME, DISTANCES)
