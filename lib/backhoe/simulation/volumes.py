"""Convex volumes around the machine's links as they are drawn: what a self filter leaves out."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from backhoe.basics.inputs import instance, whole
from backhoe.machine import BACKHOE, Machine
from backhoe.perception.cloud import Convex, hull
from backhoe.view.appearance import visuals

THINNEST = 1e-3
"""A slice of a link that is flatter than this makes no volume; its neighbours touch it [m]."""


def link_volumes(
    machine: Machine = BACKHOE,
    slices: int = 8,
    links: tuple[str, ...] = ("boom", "stick", "bucket"),
) -> dict[str, tuple[Convex, ...]]:
    """Convex parts of links, the hulls of slices across their length: a bent boom in few pieces.

    Args:
        machine: whose.
        slices: of each link; more lie closer around it and take longer.
        links: which: "undercarriage", "swing", "boom", "stick", "bucket".

    Returns:
        What `perception.cloud.self_filter` takes: link -> parts in its frame, lengths in m.

    Raises:
        ValueError: fewer than one slice, or no such link.
        TypeError: machine is no Machine.
    """
    instance(machine, "machine", Machine)
    whole(slices, "slices", least=1)
    drawn = visuals(machine)
    if set(links) - set(drawn):
        raise ValueError(f"links must be among {', '.join(drawn)}, got {', '.join(links)}")
    return {link: _slices([(p.vertices, p.faces) for p in drawn[link]], slices) for link in links}


def _slices(parts: list[tuple[NDArray, NDArray]], count: int) -> tuple[Convex, ...]:
    """Hulls of what lies between neighbouring planes x = constant, of all meshes together."""
    starts, ends = (np.concatenate([v[f[:, k]] for v, f in parts for k in ks]) for ks in _EDGES)
    every = np.concatenate([starts, ends])
    planes = np.linspace(every[:, 0].min(), every[:, 0].max(), count + 1)
    found = []
    for low, high in pairwise(planes):
        inside = every[(every[:, 0] >= low) & (every[:, 0] <= high)]
        cuts = [_cut(starts, ends, x) for x in (low, high)]
        points = np.concatenate([inside, *cuts])
        if len(points) > 3 and np.ptp(points, axis=0).min() > THINNEST:
            found.append(hull(points))
    return tuple(found)


_EDGES = (0, 1, 2), (1, 2, 0)


def _cut(starts: NDArray, ends: NDArray, x: float) -> NDArray:
    """Where edges pass through the plane at x, shape (n, 3) [m]."""
    a, b = starts[:, 0], ends[:, 0]
    through = (a - x) * (b - x) < 0
    share = ((x - a[through]) / (b[through] - a[through]))[:, None]
    return starts[through] + share * (ends[through] - starts[through])
