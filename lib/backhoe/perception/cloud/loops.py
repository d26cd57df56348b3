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


def mixed(key):
    """32 bits in which the three indices of a voxel's key, 21 bits each, are mixed."""
    i, j, k = key & 0x1FFFFF, key >> 21 & 0x1FFFFF, key >> 42
    word = (i * 73856093 ^ j * 19349669 ^ k * 83492791) & 0xFFFFFFFF
    word = ((word ^ word >> 15) * 0x2C1B3C6D) & 0xFFFFFFFF
    return word ^ word >> 12


def count(points, leaf, low, keys, shift, starts):
    """The voxel of each point, and where each bucket of voxels will begin.

    Args:
        points: shape (n, 3) [m].
        leaf: edge of a voxel [m].
        low: lowest index along each axis, shape (3,).
        keys: filled in with the voxels' indices above `low`, 21 bits each, shape (n,).
        shift: bits of `mixed` that do not choose the bucket.
        starts: filled in with the first place of each bucket, and the end, shape (b + 1,).
    """
    for n in range(len(points)):
        i = floor(points[n, 0] / leaf) - low[0]
        j = floor(points[n, 1] / leaf) - low[1]
        k = floor(points[n, 2] / leaf) - low[2]
        keys[n] = i | j << 21 | k << 42
        starts[(mixed(keys[n]) >> shift) + 1] += 1
    for b in range(1, len(starts)):
        starts[b] += starts[b - 1]


def deal(points, keys, shift, places, dealt, dealt_keys):
    """Put points and keys into their buckets, in their order; `places` (b,) is used up."""
    for n in range(len(points)):
        b = mixed(keys[n]) >> shift
        at = places[b]
        places[b] += 1
        dealt[at, 0], dealt[at, 1], dealt[at, 2] = points[n, 0], points[n, 1], points[n, 2]
        dealt_keys[at] = keys[n]


def gather(points, keys, starts, slots, sums, names, centroids):
    """Centroids of the voxels, a bucket after the other, each in the processor's cache.

    Args:
        points, keys, starts: as `deal` leaves them and `count` fills them in.
        slots: a table with -1 throughout, at least twice as long as the largest bucket, a power of
            2. A voxel's number in it that is lower than the bucket's first one is no longer there.
        sums, names: room for one bucket's voxels, shapes (m, 4), (m,).
        centroids: filled in, shape (n, 3) [m].

    Returns:
        Number of voxels.
    """
    filled = 0
    for b in range(len(starts) - 1):
        first, mask = filled, 1
        while mask < 2 * (starts[b + 1] - starts[b]):
            mask *= 2
        mask -= 1
        for n in range(starts[b], starts[b + 1]):
            key = keys[n]
            slot = mixed(key) & mask
            v = slots[slot] - first
            while v >= 0 and names[v] != key:
                slot = (slot + 1) & mask
                v = slots[slot] - first
            if v < 0:
                v = filled - first
                slots[slot] = filled
                filled += 1
                names[v] = key
                for axis in range(4):
                    sums[v, axis] = 0
            sums[v, 0] += points[n, 0]
            sums[v, 1] += points[n, 1]
            sums[v, 2] += points[n, 2]
            sums[v, 3] += 1
        for v in range(filled - first):
            for axis in range(3):
                centroids[first + v, axis] = sums[v, axis] / sums[v, 3]
    return filled


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
