from math import cos, pi, radians, sin

import numpy as np
import pytest
from matplotlib.path import Path

from backhoe.machine import BACKHOE, replace
from backhoe.simulation.soil.bucket_fill import BucketFill, retained_volume

SHELL = BACKHOE.shell
REPOSE = radians(34)
FILL = BucketFill(SHELL, REPOSE)
FLUID = 1e-6


def fluid_volume(pitch, points=900):
    """Volume of a fluid in the turned shell, by counting grid points below the lower lip."""
    turn = np.array([[cos(pitch), sin(pitch)], [-sin(pitch), cos(pitch)]])
    profile = np.array(SHELL.profile) @ turn
    low, high = profile.min(axis=0), profile.max(axis=0)
    axes = [np.linspace(a, b, points) for a, b in zip(low, high, strict=True)]
    x, z = np.meshgrid(*axes)
    inside = Path(profile).contains_points(np.column_stack([x.ravel(), z.ravel()]))
    below = z.ravel() <= min(profile[0, 1], profile[-1, 1])
    return (inside & below).mean() * np.prod(high - low) * SHELL.width


@pytest.mark.parametrize("pitch_deg", [-215, -200, -178, -165, -150, -135, -120, -100])
def test_a_fluid_stands_level_with_the_lower_lip(pitch_deg):
    pitch = radians(pitch_deg)
    assert retained_volume(SHELL, pitch, FLUID) == pytest.approx(fluid_volume(pitch), abs=2e-3)


def test_a_level_bucket_holds_its_struck_capacity_of_a_fluid_and_heaps_soil():
    teeth, lip = SHELL.profile[0], SHELL.profile[-1]
    level = -pi - np.arctan2(lip[1] - teeth[1], lip[0] - teeth[0]) + pi
    assert retained_volume(SHELL, level, FLUID) == pytest.approx(SHELL.struck_capacity, rel=1e-4)
    heaped = retained_volume(SHELL, level, REPOSE)
    span = np.hypot(lip[0] - teeth[0], lip[1] - teeth[1])
    prism = span**2 / 4 * np.tan(REPOSE) * SHELL.width
    assert SHELL.struck_capacity < heaped < SHELL.struck_capacity + prism
    ends = span**3 / 12 * np.tan(REPOSE)
    assert heaped == pytest.approx(SHELL.struck_capacity + prism - ends, rel=0.02)


def test_a_bucket_hanging_over_holds_nothing():
    for pitch_deg in range(-90, 61, 5):
        assert FILL.retained(radians(pitch_deg)) < 0.002
    assert FILL.retained(radians(-60)) == 0


def test_the_bucket_holds_less_the_more_it_opens():
    held = [FILL.retained(radians(pitch)) for pitch in range(-175, -89)]
    assert (np.diff(held) <= 1e-12).all()
    assert held[0] == pytest.approx(FILL.heaped, rel=0.02)


def test_soil_before_the_teeth_holds_soil_in_the_bucket():
    for pitch_deg in (-150, -120, -100, -80):
        held = [FILL.retained(radians(pitch_deg), h) for h in np.linspace(0, 1.2, 25)]
        assert (np.diff(held) >= -1e-12).all()
        assert held[-1] <= FILL.heaped
    assert FILL.retained(radians(-100), 0.5) > 0.2


def test_the_table_interpolates_its_solution():
    for pitch_deg, support in [(-177, 0.0), (-150, 0.15), (-121.5, 0.0), (-129, 0.3), (183, 0.0)]:
        exact = min(retained_volume(SHELL, radians(pitch_deg), REPOSE, support), FILL.heaped)
        assert FILL.retained(radians(pitch_deg), support) == pytest.approx(exact, abs=0.005)


def test_retention_is_the_same_a_full_turn_further():
    for pitch in np.linspace(-3, 3, 13):
        assert FILL.retained(pitch) == pytest.approx(FILL.retained(pitch - 2 * pi), abs=1e-9)


def test_a_wider_bucket_holds_more():
    wide = BucketFill(replace(SHELL, width=2 * SHELL.width), REPOSE)
    assert wide.heaped > 2 * FILL.heaped
