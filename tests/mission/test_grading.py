"""Grading a slope: the surface that is left, its soil, the balance, and what parts may do."""

from dataclasses import replace

import numpy as np
import pytest

from backhoe import mission, simulation, whole_body
from backhoe.machine import BACKHOE
from backhoe.mission import tracing
from backhoe.mission.design import SlopeDesign
from backhoe.mission.passes import Stroke, timed
from backhoe.simulation.scene import FLAT, GRADING, LOADING
from backhoe.simulation.soil import SOILS

BACKENDS = ("pybullet", "analytic")
LIMIT = 0.05


def surface(run, width=None):
    design = run.design if width is None else replace(run.design, width=width)
    errors = design.errors(run.after, run.scene)
    return errors[np.isfinite(errors)]


def share(run):
    return float(np.mean(np.abs(surface(run)) <= LIMIT))


@pytest.fixture(scope="module")
def graded():
    """The whole slope, graded by the library on its estimated pose."""
    return mission.grade()


def test_the_slope_is_graded_to_5_cm(graded):
    assert isinstance(graded.design, SlopeDesign)
    assert (graded.design.length, graded.design.ratio) == (6.0, 2.0)
    assert graded.design.width == pytest.approx(2.0)
    before = graded.design.errors(graded.before, graded.scene)
    assert np.nanmean(before) > 0.12
    assert np.nanmax(before) < 0.26
    assert share(graded) > 0.95
    assert abs(surface(graded).mean()) < 0.01


def test_all_soil_is_somewhere(graded):
    cell = graded.scene.cell**2
    left = graded.bucket_volume + graded.off_map_volume
    moved = (graded.after - graded.before) * cell
    assert moved.sum() + left == pytest.approx(0.0, abs=1e-9)
    assert graded.soil_lost < 1e-9
    on = graded.design.mask(graded.scene)
    assert moved[on].sum() < -1.2  # the surplus of the strip
    aside = np.abs(graded.scene.grid()[1]) > 2.5
    assert moved[aside].sum() > 1.2  # is where the bucket was emptied


def test_the_replays_camera_sees_machine_and_slope(graded):
    """All places of edge and vehicle during the strokes are in a picture of 40 by 70 degrees."""
    eye, target = graded._drawn()["camera"]
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, [0, 0, 1]) / np.hypot(*ahead[:2])
    at_work = np.isfinite(graded.goal[:, 0])
    vehicle = np.c_[graded.pose[:, :2], np.zeros(len(graded.pose))]
    rays = np.concatenate([graded.edge[:, :3], vehicle])[np.r_[at_work, at_work]] - eye
    depth = rays @ ahead
    assert np.degrees(np.arctan2(np.abs(rays @ np.cross(right, ahead)), depth)).max() < 20
    assert np.degrees(np.arctan2(np.abs(rays @ right), depth)).max() < 35


def test_the_machine_keeps_its_balance(graded):
    assert graded.least.margin > 0.3
    assert graded.margin.min() >= graded.least.margin - 1e-9


def test_tracks_and_arm_both_move_and_no_bound_is_passed(graded):
    for number in range(1, 6):
        on = (graded.stroke == number) & np.isfinite(graded.goal[:, 0])
        assert np.ptp(graded.pose[on, 0]) > 2.5  # the tracks creep
        assert np.ptp(graded.edge[on, 0]) > 6.0  # over more than the arm could alone
        speeds = np.abs(graded.v[on])
        fastest = [tracing.CREEP, tracing.TURN, *tracing.GENTLE * BACKHOE.speed_limit]
        assert (speeds <= np.array(fastest) * (1 + 1e-9)).all()
        lower, upper = BACKHOE.lower - 0.01, BACKHOE.upper + 0.01
        assert ((graded.q[on] > lower) & (graded.q[on] < upper)).all()
        assert 0.3 < graded.share[on].mean() < 0.6  # limits are felt: the way is planned faster
    assert graded.violations == 0
    assert graded.given_up == 0


def test_the_pose_is_the_filters_and_not_the_truth(graded):
    off = np.hypot(*(graded.estimate - graded.pose)[:, :2].T)
    assert 0.005 < np.sqrt(np.mean(off**2)) < 0.04


def test_the_edge_is_where_its_goal_is_up_to_the_error_of_the_pose(graded):
    on = np.isfinite(graded.goal[:, 0])
    late = on & np.roll(on, 100)  # a second after the stroke began
    height = (graded.edge - graded.goal)[late, 2]
    assert np.sqrt(np.mean(height**2)) < 0.01
    assert np.abs((graded.edge - graded.goal)[late, 3]).max() < 0.05


def a_stroke():
    """A metre back and half a metre down, in the air, at a third of the speed of a pass."""
    knots = np.array([[6.6, 0, 2.0, -1.5, 6.2], [5.6, 0, 1.5, -1.6, 5.8]])
    goals = timed(knots, tracing.PERIOD)
    rows = np.linspace(0, len(goals) - 1, 3 * len(goals))
    goals = np.stack([np.interp(rows, np.arange(len(goals)), column) for column in goals.T], 1)
    return Stroke("in the air", goals, np.array([0.4, 0.0, 0.0]), 1.0)


def trace(part=None, machine=BACKHOE, **changes):
    """The tracer after one stroke in the air, on the truth."""
    stroke = replace(a_stroke(), **changes)
    q = np.radians([-90, 20, 10, 30.0])
    with simulation.open_world(machine, backend="analytic", scene=FLAT, q=q) as world:
        world.reset(pose=(-0.8, 0.0, 0.0))
        parts = {} if part is None else {"whole_body": part}
        tracer = tracing.Tracer(world, parts, None, 0, False)
        tracer.do([stroke])
        return tracer


def on_its_way(tracer):
    """Distance of the edge from the straight line of the stroke, after its beginning [m]."""
    q, goal = (np.array(column) for column in list(zip(*tracer.log, strict=True))[2:5:2])
    on = np.flatnonzero(np.isfinite(goal[:, 0]))
    on = on[len(on) // 2 :]
    edge = whole_body.hand(q[on], tracer.plant.robot)
    line = np.array([1.0, 0.5]) / np.hypot(1.0, 0.5)
    off = edge[:, [0, 2]] - [6.6, 2.0]
    return np.abs(off[:, 0] * line[1] - off[:, 1] * line[0])


def columns(tracer):
    """Numpy columns of the tracer's log, rows of the stroke only."""
    log = [np.array(column) for column in zip(*tracer.log, strict=True)]
    on = np.isfinite(log[4][:, 0])
    return on, log


def test_the_tracks_come_to_the_stand_and_keep_reach_and_heading():
    """From 0.6 m aside, and with an arm that begins 0.3 m further out than it should work."""
    goals = a_stroke().goals.copy()
    goals[:, 4] -= 0.3
    tracer = trace(goals=goals, stand=np.array([0.4, 0.6, 0.0]))
    on, log = columns(tracer)
    first, last = np.flatnonzero(on)[[0, -1]]
    assert np.abs(log[2][first, :3] - [0.4, 0.6, 0.0]).max() < 0.15
    heading, swing = np.abs(log[2][on, 2]), np.abs(log[2][on, 3] + np.pi / 2)
    assert heading.max() < 0.2
    assert swing.max() < 0.25
    assert heading[-1] < 0.1
    q = log[2][[first, last]]
    axis = q[:, :2] + BACKHOE.base.offset * np.c_[np.cos(q[:, 2]), np.sin(q[:, 2])]
    reach = np.hypot(*(whole_body.hand(q)[:, :2] - axis).T)
    assert abs(reach[-1] - 5.5) < 0.1
    assert np.abs(log[5]).max() < 1.2  # no jump in between


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_bucket_is_emptied_on_its_side(side):
    _, log = columns(trace(side=side))
    swung = log[2][:, 3] + np.pi / 2
    assert side * swung[-1] == pytest.approx(tracing.ASIDE, abs=0.03)
    pitch = tracing.pitch_of(log[2][:, 3:], BACKHOE)
    assert pitch[-1] == pytest.approx(-np.pi + tracing.OPENING, abs=0.05)


def test_velocities_change_softly_within_a_stroke():
    on, log = columns(trace())
    change = np.diff(log[5][on], axis=0)[1:] / (tracing.SAMPLE * tracing.PERIOD)
    assert (np.abs(change) <= tracing.SOFT * (1 + 1e-9)).all()


def test_a_slowed_edge_stays_on_its_way_and_takes_its_time():
    quick = trace()

    def half(J, b, preferred, lower, upper):
        return 0.5 * tracing.library_part(J, b, preferred, lower, upper)

    slow = trace(half)
    assert on_its_way(quick).max() < 0.02
    assert on_its_way(slow).max() < 0.02
    assert len(slow.excess) > 1.7 * len(quick.excess)
    assert slow.given_up == 0


def test_another_machine_leads_its_own_edge():
    longer = replace(BACKHOE, stick=replace(BACKHOE.stick, length=2.2))
    off = on_its_way(trace(machine=longer))
    assert off.max() < 0.02
    assert off.max() < 2 * on_its_way(trace()).max()


def test_a_part_that_never_moves_is_given_up_in_the_end():
    tracer = trace(lambda J, b, preferred, lower, upper: np.zeros(6))
    assert tracer.given_up == 1
    assert len(tracer.excess) == round(tracing.PATIENCE * len(a_stroke().goals))


def test_what_a_part_asks_beyond_its_bounds_it_does_not_get():
    seen = []

    def bold(J, b, preferred, lower, upper):
        seen.append((lower, upper))
        return 10.0 * whole_body.minimum_norm(J, b, preferred)

    tracer = trace(bold)
    assert np.mean(np.array(tracer.excess) > 0) > 0.5
    v, goal = (np.array(c) for c in list(zip(*tracer.log, strict=True))[5:3:-1])
    asked = np.abs(v[np.isfinite(goal[:, 0])])
    assert (asked <= tracer.fastest * (1 + 1e-9)).all()
    lower, upper = np.array(seen).transpose(1, 0, 2)
    assert (lower <= upper).all()
    assert (upper <= tracer.fastest + 1e-12).all()


SHORT = replace(GRADING, bank=replace(GRADING.bank, length=3.0))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"scene": LOADING}, "no bank"),
        ({"job": "pond"}, "job"),
        ({"fixes": 0.0}, "fixes"),
        ({"soil": "dust"}, "soil"),
        ({"lanes": []}, "lanes"),
        ({"pose": (4.0, 0.0, 0.0)}, "pose must be 1 m or more before"),
        ({"pose": "here"}, "pose must be"),
        ({"pose": (0.0, 0.0)}, "x, y, heading"),
        ({"pose": (0.0, 0.0, 2.0)}, "face the work"),
        ({"scene": replace(GRADING, bank=replace(GRADING.bank, ratio=1.2))}, "does not stand"),
        ({"scene": replace(GRADING, bank=replace(GRADING.bank, length=8.0))}, "out of reach"),
        ({"whole_body": lambda *given: np.zeros(5), "scene": SHORT, "lanes": [0]}, "whole_body"),
    ],
)
def test_bad_input_says_what_is_wrong(options, message):
    with pytest.raises(ValueError, match=message):
        mission.grade(backend="analytic", **options)


def test_an_unknown_part_and_no_function():
    with pytest.raises(TypeError, match="wholebody"):
        mission.grade(wholebody=lambda *given: np.zeros(6))
    with pytest.raises(TypeError, match="whole_body"):
        mission.grade(whole_body=3)
    with pytest.raises(TypeError, match="machine"):
        mission.grade(machine="backhoe")


def test_every_soil_that_stands_at_1_in_2_is_taken():
    assert all(soil.repose > np.arctan(0.5) for soil in SOILS.values())


def scaled(J, b, preferred, lower, upper):
    """All by one factor, so that the limits hold: right."""
    v = whole_body.minimum_norm(J, b, preferred)
    limit = np.where(v > 0, upper, lower)
    ratio = np.where(v != 0, limit / np.where(v != 0, v, 1.0), 1.0)
    return v * min(max(ratio.min(), 0.0), 1.0)


def clipped(J, b, preferred, lower, upper):
    return np.clip(whole_body.minimum_norm(J, b, preferred), lower, upper)


def without_preference(J, b, preferred, lower, upper):
    return scaled(J, b, 0 * preferred, lower, upper)


@pytest.mark.parametrize(
    ("part", "least", "most"),
    [(None, 0.95, 1.0), (scaled, 0.95, 1.0), (clipped, 0.0, 0.6), (without_preference, 0.0, 0.7)],
)
def test_a_right_part_grades_a_short_slope_and_usual_mistakes_show(part, least, most):
    run = mission.grade(scene=SHORT, lanes=[0.0], whole_body=part, backend="analytic")
    assert least <= share(run) <= most
    assert run.swapped == (() if part is None else ("whole_body",))
    assert (run.given_up > 0) == (part is without_preference)
    assert run.least.margin > 0.25
