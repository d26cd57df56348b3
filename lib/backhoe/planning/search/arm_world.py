"""What a way of the arm must not touch: boxes, the ground, the machine itself, its joints' ends.

Boom, stick and bucket are a few spheres each, which hold all of their meshes: a way that is free
for the spheres is free for the machine. Distances to boxes are exact outside of them. Over the
ground a sphere at the height h above a surface with slopes up to L is h / sqrt(1 + L^2) away from
it or further, so that a map of heights needs no search. All in the base frame: x forward, y left,
z up, as in `arm.kinematics`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.kinematics import link_transforms
from backhoe.basics.inputs import (
    instance,
    not_negative,
    number,
    numbers,
    positive,
    real_numbers,
    short,
    whole,
)
from backhoe.machine import BACKHOE, JOINTS, Machine
from backhoe.planning.search.arm_loops import World

HELD_OFF = ("stick", "bucket")
"""Links that could meet the machine's own body; the boom is fastened to it."""

TILE = 2048
"""Postures that are looked at in one go."""


class Relief(NamedTuple):
    """Heights of the ground, shape (rows, columns), `corner` (x, y) the first, `cell` apart [m]."""

    heights: NDArray
    corner: tuple[float, float]
    cell: float


class ArmWorld:
    """Spheres of the arm among what stands around it.

    Args:
        spheres: of "boom", "stick" and "bucket" in their frames, shape (k, 4) each: middle and
            radius [m].
        boxes: lower and upper corners in the base frame, shape (b, 2, 3) [m].
        balls: round obstacles in the base frame, middle and radius, shape (m, 4) [m].
        relief: heights of the ground, or None for level ground at z = 0. Beyond its border the
            ground goes on as high as there.
        own: boxes of the machine itself, shape (b, 2, 3) each [m]: "undercarriage" in the base
            frame and "swing" in the frame that turns with the house. Stick and bucket are held off.
        margin: what `is_free` keeps from all of them [m].
        machine: whose arm it is.

    Attributes:
        lower, upper: the joints' limits, shape (4,) [rad].
        numbers: all of it as arrays, for `engine`'s loops.

    Raises:
        ValueError: other links, shapes, a value that is not finite, a box with its corners the
            wrong way round, a negative radius or margin, heights that are unknown (NaN).
        TypeError: spheres or own are no mapping, machine is no Machine.
    """

    def __init__(
        self,
        spheres: Mapping[str, ArrayLike],
        boxes: ArrayLike = (),
        *,
        balls: ArrayLike = (),
        relief: Relief | None = None,
        own: Mapping[str, ArrayLike] | None = None,
        margin: float = 0.0,
        machine: Machine = BACKHOE,
    ) -> None:
        self.machine = instance(machine, "machine", Machine)
        instance(spheres, "spheres", Mapping)
        if set(spheres) != set(JOINTS[1:]):
            raise ValueError(
                f"spheres must have {', '.join(JOINTS[1:])}, got {short(list(spheres))}"
            )
        held = [_balls(spheres[link], f"spheres of {link}") for link in JOINTS[1:]]
        self._link = np.repeat(np.arange(3), [len(some) for some in held])
        self._middles, self._radii = np.split(np.concatenate(held), [3], axis=1)
        self._radii = self._radii[:, 0]
        self._boxes = _boxes(boxes, "boxes")
        some = real_numbers(balls, "balls").size
        self._balls = _balls(balls, "balls") if some else np.empty((0, 4))
        own = instance({} if own is None else own, "own", Mapping)
        if not set(own) <= {"undercarriage", "swing"}:
            raise ValueError(f"own may have undercarriage and swing, got {short(list(own))}")
        self._under = _boxes(own.get("undercarriage", ()), "own undercarriage")
        self._house = _boxes(own.get("swing", ()), "own swing")
        self._held_off = np.isin(self._link, [JOINTS[1:].index(link) for link in HELD_OFF])
        self._relief, self._steep = _checked(relief)
        self.margin = not_negative(margin, "margin", "m")
        self.lower, self.upper = machine.lower, machine.upper
        self.numbers = self._for_loops()

    def middles(self, q: ArrayLike) -> NDArray:
        """Where the spheres' middles are, shape (..., spheres, 3) [m].

        Args:
            q: joint angles, shape (..., 4) [rad].
        """
        T = link_transforms(q, self.machine)[..., 1:, :, :][..., self._link, :, :]
        return np.einsum("...ij,...j->...i", T[..., :3, :3], self._middles) + T[..., :3, 3]

    def clearance(self, q: ArrayLike) -> NDArray:
        """Least gap between the arm's spheres and all the rest, shape (...) [m].

        Never more than the true gap of the meshes; below 0 where a sphere touches. Inside of a box
        it is minus the radius.

        Args:
            q: joint angles, shape (..., 4) [rad].

        Raises:
            ValueError: the last axis is not 4, or a value is not finite.
        """
        q = numbers(q, "q", (..., 4), meaning="joints (swing, boom, stick, bucket)")
        flat = q.reshape(-1, 4)
        gaps = [self._gap(flat[k : k + TILE]) for k in range(0, len(flat), TILE)]
        return np.concatenate(gaps or [np.empty(0)]).reshape(q.shape[:-1])

    def is_free(self, q: ArrayLike) -> NDArray:
        """Whether the joints are within their limits and the clearance at least `margin`.

        Args:
            q: joint angles, shape (..., 4) [rad].

        Returns:
            Truth values, shape (...).

        Raises:
            ValueError: as `clearance`.
        """
        from backhoe.planning.search import engine

        q = numbers(q, "q", (..., 4), meaning="joints (swing, boom, stick, bucket)")
        flat = np.ascontiguousarray(q.reshape(-1, 4))
        return engine.all_free(self.numbers, flat).reshape(q.shape[:-1])

    def _gap(self, q: NDArray) -> NDArray:
        """Clearance of postures (n, 4), shape (n,) [m]."""
        points = self.middles(q)
        gap = (points[..., 2] - self._ground(points)) / np.sqrt(1 + self._steep**2)
        gap = np.minimum(gap, _to_boxes(points, self._boxes))
        for ball in self._balls:
            gap = np.minimum(gap, np.linalg.norm(points - ball[:3], axis=-1) - ball[3])
        off = self._held_off
        gap[:, off] = np.minimum(gap[:, off], _to_boxes(points[:, off], self._under))
        if len(self._house):
            T = link_transforms(q, self.machine)[:, 0]
            turned = np.einsum("nji,nkj->nki", T[:, :3, :3], points[:, off] - T[:, None, :3, 3])
            gap[:, off] = np.minimum(gap[:, off], _to_boxes(turned, self._house))
        return (gap - self._radii).min(axis=1)

    def _for_loops(self) -> World:
        base, swing, links = self.machine.base, self.machine.swing, self.machine.links
        hinge = [base.offset, swing.offset, base.height + swing.height]
        sizes = [link.length for link in links] + [link.angle_offset for link in links]
        relief = self._relief or Relief(np.zeros((2, 2)), (0.0, 0.0), 1.0)
        kinds = (self._boxes, self._under, self._house)
        flat = (1 + self._steep**2) ** -0.5
        return World(
            arm=np.array(hinge + sizes),
            limits=np.vstack([self.lower, self.upper]),
            spheres=np.column_stack(
                [self._link, self._held_off, self._middles, self._radii + self.margin]
            ),
            balls=self._balls,
            boxes=np.vstack(
                [np.c_[np.full(len(some), k), some.reshape(-1, 6)] for k, some in enumerate(kinds)]
            ),
            heights=relief.heights,
            place=np.array([*relief.corner, relief.cell, flat, relief.heights.max()]),
            asked=np.zeros(1, np.int64),
        )

    def _ground(self, points: NDArray) -> NDArray:
        """Height of the ground under points (..., 3), bilinear [m]."""
        if self._relief is None:
            return np.zeros(points.shape[:-1])
        heights, corner, cell = self._relief
        last = np.array(heights.shape[::-1]) - 1
        at = np.clip((points[..., :2] - corner) / cell, 0, last)
        i = np.minimum(at.astype(int), last - 1)
        (x, y), (j, k) = np.moveaxis(at - i, -1, 0), np.moveaxis(i, -1, 0)
        near = heights[k, j] * (1 - x) + heights[k, j + 1] * x
        return near * (1 - y) + y * (heights[k + 1, j] * (1 - x) + heights[k + 1, j + 1] * x)


def few_spheres(spheres: ArrayLike, count: int) -> NDArray:
    """At most so many spheres that hold all the given ones.

    The first middles lie as far apart as can be (Gonzalez 1985); then the given spheres go to the
    nearest one, and each middle moves to the centre of what it holds, in turns.

    Args:
        spheres: middles and radii, shape (k, 4) [m]: `covering_spheres` of a mesh.
        count: how many at most, 1 or more.

    Returns:
        Middles and radii, shape (count or fewer, 4) [m].

    Raises:
        ValueError: another shape, a negative radius, a count below 1.
    """
    balls = _balls(spheres, "spheres")
    middles, radii = balls[:, :3], balls[:, 3]
    chosen = middles.mean(axis=0)[None]
    chosen = middles[[_gaps(middles, radii, chosen).min(axis=1).argmax()]]
    for _ in range(min(whole(count, "count", least=1), len(balls)) - 1):
        far = _gaps(middles, radii, chosen).min(axis=1).argmax()
        chosen = np.vstack([chosen, middles[far]])
    best = None
    for _ in range(30):
        which = _gaps(middles, radii, chosen).argmin(axis=1)
        held = [_around(balls[which == k]) for k in np.unique(which)]
        chosen = np.array(held)[:, :3]
        if best is None or max(ball[3] for ball in held) < best[:, 3].max():
            best = np.array(held)
    return best


def _gaps(middles: NDArray, radii: NDArray, chosen: NDArray) -> NDArray:
    """How large each chosen middle's sphere has to be to hold each given one, (k, chosen) [m]."""
    return np.linalg.norm(middles[:, None] - chosen, axis=-1) + radii[:, None]


def _around(balls: NDArray) -> NDArray:
    """A sphere (4,) around spheres (k, 4), nearly the least (Badoiu and Clarkson 2003)."""
    middle = balls[:, :3].mean(axis=0)
    for step in range(1, 60):
        away = balls[:, :3] - middle
        far = (np.linalg.norm(away, axis=1) + balls[:, 3]).argmax()
        middle = middle + away[far] / (step + 1)
    return np.r_[middle, (np.linalg.norm(balls[:, :3] - middle, axis=1) + balls[:, 3]).max()]


def _balls(given: ArrayLike, name: str) -> NDArray:
    balls = numbers(given, name, ("k", 4), meaning="middle and radius [m]")
    number(balls[:, 3].min(), f"the least radius of {name}", "m", least=0.0)
    return balls


def _boxes(given: ArrayLike, name: str) -> NDArray:
    if real_numbers(given, name, "boxes").size == 0:
        return np.empty((0, 2, 3))
    boxes = numbers(given, name, ("b", 2, 3), meaning="lower and upper corners [m]")
    if (boxes[:, 0] > boxes[:, 1]).any():
        raise ValueError(f"{name} must have the lower corner first, got {short(boxes.tolist())}")
    return boxes


def _checked(relief: Relief | None) -> tuple[Relief | None, float]:
    """The relief, and the steepest that it gets [1]."""
    if relief is None:
        return None, 0.0
    relief = instance(relief, "relief", Relief)
    heights = numbers(relief.heights, "relief.heights", ("rows", "columns"), meaning="heights [m]")
    whole(min(heights.shape), "rows and columns of relief.heights", least=2)
    corner = numbers(relief.corner, "relief.corner", (2,), meaning="x, y [m]")
    cell = positive(relief.cell, "relief.cell", "m")
    steep = np.hypot(*(np.abs(np.diff(heights, axis=axis)).max() / cell for axis in (0, 1)))
    return Relief(heights, corner, cell), float(steep)


def _to_boxes(points: NDArray, boxes: NDArray) -> NDArray:
    """Distance of points (..., 3) to the nearest of boxes (b, 2, 3), shape (...) [m]."""
    nearest = np.full(points.shape[:-1], np.inf)
    for low, high in boxes:
        out = np.maximum(np.maximum(low - points, points - high), 0.0)
        nearest = np.minimum(nearest, np.sqrt((out**2).sum(axis=-1)))
    return nearest
