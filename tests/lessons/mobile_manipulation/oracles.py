"""What proves the references of the chapter: each oracle says its way in its docstring."""

from itertools import combinations

import numpy as np
from numpy.testing import assert_allclose
from scipy.linalg import null_space
from scipy.optimize import linprog, nnls

from backhoe.whole_body import hand

# 12a, equations


def hands_moved_a_little(answer, q, robot):
    """Each velocity alone for a moment, forth and back: how far the hand went, over the time."""
    assert np.shape(answer) == (3, 2 + robot.joints)
    dt = 1e-5
    for k, velocities in enumerate(np.eye(2 + robot.joints)):
        u, *turns = velocities
        move = dt * np.array([u * np.cos(q[2]), u * np.sin(q[2]), *turns])
        went = (hand(q + move, robot) - hand(q - move, robot)) / (2 * dt)
        assert_allclose(answer[:, k], went, atol=1e-8)


def no_way_along_the_solutions_is_cheaper(answer, J, b, weights):
    """It solves J v = b, and the cost's slope along each direction that J does not see is zero."""
    assert_allclose(J @ answer, b, atol=1e-9)
    assert_allclose(null_space(J).T @ (weights * answer), 0, atol=1e-9)


def from_a_basis_of_the_null_space(answer, J):
    """The sum of z z^T over an orthonormal basis of the null space, from singular values."""
    Z = null_space(J)
    assert Z.shape[1] == J.shape[1] - len(J)
    assert_allclose(answer, Z @ Z.T, atol=1e-10)


def after_the_step_w_of_the_error_is_left(answer, h, goal, next_goal, W, T):
    """The step is made: the hand goes on for T, and the new error is W times the old one."""
    assert_allclose(next_goal - (h + T * answer), W * (goal - h), atol=1e-12)


# 12b, grading


def areas_of_all_triples_of_columns(answer, J, length):
    """Cauchy and Binet: w squared is the sum of the squared volumes of all triples of columns.

    A volume is a triple product, and it shrinks by the length for each turn among the three.
    """
    for found, first in zip(answer, (2, 0), strict=True):
        total = 0.0
        for triple in combinations(range(first, J.shape[1]), 3):
            a, b, c = J[:, triple].T
            total += (a @ np.cross(b, c) / length ** sum(k > 0 for k in triple)) ** 2
        np.testing.assert_allclose(found, total**0.5, rtol=1e-6, atol=1e-9)


def conditions_of_the_least_second_error(v, J1, b1, J2, b2):
    """J1 v = b1; no move that spares it makes the second error less; and no such v is shorter."""
    np.testing.assert_allclose(J1 @ v, b1, atol=1e-7)
    free = null_space(J1)
    np.testing.assert_allclose(free.T @ J2.T @ (J2 @ v - b2), 0.0, atol=1e-7)
    idle = null_space(np.vstack([J1, J2]), rcond=1e-9)
    np.testing.assert_allclose(idle.T @ v, 0.0, atol=1e-7)


def halved_until_it_fits(answer, v, lower, upper):
    """The factor by bisection: from 0, which fits, and 1, if that does not."""

    def fits(factor):
        return bool(((factor * v <= upper) & (factor * v >= lower)).all())

    low, high = 0.0, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if fits(middle) else (low, middle)
    np.testing.assert_allclose(answer, (1.0 if fits(1.0) else low) * v, rtol=1e-9, atol=1e-12)


def a_linear_programme_and_multipliers(v, J, b, preferred, lower, upper):
    """The greatest share of b by a linear programme; at its share, the conditions of Karush, Kuhn
    and Tucker: what draws v to the preferred is held by the edge's rows and the bounds it touches.
    """
    bounds = [*zip(lower, upper, strict=True), (0.0, 1.0)]
    most = linprog([0.0] * 6 + [-1.0], A_eq=np.c_[J, -b], b_eq=np.zeros(4), bounds=bounds).x[-1]
    s = float(b @ J @ v / (b @ b))
    assert most - 0.01 <= s <= most + 1e-9
    np.testing.assert_allclose(J @ v, s * b, atol=1e-9)
    assert (v <= upper + 1e-12).all() and (v >= lower - 1e-12).all()
    touched = np.c_[np.eye(6)[:, v > upper - 1e-7], -np.eye(6)[:, v < lower + 1e-7]]
    _, left = nnls(np.c_[J.T, -J.T, touched], preferred - v)
    assert left < 1e-6


EQUAL = {
    "12.5": {"length: zero for negative": "a length"},
    "12.7": {"upper is never negative": "limits of both directions: standing still is allowed"},
}
"""Mutants that are the reference in disguise, with the reason."""
