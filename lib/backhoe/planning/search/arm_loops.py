"""The checker of `arm_world` posture by posture in plain Python; `engine` has it compiled."""

from __future__ import annotations

from math import ceil, cos, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class World(NamedTuple):
    """What the loops get of an `ArmWorld`, lengths in m, angles in rad.

    Attributes:
        arm: x of the swing axis, r and z of the boom's joint, then lengths and angle offsets of
            boom, stick and bucket, shape (9,).
        lower, upper: the joints' limits, shape (4,).
        link: of each sphere, 0 boom, 1 stick, 2 bucket, shape (k,); held_off: whether the
            machine's own body is to be looked at, shape (k,).
        spheres: middle in its link's frame, radius with the margin, shape (k, 4).
        balls: middle, radius, shape (m, 4).
        boxes, under, house: lower and upper corner, shape (b, 2, 3): obstacles; the machine's own
            in the base frame, and in the frame of the house.
        heights, place, flat: of the ground, shape (rows, columns); corner and cell, shape (3,);
            the share of a height that is surely the distance [1].
        asked: postures that were looked at, shape (1,).
    """

    arm: NDArray
    lower: NDArray
    upper: NDArray
    link: NDArray
    held_off: NDArray
    spheres: NDArray
    balls: NDArray
    boxes: NDArray
    under: NDArray
    house: NDArray
    heights: NDArray
    place: NDArray
    flat: float
    asked: NDArray


def free(world, q):
    """Whether a posture, shape (4,), is within the limits and hits nothing.

    The outermost spheres come first: they are the ones that hit.
    """
    world.asked[0] += 1
    for i in range(4):
        if not world.lower[i] <= q[i] <= world.upper[i]:
            return False
    arm, across, ahead = world.arm, -sin(q[0]), cos(q[0])
    r, z, c, s = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    out, up, pitch = arm[1], arm[2], 0.0
    for i in range(3):
        pitch += q[1 + i] + arm[6 + i]
        c[i], s[i] = cos(pitch), sin(pitch)
        out, up = out + arm[3 + i] * c[i], up + arm[3 + i] * s[i]
        r[i], z[i] = out, up
    for k in range(len(world.link) - 1, -1, -1):
        i, radius = world.link[k], world.spheres[k, 3]
        along, above, d = world.spheres[k, 0], world.spheres[k, 1], world.spheres[k, 2]
        far = r[i] + along * c[i] - above * s[i]
        h = z[i] + along * s[i] + above * c[i]
        x, y = arm[0] + far * across + d * ahead, far * ahead - d * across
        if (h - ground(world, x, y)) * world.flat < radius:
            return False
        for j in range(len(world.balls)):
            ball = world.balls[j]
            touch = radius + ball[3]
            if (x - ball[0]) ** 2 + (y - ball[1]) ** 2 + (h - ball[2]) ** 2 < touch * touch:
                return False
        if in_box(world.boxes, x, y, h, radius):
            return False
        if world.held_off[k]:
            if in_box(world.under, x, y, h, radius):
                return False
            if in_box(world.house, far - arm[1], h - arm[2], d, radius):
                return False
    return True


def in_box(boxes, x, y, z, radius):
    """Whether a sphere reaches into one of boxes (b, 2, 3)."""
    for j in range(len(boxes)):
        e = max(boxes[j, 0, 0] - x, x - boxes[j, 1, 0], 0.0)
        f = max(boxes[j, 0, 1] - y, y - boxes[j, 1, 1], 0.0)
        g = max(boxes[j, 0, 2] - z, z - boxes[j, 1, 2], 0.0)
        if e * e + f * f + g * g < radius * radius:
            return True
    return False


def ground(world, x, y):
    """Height of the ground, bilinear, and beyond its border as there."""
    rows, columns = world.heights.shape
    u = min(max((x - world.place[0]) / world.place[2], 0.0), columns - 1.0)
    v = min(max((y - world.place[1]) / world.place[2], 0.0), rows - 1.0)
    j, k = min(int(u), columns - 2), min(int(v), rows - 2)
    u, v = u - j, v - k
    near = world.heights[k, j] * (1 - u) + world.heights[k, j + 1] * u
    return near * (1 - v) + v * (
        world.heights[k + 1, j] * (1 - u) + world.heights[k + 1, j + 1] * u
    )


def all_free(world, q):
    """Of postures of shape (n, 4)."""
    found = np.empty(len(q), np.bool_)
    for k in range(len(q)):
        found[k] = free(world, q[k])
    return found


def edge_free(world, a, b, resolution):
    """Whether the straight way between two postures is free: b, and places in between."""
    way = 0.0
    for i in range(4):
        way += (b[i] - a[i]) ** 2
    n = max(1, ceil(way**0.5 / resolution))
    q = np.empty(4)
    for k in range(n, 0, -1):
        for i in range(4):
            q[i] = a[i] + k / n * (b[i] - a[i])
        if not free(world, q):
            return False
    return True


def nearest(tree, n, place):
    """Of the first n nodes of a tree, the one nearest to a place."""
    best, least = 0, np.inf
    for k in range(n):
        total = 0.0
        for i in range(len(place)):
            total += (tree[k, i] - place[i]) ** 2
        if total < least:
            best, least = k, total
    return best
