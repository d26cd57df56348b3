"""The loops of `grid` and `body` in plain Python; `engine` has them compiled."""

from __future__ import annotations

from math import floor


def extent(points, ends):
    """Lowest and highest coordinates into `ends` (2, 3) [m]; whether all of (n, 3) are finite."""
    finite = True
    for axis in range(3):
        ends[0, axis] = ends[1, axis] = points[0, axis]
    for n in range(len(points)):
        for axis in range(3):
            x = points[n, axis]
            finite &= x - x == 0
            ends[0, axis] = min(ends[0, axis], x)
            ends[1, axis] = max(ends[1, axis], x)
    return finite


def gather(points, leaf, slots, voxels, start, filled):
    """Add points to the voxels that they lie in.

    Args:
        points: shape (n, 3) [m].
        leaf: edge of a voxel [m].
        slots: an open table of voxels, -1 where empty, a power of 2 of them.
        voxels: in order of appearance, their three indices, the sums of their points and how many
            these are, shape (m, 8) with one place unused: together in the processor's cache.
        start, filled: points and voxels already done.

    Returns:
        Points and voxels that are done: all, unless there is no room for one voxel more.
    """
    mask = len(slots) - 1
    for n in range(start, len(points)):
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        i, j, k = floor(x / leaf), floor(y / leaf), floor(z / leaf)
        mixed = (i * 73856093 ^ j * 19349669 ^ k * 83492791) & 0xFFFFFFFF
        slot = (mixed ^ mixed >> 15) & mask
        v = slots[slot]
        while v >= 0 and (voxels[v, 0] != i or voxels[v, 1] != j or voxels[v, 2] != k):
            slot = (slot + 1) & mask
            v = slots[slot]
        if v < 0:
            if filled == len(voxels):
                return n, filled
            v = filled
            filled += 1
            slots[slot] = v
            voxels[v, 0], voxels[v, 1], voxels[v, 2] = i, j, k
        voxels[v, 3] += x
        voxels[v, 4] += y
        voxels[v, 5] += z
        voxels[v, 6] += 1
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
