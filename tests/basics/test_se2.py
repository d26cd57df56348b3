"""Poses in the plane against their matrices."""

import numpy as np
import pytest
from scipy.linalg import expm

from backhoe.basics.se2 import compose, relative, se2_exp, se2_matrix


def test_the_exponential_is_that_of_the_matrix():
    for v_x, v_y, omega in np.random.default_rng(7).normal(size=(30, 3)):
        generator = np.array([[0, -omega, v_x], [omega, 0, v_y], [0, 0, 0]])
        found = se2_matrix(se2_exp([v_x, v_y, omega]))
        np.testing.assert_allclose(found, expm(generator), atol=1e-14)
    np.testing.assert_array_equal(se2_exp([1.0, 2.0, 0.0]), [1.0, 2.0, 0.0])


def test_composing_poses_multiplies_their_matrices():
    a, b = np.random.default_rng(8).normal(size=(2, 50, 3))
    np.testing.assert_allclose(se2_matrix(compose(a, b)), se2_matrix(a) @ se2_matrix(b), atol=1e-14)
    np.testing.assert_allclose(compose(a, relative(a, b)), b, atol=1e-14)
    np.testing.assert_array_equal(compose(a, b)[:, 2], a[:, 2] + b[:, 2])


def test_poses_that_do_not_fit_are_named():
    with pytest.raises(ValueError, match="poses must be alike in shape"):
        compose(np.zeros((2, 3)), np.zeros((4, 3)))
    with pytest.raises(ValueError, match=r"xi must end in 3 values \(v_x T, v_y T, omega T\)"):
        se2_exp([1.0, 0.0])
