"""Which triangle each pixel of a pinhole camera sees, as plain Python; `engine` compiles it.

A camera's rays all start at one point, so a triangle is asked which pixels see it, not a pixel
which triangle it sees. With corners a, b, c in the camera's frame, the ray v = (x, y, 1) meets the
triangle where v . (b x c), v . (c x a) and v . (a x b) have one sign, and the inverse of its depth
is v . n over a . n, n its normal: all are linear in x and y, also for a triangle that is partly
behind the camera (Olano and Greer 1997).
"""

from __future__ import annotations

from math import ceil, floor, inf

import numpy as np

from backhoe.perception.rays.loops import TIE

NEAR = 1e-6
"""Depth from which on a corner has a place in the picture [m]."""


def sides(x, y, z, lens, top, bottom, width):
    """Bits for what a point is out of: 1 left, 2 right, 4 above, 8 below, 16 behind the camera."""
    fx, fy, cx, cy = lens
    column, row = fx * x + cx * z, fy * y + cy * z
    out = 1 if column < -z else 0
    out |= 2 if column > width * z else 0
    out |= 4 if row < (top - 1) * z else 0
    out |= 8 if row > bottom * z else 0
    return out | (16 if z < NEAR else 0)


def extent(ax, ay, az, bx, by, bz, cx, cy, cz):
    """Least and greatest x / z and y / z of what of a triangle lies ahead of `NEAR`."""
    low_x, high_x, low_y, high_y = inf, -inf, inf, -inf
    for _ in range(3):
        if az >= NEAR:
            low_x, high_x = min(low_x, ax / az), max(high_x, ax / az)
            low_y, high_y = min(low_y, ay / az), max(high_y, ay / az)
        if (az >= NEAR) != (bz >= NEAR):
            share = (NEAR - az) / (bz - az)
            x, y = (ax + share * (bx - ax)) / NEAR, (ay + share * (by - ay)) / NEAR
            low_x, high_x, low_y, high_y = (
                min(low_x, x),
                max(high_x, x),
                min(low_y, y),
                max(high_y, y),
            )
        ax, ay, az, bx, by, bz, cx, cy, cz = bx, by, bz, cx, cy, cz, ax, ay, az
    return low_x, high_x, low_y, high_y


def cross(ax, ay, az, bx, by, bz):
    """The vector product of two vectors."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


def fill(a, b, c, number, lens, top, bottom, width, nearest, which):
    """Write a triangle's number into the pixels that see nothing nearer.

    Args:
        a, b, c: its corners in the camera's frame, three numbers each [m].
        number: from 0.
        lens: fx, fy, cx, cy [pixels].
        top, bottom, width: the rows from top to before bottom are filled, `width` pixels each.
        nearest: inverse depth of what each pixel sees, (bottom - top, width) [1/m].
        which: number of that, of the same shape.
    """
    ax, ay, az = a
    bx, by, bz = b
    cx, cy, cz = c
    nx, ny, nz = cross(bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az)
    determinant = ax * nx + ay * ny + az * nz
    if determinant == 0.0:
        return
    turn = 1.0 / determinant
    nx, ny, nz = nx * turn, ny * turn, nz * turn
    ux, uy, uz = cross(bx, by, bz, cx * turn, cy * turn, cz * turn)
    vx, vy, vz = cross(cx, cy, cz, ax * turn, ay * turn, az * turn)
    wx, wy, wz = cross(ax, ay, az, bx * turn, by * turn, bz * turn)
    fx, fy, mx, my = lens
    low_x, high_x, low_y, high_y = extent(ax, ay, az, bx, by, bz, cx, cy, cz)
    left = ceil(min(max(fx * low_x + mx - 1e-6, 0.0), float(width)))
    right = floor(max(min(fx * high_x + mx + 1e-6, width - 1.0), -1.0))
    first = ceil(min(max(fy * low_y + my - 1e-6, float(top)), float(bottom)))
    last = floor(max(min(fy * high_y + my + 1e-6, bottom - 1.0), -1.0))
    for i in range(first, last + 1):
        y = (i - my) / fy
        u0, v0, w0, n0 = uy * y + uz, vy * y + vz, wy * y + wz, ny * y + nz
        for j in range(left, right + 1):
            x = (j - mx) / fx
            u, v, w, inverse = u0 + ux * x, v0 + vx * x, w0 + wx * x, n0 + nx * x
            if min(u, v, w) >= -1e-9 * inverse and inverse > nearest[i - top, j] * (1 + TIE):
                nearest[i - top, j] = inverse
                which[i - top, j] = number


def cover(fields, corners, triangles, lens, top, bottom, width, nearest, which):
    """What the pixels of some rows see first of heightmaps and bodies.

    Args:
        fields: as in `loops.Surfaces`.
        corners: the heights' points in the camera's frame, (n, 3) [m].
        triangles: of the bodies, a corner and two edges in the camera's frame, (t, 9) [m].
        lens, top, bottom, width, nearest, which: as for `fill`. Triangles are numbered 2 n and
            2 n + 1 for the cell whose first corner is n, then from 2 len(corners) on.
    """
    out = np.empty(len(corners), np.uint8)
    for n in range(len(corners)):
        out[n] = sides(corners[n, 0], corners[n, 1], corners[n, 2], lens, top, bottom, width)
    for k in range(len(fields)):
        rows, columns, start = int(fields[k, 3]), int(fields[k, 4]), int(fields[k, 5])
        for p in range(rows - 1):
            for q in range(columns - 1):
                n = start + p * columns + q
                m = n + columns
                if out[n] & out[n + 1] & out[m] & out[m + 1]:
                    continue
                a = corners[n, 0], corners[n, 1], corners[n, 2]
                b = corners[n + 1, 0], corners[n + 1, 1], corners[n + 1, 2]
                c = corners[m + 1, 0], corners[m + 1, 1], corners[m + 1, 2]
                d = corners[m, 0], corners[m, 1], corners[m, 2]
                fill(a, b, c, 2 * n, lens, top, bottom, width, nearest, which)
                fill(a, c, d, 2 * n + 1, lens, top, bottom, width, nearest, which)
    for n in range(len(triangles)):
        x, y, z = triangles[n, 0], triangles[n, 1], triangles[n, 2]
        a = x, y, z
        b = x + triangles[n, 3], y + triangles[n, 4], z + triangles[n, 5]
        c = x + triangles[n, 6], y + triangles[n, 7], z + triangles[n, 8]
        hidden = sides(x, y, z, lens, top, bottom, width)
        hidden &= sides(b[0], b[1], b[2], lens, top, bottom, width)
        if not hidden & sides(c[0], c[1], c[2], lens, top, bottom, width):
            fill(a, b, c, 2 * len(corners) + n, lens, top, bottom, width, nearest, which)
