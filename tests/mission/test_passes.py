"""The plan of a slope's passes: where the edge goes, what the arm can and what it cannot."""

from dataclasses import replace
from math import atan2, degrees, radians

import numpy as np
import pytest
from numpy.testing import assert_allclose

from backhoe.arm import kinematics
from backhoe.machine import BACKHOE
from backhoe.mission.design import SlopeDesign
from backhoe.mission.passes import (
    CLEARANCE,
    CURLING,
    LANES,
    ROUNDED,
    SPEED,
    STAND_OFF,
    Stroke,
    check_reach,
    edge_posture,
    slope_strokes,
    timed,
)

T = 0.01
DESIGN = SlopeDesign((5.0, 0.0), 0.0, 2.0, 6.0, 2.0)


def test_a_posture_puts_the_edge_where_it_should_be():
    rng = np.random.default_rng(3)
    edges = np.c_[
        rng.uniform(4.5, 6.5, 50), rng.uniform(0, 2, 50), np.radians(rng.uniform(-110, -80, 50))
    ]
    q = edge_posture(edges)
    found = ~np.isnan(q[:, 0])
    assert found.sum() > 30
    q = q[found]
    tip = kinematics.forward_kinematics(q)
    assert_allclose(
        np.hypot(tip[:, 0, 3] - BACKHOE.base.offset, tip[:, 1, 3]), edges[found, 0], atol=1e-9
    )
    assert_allclose(tip[:, 2, 3], edges[found, 1], atol=1e-9)
    x_axis = tip[:, :3, 0]
    assert_allclose(np.arctan2(x_axis[:, 2], x_axis[:, 0]), edges[found, 2], atol=1e-9)
    assert ((q >= BACKHOE.lower - 1e-9) & (q <= BACKHOE.upper + 1e-9)).all()


def test_out_of_reach_is_nan_and_a_stroke_there_says_where():
    assert np.isnan(edge_posture((12.0, 0.0, -1.5))).all()
    assert np.isnan(edge_posture((4.0, 2.5, radians(-60)))).all()  # the bucket would open too far
    stroke = Stroke(
        "a far one",
        np.array([[9.0, 0, 1.0, -1.5, 6.0], [9.0, 0, 1.0, -1.5, 9.5]]),
        np.zeros(3),
        1.0,
    )
    with pytest.raises(
        ValueError, match=r"a far one is out of reach: .* 9\.50 m from the swing axis"
    ):
        check_reach(stroke)


@pytest.mark.parametrize("direction", [0.0, 0.7])
def test_the_edge_follows_the_design_from_the_crest_to_the_foot(direction):
    design = replace(DESIGN, direction=direction)
    for stroke, lane in zip(slope_strokes(design, T), LANES, strict=True):
        along, across = design.along_across(stroke.goals[:, 0], stroke.goals[:, 1])
        assert_allclose(across, lane * BACKHOE.shell.width, atol=1e-9)
        on = (along > 0.15) & (along < design.run - 0.15)
        assert on.sum() > 300
        assert_allclose(stroke.goals[on, 2], along[on] / 2, atol=1e-9)
        assert along[0] == pytest.approx(design.run + 0.1)
        assert along[-1] == pytest.approx(-1.5)
        near_the_ends = (along > -0.5) & (along < design.run)
        height = np.maximum(along, 0) / 2
        assert (
            np.abs(stroke.goals - np.c_[stroke.goals[:, :2], height, stroke.goals[:, 3:]])[
                near_the_ends & (stroke.goals[:, 2] < design.crest), 2
            ].max()
            < 0.03
        )
        # The floor of the bucket stays clear of the slope.
        floor = stroke.goals[on, 3] + atan2(*BACKHOE.shell.profile[1][::-1])
        assert (floor - design.angle > CLEARANCE - 1e-9).all()
        assert stroke.side == (-1 if lane < 0 else 1)
        # The reach is what it says, and at the begin the tracks stand before the foot.
        c, s = np.cos(direction), np.sin(direction)
        axis = stroke.stand[:2] + BACKHOE.base.offset * np.array([c, s])
        assert np.hypot(*(stroke.goals[0, :2] - axis)) == pytest.approx(stroke.goals[0, 4])
        front = stroke.stand[:2] + BACKHOE.tracks.length / 2 * np.array([c, s])
        assert design.along_across(*front)[0] == pytest.approx(-STAND_OFF)


def test_the_way_keeps_its_speeds_and_begins_and_ends_at_rest():
    goals = slope_strokes(DESIGN, T)[0].goals
    speed = np.linalg.norm(np.diff(goals[:, :3], axis=0), axis=1) / T
    assert speed.max() <= SPEED * 1.001
    assert np.abs(np.diff(goals[:, 3])).max() / T <= CURLING * 1.001
    assert speed[[0, -1]].max() < 0.1 * SPEED
    jumps = np.abs(np.diff(goals[:, :3], n=2, axis=0)).max() / T**2
    assert jumps < 2 * SPEED / ROUNDED * 1.1  # rounded corners


def test_timed_goes_through_the_middle_of_straight_legs():
    knots = np.array([[0.0, 0, 0, 0, 5], [3.0, 0, 0, 0, 6], [3.0, 0, 3.0, 0.2, 6]])
    goals = timed(knots, T)
    assert_allclose(goals[[0, -1]], knots[[0, -1]], atol=1e-12)
    middle = goals[np.argmin(np.abs(goals[:, 0] - 1.5))]
    assert_allclose(middle, [1.5, 0, 0, 0, 5.5], atol=0.01)


def test_the_arm_alone_cannot_do_it():
    """From no stand do postures with the pitch of the pass reach both the crest and the foot."""
    goals = slope_strokes(DESIGN, T)[0].goals
    along = goals[:, 0] - 5.0
    on = (along >= 0) & (along <= DESIGN.run)
    stands = np.arange(-6.0, 3.0, 0.05)
    reach = goals[on, 0][::20] - stands[:, None]
    edges = np.stack(
        [reach, *(np.broadcast_to(c, reach.shape) for c in goals[on][::20, 2:4].T)], -1
    )
    able = ~np.isnan(edge_posture(edges)[..., 0])
    assert able.mean(axis=1).max() < 0.75
    assert np.ptp(stands[:, None] * np.ones_like(reach) * able) > 2.0


@pytest.mark.parametrize(
    ("length", "ratio", "message"),
    [
        (7.0, 2.0, "out of reach: with the tracks 0.25 m before its foot"),
        (9.0, 3.0, "out of reach"),
    ],
)
def test_a_slope_out_of_reach_says_so(length, ratio, message):
    with pytest.raises(ValueError, match=message):
        slope_strokes(replace(DESIGN, length=length, ratio=ratio), T)


@pytest.mark.parametrize(
    ("ratio", "length"), [(1.5, 4.0), (1.5, 6.0), (2.0, 4.0), (2.5, 6.0), (3.0, 6.0)]
)
def test_other_slopes_are_within_reach_and_the_pitch_follows_them(ratio, length):
    design = replace(DESIGN, ratio=ratio, length=length)
    goals = slope_strokes(design, T)[0].goals
    at_foot = goals[np.argmin(np.abs(goals[:, 0] - 5.0)), 3]
    floor = atan2(*BACKHOE.shell.profile[1][::-1])
    assert degrees(at_foot + floor - design.angle) == pytest.approx(5.0, abs=0.7)
