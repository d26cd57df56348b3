"""The checker of `arm_world` posture by posture in plain Python; `engine` has it compiled."""

from __future__ import annotations

from math import ceil, cos, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class World(NamedTuple):
    """What the loops get of an `ArmWorld`, lengths in m, angles in rad.

    Attributes:
        arm: x of the swing axis, r and z of the boom's joint, lengths and angle offsets of boom,
            stick and bucket, shape (9,).
        limits: of the joints, lower and upper, shape (2, 4).
        spheres: link (0 boom, 1 stick, 2 bucket), whether the machine's own body is looked at (0,
            1), middle in the link's frame, radius with the margin, shape (k, 6).
        balls: middle, radius, shape (m, 4).
        boxes: kind (0 an obstacle; the machine's own: 1 in the base frame, 2 in the frame of the
            house), lower corner, upper corner, shape (b, 7).
        heights: of the ground, shape (rows, columns).
        place: their corner x, y and cell, the share of a height that is surely the distance, and
            the highest, shape (5,).
        asked: postures that were looked at, shape (1,).
    """

    arm: NDArray
    limits: NDArray
    spheres: NDArray
    balls: NDArray
    boxes: NDArray
    heights: NDArray
    place: NDArray
    asked: NDArray


def all_free(world, q):
    """Of postures, shape (n, 4), whether they are within the limits and hit nothing, shape (n,)."""
    found = np.zeros(len(q), np.bool_)
    for n in range(len(q)):
        found[n] = free_at(world, q[n])
    return found


def free_at(world, q):
    """The same of one posture, shape (4,).

    The outermost spheres come first: they are the ones that hit.
    """
    arm, limits, spheres, balls, boxes, heights, place, asked = world
    asked[0] += 1
    for i in range(4):
        if not limits[0, i] <= q[i] <= limits[1, i]:
            return False
    across, ahead = -sin(q[0]), cos(q[0])
    p1 = q[1] + arm[6]
    p2 = p1 + q[2] + arm[7]
    p3 = p2 + q[3] + arm[8]
    c, s = (cos(p1), cos(p2), cos(p3)), (sin(p1), sin(p2), sin(p3))
    r1, z1 = arm[1] + arm[3] * c[0], arm[2] + arm[3] * s[0]
    r2, z2 = r1 + arm[4] * c[1], z1 + arm[4] * s[1]
    r, z = (r1, r2, r2 + arm[5] * c[2]), (z1, z2, z2 + arm[5] * s[2])
    for k in range(len(spheres) - 1, -1, -1):
        i, radius = int(spheres[k, 0]), spheres[k, 5]
        along, above, beside = spheres[k, 2], spheres[k, 3], spheres[k, 4]
        far = r[i] + along * c[i] - above * s[i]
        h = z[i] + along * s[i] + above * c[i]
        x, y = arm[0] + far * across + beside * ahead, far * ahead - beside * across
        if (h - place[4]) * place[3] < radius:  # not above all of the ground
            if (h - ground(heights, place, x, y)) * place[3] < radius:
                return False
        for j in range(len(balls)):
            touch = radius + balls[j, 3]
            u, v, w = x - balls[j, 0], y - balls[j, 1], h - balls[j, 2]
            if u * u + v * v + w * w < touch * touch:
                return False
        for j in range(len(boxes)):
            if boxes[j, 0] > 0.0 and spheres[k, 1] == 0.0:
                continue
            u, v, w = x, y, h
            if boxes[j, 0] == 2.0:
                u, v, w = far - arm[1], h - arm[2], beside
            u = max(boxes[j, 1] - u, u - boxes[j, 4], 0.0)
            v = max(boxes[j, 2] - v, v - boxes[j, 5], 0.0)
            w = max(boxes[j, 3] - w, w - boxes[j, 6], 0.0)
            if u * u + v * v + w * w < radius * radius:
                return False
    return True


def ground(heights, place, x, y):
    """Height of the ground, bilinear, and beyond its border as there."""
    rows, columns = heights.shape
    u = min(max((x - place[0]) / place[2], 0.0), columns - 1.0)
    v = min(max((y - place[1]) / place[2], 0.0), rows - 1.0)
    j, k = min(int(u), columns - 2), min(int(v), rows - 2)
    u, v = u - j, v - k
    near = heights[k, j] * (1 - u) + heights[k, j + 1] * u
    return near * (1 - v) + v * (heights[k + 1, j] * (1 - u) + heights[k + 1, j + 1] * u)


def edge_free(world, a, b, resolution):
    """Whether the straight way between two postures is free: b, the middle, the quarters, and so
    on, for in the middle of what is left an obstacle is found soonest."""
    way = 0.0
    for i in range(4):
        way += (b[i] - a[i]) ** 2
    if not free_at(world, b):
        return False
    n, step, place = max(1, ceil(way**0.5 / resolution)), 1, np.empty(4)
    while step < n:
        step *= 2
    while step > 1:
        for k in range(step // 2, n, step):
            for i in range(4):
                place[i] = a[i] + k / n * (b[i] - a[i])
            if not free_at(world, place):
                return False
        step //= 2
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
