"""The light of each pixel, as plain Python; `engine` compiles it."""

from __future__ import annotations

from math import floor, log2, sqrt


def texture_at(levels, pixels, side, x, y, width):
    """The texture at x, y [m], averaged over about `width` [m]; linear between all copies."""
    first = min(max(log2(max(width * pixels / side, 1e-9)), 0.0), log2(pixels) - 1.0)
    value = 0.0
    for level in (int(first), int(first) + 1):
        share = 1 - abs(first - level)
        count = pixels >> level
        start = 4 * (pixels * pixels - count * count) // 3
        u, v = x / side * count - 0.5, y / side * count - 0.5
        i, j = floor(v), floor(u)
        a, b = u - j, v - i
        top, bottom = i % count * count, (i + 1) % count * count
        left, right = j % count, (j + 1) % count
        upper = (1 - a) * levels[start + top + left] + a * levels[start + top + right]
        lower = (1 - a) * levels[start + bottom + left] + a * levels[start + bottom + right]
        value += share * ((1 - b) * upper + b * lower)
    return value


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
    """Fill `grey` (n,), 0 to 255, uint8, from hits (n,) with points, vectors and normals (n, 3).

    `bodies` as in `rays.loops.Surfaces`; `fields` many surfaces come before them. `paints` (n, 3):
    brightness, how much of it the texture changes, and the light where no sun shines. `angle` is
    that of a pixel [rad]; `sun` (3,) points to the light.
    """
    for n in range(len(t)):
        k = surface[n]
        if k < 0:
            grey[n] = 220
            continue
        nx, ny, nz = normal[n, 0], normal[n, 1], normal[n, 2]
        vx, vy, vz = vector[n, 0], vector[n, 1], vector[n, 2]
        length = sqrt(vx * vx + vy * vy + vz * vz)
        facing = -(nx * vx + ny * vy + nz * vz) / length
        if facing < 0:
            nx, ny, nz, facing = -nx, -ny, -nz, -facing
        light = max(nx * sun[0] + ny * sun[1] + nz * sun[2], 0.0)
        value = paints[k, 0] * (paints[k, 2] + (1 - paints[k, 2]) * light)
        if paints[k, 1] > 0:
            x, y, z = points[n, 0], points[n, 1], points[n, 2]
            i = k - fields
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
            width = t[n] * length * angle / sqrt(max(facing, 0.05))
            value *= 1 + paints[k, 1] * texture_at(levels, pixels, side, x, y, width)
        grey[n] = int(min(max(255 * value + 0.5, 0.0), 255.0))
