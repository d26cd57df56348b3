"""The matcher's loops over pixels, as plain Python; `engine` compiles them.

Pictures are uint8; a prefiltered one has `cap` where there is no texture. Costs are sums of
absolute differences (SAD) in uint16: `LARGEST` keeps window and cap within it. The innermost loops
run over the disparities, side by side in memory, so that a processor does 16 of them at once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

MOST = np.uint16(65535)
LARGEST = 60_000
"""Most that a window's cost may reach, 2 cap a pixel."""


def sobel_response(image: NDArray, cap: int, out: NDArray) -> None:
    """Fill `out` with the horizontal Sobel derivative, clipped to +-cap, plus cap; (rows, columns).

    Above the first row lies the second, below the last the last but one (1); the first and last
    column are without texture.
    """
    rows, columns = image.shape
    for i in range(rows):
        over = image[i - 1] if i > 0 else image[min(1, rows - 1)]
        here = image[i]
        under = image[i + 1] if i < rows - 1 else image[max(rows - 2, 0)]
        out[i, 0] = out[i, columns - 1] = cap
        for j in range(1, columns - 1):
            right = np.int16(over[j + 1]) + 2 * np.int16(here[j + 1]) + np.int16(under[j + 1])
            left = np.int16(over[j - 1]) + 2 * np.int16(here[j - 1]) + np.int16(under[j - 1])
            out[i, j] = min(max(right - left, -cap), cap) + cap


def normalised_response(image: NDArray, half: int, cap: int, out: NDArray, sums: NDArray) -> None:
    """Fill `out` with the pixel less the mean of its window, clipped to +-cap, plus cap.

    The window is 2 half + 1 pixels a side; beyond the picture its outermost pixels go on. `sums`
    (columns,) is room for the columns' sums, int32.
    """
    rows, columns = image.shape
    share = np.float32(1 / (2 * half + 1) ** 2)
    sums[:] = 0
    for i in range(-half - 1, half):
        row = image[min(max(i, 0), rows - 1)]
        for j in range(columns):
            sums[j] += np.int32(row[j])
    line = np.empty(columns, dtype=np.int32)
    for i in range(rows):
        new, old = image[min(i + half, rows - 1)], image[max(i - half - 1, 0)]
        for j in range(columns):
            sums[j] += np.int32(new[j]) - np.int32(old[j])
        window = (half + 1) * sums[0]
        for j in range(half):
            window += sums[min(j, columns - 1)]
        for j in range(columns):
            window += sums[min(j + half, columns - 1)]
            window -= sums[max(j - half - 1, 0)]
            line[j] = window
        for j in range(columns):
            response = np.floor(np.float32(image[i, j]) - np.float32(line[j]) * share + 0.5)
            out[i, j] = np.uint8(min(max(response, np.float32(-cap)), np.float32(cap)) + cap)


def match_rows(left, right, first, last, half, cap, texture, uniqueness, columns, disparity, cost):
    """Fill rows first to last of `disparity` (NaN where none) and of its `cost`, by running sums.

    Args:
        left, right: prefiltered pictures, the right one mirrored, (rows, columns).
        first, last: rows that have a whole window around them, from `half` on.
        half: of the window, 2 half + 1 pixels a side.
        cap: of the prefilter.
        texture: least sum of |response| in the left window.
        uniqueness: by how much worse, in percent, every disparity but the best and its neighbours
            must be.
        columns: room for one column's sums a disparity, uint16 (columns - disparities + 1,
            disparities).
        disparity, cost: to fill, float32 and uint16 (rows, columns).
    """
    width, (places, disparities) = left.shape[1], columns.shape
    side = 2 * half + 1
    costs = np.zeros(disparities, dtype=np.uint16)
    nothing = np.zeros(disparities, dtype=np.uint16)
    textures = np.zeros(places, dtype=np.int64)
    columns[:] = 0
    for place in range(places):
        j = place + disparities - 1
        sums, mirrored = columns[place], width - 1 - j
        for i in range(first - half, first + half):
            pixel, others = left[i, j], right[i, mirrored : mirrored + disparities]
            textures[place] += abs(np.int64(pixel) - cap)
            for d in range(disparities):
                other = others[d]
                difference = np.uint16(max(pixel, other) - min(pixel, other))
                sums[d] = np.uint16(sums[d] + difference)
    for i in range(first, last):
        disparity[i] = np.nan
        costs[:] = 0
        seen = np.int64(0)
        for place in range(places):
            j = place + disparities - 1
            sums, mirrored = columns[place], width - 1 - j
            new, added = left[i + half, j], right[i + half, mirrored : mirrored + disparities]
            before = columns[place - side] if place >= side else nothing
            if i > first:
                old = left[i - half - 1, j]
                removed = right[i - half - 1, mirrored : mirrored + disparities]
                textures[place] -= abs(np.int64(old) - cap)
                for d in range(disparities):
                    a, r = added[d], removed[d]
                    gain = np.uint16(max(new, a) - min(new, a))
                    loss = np.uint16(max(old, r) - min(old, r))
                    sums[d] = np.uint16(sums[d] + gain - loss)
            else:
                for d in range(disparities):
                    a = added[d]
                    sums[d] = np.uint16(sums[d] + np.uint16(max(new, a) - min(new, a)))
            best = MOST
            for d in range(disparities):
                total = np.uint16(costs[d] + sums[d] - before[d])
                costs[d] = total
                best = min(best, total)
            textures[place] += abs(np.int64(new) - cap)
            seen += textures[place]
            if place >= side:
                seen -= textures[place - side]
            if place < side - 1 or seen < texture:
                continue
            limit = np.uint16(min(np.int64(best) + np.int64(best) * uniqueness // 100, 65535))
            at, rivals = MOST, np.uint16(0)
            for d in range(disparities):
                at = min(at, np.uint16(d) if costs[d] == best else MOST)
                rivals = np.uint16(rivals + (np.uint16(1) if costs[d] <= limit else np.uint16(0)))
            k, near = np.int64(at), np.int64(0)
            for d in range(max(k - 1, 0), min(k + 2, disparities)):
                if costs[d] <= limit:
                    near += 1
            if uniqueness > 0 and rivals > near:
                continue
            disparity[i, j - half] = k
            cost[i, j - half] = best
            below = np.int64(costs[k - 1] if k > 0 else costs[k + 1])
            above = np.int64(costs[k + 1] if k < disparities - 1 else costs[k - 1])
            rise = 2 * (max(below, above) - np.int64(best))
            if rise > 0:
                disparity[i, j - half] += np.float32((below - above) / rise)


def keep_consistent(disparity: NDArray, cost: NDArray, most: float, best: NDArray, claim: NDArray):
    """Drop pixels whose right pixel belongs to another one, by more than `most` disparities.

    A right pixel belongs to the left one that matches it at the lowest cost. All (rows, columns);
    `best`, int64, and `claim`, float32, are room for a row's costs and disparities, (columns,).
    """
    rows, columns = disparity.shape
    for i in range(rows):
        best[:] = 65536
        for j in range(columns):
            d = disparity[i, j]
            if d == d:
                other = j - int(d + 0.5)
                if cost[i, j] < best[other]:
                    best[other] = cost[i, j]
                    claim[other] = d
        for j in range(columns):
            d = disparity[i, j]
            if d == d and abs(claim[j - int(d + 0.5)] - d) > most:
                disparity[i, j] = np.nan


def drop_speckles(disparity, largest, step, parent, size, label):
    """Drop patches of at most `largest` pixels; neighbours differ by at most `step` in a patch.

    One pass gives each run of pixels in a row the patch of what lies above it and joins patches
    that it touches; a second one drops. `parent`, `size` (rows * columns,) and `label` (rows,
    columns) are room, int32.
    """
    rows, columns = disparity.shape
    count = 0
    for i in range(rows):
        mine, length, left, seen = -1, 0, np.float32(np.nan), -1
        for j in range(columns):
            d = disparity[i, j]
            if not abs(d - left) <= step:
                if length:
                    size[mine] += length
                mine, length, seen = -1, 0, -1
            left = d
            if not d == d:
                continue
            if i > 0 and abs(disparity[i - 1, j] - d) <= step and label[i - 1, j] != seen:
                seen = label[i - 1, j]
                other = seen
                while parent[other] != other:
                    parent[other] = parent[parent[other]]
                    other = parent[other]
                if mine < 0:
                    mine = other
                elif mine != other:
                    mine, other = min(mine, other), max(mine, other)
                    parent[other] = mine
                    size[mine] += size[other]
            if mine < 0:
                mine = count
                parent[mine] = mine
                size[mine] = 0
                count += 1
            label[i, j] = mine
            length += 1
        if length:
            size[mine] += length
    for k in range(count):
        parent[k] = parent[parent[k]]
        size[k] = size[parent[k]]
    for i in range(rows):
        for j in range(columns):
            if disparity[i, j] == disparity[i, j] and size[label[i, j]] <= largest:
                disparity[i, j] = np.nan
