"""Exercises of lesson 09a."""

from __future__ import annotations

from collections.abc import Callable
from math import pi, radians

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.perception import cloud

__all__ = ["EXERCISES"]


def _beams(rng: np.random.Generator) -> list[tuple]:
    """Ranges, beam angles and nods, and the pose of the laser's mount at each beam's time."""
    cases = []
    for n in (1, 6, 25, 25, 25):
        heading = rng.uniform(-3, 3) + np.cumsum(rng.uniform(0, 0.1, n))
        c, s, poses = np.cos(heading), np.sin(heading), np.tile(np.eye(4), (n, 1, 1))
        poses[:, 0, 0], poses[:, 0, 1], poses[:, 1, 0], poses[:, 1, 1] = c, -s, s, c
        poses[:, :3, 3] = rng.uniform(-3, 3, 3) + np.c_[1.5 * c, 1.5 * s, 0 * c]
        ranges, angle = rng.uniform(1, 20, n), rng.uniform(-1.2, 1.2, n)
        ranges[rng.random(n) < 0.15 * (n > 1)] = np.nan
        cases.append((ranges, angle, rng.uniform(-0.6, 1.0, n), poses))
    return cases


def place(ranges: NDArray, angle: NDArray, nod: NDArray, poses: NDArray) -> NDArray:
    """Points in the world of n beams, shape (n, 3) [m]."""
    ahead, left = ranges * np.cos(angle), ranges * np.sin(angle)
    beam = np.stack([ahead * np.cos(nod), left, -ahead * np.sin(nod)], axis=-1)
    return np.einsum("nij,nj->ni", poses[:, :3, :3], beam) + poses[:, :3, 3]


def _elevated(ranges: NDArray, angle: NDArray, nod: NDArray, poses: NDArray) -> NDArray:
    level = np.stack([np.cos(angle), np.sin(angle)], axis=-1) * np.cos(nod)[:, None]
    beam = ranges[:, None] * np.c_[level, -np.sin(nod)]
    return np.einsum("nij,nj->ni", poses[:, :3, :3], beam) + poses[:, :3, 3]


def _turned_only(ranges: NDArray, angle: NDArray, nod: NDArray, poses: NDArray) -> NDArray:
    return place(ranges, angle, nod, poses) - poses[:, :3, 3]


def _inverse(ranges: NDArray, angle: NDArray, nod: NDArray, poses: NDArray) -> NDArray:
    return place(ranges, angle, nod, np.linalg.inv(poses))


def _first(ranges: NDArray, angle: NDArray, nod: NDArray, poses: NDArray) -> NDArray:
    return place(ranges, angle, nod, np.broadcast_to(poses[0], poses.shape))


BEAMS = Exercise(
    number="9.1",
    title="One cloud in motion",
    reference=place,
    cases=_beams,
    oracle="undone_step_by_step",
    mistakes={
        "the nod turns upwards: a positive nod looks down, so z is minus the sine": (
            lambda r, a, n, T: place(r, a, -n, T)
        ),
        "the nod is used as an elevation: it turns the whole line about y, and y stays": _elevated,
        "every beam has the first beam's pose: the machine moved on, each has its own": _first,
        "the points are turned but not moved: add where the laser was": _turned_only,
        "the poses are inverted: T takes from the laser's axes to the world's": _inverse,
        "angles count to the left, towards +y": lambda r, a, n, T: place(r, -a, n, T),
        "the nod is left out: all lines lie in one plane": lambda r, a, n, T: place(r, a, 0 * n, T),
    },
    hints=(
        "In the line's own plane the point is r (cos a, sin a, 0); nod it about y, then use T.",
        "poses[:, :3, :3] @ beam[..., None] turns each beam with its own pose; [..., 0] after it.",
    ),
    tested_on="82 beams of a machine that turns, some of which met nothing",
)


def _scans(rng: np.random.Generator) -> list[tuple]:
    """Lines over a floor with things on it, and false points between; beams without an echo."""
    cases = []
    for lines, n in ((1, 12), (3, 40), (4, 60), (4, 60)):
        a = np.linspace(-0.6, 0.6, n) + np.zeros((lines, 1))
        down = np.linspace(0.3, 0.7, lines)[:, None]
        ranges = 3 / np.sin(down) / np.cos(a) + 0.02 * rng.standard_normal(a.shape)
        for line in ranges:
            first = rng.integers(1, n - 6)
            line[first : first + 4] = rng.uniform(2, 4) + 0.01 * rng.standard_normal(4)
            line[first + 4] = rng.uniform(4, 5)
        ranges[rng.random(a.shape) < 0.06] = np.nan
        ahead = np.stack([np.cos(a) * np.cos(down), np.sin(a), -np.cos(a) * np.sin(down)], axis=-1)
        origin = rng.uniform(-12, 3, 3)
        cases.append((origin + ranges[..., None] * ahead, origin))
    return cases


def _sides(points: NDArray, origin: NDArray) -> tuple[NDArray, NDArray]:
    return origin - points[..., :-1, :], np.diff(points, axis=-2)


def _angle(one: NDArray, other: NDArray) -> NDArray:
    lengths = np.linalg.norm(one, axis=-1) * np.linalg.norm(other, axis=-1)
    return np.arccos(np.clip(np.sum(one * other, axis=-1) / lengths, -1, 1))


def _at_the_laser(points: NDArray, origin: NDArray) -> NDArray:
    return _angle(points[..., :-1, :] - origin, points[..., 1:, :] - origin)


def _folded(points: NDArray, origin: NDArray) -> NDArray:
    return np.minimum(cloud.incidence(points, origin), pi - cloud.incidence(points, origin))


def _without_lengths(points: NDArray, origin: NDArray) -> NDArray:
    return np.arccos(np.clip(np.sum(np.prod(_sides(points, origin), axis=0), axis=-1), -1, 1))


def _at_the_second(points: NDArray, origin: NDArray) -> NDArray:
    return _angle(origin - points[..., 1:, :], np.diff(points, axis=-2))


INCIDENCE = Exercise(
    number="9.2",
    title="How steeply does the beam meet the surface?",
    reference=cloud.incidence,
    cases=_scans,
    oracle="by_the_law_of_cosines",
    rtol=1e-5,
    atol=1e-5,
    mistakes={
        "the ray goes back from the point to the laser: yours goes forth, that gives pi less it": (
            lambda points, origin: pi - cloud.incidence(points, origin)
        ),
        "that is the angle at the laser, between the beams: the same for all, it says nothing": (
            _at_the_laser
        ),
        "folded at a right angle: 10 and 170 degrees are two edges, one near, one far": _folded,
        "a cosine is the product divided by both lengths": _without_lengths,
        "the ray starts at the second point: take the first of each pair": _at_the_second,
        "measured from the surface's normal: the angle is between ray and surface": (
            lambda points, origin: pi / 2 - cloud.incidence(points, origin)
        ),
        "the origin is left out: the laser is not at 0, 0, 0": (
            lambda points, origin: cloud.incidence(points, 0 * origin)
        ),
    },
    hints=(
        "back = origin - points[..., :-1, :] and along = np.diff(points, axis=-2).",
        "The cosine is the sum of back * along over both lengths; np.linalg.norm(..., axis=-1).",
    ),
    tested_on="four scans with edges, false points and beams that met nothing",
)


def _with(**changed: float) -> Callable:
    return lambda points, origin: cloud.shadow_filter(points, origin, **changed)


def _one_end(points: NDArray, origin: NDArray, end: int) -> NDArray:
    angles = cloud.incidence(points, origin)
    keep = np.isfinite(points[..., 0])
    sharp = (angles < radians(10)) | (angles > radians(170))
    keep[..., end : keep.shape[-1] - 1 + end] &= ~sharp
    return keep


def _nothing_kept_too(points: NDArray, origin: NDArray) -> NDArray:
    return cloud.shadow_filter(points, origin) | np.isnan(points[..., 0])


FILTER = Exercise(
    number="9.3",
    title="A shadow filter for the machine",
    reference=cloud.shadow_filter,
    cases=_scans,
    oracle="pair_by_pair",
    mistakes={
        "the mask is inverted: True is a point to keep": (
            lambda points, origin: (
                ~cloud.shadow_filter(points, origin) & np.isfinite(points[..., 0])
            )
        ),
        "10 to 70 degrees throws away what faces the laser: 10 to 170": _with(most=radians(70)),
        "only the first end of a steep step goes: either may be the false one": (
            lambda points, origin: _one_end(points, origin, 0)
        ),
        "only the second end of a steep step goes: either may be the false one": (
            lambda points, origin: _one_end(points, origin, 1)
        ),
        "a beam that met nothing is kept: NaN compares as False, ask np.isfinite": (
            _nothing_kept_too
        ),
        "nothing is removed: are 10 and 170 in radians?": (
            lambda points, origin: np.isfinite(points[..., 0])
        ),
        "steps towards the laser are missed: angles above 170 degrees are edges, too": (
            _with(most=pi)
        ),
        "steps away from the laser are missed: angles below 10 degrees are edges, too": (
            _with(least=0.0)
        ),
    },
    hints=(
        "Start with keep = np.isfinite(points[..., 0]); sharp is True between two beams.",
        "keep[..., :-1] &= ~sharp takes the first end of each steep step away; what the other?",
    ),
    tested_on="four scans with edges, false points and beams that met nothing",
)

EXERCISES = (BEAMS, INCIDENCE, FILTER)
