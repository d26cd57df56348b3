"""A trench that the machine digs on its tracks, on the pose that its sensors say."""

from dataclasses import replace

import numpy as np
import pytest

from backhoe import mission
from backhoe.mission.design import SlopeDesign, TrenchDesign

SHORT = TrenchDesign((4.2, 0.3), length=2.4, depth=0.2)


@pytest.fixture(scope="module", params=["pybullet", "analytic"])
def run(request):
    if request.param == "pybullet":
        pytest.importorskip("pybullet")
    return mission.grade(job="trench", design=SHORT, backend=request.param)


def test_the_bottom_is_flat_and_the_edges_are_straight(run):
    score = mission.score(run)
    assert score.share >= 0.95
    assert score.bowed < 0.08
    assert score.margin > 0.2
    assert score.cut > 0.9 * score.surplus > 0.1


def test_the_soil_is_all_there(run):
    assert run.soil_lost < 1e-9
    assert abs(mission.score(run).lost) < 1e-9
    assert run.off_map_volume == 0.0


def test_the_tracks_creep_backwards_on_ground_that_is_not_dug(run):
    reached = 4.2 + SHORT.length
    for k in range(1, len(run.strokes) + 1):
        rows = (run.stroke == k) & np.isfinite(run.goal[:, 0])
        crept = run.pose[rows, 0]
        assert crept[-1] - crept[0] < -0.5
        reached = min(reached, run.edge[rows, 0].min())
        front = run.pose[run.stroke <= k, 0] + run.machine.tracks.length / 2
        assert front.max() < reached


def test_no_limit_is_broken(run):
    assert run.violations == 0.0
    assert run.given_up == 0


@pytest.mark.parametrize(
    ("settings", "error", "words"),
    [
        ({"job": "ditch"}, ValueError, "job"),
        ({"job": "slope", "design": SHORT}, ValueError, "leave design out"),
        ({"job": "trench", "design": SlopeDesign((4, 0))}, TypeError, "design"),
        ({"job": "trench", "design": TrenchDesign((8.0, 0.0))}, ValueError, "within the scene"),
        ({"job": "trench", "pose": (2.0, 0, 0)}, ValueError, "pose"),
    ],
)
def test_what_cannot_be_done_is_refused(settings, error, words):
    with pytest.raises(error, match=words):
        mission.grade(**settings)


@pytest.mark.parametrize("run", ["analytic"], indirect=True)
def test_the_reference_of_a_score_is_the_same_work_done_by_the_library(run):
    """A run whose part is the library's, said to be a student's, is as good as its reference."""
    score = mission.score(replace(run, swapped=("whole_body",)))
    assert score.swapped == ("whole_body",)
    assert replace(score, swapped=(), reference=None) == score.reference
    assert "library" in str(score)
