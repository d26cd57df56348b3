"""The loops of `grid` and `body` in plain Python; `engine` has them compiled."""

from __future__ import annotations

from math import floor


def gather(points, leaf, low, slots, keys, sums, counts, start, filled):
    """Add points to the voxels that they lie in.

    Args:
        points: shape (n, 3) [m].
        leaf: edge of a voxel [m].
        low: lowest index along each axis, three whole numbers as floats.
        slots: an open table of voxels, -1 where empty, a power of 2 of them.
        keys, sums, counts: of the voxels in order of appearance, (m,), (m, 3), (m,).
        start, filled: points and voxels already done.

    Returns:
        Points and voxels that are done: all, unless there is no room for one voxel more.
    """
    mask = len(slots) - 1
    for n in range(start, len(points)):
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        i = int(floor(x / leaf) - low[0])
        j = int(floor(y / leaf) - low[1])
        k = int(floor(z / leaf) - low[2])
        key = k << 42 | j << 21 | i
        slot = ((key * 0x9E3779B1 ^ key >> 21) >> 7) & mask
        while slots[slot] >= 0 and keys[slots[slot]] != key:
            slot = (slot + 1) & mask
        v = slots[slot]
        if v < 0:
            if filled == len(keys):
                return n, filled
            v = filled
            filled += 1
            slots[slot], keys[v] = v, key
        sums[v, 0] += x
        sums[v, 1] += y
        sums[v, 2] += z
        counts[v] += 1
    return len(points), filled


def outside(points, planes, first, middles, radii, padding, keep):
    """Say of each point, in `keep` (n,), whether it is in none of the convex volumes.

    Args:
        points: shape (n, 3) [m].
        planes: outward normals and offsets of all volumes, shape (p, 4) [1, m].
        first: where each volume's planes begin, and the end, shape (v + 1,).
        middles, radii: a sphere about each volume, shapes (v, 3), (v,) [m].
        padding: what the volumes are larger [m].
    """
    for n in range(len(points)):
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        keep[n] = True
        for v in range(len(radii)):
            dx, dy, dz = x - middles[v, 0], y - middles[v, 1], z - middles[v, 2]
            if dx * dx + dy * dy + dz * dz > radii[v] * radii[v]:
                continue
            inside = True
            for p in range(first[v], first[v + 1]):
                far = planes[p, 0] * x + planes[p, 1] * y + planes[p, 2] * z + planes[p, 3]
                if far > padding:
                    inside = False
                    break
            if inside:
                keep[n] = False
                break
