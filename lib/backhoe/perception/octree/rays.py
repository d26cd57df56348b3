"""Which voxels a scan touches: rays through a grid of voxels.

A voxel's key is its three indices, 0 to 65535, voxel 32768 beginning at the origin. Voxels are
gathered in bricks of 8 x 8 x 8, in the octree's own order: byte m // 8 of a brick is eight
siblings, bit m % 8 is one of them. `engine` has the same functions compiled.

Ties and rounding are those of OctoMap (Hornung et al. 2013): points are single precision. The ray
is Amanatides and Woo's, 1987.
"""

from __future__ import annotations

from math import floor, inf, sqrt

import numpy as np

MIDDLE = 32768
"""Index of the voxel that begins at the origin; half as many as there are along an axis."""


def index(coordinate, resolution):
    """Index along an axis of the voxel at a coordinate [m]."""
    return floor((1.0 / resolution) * float(coordinate)) + MIDDLE


def centre(key, resolution):
    """Coordinate of the middle of a voxel [m]."""
    return (float(key - MIDDLE) + 0.5) * resolution


def spread(k):
    """The last three bits of an index, three places apart."""
    return (k & 1) | (k & 2) << 2 | (k & 4) << 4


def place(kx, ky, kz):
    """Where a voxel is in its brick, 0 to 511."""
    return spread(kx) | spread(ky) << 1 | spread(kz) << 2


def brick_key(kx, ky, kz):
    """One number for a voxel's brick."""
    return (kz >> 3) << 26 | (ky >> 3) << 13 | (kx >> 3)


def brick_of(key, slots, bricks, books):
    """Number of a brick, which a new one gets; -1 where there is no room for it."""
    mask = len(slots) - 1
    slot = (key * 0x9E3779B1 >> 15) & mask
    while slots[slot] >= 0:
        if bricks[slots[slot]] == key:
            return slots[slot]
        slot = (slot + 1) & mask
    b = books[0]
    if b == len(bricks):
        return -1
    books[0] += 1
    bricks[b], slots[slot] = key, b
    return b


def cut(origin, point, max_range):
    """Where a ray to the point ends, three numbers [m], and whether it hits something there."""
    dx, dy, dz = point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]
    length = sqrt(float(dx * dx + dy * dy + dz * dz))
    if length <= max_range:
        return point[0], point[1], point[2], True
    scale, reach = np.float32(length), np.float32(max_range)
    x, y, z = dx / scale * reach, dy / scale * reach, dz / scale * reach
    return origin[0] + x, origin[1] + y, origin[2] + z, False


def first_border(key, start, along, resolution):
    """Step (-1, 0, 1), ray length to the first border and from border to border [m]."""
    if along == 0:
        return 0, inf, inf
    step = 1 if along > 0 else -1
    border = centre(key, resolution) + float(np.float32(step * resolution * 0.5))
    return step, (border - float(start)) / float(along), resolution / abs(float(along))


def ray(origin, x, y, z, resolution):
    """What `mark` needs to walk from the origin to (x, y, z).

    Returns:
        Length [m]; for each axis the keys of both ends, step, border and distance of borders.
    """
    dx, dy, dz = x - origin[0], y - origin[1], z - origin[2]
    length = np.float32(sqrt(float(dx * dx + dy * dy + dz * dz)))
    scale = length if length > 0 else np.float32(1)
    ax, ay = index(origin[0], resolution), index(origin[1], resolution)
    az = index(origin[2], resolution)
    bx, by, bz = index(x, resolution), index(y, resolution), index(z, resolution)
    sx, tx, wx = first_border(ax, origin[0], dx / scale, resolution)
    sy, ty, wy = first_border(ay, origin[1], dy / scale, resolution)
    sz, tz, wz = first_border(az, origin[2], dz / scale, resolution)
    return float(length), (ax, bx, sx, tx, wx), (ay, by, sy, ty, wy), (az, bz, sz, tz, wz)


def mark(points, origin, resolution, max_range, start, bricks, slots, free, hit, books):
    """Mark the voxels that the rays of a scan pass and those that they hit, as bits.

    Args:
        points, origin: single precision, shapes (n, 3), (3,) [m].
        resolution, max_range: [m], the latter may be infinite.
        start: the first ray to do.
        bricks: keys of the bricks that are touched, with room for more, shape (b,).
        slots: a table to find them in, 4 b entries, a power of 2, -1 where empty.
        free, hit: passed and hit voxels of these bricks, shapes (b, 64).
        books: number of the bricks, shape (1,).

    Returns:
        The first ray that is not done for want of room, or how many there are.
    """
    for n in range(start, len(points)):
        x, y, z, hits = cut(origin, points[n], max_range)
        length, along_x, along_y, along_z = ray(origin, x, y, z, resolution)
        kx, bx, sx, tx, wx = along_x
        ky, by, sy, ty, wy = along_y
        kz, bz, sz, tz, wz = along_z
        last, b = -1, 0
        nearest = 0.0
        while nearest <= length and (kx != bx or ky != by or kz != bz):
            key = brick_key(kx, ky, kz)
            if key != last:
                last, b = key, brick_of(key, slots, bricks, books)
                if b < 0:
                    return n
            m = place(kx, ky, kz)
            free[b, m >> 3] |= 1 << (m & 7)
            if tx < ty and tx < tz:
                kx += sx
                tx += wx
            elif ty < tz and not tx < ty:
                ky += sy
                ty += wy
            else:
                kz += sz
                tz += wz
            nearest = min(tx, ty, tz)
        if hits:
            b = brick_of(brick_key(bx, by, bz), slots, bricks, books)
            if b < 0:
                return n
            m = place(bx, by, bz)
            hit[b, m >> 3] |= 1 << (m & 7)
    return len(points)
