"""The light of each pixel, as plain Python; `engine` compiles it."""

from __future__ import annotations

from math import floor, inf, log2, sqrt

from backhoe.perception.rays.loops import plain_at, slope_normal, triangle_normal

SKY = 220
"""Grey level where nothing is."""


def texture_at(levels, pixels, side, x, y, width):
    """The texture at x, y [m], averaged over about `width` [m]; linear between all copies."""
    first = min(max(log2(max(width * pixels / side, 1e-9)), 0.0), log2(pixels) - 1.0)
    value, x, y = 0.0, x / side, y / side
    for level in (int(first), int(first) + 1):
        share = 1 - abs(first - level)
        count = pixels >> level
        start = 4 * (pixels * pixels - count * count) // 3
        if share == 0.0:
            continue
        u, v = x * count - 0.5, y * count - 0.5
        i, j = floor(v), floor(u)
        a, b, last = u - j, v - i, count - 1
        top, bottom = (i & last) * count, (i + 1 & last) * count
        left, right = j & last, j + 1 & last
        upper = (1 - a) * levels[start + top + left] + a * levels[start + top + right]
        lower = (1 - a) * levels[start + bottom + left] + a * levels[start + bottom + right]
        value += share * ((1 - b) * upper + b * lower)
    return value


def light(
    bodies,
    i,
    brightness,
    contrast,
    ambient,
    levels,
    pixels,
    side,
    angle,
    sun,
    t,
    x,
    y,
    z,
    vx,
    vy,
    vz,
    nx,
    ny,
    nz,
):
    """Grey level, 0 to 255, of a point x, y, z with a normal, t vectors from the eye.

    `i` is the number of the body, of those in `bodies`, on which it lies; for ground it is none.
    `contrast` is how much the texture changes, `ambient` the light where no sun shines.
    `angle` is that of a pixel [rad]; `sun` (3,) points to the light.
    """
    length = sqrt(vx * vx + vy * vy + vz * vz)
    facing = -(nx * vx + ny * vy + nz * vz) / length
    if facing < 0:
        nx, ny, nz, facing = -nx, -ny, -nz, -facing
    shine = max(nx * sun[0] + ny * sun[1] + nz * sun[2], 0.0)
    value = brightness * (ambient + (1 - ambient) * shine)
    if contrast > 0:
        if 0 <= i < len(bodies):
            x, y, z = (
                bodies[i, 0] * x + bodies[i, 1] * y + bodies[i, 2] * z + bodies[i, 9],
                bodies[i, 3] * x + bodies[i, 4] * y + bodies[i, 5] * z + bodies[i, 10],
                bodies[i, 6] * x + bodies[i, 7] * y + bodies[i, 8] * z + bodies[i, 11],
            )
            a = abs(bodies[i, 0] * nx + bodies[i, 1] * ny + bodies[i, 2] * nz)
            b = abs(bodies[i, 3] * nx + bodies[i, 4] * ny + bodies[i, 5] * nz)
            c = abs(bodies[i, 6] * nx + bodies[i, 7] * ny + bodies[i, 8] * nz)
            if a >= b and a >= c:
                x, y = y, z
            elif b >= c:
                x, y = x, z
        width = t * length * angle / sqrt(max(facing, 0.05))
        value *= 1 + contrast * texture_at(levels, pixels, side, x, y, width)
    return int(min(max(255 * value + 0.5, 0.0), 255.0))


def shade(
    points,
    t,
    vector,
    surface,
    normal,
    bodies,
    fields,
    paints,
    levels,
    pixels,
    side,
    angle,
    sun,
    grey,
):
    """Fill `grey` (n,), uint8, from hits (n,) with points, vectors and normals (n, 3).

    `bodies` as in `rays.loops.Surfaces`; `fields` many surfaces come before them. `paints` has
    brightness, contrast and ambient light of each surface; the rest is as in `light`.
    """
    for n in range(len(t)):
        k = surface[n]
        grey[n] = SKY
        if k >= 0:
            grey[n] = light(
                bodies,
                k - fields,
                paints[k, 0],
                paints[k, 1],
                paints[k, 2],
                levels,
                pixels,
                side,
                angle,
                sun,
                t[n],
                points[n, 0],
                points[n, 1],
                points[n, 2],
                vector[n, 0],
                vector[n, 1],
                vector[n, 2],
                normal[n, 0],
                normal[n, 1],
                normal[n, 2],
            )


def show(
    scene,
    owners,
    nearest,
    which,
    T,
    lens,
    top,
    paints,
    levels,
    pixels,
    side,
    sun,
    depth,
    surface,
    grey,
):
    """Fill rows of a picture from what `rays.raster.cover` found for them, and the plain.

    Args:
        scene: a `rays.loops.Surfaces`; `owners` has the number of the body of each triangle.
        nearest, which: as `cover` leaves them for rows from `top` on.
        T: the camera's pose, (4, 4) [m]: x right, y down, z ahead.
        lens: fx, fy, cx, cy [pixels].
        paints, levels, pixels, side, sun: as for `shade`.
        depth, surface, grey: filled in, (rows, columns); infinity and -1 where nothing is.
    """
    fields, heights, _, _, bodies, _, _, triangles, plain = scene
    count = len(fields)
    fx, fy, mx, my = lens
    sx, sy, sz = T[0, 3], T[1, 3], T[2, 3]
    for row in range(len(which)):
        y = (row + top - my) / fy
        for column in range(which.shape[1]):
            x, number = (column - mx) / fx, which[row, column]
            vx = T[0, 0] * x + T[0, 1] * y + T[0, 2]
            vy = T[1, 0] * x + T[1, 1] * y + T[1, 2]
            vz = T[2, 0] * x + T[2, 1] * y + T[2, 2]
            t, k, nx, ny, nz = inf, -1, 0.0, 0.0, 1.0
            if number >= 0:
                t, k = 1 / nearest[row, column], 0
                if number >= 2 * len(heights):
                    triangle = number - 2 * len(heights)
                    k = count + owners[triangle]
                    nx, ny, nz = triangle_normal(bodies, triangles, k - count, triangle)
                else:
                    at = number >> 1
                    while k + 1 < count and at >= fields[k + 1, 5]:
                        k += 1
                    m = at + int(fields[k, 4])
                    a, b, c, d = heights[at], heights[at + 1], heights[m + 1], heights[m]
                    slope_x, slope_y = (c - d, d - a) if number & 1 else (b - a, c - b)
                    nx, ny, nz = slope_normal(slope_x / fields[k, 2], slope_y / fields[k, 2])
            far = plain_at(plain, sx, sy, sz, vx, vy, vz, t)
            if far < t:
                t, k, nx, ny, nz = far, count + len(bodies), 0.0, 0.0, 1.0
            depth[row, column], surface[row, column], grey[row, column] = t, k, SKY
            if k >= 0:
                grey[row, column] = light(
                    bodies,
                    k - count,
                    paints[k, 0],
                    paints[k, 1],
                    paints[k, 2],
                    levels,
                    pixels,
                    side,
                    1 / fx,
                    sun,
                    t,
                    sx + t * vx,
                    sy + t * vy,
                    sz + t * vz,
                    vx,
                    vy,
                    vz,
                    nx,
                    ny,
                    nz,
                )
