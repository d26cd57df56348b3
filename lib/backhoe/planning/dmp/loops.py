"""The loops of the primitives, written once as plain Python; `engine` has them compiled.

Shapes: m samples, n kernels, d dimensions. Units: times [s], positions of any unit.
"""

from __future__ import annotations

from math import exp

FAR = 37.0
"""A kernel is left out where it is below exp(-37) of the largest: beyond a float's digits."""


def reach(u, centres, widths, first, counts):
    """Which kernels count at each sample: first (m,) and how many, counts (m,); both rise."""
    n, near = len(centres), 0
    sign = 1.0 if centres[-1] >= centres[0] else -1.0
    for k in range(len(u)):
        while near + 1 < n and sign * (u[k] - centres[near] + u[k] - centres[near + 1]) > 0:
            near += 1
        best = 1e300
        for i in range(max(near - 1, 0), min(near + 2, n)):
            best = min(best, widths[i] * (u[k] - centres[i]) ** 2)
        low = high = near
        while low > 0 and widths[low - 1] * (u[k] - centres[low - 1]) ** 2 < best + FAR:
            low -= 1
        while high + 1 < n and widths[high + 1] * (u[k] - centres[high + 1]) ** 2 < best + FAR:
            high += 1
        first[k], counts[k] = low, high - low + 1


def kernels(u, s, centres, widths, first, offsets, values, totals):
    """s psi / sum(psi) of each kernel that counts, in a row, and s psi = value * total (m,)."""
    for k in range(len(u)):
        begin, total, best = offsets[k], 0.0, 1e300
        for j in range(offsets[k + 1] - begin):
            best = min(best, widths[first[k] + j] * (u[k] - centres[first[k] + j]) ** 2)
        for j in range(offsets[k + 1] - begin):
            i = first[k] + j
            values[begin + j] = exp(best - widths[i] * (u[k] - centres[i]) ** 2)
            total += values[begin + j]
        for j in range(offsets[k + 1] - begin):
            values[begin + j] *= s[k] / total
        totals[k] = total * exp(-best)


def weighed(first, offsets, values, by, y, sums):
    """sum over the samples of value * by * y, into sums (n, d); by (m,), y (m, d), d in fours."""
    for c in range(0, y.shape[1], 4):
        for k in range(len(first)):
            to = first[k] - offsets[k]
            y0, y1, y2, y3 = y[k, c], y[k, c + 1], y[k, c + 2], y[k, c + 3]
            for j in range(offsets[k], offsets[k + 1]):
                one = values[j] * by[k]
                sums[to + j, c] += one * y0
                sums[to + j, c + 1] += one * y1
                sums[to + j, c + 2] += one * y2
                sums[to + j, c + 3] += one * y3


def products(first, offsets, values, sums):
    """sum over the samples of the product of two values, into the upper half of sums (n, n)."""
    for k in range(len(first)):
        begin, end, n = offsets[k], offsets[k + 1], first[k]
        for i in range(begin, end):
            for j in range(i, end):
                sums[n + i - begin, n + j - begin] += values[i] * values[j]


def mixed(first, offsets, values, weights, f):
    """f (m, d) = sum of the weights (n, d) times the normed kernels; d in fours."""
    for c in range(0, f.shape[1], 4):
        for k in range(len(first)):
            to, f0, f1, f2, f3 = first[k] - offsets[k], 0.0, 0.0, 0.0, 0.0
            for j in range(offsets[k], offsets[k + 1]):
                f0 += values[j] * weights[to + j, c]
                f1 += values[j] * weights[to + j, c + 1]
                f2 += values[j] * weights[to + j, c + 2]
                f3 += values[j] * weights[to + j, c + 3]
            f[k, c], f[k, c + 1], f[k, c + 2], f[k, c + 3] = f0, f1, f2, f3


def differences(t, x, v, a):
    """Slope and curvature of the parabola through three samples, at the ends of the last such."""
    m, d = x.shape
    for k in range(m):
        i = min(max(k, 1), m - 2)
        before, after = t[i] - t[i - 1], t[i + 1] - t[i]
        for c in range(d):
            left, right = (x[i, c] - x[i - 1, c]) / before, (x[i + 1, c] - x[i, c]) / after
            a[k, c] = 2.0 * (right - left) / (before + after)
            middle = (left * after + right * before) / (before + after)
            v[k, c] = middle + a[k, c] * (t[k] - t[i])


def wanted(x, v, a, s, start, goal, by_v, by_a, f):
    """f = u - g + (g - x0) s into f (m, d), with u = x + by_v v + by_a a; s (m,)."""
    m, d = x.shape
    for k in range(m):
        for c in range(d):
            u = x[k, c] + by_v * v[k, c] + by_a * a[k, c]
            f[k, c] = u - goal[c] + (goal[c] - start[c]) * s[k]


def parabolas(t, x, half, y, v, a):
    """A parabola by weighted least squares through the samples within `half` [s] of each time: its
    value, slope and curvature there. The weights fall as (1 - (dt/half)^2)^2."""
    m, d = x.shape
    low = high = 0
    for k in range(m):
        while t[low] <= t[k] - half:
            low += 1
        while high < m and t[high] < t[k] + half:
            high += 1
        w0 = w1 = 0.0
        for i in range(low, high):
            w = (1.0 - ((t[i] - t[k]) / half) ** 2) ** 2
            w0 += w
            w1 += w * (t[i] - t[k])
        mean = w1 / w0
        w2 = w3 = 0.0
        for i in range(low, high):
            w, p = (1.0 - ((t[i] - t[k]) / half) ** 2) ** 2, t[i] - t[k] - mean
            w2 += w * p * p
            w3 += w * p * p * p
        skew, var, w4 = w3 / w2, w2 / w0, 0.0
        for i in range(low, high):
            w, p = (1.0 - ((t[i] - t[k]) / half) ** 2) ** 2, t[i] - t[k] - mean
            w4 += w * (p * p - skew * p - var) ** 2
        for c in range(d):
            s0 = s1 = s2 = 0.0
            for i in range(low, high):
                w, p = (1.0 - ((t[i] - t[k]) / half) ** 2) ** 2, t[i] - t[k] - mean
                s0 += w * x[i, c]
                s1 += w * p * x[i, c]
                s2 += w * (p * p - skew * p - var) * x[i, c]
            c0, c1, c2 = s0 / w0, s1 / w2, s2 / w4
            y[k, c] = c0 - c1 * mean + c2 * (mean * mean + skew * mean - var)
            v[k, c] = c1 - c2 * (2.0 * mean + skew)
            a[k, c] = 2.0 * c2


def follow(u, x, v, M, xs, vs):
    """(x, v) after a step = M (x, v, u before, u after), for each dimension, into xs, vs (m, d)."""
    m, d = u.shape
    xx, xv, xb, xa = M[0, 0], M[0, 1], M[0, 2], M[0, 3]
    vx, vv, vb, va = M[1, 0], M[1, 1], M[1, 2], M[1, 3]
    for c in range(d):
        xs[0, c], vs[0, c] = x[c], v[c]
    for k in range(m - 1):
        for c in range(d):
            p, q, b, e = xs[k, c], vs[k, c], u[k, c], u[k + 1, c]
            xs[k + 1, c] = xx * p + xv * q + xb * b + xa * e
            vs[k + 1, c] = vx * p + vv * q + vb * b + va * e
