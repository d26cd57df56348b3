"""The exact shortest way in the plane among discs and convex polygons.

A rubber band consists of straight pieces that touch what they pass and arcs along discs. So the
shortest way is in a finite graph: all common tangents of start, goal, discs and corners (points are
discs of radius 0), and the arcs between their ends. What is not free leaves it; Dijkstra finds the
rest. Whether a piece is free is decided between the places where it crosses an edge, so nothing
depends on a resolution.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import instance, number, numbers, real_numbers
from backhoe.planning.search.checker import NoPath
from backhoe.planning.search.grid import best_first

TOUCH = 1e-9
"""How deep a piece may reach into an obstacle and still touch it, as a share of the size of all."""


class Shortest(NamedTuple):
    """The shortest way: its exact length [m], and places along it, shape (n, 2) [m]; arcs are drawn
    by chords of a degree."""

    length: float
    path: NDArray


def tangent(
    start: ArrayLike,
    goal: ArrayLike,
    discs: ArrayLike = (),
    polygons: Sequence[ArrayLike] = (),
) -> Shortest:
    """The shortest way from start to goal that enters no obstacle; it may touch them.

    Args:
        start, goal: shape (2,) [m].
        discs: middles and radii, shape (m, 3) [m]; they may overlap each other and polygons.
        polygons: corners of convex polygons in order, shape (k, 2) each [m].

    Raises:
        ValueError: shapes, a radius that is not above 0, a polygon that is not convex, a start or
            goal inside an obstacle.
        NoPath: obstacles shut the start or the goal in.
    """
    ends = np.vstack(
        [numbers(start, "start", (2,), within=1e9), numbers(goal, "goal", (2,), within=1e9)]
    )
    discs = real_numbers(discs, "discs")
    if discs.size:
        discs = numbers(discs, "discs", ("m", 3), meaning="middles and radii [m]", within=1e9)
    discs = discs.reshape(-1, 3)
    instance(polygons, "polygons", (list, tuple))
    number(discs[:, 2].min(initial=1.0), "least radius of discs", "m", above=0.0)
    polygons = [_convex(corners, f"polygons[{k}]") for k, corners in enumerate(polygons)]
    points = np.vstack([ends, *polygons])
    deep = TOUCH * max(np.ptp(np.vstack([points, discs[:, :2]])), discs[:, 2].max(initial=0.0))
    yard = _Yard(discs, [_half_planes(corners) for corners in polygons], deep)
    for name, place in zip(("start", "goal"), ends, strict=True):
        if yard.inside(place[None])[0]:
            raise ValueError(f"{name} must be free, {place} is inside an obstacle")
    circles = np.vstack([np.column_stack([points, np.zeros(len(points))]), discs])
    segments = _tangents(circles)
    on = {k: [] for k in range(len(circles))}
    places, joined = [], {}

    def place(circle: int, at: NDArray) -> int:
        if circles[circle, 2] == 0.0 and on[circle]:
            return on[circle][0]
        on[circle].append(len(places))
        joined[len(places)] = []
        places.append(at)
        return len(places) - 1

    def join(i: int, j: int, length: float, middle: tuple | None = None) -> None:
        joined[i].append((j, length))
        joined[j].append((i, length))
        if middle and ((i, j) not in arcs or length < arcs[i, j][-1]):
            arcs[i, j] = arcs[j, i] = (*middle, length)

    arcs: dict = {}
    first, last = place(0, ends[0]), place(1, ends[1])
    for i, a, j, b in segments:
        if yard.segment_free(a, b):
            join(place(i, a), place(j, b), float(np.linalg.norm(b - a)))
    for k in range(len(points), len(circles)):
        x, y, r = circles[k]
        around = np.array([places[i] for i in on[k]]).reshape(-1, 2) - (x, y)
        angles = np.arctan2(around[:, 1], around[:, 0])
        order = np.argsort(angles)
        for one, other in zip(order, np.roll(order, -1), strict=True):
            turn = (angles[other] - angles[one]) % (2 * np.pi)
            if len(order) > 1 and yard.arc_free(circles[k], angles[one], turn):
                join(on[k][one], on[k][other], r * turn, (k, angles[one], turn, on[k][one]))
    try:
        nodes, length, _ = best_first(first, last, joined.__getitem__)
    except NoPath:
        raise NoPath("no way from start to goal: obstacles shut one of them in") from None
    path = [places[nodes[0]]]
    for i, j in pairwise(nodes):
        if (i, j) in arcs:
            k, angle, turn, begins, _ = arcs[i, j]
            steps = np.linspace(0, turn, 2 + int(np.degrees(turn)))[1:-1]
            along = angle + (steps if begins == i else steps[::-1])
            path += list(circles[k, :2] + circles[k, 2] * np.c_[np.cos(along), np.sin(along)])
        path.append(places[j])
    return Shortest(float(length), np.array(path))


class _Yard:
    """Obstacles, and which pieces are free of them."""

    def __init__(self, discs: NDArray, polygons: list[tuple[NDArray, NDArray]], deep: float):
        self.discs, self.polygons, self.deep = discs, polygons, deep

    def inside(self, at: NDArray) -> NDArray:
        """Of places (n, 2), whether they are deeper in an obstacle than a touch."""
        apart = np.linalg.norm(at[:, None] - self.discs[:, :2], axis=-1)
        found = (apart < self.discs[:, 2] - self.deep).any(axis=1)
        for normals, offsets in self.polygons:
            found |= (at @ normals.T < offsets - self.deep).all(axis=1)
        return found

    def segment_free(self, a: NDArray, b: NDArray) -> bool:
        """Cut at all crossings of circles and of polygons' lines; no piece's middle is inside."""
        way = b - a
        square = way @ way
        if square == 0.0:
            return True
        cuts = [0.0, 1.0]
        from_a = a - self.discs[:, :2]
        half, rest = from_a @ way / square, (from_a**2).sum(axis=1) - self.discs[:, 2] ** 2
        root = half**2 - rest / square
        crossed = root > 0
        for sign in (-1, 1):
            cuts += (-half[crossed] + sign * np.sqrt(root[crossed])).tolist()
        for normals, offsets in self.polygons:
            steep = normals @ way
            level = steep != 0
            cuts += ((offsets - normals @ a)[level] / steep[level]).tolist()
        cuts = np.unique(np.clip(cuts, 0.0, 1.0))
        middles = (cuts[1:] + cuts[:-1]) / 2
        return not self.inside(a + middles[:, None] * way).any()

    def arc_free(self, circle: NDArray, angle: float, turn: float) -> bool:
        """The same along an arc, from an angle on."""
        middle, r = circle[:2], circle[2]
        lines = [
            (np.arctan2(n[1], n[0]), (offset - n @ middle) / r)
            for normals, offsets in self.polygons
            for n, offset in zip(normals, offsets, strict=True)
        ]
        for x, y, other in self.discs:
            d = np.hypot(x - middle[0], y - middle[1])
            if d > 0:
                share = (r * r + d * d - other * other) / (2 * r * d)
                lines.append((np.arctan2(y - middle[1], x - middle[0]), share))
        cuts = [0.0, turn]
        for towards, share in lines:  # r cos(angle - towards) = share r
            if abs(share) < 1:
                for sign in (-1, 1):
                    cuts.append((towards + sign * np.arccos(share) - angle) % (2 * np.pi))
        cuts = np.unique(np.clip(cuts, 0.0, turn))
        at = angle + (cuts[1:] + cuts[:-1]) / 2
        return not self.inside(middle + r * np.c_[np.cos(at), np.sin(at)]).any()


def _tangents(circles: NDArray) -> list[tuple[int, NDArray, int, NDArray]]:
    """Common tangents of all pairs of circles (n, 3), a radius may be 0: circle, place, and again.

    Both places lie in the direction of a normal n or against it: (b - a) . n = s r_a - t r_b with
    the sides s, t; a point has one place for both.
    """
    found = []
    for i in range(len(circles)):
        for j in range(i + 1, len(circles)):
            (a, ra), (b, rb) = ((circles[k, :2], circles[k, 2]) for k in (i, j))
            apart = float(np.linalg.norm(b - a))
            sides = [(s, t) for s in ((1, -1) if ra else (1,)) for t in ((1, -1) if rb else (1,))]
            for s, t in sides:
                share = (s * ra - t * rb) / apart if apart > 0 else 2.0 * (ra + rb > 0)
                if abs(share) > 1:
                    continue
                turn, towards = np.arccos(share), np.arctan2(*(b - a)[::-1])
                n = np.array([np.cos(towards + turn), np.sin(towards + turn)])
                found.append((i, a + s * ra * n, j, b + t * rb * n))
    return found


def _convex(corners: ArrayLike, name: str) -> NDArray:
    corners = numbers(
        corners, name, ("k", 2), meaning="corners of a convex polygon [m]", within=1e9
    )
    edges = np.roll(corners, -1, axis=0) - corners
    after = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0]
    whole_turn = np.arctan2(turns, (edges * after).sum(axis=1)).sum() / (2 * np.pi)
    if len(corners) < 3 or not ((turns > 0).all() or (turns < 0).all()) or abs(whole_turn) > 1.5:
        raise ValueError(
            f"{name} must be convex, 3 or more corners in order, got {corners.tolist()}"
        )
    return corners if turns[0] > 0 else corners[::-1]


def _half_planes(corners: NDArray) -> tuple[NDArray, NDArray]:
    """Outward normals (k, 2) and offsets (k,) of a polygon that turns left: inside is n . x < c."""
    edges = np.roll(corners, -1, axis=0) - corners
    normals = np.column_stack([edges[:, 1], -edges[:, 0]])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return normals, (normals * corners).sum(axis=1)
