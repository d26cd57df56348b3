"""Angles wrapped where two are compared."""

import numpy as np
import pytest

from backhoe.basics.angles import residual, wrap

ANGLES = np.array([0.0, np.pi, -np.pi, 3.5, -3.5, 100.0, -1e-300, 2 * np.pi])


def test_wrap_is_within_half_a_turn_and_the_same_direction():
    found = wrap(ANGLES)
    assert ((found > -np.pi) & (found <= np.pi)).all()
    np.testing.assert_allclose(np.exp(1j * found), np.exp(1j * ANGLES), atol=1e-13)


def test_a_float_is_wrapped_as_in_an_array_and_stays_one():
    for angle, expected in zip(ANGLES.tolist(), wrap(ANGLES).tolist(), strict=True):
        assert wrap(angle) == expected and type(wrap(angle)) is float


def test_an_angle_within_half_a_turn_is_returned_to_the_last_bit():
    inside = np.random.default_rng(1).uniform(-np.pi, np.pi, 1000)
    np.testing.assert_array_equal(wrap(inside), inside)


def test_what_is_infinite_or_nan_has_no_direction():
    with np.errstate(invalid="ignore"):
        assert np.isnan([wrap(np.inf), wrap(float("nan"))]).all()


def test_a_residual_is_wrapped_in_its_angles_alone_and_leaves_its_arguments():
    a, b = np.array([[3.0, 4.0], [7.0, -7.0]]), np.array([-1.0, -1.0])
    kept = a.copy()
    np.testing.assert_allclose(residual(a, b, (1,)), [[4.0, 5 - 2 * np.pi], [8.0, 2 * np.pi - 6]])
    np.testing.assert_array_equal(residual(a, b), a - b)
    np.testing.assert_array_equal(a, kept)


def test_bad_angles_are_named():
    with pytest.raises(ValueError, match="angle must be numbers in rad, got 'north'"):
        wrap("north")
    with pytest.raises(ValueError, match="angles must be indices from 0 to 1"):
        residual([1, 2], [1, 1], (5,))
