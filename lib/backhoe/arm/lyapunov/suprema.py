"""Largest values over postures: over given ones, over the joint box, or over all angles.

The largest value over a whole box or torus is searched on a grid, and from its best points uphill
on ever finer stencils. That proves nothing: the tests hold it against SciPy, random search and
bounds from above. Of two summits less than a cell apart the lower may be taken; the cases known
differ by less than a millionth. Neither M nor g depends on the swing, which stays at 0.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.kinematics import joint_vector
from backhoe.arm.lyapunov.bilinear import bilinear_norm, by_turns, unfolded_bound, widest
from backhoe.basics.inputs import choice
from backhoe.machine import BACKHOE, Machine

DOMAINS = ("box", "torus")
_CELLS = {"box": 13, "torus": 16}
_EACH, _LOOKED_AT = 4, 100
_TILE, _ROUGHLY = 512, 0.95
_FINEST, _GAIN, _ROUNDS, _FARTHEST = 1e-6, 1e-12, 300, 5.0
_STENCIL = np.array(list(product((-1.0, 0.0, 1.0), repeat=3)))

Parts = Callable[[NDArray], tuple[NDArray, NDArray]]


class Domain(NamedTuple):
    """A set of postures: `name` "box", "torus" or "postures"; `q` (n, 4) [rad] are the given ones,
    or the points of a grid over boom, stick and bucket; `lower`, `upper` (4,) [rad] its sides."""

    name: str
    q: NDArray
    lower: NDArray | None
    upper: NDArray | None


class Peak(NamedTuple):
    """A largest value and the posture (4,) [rad] that has it."""

    value: float
    posture: NDArray


def domain_of(q: ArrayLike | None = None, name: str = "box", machine: Machine = BACKHOE) -> Domain:
    """The set of postures that a caller means.

    Args:
        q: postures, shape (..., 4) [rad]; None for a whole domain.
        name: "box" (within the joint limits) or "torus" (all angles), when q is None.
        machine: whose joint limits.

    Raises:
        ValueError: no posture at all, not 4 joints, not finite, or an unknown name.
    """
    if q is not None:
        q = joint_vector(q).reshape(-1, 4)
        if not len(q):
            raise ValueError("q must hold at least one posture, got none")
        return Domain("postures", q, None, None)
    choice(name, "domain", DOMAINS)
    turn = np.array([0.0, np.pi, np.pi, np.pi])
    lower, upper = (machine.lower, machine.upper) if name == "box" else (-turn, turn)
    axes = [
        np.linspace(low, high, _CELLS[name], endpoint=name == "box")
        for low, high in zip(lower[1:], upper[1:], strict=True)
    ]
    arm = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return Domain(name, np.pad(arm, ((0, 0), (1, 0))), lower, upper)


def supremum(f: Callable[[NDArray], NDArray], domain: Domain) -> Peak:
    """Largest value of f over the domain.

    Args:
        f: from postures (n, 4) to values (n,); continuous.
        domain: where.
    """
    values = f(domain.q)
    best = int(np.argmax(values))
    if domain.name == "postures":
        return Peak(float(values[best]), domain.q[best])
    nothing = np.zeros((len(values), 0))
    return _climb(lambda q, x: (f(q), x), values, nothing, domain)


def largest_norm(B: Callable[[NDArray], NDArray], domain: Domain) -> Peak:
    """Largest norm of a bilinear map over the domain.

    Args:
        B: from postures (n, 4) to symmetric matrices (n, m, 4, 4), as for `bilinear_norm`.
        domain: where. Of its points only those are searched where a cheap bound leaves hope.
    """
    maps = B(domain.q)
    bound = unfolded_bound(maps)
    norm, vector = np.zeros(len(bound)), np.zeros((len(bound), 4))

    def measure(rows: NDArray) -> None:
        norm[rows], vector[rows] = bilinear_norm(maps[rows])

    highest = np.argsort(bound)[::-1][:_TILE]
    measure(highest)
    hopeful = np.flatnonzero((bound > norm.max()) & (norm == 0))
    about, _ = widest(np.zeros((4, 4)), maps[hopeful])
    measure(hopeful[about > _ROUGHLY * max(norm.max(), about.max(initial=0.0))])
    best = int(np.argmax(norm))
    if domain.name == "postures":
        return Peak(float(norm[best]), domain.q[best])

    def follow(q: NDArray, x: NDArray) -> tuple[NDArray, NDArray]:
        return by_turns(np.zeros((4, 4)), B(q), x, turns=2)

    return _climb(follow, norm, vector, domain)


def heaviest(parts: Parts, domain: Domain) -> Peak:
    """Largest x^T A x + ||B(x, x)|| over unit x and the domain.

    Args:
        parts: from postures (n, 4) to A (n, 4, 4), positive semidefinite, and B (n, m, 4, 4).
        domain: where.
    """
    values, vectors = widest(*parts(domain.q))
    best = int(np.argmax(values))
    if domain.name == "postures":
        return Peak(float(values[best]), domain.q[best])

    def follow(q: NDArray, x: NDArray) -> tuple[NDArray, NDArray]:
        return by_turns(*parts(q), x, turns=2)

    return _climb(follow, values, vectors, domain)


def _climb(follow: Callable, values: NDArray, vectors: NDArray, domain: Domain) -> Peak:
    """The highest top reached uphill from the best points of the grid.

    Args:
        follow: from postures and a vector for each to values and the vectors changed for the
            better; it may be anything that belongs to a posture.
        values, vectors: what is known on the grid.
    """
    starts = _starts(values, domain)
    q, x, height = domain.q[starts], vectors[starts], values[starts]
    step, row = np.tile(_cell(domain), (len(starts), 1)), np.arange(len(starts))
    leap = np.zeros((len(starts), 3))
    for _ in range(_ROUNDS):
        moves = np.concatenate([np.tile(_STENCIL, (len(q), 1, 1)), leap[:, None]], axis=1)
        tried = q[:, None] + np.pad(moves * step[:, None], ((0, 0), (0, 0), (1, 0)))
        if domain.name == "box":
            tried = np.clip(tried, domain.lower, domain.upper)
        found, followed = follow(tried.reshape(-1, 4), np.repeat(x, moves.shape[1], axis=0))
        found = found.reshape(len(q), -1)
        followed = followed.reshape(*found.shape, x.shape[-1])
        best = found.argmax(axis=-1)
        leap = _leap(((tried - q[:, None])[:, :, 1:] / step[:, None])[:, :-1], found[:, :-1])
        leap -= ((tried[row, best] - q)[:, 1:]) / step
        higher = found[row, best] > height
        flat = found[row, best] <= height * (1 + _GAIN)
        q[higher], x[higher] = tried[row, best][higher], followed[row, best][higher]
        height = np.maximum(height, found[row, best])
        step[flat], leap[flat] = step[flat] * 0.4, leap[flat] / 0.4
        if step.max() < _FINEST:
            break
    top = int(np.argmax(height))
    return Peak(float(height[top]), q[top])


def _leap(moves: NDArray, values: NDArray) -> NDArray:
    """Where the parabola through the stencil has its top, at most a few steps away, (s, 3).

    Without it, a narrow ridge askew to the axes takes very many steps.

    Args:
        moves: points tried, in steps from the middle, shape (s, 27, 3).
        values: theirs, shape (s, 27).
    """
    i, j = np.triu_indices(3)
    one = np.ones((*values.shape, 1))
    fit = np.linalg.pinv(np.concatenate([one, moves, moves[..., i] * moves[..., j]], axis=-1))
    shape = (fit @ values[..., None])[..., 0]
    slope, curved = shape[:, 1:4], np.zeros((len(values), 3, 3))
    curved[:, i, j] += shape[:, 4:]
    curved[:, j, i] += shape[:, 4:]
    bend, axes = np.linalg.eigh(curved)
    bend = np.maximum(np.abs(bend), 1e-9 * np.abs(bend).max(axis=-1, keepdims=True) + 1e-300)
    leap = (axes @ ((np.swapaxes(axes, -1, -2) @ slope[..., None])[..., 0] / bend)[..., None])[
        ..., 0
    ]
    return leap * np.minimum(1, _FARTHEST / np.maximum(np.abs(leap).max(axis=-1), 1e-300))[:, None]


def _starts(values: NDArray, domain: Domain) -> list[int]:
    """Indices of the grid's highest points, and of the highest that no neighbour exceeds."""
    grid = values.reshape((_CELLS[domain.name],) * 3)
    edge = {"mode": "wrap"} if domain.name == "torus" else {"constant_values": -np.inf}
    around = sliding_window_view(np.pad(grid, 1, **edge), (3, 3, 3)).max(axis=(-3, -2, -1))
    order = np.argsort(values)[::-1]
    tops = order[values[order] == around.ravel()[order]]
    chosen = _without_repetitions(tops, values, domain) + _without_repetitions(
        order, values, domain
    )
    return sorted(set(chosen))


def _without_repetitions(order: NDArray, values: NDArray, domain: Domain) -> list[int]:
    """The first few of `order`; what one joint does not change is the same all along it."""
    chosen: list[int] = []
    for i in order[:_LOOKED_AT]:
        same = np.abs(values[i] - values[chosen]) <= 1e-9 * abs(values[i])
        beside = (domain.q[i] != domain.q[chosen]).sum(axis=-1) == 1
        if not (same & beside).any():
            chosen.append(int(i))
        if len(chosen) == _EACH:
            break
    return chosen


def _cell(domain: Domain) -> NDArray:
    """Sides of a cell of the grid, (3,) [rad]."""
    cells = _CELLS[domain.name] - (domain.name == "box")
    return (domain.upper - domain.lower)[1:] / cells
