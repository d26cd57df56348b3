"""J v = b for many small J at once, by Cholesky's factors of J J^T: arithmetic without checks."""

from __future__ import annotations

from math import isfinite, sqrt

DEPENDENT = 1e-14
"""A row of J is taken for a sum of others where this share, or less, of its square is left [1]."""


def solve(J, b, preferred, damping, v, L, y):
    """v nearest to `preferred` with J v = b, shapes (N, m, n), (N, m), (N, n) to (N, n).

    damping (N,); L (m, m) and y (m,) are scratch. Returns the index of the first J whose rows
    depend on each other, or with which v is not finite; -1 if there is none.
    """
    count, m, n = J.shape
    for i in range(count):
        least = 1.0
        for row in range(m):
            for column in range(row + 1):
                product = damping[i] * damping[i] if row == column else 0.0
                for k in range(n):
                    product += J[i, row, k] * J[i, column, k]
                square = product
                for k in range(column):
                    product -= L[row, k] * L[column, k]
                if row > column:
                    L[row, column] = product / L[column, column]
                else:
                    if not product > DEPENDENT * square:
                        return i
                    least = min(least, product / square)
                    L[row, row] = sqrt(product)
        for k in range(n):
            v[i, k] = preferred[i, k]
        # What rounding leaves near a singularity, further rounds take away.
        for _ in range(4 if least < 1e-3 and damping[i] == 0.0 else 1):
            for row in range(m):
                missing = b[i, row]
                for k in range(n):
                    missing -= J[i, row, k] * v[i, k]
                for k in range(row):
                    missing -= L[row, k] * y[k]
                y[row] = missing / L[row, row]
            for row in range(m - 1, -1, -1):
                for k in range(row + 1, m):
                    y[row] -= L[k, row] * y[k]
                y[row] /= L[row, row]
            for k in range(n):
                for row in range(m):
                    v[i, k] += J[i, row, k] * y[row]
        total = 0.0
        for k in range(n):
            total += v[i, k]
        if not isfinite(total):
            return i
    return -1
