"""Encoders: ticks, counters that overflow, speeds that they cannot tell apart."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from backhoe.localisation.odometry import Encoder


@given(
    st.lists(st.integers(-127, 127), min_size=1, max_size=60),
    st.integers(-(10**9), 10**9),
    st.booleans(),
)
def test_increments_come_back_across_overflows_both_ways(steps, start, signed):
    encoder = Encoder(ticks=500, bits=8, signed=signed)
    total = start + np.r_[0, np.cumsum(steps)]
    readings = encoder.count((total + 0.5) * encoder.resolution)
    low = -128 if signed else 0
    assert (readings >= low).all() and (readings < low + 256).all()
    assert encoder.increments(readings).tolist() == steps


def test_the_last_step_before_half_a_counter_is_told_and_half_is_refused():
    encoder = Encoder(100, bits=8)
    assert encoder.increments([0, 127]).tolist() == [127]
    assert encoder.increments([0, 129]).tolist() == [-127]
    with pytest.raises(ValueError, match=r"between readings 1 and 2 .*exactly half its range, 128"):
        encoder.increments([0, 3, 131])


def test_a_counter_read_too_slowly_shows_another_motion():
    encoder = Encoder(100, bits=8)
    speed, dt = 1.03 * encoder.fastest(0.1), 0.1
    angle = speed * dt * np.arange(20) + 0.5 * encoder.resolution
    shown = encoder.angles(encoder.count(angle), angle[0])
    assert shown[-1] < 0 < angle[-1]


@given(st.lists(st.floats(-50, 50), min_size=2, max_size=50), st.integers(1, 10**5))
def test_angles_are_within_a_tick_of_what_the_wheel_turned(angles, ticks):
    encoder, angles = Encoder(ticks, bits=32), np.array(angles)
    shown = encoder.angles(encoder.count(angles), angles[0])
    assert (np.abs(shown - angles) <= encoder.resolution * (1 + 1e-9)).all()


def test_a_turn_has_as_many_ticks_as_the_encoder_says():
    encoder = Encoder(ticks=100)
    assert encoder.count(2 * np.pi * 0.375) == 37
    assert encoder.angles(np.arange(101))[-1] == pytest.approx(2 * np.pi)


def test_batches_of_readings_are_taken_row_by_row():
    encoder = Encoder(1000, bits=10)
    angle = np.cumsum(np.random.default_rng(1).uniform(-1, 1, (3, 4, 50)), axis=-1)
    together = encoder.angles(encoder.count(angle))
    for i in np.ndindex(3, 4):
        np.testing.assert_array_equal(together[i], encoder.angles(encoder.count(angle[i])))


def test_quantisation_looks_like_noise_of_a_tick_over_the_root_of_12():
    encoder = Encoder(720, bits=24)
    angle = np.random.default_rng(2).uniform(0, 100, 200_000)
    error = angle - encoder.count(angle) * encoder.resolution - encoder.resolution / 2
    assert error.std() == pytest.approx(encoder.resolution / np.sqrt(12), rel=0.01)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0,), "Encoder.ticks must be one whole number at least 1 and at most"),
        ((100.0,), "Encoder.ticks must be one whole number"),
        ((True,), "Encoder.ticks"),
        ((100, 1), "Encoder.bits must be one whole number at least 2 and at most 52, got 1"),
        ((100, 64), "Encoder.bits"),
    ],
)
def test_an_encoder_has_whole_ticks_and_a_counter(arguments, message):
    with pytest.raises(ValueError, match=message):
        Encoder(*arguments)


@pytest.mark.parametrize(
    ("counts", "message"),
    [
        ([0, 256], "shows whole numbers from 0 to 255, got 256"),
        ([0, -1], "got -1"),
        ([0, 0.5], "got 0.5"),
        ([0, np.nan], "counts must be finite"),
        (3, r"counts must end in n readings, got shape \(\)"),
    ],
)
def test_readings_must_be_those_of_the_counter(counts, message):
    with pytest.raises(ValueError, match=message):
        Encoder(100, bits=8).increments(counts)


def test_bad_angles_and_times_are_named():
    encoder = Encoder(100)
    with pytest.raises(ValueError, match="angle must be finite"):
        encoder.count([0, np.inf])
    with pytest.raises(ValueError, match="dt must be one number above 0"):
        encoder.fastest(0.0)
    with pytest.raises(ValueError, match=r"start must be one finite number \[rad\], got nan"):
        encoder.angles([0, 1], np.nan)
