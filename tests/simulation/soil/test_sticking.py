"""Sticky soil stays in a tipped bucket until it is shaken hard enough."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from backhoe.machine import BACKHOE
from backhoe.simulation.soil import SANDY_LOAM, SOILS, Ground, Terrain
from backhoe.simulation.soil.sticking import PEEL, StuckLayer

CLAY = SOILS["stiff clay"]
DT = 0.01
LENGTH = 1.48
"""From the pin, which stands still, to the tip [m]."""


def tip(pitch, rate, pin=4.0):
    """Pose and velocity of the tip about a pin at (5, 0, pin), in the plane y = 0."""
    c, s = np.cos(pitch), np.sin(pitch)
    T = np.eye(4)
    T[:3, :3] = np.array([[c, -s, 0], [0, 0, -1], [s, c, 0]])
    T[:3, 3] = 5 + LENGTH * c, 0.0, pin + LENGTH * s
    return T, LENGTH * rate * np.array([-s, 0.0, c])


def full(soil):
    ground = Ground(Terrain.flat((2, 8), (-2, 2), 0.1), None, soil, hold=0.001)
    ground.bucket_volume = ground.fill.heaped
    return ground


def tipped(ground, amplitude=0.0, frequency=1.0, seconds=4.0):
    """Hold the bucket tipped, swinging about its pin; returns the largest acceleration."""
    most, before = 0.0, None
    for t in np.arange(0, seconds, DT):
        phase, swing = 2 * np.pi * frequency * t, 2 * np.pi * frequency * amplitude
        T, velocity = tip(0.1 + amplitude * np.sin(phase), swing * np.cos(phase))
        ground.advance(T, velocity, DT)
        if before is not None:
            most = max(most, np.linalg.norm(velocity - before) / DT)
        before = velocity
    return most


def test_soil_without_adhesion_leaves_nothing_and_clay_a_layer_that_its_grip_can_carry():
    loam, clay = full(SANDY_LOAM), full(CLAY)
    before = clay.total_volume
    tipped(loam), tipped(clay)
    assert loam.bucket_volume == 0.0
    assert clay.total_volume == pytest.approx(before, abs=1e-12)
    back = np.array(BACKHOE.shell.profile)
    bent = sum(float(np.linalg.norm(b - a)) for a, b in pairwise(back))
    area = bent * BACKHOE.shell.width + 2 * BACKHOE.shell.section_area
    weight = CLAY.density * BACKHOE.gravity * clay.bucket_volume / area
    assert weight == pytest.approx(PEEL * CLAY.adhesion, rel=1e-3)
    assert 0.05 < clay.bucket_volume / clay.fill.heaped < 0.25


def test_shaking_leaves_as_much_as_its_acceleration_lets_stick_and_no_more_falls_later():
    left = []
    for amplitude, frequency in ((0.0, 1.0), (0.05, 1.0), (0.05, 3.0), (0.1, 3.0)):
        clay = full(CLAY)
        pull = CLAY.density * (BACKHOE.gravity + tipped(clay, amplitude, frequency))
        layer = clay.bucket_volume * pull
        left.append(clay.bucket_volume)
        assert layer == pytest.approx(full_layer(), rel=2e-3)
        clay.forget_pose()
        tipped(clay)
        assert clay.bucket_volume == pytest.approx(left[-1], rel=1e-3)
    assert left == sorted(left, reverse=True) and left[-1] < 0.3 * left[0]


def full_layer():
    """Weight and grip in balance at rest [N]."""
    return StuckLayer(CLAY, BACKHOE).volume() * CLAY.density * BACKHOE.gravity


def test_soil_that_is_dug_sticks_again_and_a_snapshot_knows_what_sticks():
    ground = Ground(Terrain.flat((2, 8), (-2, 2), 0.1), None, CLAY, hold=0.001)
    tipped(ground, 0.1, 3.0, 1.0)
    shaken = ground.snapshot()
    for k in range(60):  # the edge, mouth ahead, drawn through the ground
        T, _ = tip(-np.pi / 2 - 0.3, 0.0, 1.2)
        T[0, 3] += -0.02 * k
        ground.forget_pose() if k == 0 else None
        ground.advance(T, np.array([-2.0, 0, 0]), DT)
    assert ground.bucket_volume > 0.05
    assert ground.snapshot()["stuck"][1] == pytest.approx(StuckLayer(CLAY, BACKHOE).volume())
    ground.restore(shaken)
    assert ground.snapshot()["stuck"][1] < 0.5 * StuckLayer(CLAY, BACKHOE).volume()


def test_more_adhesion_and_less_weight_leave_more():
    layer = StuckLayer(CLAY, BACKHOE).volume(5.0)
    assert StuckLayer(replace(CLAY, adhesion=60e3, cohesion=60e3), BACKHOE).volume(
        5.0
    ) == pytest.approx(2 * layer)
    assert StuckLayer(replace(CLAY, density=900.0), BACKHOE).volume(5.0) == pytest.approx(2 * layer)
    with pytest.raises(ValueError, match="acceleration"):
        StuckLayer(CLAY, BACKHOE).volume(-1.0)
