"""What an octree answers: log-odds by size of voxel, leaves, rays. `engine` has it compiled."""

from __future__ import annotations

import numpy as np

from backhoe.perception.octree.nodes import DEPTH, find
from backhoe.perception.octree.rays import MIDDLE, centre, first_border, index


def look_up(value, child, keys, depth, mean, found):
    """Log-odds of the nodes of a depth that have the voxels of these keys, (n, 3), into `found`.

    Args:
        mean: whether an inner node gives the mean of its eight children, eq. (5.4), to which an
            unknown one brings its prior's 0; else their largest, eq. (5.5).
    """
    for n in range(len(keys)):
        b, i, d = find(value, child, keys[n, 0], keys[n, 1], keys[n, 2], depth)
        found[n] = mean_of(value, child, b, i, d) if mean and child[b, i] else value[b, i]


def mean_of(value, child, b, i, depth):
    """Mean log-odds of all voxels in a node."""
    total, waiting = 0.0, [(child[b, i], depth + 1)]
    while len(waiting) > 0:
        block, d = waiting.pop()
        for j in range(8):
            if child[block, j]:
                waiting.append((child[block, j], d + 1))
            elif not np.isnan(value[block, j]):
                total += float(value[block, j]) / 8.0 ** (d - depth)
    return total


def list_leaves(value, child, depth, low, high, keys, depths, odds):
    """Known leaves and inner nodes of `depth`, in the octree's order, that touch a box of keys.

    Args:
        low, high: first and last index along each axis, shapes (3,).
        keys, depths, odds: filled in, shapes (n, 3), (n,), (n,); keys are the lowest of a node.

    Returns:
        How many there are; what exceeds n is only counted.
    """
    count = 0
    waiting = [(0, 0, 0, 0, 0, 0)]
    while len(waiting) > 0:
        b, i, d, x, y, z = waiting.pop()
        last = (1 << (DEPTH - d)) - 1
        outside = x > high[0] or y > high[1] or z > high[2]
        if outside or x + last < low[0] or y + last < low[1] or z + last < low[2]:
            continue
        below = int(child[b, i])
        if below and d < depth:
            half = (last + 1) >> 1
            for j in range(7, -1, -1):
                if not np.isnan(value[below, j]):
                    corner = (x + (j & 1) * half, y + (j >> 1 & 1) * half, z + (j >> 2) * half)
                    waiting.append((below, j, d + 1, corner[0], corner[1], corner[2]))
        elif not np.isnan(value[b, i]):
            if count < len(keys):
                keys[count, 0], keys[count, 1], keys[count, 2] = x, y, z
                depths[count], odds[count] = d, value[b, i]
            count += 1
    return count


def cast(value, child, origins, directions, resolution, max_range, through, ends, met):
    """Follow rays to the first occupied voxel, or unknown one unless `through` those.

    Args:
        origins, directions: shapes (n, 3) [m], [1]; directions have length 1.
        ends: filled in with the middles of the last voxels, shape (n, 3) [m].
        met: filled in with 1 for occupied, 0 for free to the range's or map's end, -1 for unknown.
    """
    for n in range(len(origins)):
        kx = index(origins[n, 0], resolution)
        ky = index(origins[n, 1], resolution)
        kz = index(origins[n, 2], resolution)
        sx, tx, wx = first_border(kx, origins[n, 0], directions[n, 0], resolution)
        sy, ty, wy = first_border(ky, origins[n, 1], directions[n, 1], resolution)
        sz, tz, wz = first_border(kz, origins[n, 2], directions[n, 2], resolution)
        while True:
            b, i, _ = find(value, child, kx, ky, kz, DEPTH)
            unknown = np.isnan(value[b, i])
            if unknown and not through:
                met[n] = -1
                break
            if value[b, i] >= 0:
                met[n] = 1
                break
            if min(tx, ty, tz) > max_range:
                met[n] = 0
                break
            ax, ay, az = kx, ky, kz
            if tx < ty and tx < tz:
                kx += sx
                tx += wx
            elif ty < tz and not tx < ty:
                ky += sy
                ty += wy
            else:
                kz += sz
                tz += wz
            if min(kx, ky, kz) < 0 or max(kx, ky, kz) >= 2 * MIDDLE:
                kx, ky, kz, met[n] = ax, ay, az, 0
                break
        ends[n, 0] = centre(kx, resolution)
        ends[n, 1] = centre(ky, resolution)
        ends[n, 2] = centre(kz, resolution)
