"""J v = b for many small J at once, by Cholesky's factors of J J^T, and what the programme of
a step within limits needs: arithmetic without checks."""

from __future__ import annotations

from math import inf, isfinite, sqrt

DEPENDENT = 1e-14
"""A row of J is a sum of those before where this share of its square, or less, is left [1]."""

ROUNDING = 1e-28
"""A row, or what is left of it, whose square is this share of another's or less is rounding [1]."""

WITHIN = 1e9
"""What the programme takes of any value, of its own unit: quadprog may not end with larger ones."""


def solve(J, b, preferred, damping, v, L, y):
    """v nearest to `preferred` with J v = b, shapes (N, m, n), (N, m), (N, n) to (N, n).

    damping (N,); L (m, m) and y (m,) are scratch. Returns the index of the first J whose rows
    depend on each other, or with which v is not finite; -1 if there is none.
    """
    _, m, n = J.shape
    if m == 3 and n == 6:  # the machine's: sizes that the compiler knows are half as dear
        return solve_sized(J, b, preferred, damping, v, L, y, 3, 6)
    return solve_sized(J, b, preferred, damping, v, L, y, m, n)


def solve_sized(J, b, preferred, damping, v, L, y, m, n):
    """`solve` with its m and n."""
    for i in range(len(J)):
        A, x, least, smallest, largest = J[i], v[i], 1.0, inf, 0.0
        for row in range(m):
            for column in range(row):
                product = 0.0
                for k in range(n):
                    product += A[row, k] * A[column, k]
                for k in range(column):
                    product -= L[row, k] * L[column, k]
                L[row, column] = product * L[column, column]
            square = damping[i] * damping[i]
            for k in range(n):
                square += A[row, k] * A[row, k]
            product = square
            for k in range(row):
                product -= L[row, k] * L[row, k]
            if not product > DEPENDENT * square:
                return i
            least = min(least, product / square)
            smallest, largest = min(smallest, product), max(largest, square)
            L[row, row] = 1.0 / sqrt(product)
        if not smallest > ROUNDING * largest:
            return i
        for k in range(n):
            x[k] = preferred[i, k]
        # What rounding leaves near a singularity, further rounds take away.
        for _ in range(4 if least < 1e-3 and damping[i] == 0.0 else 1):
            for row in range(m):
                missing = b[i, row]
                for k in range(n):
                    missing -= A[row, k] * x[k]
                for k in range(row):
                    missing -= L[row, k] * y[k]
                y[row] = missing * L[row, row]
            for back in range(m):
                row = m - 1 - back
                left = y[row]
                for k in range(row + 1, m):
                    left -= L[k, row] * y[k]
                y[row] = left * L[row, row]
            for k in range(n):
                total = x[k]
                for row in range(m):
                    total += A[row, k] * y[row]
                x[k] = total
        total = 0.0
        for k in range(n):
            total += x[k]
        if not isfinite(total):
            return i
    return -1


def programme(J, b, lower, upper, v0, weights, A, c, G, a, C, least):
    """Fill G, a, C, least of min x^T G x / 2 - a^T x with C^T x >= least for x = (v, s).

    Shapes (m, n), (m,), (n,) four times, (k, n), (k,); then (n + 1, n + 1), (n + 1,), whose last
    value is given, (n + 1, m + 2 n + 2 + k) and its columns. The first m are equations. Returns
    whether all values are within `WITHIN` and lower is not above upper.
    """
    m, n = J.shape
    G[:], C[:], least[:] = 0.0, 0.0, 0.0
    fine = True
    for row in range(m):
        for k in range(n):
            C[k, row] = J[row, k]
            fine &= abs(J[row, k]) < WITHIN
        C[n, row] = -b[row]
        fine &= abs(b[row]) < WITHIN
    for k in range(n):
        G[k, k], a[k] = weights[k], weights[k] * v0[k]
        C[k, m + k], C[k, m + n + k] = 1.0, -1.0
        least[m + k], least[m + n + k] = lower[k], -upper[k]
        fine &= -WITHIN < lower[k] <= upper[k] < WITHIN and abs(a[k]) < WITHIN
        fine &= 1 / WITHIN < weights[k] < WITHIN
    G[n, n] = 1.0
    at = m + 2 * n
    C[n, at], C[n, at + 1], least[at + 1] = 1.0, -1.0, -1.0
    for row in range(len(A)):
        for k in range(n):
            C[k, at + 2 + row] = -A[row, k]
            fine &= abs(A[row, k]) < WITHIN
        least[at + 2 + row] = -c[row]
        fine &= abs(c[row]) < WITHIN
    return fine


def within(J, b, lower, upper, x, v):
    """Put the velocities of x = (v, s) into v, clipped by what rounding leaves; returns s and by
    how much J v misses s b."""
    m, n = J.shape
    s = min(max(x[n], 0.0), 1.0)
    for k in range(n):
        v[k] = min(max(x[k], lower[k]), upper[k])
    worst = 0.0
    for row in range(m):
        missed = -s * b[row]
        for k in range(n):
            missed += J[row, k] * v[k]
        worst = max(worst, abs(missed))
    return s, worst
