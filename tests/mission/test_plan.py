"""The plan that the mission digs by, and the way between its way-points."""

import numpy as np
import pytest

from backhoe import mission
from backhoe.machine import BACKHOE
from backhoe.mission.parts import STRIPS, STROKE


@pytest.mark.parametrize("cycle", [0, 1, 2])
def test_a_stroke_lies_in_one_plane_through_the_swing_axis(cycle):
    points = mission.hand_made_plan(cycle)[: len(STROKE)]
    x, y, _, bucket = np.array([point.target for point in points]).T
    x = x - BACKHOE.base.offset
    np.testing.assert_allclose(np.hypot(x, y), [stroke[2] for stroke in STROKE])
    np.testing.assert_allclose(np.degrees(np.arctan2(y, x)), STRIPS[cycle][0], atol=1e-12)
    np.testing.assert_allclose(np.degrees(bucket), [stroke[4] for stroke in STROKE])


def test_the_speeds_of_the_smooth_way_are_the_slopes_of_its_angles():
    rng = np.random.default_rng(3)
    times, q_way = np.array([0.0, 1.0, 2.5, 3.0]), rng.uniform(-1, 1, (4, 4))
    t = rng.uniform(0.05, 2.95, 50)
    slope = (
        mission.smooth_trajectory(times, q_way, t + 1e-6)[0]
        - mission.smooth_trajectory(times, q_way, t - 1e-6)[0]
    ) / 2e-6
    np.testing.assert_allclose(mission.smooth_trajectory(times, q_way, t)[1], slope, atol=1e-4)
