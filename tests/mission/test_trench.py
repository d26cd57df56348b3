"""The plan of a trench: led through the soil without a machine, it leaves what was designed."""

from math import cos, radians, sin

import numpy as np
import pytest

from backhoe.machine import BACKHOE
from backhoe.mission.design import TrenchDesign
from backhoe.mission.passes import edge_posture
from backhoe.mission.surface import assess
from backhoe.mission.trench import trench_strokes
from backhoe.simulation.scene import Scene
from backhoe.simulation.soil import Ground, Terrain, soil_of

SCENE = Scene(corner=(-8.0, -8.0), rows=201, columns=201, cell=0.08)
PERIOD = 0.01
DESIGNS = {
    "plain": TrenchDesign((1.0, 0.0)),
    "turned": TrenchDesign((1.0, 1.0), radians(40), length=3.0, width=0.8, depth=0.3),
    "falling": TrenchDesign((0.5, -0.5), radians(-100), length=3.5, depth=0.35, fall=0.03),
    "short": TrenchDesign((1.0, 0.0), length=1.2, depth=0.25),
    "long": TrenchDesign((-1.0, 0.0), radians(10), length=5.0, width=1.0, depth=0.25),
}
EACH = pytest.mark.parametrize("design", DESIGNS.values(), ids=DESIGNS)


def pose(goal, heading):
    """Of the bucket's tip frame, its x from the pin through the teeth."""
    x, y, z, pitch = goal
    ahead = np.array([cos(heading), sin(heading), 0.0])
    T = np.eye(4)
    T[:3, 0] = cos(pitch) * ahead + [0, 0, sin(pitch)]
    T[:3, 1] = -sin(pitch) * ahead + [0, 0, cos(pitch)]
    T[:3, 2], T[:3, 3] = np.cross(T[:3, 0], T[:3, 1]), (x, y, z)
    return T


def dug(design, soil):
    """Soil after the strokes, and what each had in the bucket [m^3]."""
    ground = Ground(Terrain(np.zeros((201, 201)), 0.08, SCENE.corner), None, soil_of(soil))
    loads, taken = [], 0.0
    for stroke in trench_strokes(design, BACKHOE, PERIOD):
        ground.forget_pose()
        rates = np.gradient(stroke.goals, PERIOD, axis=0)
        for goal, rate in zip(stroke.goals[:, :4], rates, strict=True):
            ground.advance(pose(goal, design.heading), rate[:3], PERIOD, rate[3])
        loads.append(ground.bucket_volume)
        taken += ground.bucket_volume
        ground.bucket_volume = 0.0
    return ground, loads, taken


@pytest.mark.parametrize(
    ("name", "soil"),
    [*((name, "sandy loam") for name in ("falling", "short", "long")), ("plain", "stiff clay")],
)
def test_the_plan_leaves_a_flat_bottom_and_straight_edges(name, soil):
    design = DESIGNS[name]
    ground, loads, taken = dug(design, soil)
    score = assess(design, SCENE, np.zeros((201, 201)), ground.terrain.heights, bucket=taken)
    assert score.share > 0.97
    assert score.bowed < 0.06
    assert abs(score.lost) < 1e-9
    assert max(loads) < 0.85
    assert loads[-1] < 0.3
    assert np.maximum(ground.terrain.heights, 0.0).sum() * SCENE.cell**2 < 0.05


@EACH
def test_every_goal_is_in_reach_and_the_tracks_stay_on_ground_that_is_not_dug(design):
    dug_to = np.inf
    for stroke in trench_strokes(design, BACKHOE, PERIOD):
        along, across = design.along_across(*stroke.goals[:, :2].T)
        assert np.allclose(across, 0.0, atol=1e-9)
        q = edge_posture(stroke.goals[:, [4, 2, 3]], BACKHOE)
        assert ((q >= BACKHOE.lower) & (q <= BACKHOE.upper)).all()
        front = along - stroke.goals[:, 4] - BACKHOE.base.offset + BACKHOE.tracks.length / 2
        dug_to = min(dug_to, along[stroke.goals[:, 2] < 0].min())
        assert front.max() < dug_to
        stand, _ = design.along_across(*stroke.stand[:2])
        assert stand + BACKHOE.tracks.length / 2 == pytest.approx(front[0])
        assert stroke.stand[2] == design.heading


@EACH
def test_the_edge_goes_along_the_bottom_and_never_below_it(design):
    strokes = trench_strokes(design, BACKHOE, PERIOD)
    for stroke in strokes:
        along, _ = design.along_across(*stroke.goals[:, :2].T)
        over = stroke.goals[:, 2] - design.point(along)[:, 2]
        assert over.min() > -1e-9
    assert over.min() < 1e-9
    last = {stroke.name.split(",")[0] for stroke in strokes if "bay" in stroke.name}
    assert len(last) == (2 if design.length == 5.0 else 0)


def test_the_tracks_creep_backwards_in_a_stroke():
    for stroke in trench_strokes(DESIGNS["plain"], BACKHOE, PERIOD):
        place = stroke.goals[:, 0] - stroke.goals[:, 4]
        assert (np.diff(place) < 1e-9).all()
        assert place[0] - place[-1] > 1.0


@pytest.mark.parametrize(
    ("design", "words"),
    [
        (TrenchDesign((0, 0), width=1.1), "wider than 1.00 m"),
        (TrenchDesign((0, 0), depth=2.5), "out of reach"),
    ],
)
def test_what_cannot_be_dug_is_refused(design, words):
    with pytest.raises(ValueError, match=words):
        trench_strokes(design, BACKHOE, PERIOD)


@EACH
def test_the_heel_of_the_bucket_stays_above_the_bottom(design):
    """The lowest point of the shell, wherever the bucket curls."""
    profile = np.array(BACKHOE.shell.profile)
    for stroke in trench_strokes(design, BACKHOE, PERIOD):
        x, y, z, pitch, _ = stroke.goals.T
        u = np.outer(np.cos(pitch), profile[:, 0]) - np.outer(np.sin(pitch), profile[:, 1])
        up = np.outer(np.sin(pitch), profile[:, 0]) + np.outer(np.cos(pitch), profile[:, 1])
        along, _ = design.along_across(x, y)
        bottom = design.point(along[:, None] + u)[..., 2]
        assert (z[:, None] + up - bottom).min() > -0.01
