"""What proves the references of the chapter: each oracle says its way in its docstring."""

import numpy as np
from numpy.testing import assert_allclose
from scipy.linalg import null_space

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
