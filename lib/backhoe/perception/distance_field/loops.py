"""The loops of `field` in plain Python; `engine` has them compiled."""

from __future__ import annotations

from math import inf

import numpy as np


def lower_envelope(f, d, apexes, borders):
    """Least of the parabolas (q - p)^2 + f[p] at each place q, into d; all of shape (n,) [1].

    Parabolas join the envelope one by one; each cuts off those that it is below from there on.
    `apexes` (n,) and `borders` (n + 1,) are room for the envelope.
    Source: Felzenszwalb and Huttenlocher 2012, algorithm 1.
    """
    last = -1
    for p in range(len(f)):
        if f[p] == inf:
            continue
        border = -inf
        while last >= 0:
            q = apexes[last]
            border = ((f[p] + p * p) - (f[q] + q * q)) / (2.0 * (p - q))
            if border > borders[last]:
                break
            last -= 1
            border = -inf
        last += 1
        apexes[last], borders[last] = p, border
    if last < 0:
        d[:] = inf
        return
    borders[last + 1], k = inf, 0
    for q in range(len(f)):
        while borders[k + 1] < q:
            k += 1
        d[q] = (q - apexes[k]) ** 2 + f[apexes[k]]


def squared_distances(grid):
    """Squares of the distance to the nearest 0 of a grid (a, b, c) of 0 and inf, in place [1].

    Along one axis after another: the squares of lines add up, Pythagoras by parts.
    """
    n = max(grid.shape)
    f, d = np.empty(n), np.empty(n)
    apexes, borders = np.empty(n, np.int64), np.empty(n + 1)
    a, b, c = grid.shape
    for i in range(a):
        for j in range(b):
            f[:c] = grid[i, j]
            lower_envelope(f[:c], d[:c], apexes, borders)
            grid[i, j] = d[:c]
    for i in range(a):
        for k in range(c):
            f[:b] = grid[i, :, k]
            lower_envelope(f[:b], d[:b], apexes, borders)
            grid[i, :, k] = d[:b]
    for j in range(b):
        for k in range(c):
            f[:a] = grid[:, j, k]
            lower_envelope(f[:a], d[:a], apexes, borders)
            grid[:, j, k] = d[:a]
