"""J v = b for many small J at once, by Cholesky's factors of J J^T: arithmetic without checks."""

from __future__ import annotations

from math import sqrt


def solve(J, b, preferred, damping, v, L, y):
    """v nearest to `preferred` with J v = b, shapes (N, m, n), (N, m), (N, n) to (N, n).

    L (m, m) and y (m,) are scratch. Returns the index of the first J whose rows depend on each
    other, -1 if there is none.
    """
    count, m, n = J.shape
    for i in range(count):
        for row in range(m):
            missing = b[i, row]
            for k in range(n):
                missing -= J[i, row, k] * preferred[i, k]
            y[row] = missing
        for row in range(m):
            for column in range(row + 1):
                product = damping * damping if row == column else 0.0
                for k in range(n):
                    product += J[i, row, k] * J[i, column, k]
                square = product
                for k in range(column):
                    product -= L[row, k] * L[column, k]
                if row > column:
                    L[row, column] = product / L[column, column]
                else:
                    if not product > 1e-14 * square:
                        return i
                    L[row, row] = sqrt(product)
        for row in range(m):
            for k in range(row):
                y[row] -= L[row, k] * y[k]
            y[row] /= L[row, row]
        for row in range(m - 1, -1, -1):
            for k in range(row + 1, m):
                y[row] -= L[k, row] * y[k]
            y[row] /= L[row, row]
        for k in range(n):
            v[i, k] = preferred[i, k]
            for row in range(m):
                v[i, k] += J[i, row, k] * y[row]
    return -1
