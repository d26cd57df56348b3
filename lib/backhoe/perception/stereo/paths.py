"""The loops of semi-global matching, as plain Python; `engine` compiles them.

Costs are uint16, (rows, columns, disparities), the disparities side by side in memory. Where the
right eye's pixel would lie outside its picture they are `OUTSIDE`, so that no path goes there.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

OUTSIDE = np.uint16(2000)
"""Cost of a pixel that has no partner."""

WALL = np.uint16(60000)
"""Above all sums of a way, also after a step."""


def window_costs(left: NDArray, right: NDArray, half: int, costs: NDArray, room: NDArray) -> None:
    """Fill `costs` with the mean absolute difference of windows of 2 half + 1 pixels a side, in
    quarters of a grey level; beyond the picture its outermost pixels go on. `room` (columns,)
    int32."""
    rows, columns, disparities = costs.shape
    share = 4.0 / (2 * half + 1) ** 2
    for d in range(disparities):
        room[:] = 0
        for i in range(-half, rows + half):
            new = min(max(i, 0), rows - 1)
            old = min(max(i - 2 * half - 1, 0), rows - 1)
            for j in range(d, columns):
                room[j] += abs(np.int32(left[new, j]) - np.int32(right[new, j - d]))
                if i > half:
                    room[j] -= abs(np.int32(left[old, j]) - np.int32(right[old, j - d]))
            at = i - half
            if at < 0:
                continue
            for j in range(min(d, columns)):
                costs[at, j, d] = OUTSIDE
            if d < columns:
                total = np.int32(0)
                for k in range(-half, half + 1):
                    total += room[min(max(d + k, d), columns - 1)]
                for j in range(d, columns):
                    costs[at, j, d] = np.uint16(total * share + 0.5)
                    total += room[min(j + half + 1, columns - 1)] - room[max(j - half, d)]


def add_paths(costs, di, dj, turned, small, large, total, room):
    """Add to `total` the costs of the cheapest straight ways to each pixel from one side.

    A way comes from the pixel (di, dj) before, (0, 1) or (1, -1 to 1), or from its opposite if
    `turned`. It may keep its disparity, change it by one for `small`, or to any other for `large`.
    What the cheapest has cost at the pixel before is taken off, so that sums stay small. `room` is
    uint16 (2, columns + 2, disparities + 2).
    """
    rows, columns, disparities = costs.shape
    room[:] = 0
    room[:, :, 0] = room[:, :, disparities + 1] = WALL
    for row in range(rows):
        i = rows - 1 - row if turned else row
        now = room[row % 2]
        before = room[(row + 1) % 2] if di else now
        for place in range(columns):
            j = columns - 1 - place if turned else place
            past, here = before[place + 1 - dj], now[place + 1]
            cost, sums = costs[i, j], total[i, j]
            least = WALL
            for d in range(1, disparities + 1):
                least = min(least, past[d])
            jump = np.uint16(least + large)
            for d in range(disparities):
                near = np.uint16(min(past[d], past[d + 2]) + small)
                way = min(min(past[d + 1], near), jump)
                here[d + 1] = np.uint16(cost[d] + way - least)
                sums[d] = np.uint16(sums[d] + here[d + 1])


def cheapest(total: NDArray, uniqueness: int, disparity: NDArray, cost: NDArray) -> None:
    """Fill `disparity` (NaN where another one, no neighbour, is as good) and its `cost`.

    Columns whose search would leave the right picture stay NaN. The disparity between whole ones
    is the middle of the parabola through the costs beside the best.
    """
    rows, columns, disparities = total.shape
    disparity[:] = np.nan
    for i in range(rows):
        for j in range(disparities - 1, columns):
            ways = total[i, j]
            k = 0
            for d in range(1, disparities):
                if ways[d] < ways[k]:
                    k = d
            best = np.int64(ways[k])
            rivals = 0
            for d in range(disparities):
                if abs(d - k) > 1 and np.int64(ways[d]) * (100 - uniqueness) < best * 100:
                    rivals += 1
            if rivals:
                continue
            disparity[i, j], cost[i, j] = k, ways[k]
            if 0 < k < disparities - 1:
                below, above = np.int64(ways[k - 1]), np.int64(ways[k + 1])
                bend = below + above - 2 * best
                if bend > 0:
                    disparity[i, j] += np.float32((below - above) / (2 * bend))
