"""A ray's way through heightmaps and triangle meshes, as plain Python; `engine` compiles it.

A ray is start + t vector, t from 0 to `most`. A hit is t, the surface's number (-1 for none) and a
normal, of either side. Heightmaps come first among the numbers, then bodies, then
the plain around.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

BLOCK = 8
"""Cells a side of the blocks whose lowest and highest point a ray asks for first."""

DEPTH = 64
"""Most open boxes while a ray descends a tree."""


TIE = 1e-9
"""Share by which a body must be nearer than what came before it: of two surfaces in one place the
first is seen, not now the one, now the other as rounding has it."""


class Surfaces(NamedTuple):
    """All that rays can hit, as arrays, lengths in m.

    `fields` (f, 9): x, y of the first height, cell, rows, columns, where its heights and its blocks
    start, lowest, highest. `heights` (n,), `low`, `high` (blocks,). `bodies` (b, 17): rotation into
    the body's frame by rows, its translation, the middle and radius of a ball around it in the
    world, and the root of its tree. `boxes` (nodes, 6): lower and upper corner; `tree` (nodes, 2):
    the second child and 0 (the first child follows), or the first triangle and how many.
    `triangles` (t, 9): a corner and two edges. `plain` (5,): z = 0 outside of x from, to, y from,
    to, within that half side; 0 for none.
    """

    fields: NDArray
    heights: NDArray
    low: NDArray
    high: NDArray
    bodies: NDArray
    boxes: NDArray
    tree: NDArray
    triangles: NDArray
    plain: NDArray


def hit_cell(a, b, c, d, x, y, z, vx, vy, vz, most):
    """t and slopes along x and y where a ray meets a cell's two triangles; inf beside it.

    a at (0, 0), b at (1, 0), c at (1, 1), d at (0, 1); the diagonal runs from a to c.
    """
    best, slope_x, slope_y = inf, 0.0, 0.0
    for upper in range(2):
        sx, sy = (c - d, d - a) if upper else (b - a, c - b)
        fall = vz - sx * vx - sy * vy
        if fall == 0.0:
            continue
        t = (a + sx * x + sy * y - z) / fall
        if not -1e-9 <= t < min(best, most):
            continue
        u, v = x + t * vx, y + t * vy
        if -1e-7 <= u <= 1 + 1e-7 and -1e-7 <= v <= 1 + 1e-7:
            if (v >= u - 1e-7) if upper else (u >= v - 1e-7):
                best, slope_x, slope_y = t, sx, sy
    return best, slope_x, slope_y


def hit_field(fields, heights, low, high, k, sx, sy, sz, vx, vy, vz, most):
    """t and slopes where a ray first meets heightmap k, by blocks of cells, then by cells."""
    cell, rows, columns = fields[k, 2], int(fields[k, 3]), int(fields[k, 4])
    first, blocks = int(fields[k, 5]), int(fields[k, 6])
    x, y = (sx - fields[k, 0]) / cell, (sy - fields[k, 1]) / cell
    ax, ay = vx / cell, vy / cell
    near, far = 0.0, most
    for s, v, least, greatest in (
        (x, ax, 0.0, columns - 1.0),
        (y, ay, 0.0, rows - 1.0),
        (sz, vz, fields[k, 7] - 1e-9, fields[k, 8] + 1e-9),
    ):
        if v == 0.0:
            if s < least or s > greatest:
                return inf, 0.0, 0.0
        else:
            t0, t1 = (least - s) / v, (greatest - s) / v
            near, far = max(near, min(t0, t1)), min(far, max(t0, t1))
    if near > far:
        return inf, 0.0, 0.0
    wide = (columns - 2) // BLOCK + 1
    step_x, step_y = (1 if ax > 0 else -1), (1 if ay > 0 else -1)
    i = min(max(int(y + near * ay), 0), rows - 2) // BLOCK
    j = min(max(int(x + near * ax), 0), columns - 2) // BLOCK
    high_blocks = (rows - 2) // BLOCK + 1
    t = near
    while True:
        out_x = ((j + (step_x > 0)) * BLOCK - x) / ax if ax != 0.0 else inf
        out_y = ((i + (step_y > 0)) * BLOCK - y) / ay if ay != 0.0 else inf
        end = min(out_x, out_y, far)
        z0, z1 = sz + t * vz, sz + end * vz
        block = blocks + i * wide + j
        if min(z0, z1) <= high[block] + 1e-9 and max(z0, z1) >= low[block] - 1e-9:
            top, left = i * BLOCK, j * BLOCK
            bottom, right = min(top + BLOCK, rows - 1) - 1, min(left + BLOCK, columns - 1) - 1
            p = min(max(int(y + t * ay), top), bottom)
            q = min(max(int(x + t * ax), left), right)
            while True:
                at = first + p * columns + q
                a, b = heights[at], heights[at + 1]
                d, c = heights[at + columns], heights[at + columns + 1]
                exit_x = (q + (step_x > 0) - x) / ax if ax != 0.0 else inf
                exit_y = (p + (step_y > 0) - y) / ay if ay != 0.0 else inf
                leave = min(exit_x, exit_y, end)
                z0, z1 = sz + t * vz, sz + leave * vz
                if min(z0, z1) <= max(a, b, c, d) + 1e-9 and max(z0, z1) >= min(a, b, c, d) - 1e-9:
                    found, slope_x, slope_y = hit_cell(
                        a, b, c, d, x - q, y - p, sz, ax, ay, vz, most
                    )
                    if found < inf:
                        return found, slope_x / cell, slope_y / cell
                t = max(t, leave)
                if leave >= end:
                    break
                if exit_x <= exit_y:
                    q += step_x
                else:
                    p += step_y
                if p < top or p > bottom or q < left or q > right:
                    break
        t = max(t, end)
        if end >= far:
            return inf, 0.0, 0.0
        if out_x <= out_y:
            j += step_x
        else:
            i += step_y
        if i < 0 or j < 0 or i >= high_blocks or j >= wide:
            return inf, 0.0, 0.0


def box_entry(boxes, node, s, inverse, most):
    """t where a ray enters a box, inf where it misses it before `most`."""
    near, far = 0.0, most
    for k in range(3):
        t0, t1 = (boxes[node, k] - s[k]) * inverse[k], (boxes[node, k + 3] - s[k]) * inverse[k]
        near, far = max(near, min(t0, t1)), min(far, max(t0, t1))
    return near if near <= far else inf


def hit_triangle(triangles, k, s, v, most):
    """t where a ray meets a triangle (Moeller and Trumbore 1997), inf where it does not."""
    ax, ay, az = triangles[k, 3], triangles[k, 4], triangles[k, 5]
    bx, by, bz = triangles[k, 6], triangles[k, 7], triangles[k, 8]
    px, py, pz = v[1] * bz - v[2] * by, v[2] * bx - v[0] * bz, v[0] * by - v[1] * bx
    determinant = ax * px + ay * py + az * pz
    if determinant == 0.0:
        return inf
    x, y, z = s[0] - triangles[k, 0], s[1] - triangles[k, 1], s[2] - triangles[k, 2]
    u = (x * px + y * py + z * pz) / determinant
    if u < -1e-9 or u > 1 + 1e-9:
        return inf
    qx, qy, qz = y * az - z * ay, z * ax - x * az, x * ay - y * ax
    w = (v[0] * qx + v[1] * qy + v[2] * qz) / determinant
    if w < -1e-9 or u + w > 1 + 1e-9:
        return inf
    t = (bx * qx + by * qy + bz * qz) / determinant
    return t if 0.0 <= t < most else inf


def hit_body(bodies, boxes, tree, triangles, i, sx, sy, sz, vx, vy, vz, most, stack):
    """t and triangle where a ray first meets body i, down its tree of boxes; inf, -1 beside it."""
    cx, cy, cz, radius = bodies[i, 12] - sx, bodies[i, 13] - sy, bodies[i, 14] - sz, bodies[i, 15]
    along, length = cx * vx + cy * vy + cz * vz, vx * vx + vy * vy + vz * vz
    distance = cx * cx + cy * cy + cz * cz
    if (distance - radius * radius) * length > along * along:
        return inf, -1
    if along < 0 and distance > radius * radius:
        return inf, -1
    s = (
        bodies[i, 0] * sx + bodies[i, 1] * sy + bodies[i, 2] * sz + bodies[i, 9],
        bodies[i, 3] * sx + bodies[i, 4] * sy + bodies[i, 5] * sz + bodies[i, 10],
        bodies[i, 6] * sx + bodies[i, 7] * sy + bodies[i, 8] * sz + bodies[i, 11],
    )
    v = (
        bodies[i, 0] * vx + bodies[i, 1] * vy + bodies[i, 2] * vz,
        bodies[i, 3] * vx + bodies[i, 4] * vy + bodies[i, 5] * vz,
        bodies[i, 6] * vx + bodies[i, 7] * vy + bodies[i, 8] * vz,
    )
    inverse = (
        1 / v[0] if abs(v[0]) > 1e-300 else 1e300,
        1 / v[1] if abs(v[1]) > 1e-300 else 1e300,
        1 / v[2] if abs(v[2]) > 1e-300 else 1e300,
    )
    best, which, waiting = most, -1, 0
    node = int(bodies[i, 16])
    if box_entry(boxes, node, s, inverse, best) == inf:
        return inf, -1
    while True:
        first, count = tree[node, 0], tree[node, 1]
        if count == 0:
            one, other = node + 1, first
            t_one = box_entry(boxes, one, s, inverse, best)
            t_other = box_entry(boxes, other, s, inverse, best)
            if t_other < t_one:
                one, other, t_one, t_other = other, one, t_other, t_one
            if t_other < inf:
                stack[waiting] = other
                waiting += 1
            if t_one < inf:
                node = one
                continue
        for k in range(first, first + count):
            t = hit_triangle(triangles, k, s, v, best)
            if t < best:
                best, which = t, k
        if waiting == 0:
            break
        waiting -= 1
        node = stack[waiting]
    return (best, which) if which >= 0 else (inf, -1)


def plain_at(plain, sx, sy, sz, vx, vy, vz, most):
    """t where a ray meets the plain around the first heightmap, inf where it does not."""
    if not plain[4] > 0 or vz == 0.0:
        return inf
    t = -sz / vz
    x, y = sx + t * vx, sy + t * vy
    inside = plain[0] < x < plain[1] and plain[2] < y < plain[3]
    hit = 0.0 <= t < most and not inside and abs(x) <= plain[4] and abs(y) <= plain[4]
    return t if hit else inf


def meet(scene, stack, sx, sy, sz, vx, vy, vz, most):
    """What a ray meets first: t, surface, slopes along x and y, and the triangle of a body."""
    fields, heights, low, high, bodies, boxes, tree, triangles, plain = scene
    best, which, slope_x, slope_y, triangle = most, -1, 0.0, 0.0, -1
    for k in range(len(fields)):
        t, a, b = hit_field(fields, heights, low, high, k, sx, sy, sz, vx, vy, vz, best)
        if t < best:
            best, which, slope_x, slope_y = t, k, a, b
    for i in range(len(bodies)):
        limit = best * (1 - TIE)
        t, k = hit_body(bodies, boxes, tree, triangles, i, sx, sy, sz, vx, vy, vz, limit, stack)
        if t < limit:
            best, which, triangle = t, len(fields) + i, k
    t = plain_at(plain, sx, sy, sz, vx, vy, vz, best)
    if t < best:
        best, which, slope_x, slope_y, triangle = t, len(fields) + len(bodies), 0.0, 0.0, -1
    return (best if which >= 0 else inf), which, slope_x, slope_y, triangle


def slope_normal(slope_x, slope_y):
    """Normal of a surface with slopes along x and y, upwards, three numbers."""
    length = sqrt(1 + slope_x * slope_x + slope_y * slope_y)
    return -slope_x / length, -slope_y / length, 1 / length


def triangle_normal(bodies, triangles, i, k):
    """Normal in the world of triangle k, which is one of body i's, three numbers."""
    ax, ay, az = triangles[k, 3], triangles[k, 4], triangles[k, 5]
    bx, by, bz = triangles[k, 6], triangles[k, 7], triangles[k, 8]
    nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    length = sqrt(nx * nx + ny * ny + nz * nz)
    return (
        (bodies[i, 0] * nx + bodies[i, 3] * ny + bodies[i, 6] * nz) / length,
        (bodies[i, 1] * nx + bodies[i, 4] * ny + bodies[i, 7] * nz) / length,
        (bodies[i, 2] * nx + bodies[i, 5] * ny + bodies[i, 8] * nz) / length,
    )


def cast(scene, start, vector, most, hits, surface, normal):
    """Fill t (n,), surface (n,) and normal (n, 3) of rays, start and vector (n, 3) each."""
    stack = np.empty(DEPTH, dtype=np.int64)
    for n in range(len(start)):
        hits[n], surface[n], slope_x, slope_y, triangle = meet(
            scene,
            stack,
            start[n, 0],
            start[n, 1],
            start[n, 2],
            vector[n, 0],
            vector[n, 1],
            vector[n, 2],
            most,
        )
        if triangle >= 0:
            i = surface[n] - len(scene.fields)
            nx, ny, nz = triangle_normal(scene.bodies, scene.triangles, i, triangle)
        else:
            nx, ny, nz = slope_normal(slope_x, slope_y)
        normal[n, 0], normal[n, 1], normal[n, 2] = nx, ny, nz
