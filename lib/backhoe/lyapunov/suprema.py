"""Largest values over postures: over given ones, over the joint box, or over all angles.

The largest value over a whole box or torus is searched on a grid, and from its best points uphill
by SciPy's L-BFGS-B. That proves nothing: the tests hold it against random search and against bounds
that follow from Lipschitz constants. Neither M nor g depends on the swing, which stays at 0.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.kinematics import joint_vector
from backhoe.lyapunov.bilinear import bilinear_norm, bilinear_value, unfolded_bound
from backhoe.machine import BACKHOE, Machine

__all__ = ["DOMAINS", "Domain", "Peak", "climb", "domain_of", "largest_norm", "peaks", "supremum"]

DOMAINS = ("box", "torus")
_CELLS = {"box": 13, "torus": 16}
_STARTS = 6
_STEP = 1e-5
_TILE = 512


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
    if name not in DOMAINS:
        raise ValueError(f'domain must be "box" or "torus", got {name!r}: give postures as q')
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
    if domain.name == "postures":
        best = int(np.argmax(values))
        return Peak(float(values[best]), domain.q[best])
    tops = (climb(f, domain.q[i], domain) for i in peaks(values, domain))
    value, posture = max(tops, key=lambda top: top[0])
    return Peak(value, posture)


def largest_norm(B: Callable[[NDArray], NDArray], domain: Domain) -> Peak:
    """Largest norm of a bilinear map over the domain.

    Args:
        B: from postures (n, 4) to symmetric matrices (n, m, 4, 4), as for `bilinear_norm`.
        domain: where. Of its points only those are searched where a cheap bound leaves hope.
    """
    maps = B(domain.q)
    bound = unfolded_bound(maps)
    norm, vector = np.zeros(len(bound)), np.zeros((len(bound), 4))
    order = np.argsort(bound)[::-1]
    for start in range(0, len(order), _TILE):
        rows = order[start : start + _TILE]
        if bound[rows[0]] <= norm.max():
            break
        norm[rows], vector[rows] = bilinear_norm(maps[rows])
    best = int(np.argmax(norm))
    if domain.name == "postures":
        return Peak(float(norm[best]), domain.q[best])

    def size(rows: NDArray) -> NDArray:
        length = np.linalg.norm(rows[:, 4:], axis=-1)
        return np.linalg.norm(bilinear_value(B(rows[:, :4]), rows[:, 4:]), axis=-1) / length**2

    starts = [np.concatenate([domain.q[i], vector[i]]) for i in peaks(norm, domain)]
    value, row = max((climb(size, start, domain) for start in starts), key=lambda top: top[0])
    return Peak(value, row[:4])


def peaks(values: NDArray, domain: Domain, count: int = _STARTS) -> list[int]:
    """Indices of the highest points of the grid that are not neighbours of each other."""
    cell = (domain.upper - domain.lower)[1:] / (_CELLS[domain.name] - 1)
    chosen: list[int] = []
    for i in np.argsort(values)[::-1]:
        apart = np.abs(domain.q[i, 1:] - domain.q[chosen, 1:]) / cell
        if (apart.max(axis=-1) > 1.5).all():
            chosen.append(int(i))
        if len(chosen) == count:
            break
    return chosen


def climb(f: Callable[[NDArray], NDArray], start: NDArray, domain: Domain) -> tuple[float, NDArray]:
    """The top that is reached from `start` uphill, its posture kept within a box.

    Args:
        f: from rows (n, m) to values (n,); the first four of a row are a posture, the rest is free.
        start: a row, shape (m,), where f is positive.
        domain: box or torus.

    Returns:
        The value and the row.
    """
    from scipy.optimize import minimize

    start = np.asarray(start, dtype=float)
    size = len(start)
    steps = _STEP * np.vstack([np.eye(size)[1:], -np.eye(size)[1:]])
    scale = abs(float(f(start[None])[0])) or 1.0

    def downhill(free: NDArray) -> tuple[float, NDArray]:
        x = np.concatenate([[start[0]], free])
        here, *around = f(np.vstack([x, x + steps])) / -scale
        ahead, behind = np.split(np.array(around), 2)
        return here, (ahead - behind) / (2 * _STEP)

    sides = [(None, None)] * (size - 1)
    if domain.name == "box":
        sides[:3] = zip(domain.lower[1:], domain.upper[1:], strict=True)
    found = minimize(
        downhill,
        start[1:],
        jac=True,
        method="L-BFGS-B",
        bounds=sides,
        options={"ftol": 1e-15, "gtol": 1e-10},
    )
    return -float(found.fun) * scale, np.concatenate([[start[0]], found.x])
