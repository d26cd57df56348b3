"""Tracks: how sprockets move the machine."""

import numpy as np
import pytest

from backhoe.basics.se2 import sides_of_twist, twist_of_sides
from backhoe.machine import BACKHOE, replace
from backhoe.vehicle.tracks import tracks_twist, twist_to_world, world_rates


@pytest.fixture
def rng():
    return np.random.default_rng(20)


def test_equal_sprockets_drive_straight_and_opposite_ones_turn_on_the_spot():
    r, gauge = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge
    np.testing.assert_allclose(tracks_twist(2.0, 2.0), [2 * r, 0])
    np.testing.assert_allclose(tracks_twist(-1.0, 1.0), [0, 2 * r / gauge])


def test_sides_and_twist_undo_each_other(rng):
    left, right = rng.normal(size=(2, 5, 7))
    sides = sides_of_twist(*twist_of_sides(left, right, 2.4), 2.4)
    np.testing.assert_allclose(sides, (left, right), atol=1e-14)


def test_world_rates_are_the_corrected_matrix_times_the_sprocket_speeds(rng):
    r, gauge = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge
    for right, left, psi in rng.normal(size=(20, 3)):
        matrix = np.array(
            [
                [r / 2 * np.cos(psi), r / 2 * np.cos(psi)],
                [r / 2 * np.sin(psi), r / 2 * np.sin(psi)],
                [r / gauge, -r / gauge],
            ]
        )
        np.testing.assert_allclose(
            world_rates(left, right, psi), matrix @ [right, left], atol=1e-14
        )


def test_each_track_moves_at_the_speed_of_its_sprocket(rng):
    """Velocity of the points above the tracks, by the velocity of a rigid body."""
    r, half = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge / 2
    for right, left in rng.normal(size=(20, 2)):
        v, omega = tracks_twist(left, right)
        velocity = [np.cross([0, 0, omega], [0, y, 0])[0] + v for y in (-half, half)]
        np.testing.assert_allclose(velocity, [r * right, r * left], atol=1e-14)


def test_a_turn_to_the_left_circles_a_point_on_the_left():
    v, omega = tracks_twist(1.0, 2.0)
    radius = v / omega
    x = np.zeros(3)
    steps = 2000
    dt = 2 * np.pi / omega / steps
    far = 0.0
    for _ in range(steps):
        middle = x[2] + omega * dt / 2
        x = x + dt * twist_to_world([v, omega], middle)
        far = max(far, x[1])
    np.testing.assert_allclose(x[:2], 0, atol=1e-9)
    assert far == pytest.approx(2 * radius, rel=1e-5)


def test_tracks_follow_the_machine():
    wide = replace(BACKHOE, tracks=replace(BACKHOE.tracks, gauge=2 * BACKHOE.tracks.gauge))
    assert tracks_twist(-1, 1, wide)[1] == tracks_twist(-1, 1)[1] / 2


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: tracks_twist(np.array(1j), 0), "left must be numbers"),
        (lambda: tracks_twist("fast", 0), "left must be numbers"),
        (lambda: tracks_twist(0, np.nan), "right must be finite"),
        (lambda: tracks_twist([1, 2], [1]), "left and right must be alike"),
        (lambda: tracks_twist(1, 1, slip=(0, 1)), "two shares below 1"),
        (lambda: twist_of_sides(1, 1, 0.0), "gauge must be one number above 0"),
        (lambda: twist_to_world([1, 2, 3], 0), r"twist must end in 2 .* shape \(3,\)"),
        (lambda: twist_to_world([1, 2], np.inf), "heading must be finite"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()
