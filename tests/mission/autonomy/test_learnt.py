"""The learnt stroke: it enters where the strip begins, is the operator's, and brings soil."""

from pathlib import Path

import numpy as np
import pytest

from backhoe.arm.kinematics import forward_kinematics, inverse_kinematics, pose
from backhoe.machine import BACKHOE
from backhoe.mission import autonomy
from backhoe.mission.autonomy import DIRECTIONS, REACHES, Strip, choice
from backhoe.mission.autonomy.report import report
from backhoe.mission.parts import smooth_trajectory
from backhoe.planning.dmp import demonstration
from backhoe.planning.foresight import foresee
from backhoe.simulation.scene import untouched_ground
from backhoe.simulation.soil import SANDY_LOAM
from backhoe.simulation.trial import TICK, dig

ROOT = Path(__file__).resolve().parents[3]

SAID = "1.4", "99", "13.9"
"""Soil in the truck [m^3], an hour [m^3/h], and the time to dig [s]."""

VIEW = DIRECTIONS, REACHES
HEAP = np.clip(1.2 - 0.5 * np.abs(REACHES - 5.4), 0, None) + np.zeros((len(DIRECTIONS), 1))


def edge_of(path):
    """Direction, reach and height of the edge along a path."""
    x, y, z = forward_kinematics(inverse_kinematics(path))[:, :3, 3].T
    return np.arctan2(y, x - BACKHOE.base.offset), np.hypot(x - BACKHOE.base.offset, y), z


STRIPS = [Strip(0.0, 6.0, 0.3), Strip(-0.7, 5.4, 0.2), Strip(0.5, 6.3, 0.45), Strip(0.2, 5.2, 0.6)]


@pytest.mark.parametrize("strip", STRIPS)
def test_it_comes_from_above_enters_at_the_strip_and_ends_lifted(strip):
    times, path = autonomy.learnt_stroke(strip, HEAP, *VIEW)
    direction, reach, z = edge_of(path)
    assert (np.diff(times) > 0).all() and foresee(path, times).ok
    np.testing.assert_allclose(direction, strip.direction, atol=1e-6)
    near = np.abs(reach - strip.start) < 0.15
    depth = choice.edge_height(strip, HEAP, *VIEW)
    assert np.abs(z[near] - depth).min() < 0.1
    assert z.min() > choice.LEVEL - 1e-9
    over = np.interp(reach[:2], REACHES, HEAP[0])
    assert (z[:2] > over + np.array([0.5, 0.0])).all() and z[-1] > 2.0


def test_where_nothing_bends_it_it_is_the_operator_s_movement():
    """The strip that the operator dug gives the demonstrated way of the edge back."""
    shown = demonstration("dig")
    _, reach, z = edge_of(shown.positions)
    k = int(reach.argmax())
    entry = k + int(np.argmax(z[k:] < 0.4))
    ground = np.zeros_like(HEAP) + z[entry] + 0.3
    _, path = autonomy.learnt_stroke(Strip(0.0, float(reach[entry]), 0.3), ground, *VIEW)
    _, found_reach, found_z = edge_of(path)
    for height in (0.9, 0.7, 0.5, 0.4, 0.3):
        ways = ((reach[k:], z[k:]), (found_reach[1:], found_z[1:]))
        there = [float(r[np.argmax(up < height)]) for r, up in ways]
        assert there[0] == pytest.approx(there[1], abs=0.08)


def test_it_digs_four_fifths_of_what_the_hand_made_stroke_does():
    for seed in (0, 4):
        scene = autonomy.heap_site(seed)
        ground = untouched_ground(scene, BACKHOE, seed, TICK, SANDY_LOAM)
        heights = autonomy.seen(autonomy.polar(ground.terrain)[0])
        strip = autonomy.best_strip(heights, 0 * heights, *VIEW)
        soil = []
        for stroke in (autonomy.learnt_stroke, autonomy.stroke):
            times, path = stroke(strip, heights, *VIEW)
            t = np.linspace(0.0, times[-1], 200)
            q, _ = smooth_trajectory(times, inverse_kinematics(path), t)
            soil.append(dig(pose(q), t, scene=scene, seed=seed).soil)
        assert soil[0] > 0.8 * soil[1] > 0.4


def test_it_loads_what_lesson_14b_says_it_does_in_the_mission():
    """Two buckets; the library's stroke brings 1.3 m^3 in the stored output of that lesson."""
    run = autonomy.run(primitive=autonomy.learnt_stroke, loads=2, backend="analytic")
    found = report(run)
    assert (run.stopped, run.events, run.swapped) == (False, (), ("primitive",))
    assert (f"{found.soil:.1f}", f"{found.rate:.0f}", f"{found.digging:.1f}") == SAID
    lesson = (ROOT / "notebooks" / "14b_report.ipynb").read_text(encoding="utf-8")
    assert "{} m³ at {} m³/h, {} s to dig".format(*SAID) in lesson


def test_a_strip_out_of_reach_is_refused():
    with pytest.raises(ValueError, match="cannot be dug: out of reach"):
        autonomy.learnt_stroke(Strip(0.0, 9.0, 0.3), HEAP, *VIEW)
    with pytest.raises(ValueError, match="remedy"):
        autonomy.learnt_stroke(STRIPS[0], HEAP, *VIEW, remedy="hope")
    for stroke in (autonomy.learnt_stroke, autonomy.stroke):
        with pytest.raises(ValueError, match="strip must be finite"):
            stroke(Strip(np.nan, 6.0, 0.3), HEAP, *VIEW)
