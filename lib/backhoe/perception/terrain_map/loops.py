"""The loops of `heights` and `layers` in plain Python; `engine` has them compiled."""

from __future__ import annotations

from math import floor, inf, isnan, sqrt

import numpy as np


def gather(points, x0, y0, cell, sums):
    """Add points (n, 3) to the cells that they lie in: how many, and their sums, (r, c, 4) [1, m].

    x and y are counted from the cell's middle.
    """
    rows, columns = sums.shape[:2]
    for n in range(len(points)):
        x, y = (points[n, 0] - x0) / cell, (points[n, 1] - y0) / cell
        if not (-0.5 <= x < columns - 0.5 and -0.5 <= y < rows - 0.5):
            continue
        i, j = min(floor(y + 0.5), rows - 1), min(floor(x + 0.5), columns - 1)
        sums[i, j, 0] += 1
        sums[i, j, 1] += (x - j) * cell
        sums[i, j, 2] += (y - i) * cell
        sums[i, j, 3] += points[n, 2]


def slope(heights, offsets, i, j, di, dj, cell):
    """Slope of cell (i, j) along one axis, from the cells on both sides, one, or none: 0."""
    rows, columns = heights.shape
    low, high = (i - di, j - dj), (i + di, j + dj)
    if low[0] < 0 or low[1] < 0 or isnan(heights[low]):
        low = (i, j)
    if high[0] >= rows or high[1] >= columns or isnan(heights[high]):
        high = (i, j)
    steps = high[0] - low[0] + high[1] - low[1]
    if steps == 0:
        return 0.0
    return (heights[high] - heights[low]) / (steps * cell + offsets[high] - offsets[low])


def slopes(heights, sums, cell, found):
    """Slopes along x and y of the cells with points, into `found` (r, c, 2) [1].

    Heights are those of the scan, each where its points lie, and the map's around them.
    """
    rows, columns = heights.shape
    x, y, z = np.zeros((rows, columns)), np.zeros((rows, columns)), heights.copy()
    for i in range(rows):
        for j in range(columns):
            if sums[i, j, 0] > 0:
                x[i, j], y[i, j], z[i, j] = sums[i, j, 1:] / sums[i, j, 0]
    for i in range(rows):
        for j in range(columns):
            if sums[i, j, 0] > 0:
                found[i, j, 0] = slope(z, x, i, j, 0, 1, cell)
                found[i, j, 1] = slope(z, y, i, j, 1, 0, cell)


def lift(points, origin, x0, y0, cell, gradient, total):
    """Squares of the height by which 1 m more of range lifts a point off its surface, summed up.

    Source: first order; a point p = o + r u moves by u, its surface stands still.
    """
    rows, columns = total.shape
    for n in range(len(points)):
        x, y = (points[n, 0] - x0) / cell, (points[n, 1] - y0) / cell
        if not (-0.5 <= x < columns - 0.5 and -0.5 <= y < rows - 0.5):
            continue
        i, j = min(floor(y + 0.5), rows - 1), min(floor(x + 0.5), columns - 1)
        ux, uy, uz = points[n, 0] - origin[0], points[n, 1] - origin[1], points[n, 2] - origin[2]
        up = uz - gradient[i, j, 0] * ux - gradient[i, j, 1] * uy
        total[i, j] += up * up / max(ux * ux + uy * uy + uz * uz, 1e-12)


def update(heights, variance, seen, changed, sums, gradient, lifts, time, how):
    """A Kalman step a cell; returns how many cells were found changed.

    Args:
        heights, variance, seen, changed: of the map, changed in place, shape (r, c) [m, m^2, s, s].
        sums, gradient, lifts: of the scan, as `gather`, `slopes` and `lift` have them.
        time: of the scan [s].
        how: range's and roughness's variances, common variance [m^2], growth [m^2/s], gate [1].
    """
    ranging, rough, common, growth, gate = how
    rows, columns = heights.shape
    count = 0
    for i in range(rows):
        for j in range(columns):
            n = sums[i, j, 0]
            if n == 0:
                continue
            mean = sums[i, j, 1:] / n
            z = mean[2] - gradient[i, j, 0] * mean[0] - gradient[i, j, 1] * mean[1]
            R = (ranging * lifts[i, j] / n + rough) / n
            h, P = heights[i, j], variance[i, j] + growth * (time - seen[i, j])
            if isnan(h):
                heights[i, j], variance[i, j], changed[i, j] = z, R, time
            elif (z - h) ** 2 > gate * gate * (P + R + common):
                heights[i, j], variance[i, j], changed[i, j] = z, R, time
                count += 1
            else:
                K = P / (P + R) if P + R > 0 else 0.5
                heights[i, j], variance[i, j] = h + K * (z - h), (1 - K) * P
            seen[i, j] = time
    return count


def envelope(lowest, slope):
    """The highest surface under all `lowest` (r, c) [m] that rises by at most `slope` a cell [m].

    In place; inf where nothing was seen. Two sweeps over the eight neighbours, as in a chamfer
    distance: along diagonals the way is sqrt(2), at other angles at most 8 % too long.
    """
    rows, columns = lowest.shape
    across = sqrt(2) * slope
    for sweep in range(2):
        turn = 1 - 2 * sweep
        for a in range(rows):
            i = a if sweep == 0 else rows - 1 - a
            for b in range(columns):
                j = b if sweep == 0 else columns - 1 - b
                best = lowest[i, j]
                for di, dj, step in ((0, 1, slope), (1, 0, slope), (1, 1, across), (1, -1, across)):
                    k, m = i - turn * di, j - turn * dj
                    if 0 <= k < rows and 0 <= m < columns and lowest[k, m] < inf:
                        best = min(best, lowest[k, m] + step)
                lowest[i, j] = best
