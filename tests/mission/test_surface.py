"""Finished earthwork in numbers, on surfaces that are made up."""

from dataclasses import replace
from math import radians, tan

import numpy as np
import pytest

from backhoe.mission.design import SlopeDesign, TrenchDesign
from backhoe.mission.surface import assess
from backhoe.simulation.scene import Scene

SCENE = Scene(corner=(-5.0, -5.0), rows=150, columns=160, cell=0.08)
SLOPE = SlopeDesign((1.0, 0.0), radians(20), ratio=2.0, length=3.0, width=1.4)
TRENCH = TrenchDesign((-1.0, 1.0), radians(30), length=3.0, width=0.9, depth=0.4, fall=0.02)


REPOSE = radians(34)


def trench(design=TRENCH, left=0.0, turned=0.0, wave=0.0):
    """A trench with walls at the angle of repose from 0.1 m beside its bottom; one side moves."""
    along, across = design.along_across(*SCENE.grid())
    bottom = design.point(along, 0.0)[..., 2]
    toe = design.width / 2 + 0.1
    toe = toe + (across > 0) * (left + tan(turned) * along + wave * np.sin(2 * along))
    ends = np.maximum(-along, along - design.run)
    up = np.maximum(np.abs(across) - toe, ends - 0.2)
    return np.minimum(bottom + tan(REPOSE) * np.maximum(up, 0.0), 0.0)


def test_errors_are_counted_within_the_tolerance():
    x, y = SCENE.grid()
    mask = SLOPE.mask(SCENE)
    rng = np.random.default_rng(0)
    off = rng.uniform(-0.08, 0.10, x.shape)
    soil = np.where(mask, SLOPE.height(x, y) + off, 5.0)
    found = assess(SLOPE, SCENE, np.zeros(x.shape), soil)
    inside = off[mask]
    assert found.share == pytest.approx(np.mean(abs(inside) <= 0.05))
    assert found.mean == pytest.approx(inside.mean())
    assert found.rms**2 == pytest.approx(np.var(inside) + inside.mean() ** 2)
    assert found.worst == pytest.approx(max(inside.max(), -inside.min()))
    assert np.mean(abs(inside) <= found.p95 + 1e-9) == pytest.approx(0.95, abs=0.002)
    assert np.isnan([found.bowed, found.askew]).all()
    assert assess(SLOPE, SCENE, soil, soil, tolerance=0.1).share == 1.0


def test_soil_is_where_it_went():
    """Built up from parts of known volume: boxes that are dug, heaped, carried and lost."""
    x, y = SCENE.grid()
    before = np.where(np.isfinite(SLOPE.height(x, y)), np.nan_to_num(SLOPE.height(x, y)), 0.0) + 0.2
    mask, area = SLOPE.mask(SCENE), SCENE.cell**2
    inside, outside = np.argwhere(mask), np.argwhere(~mask)
    after = before.copy()
    after[tuple(inside[:100].T)] -= 0.3
    after[tuple(inside[100:130].T)] += 0.1
    after[tuple(outside[:50].T)] += 0.2
    found = assess(SLOPE, SCENE, before, after, bucket=0.05, off_map=0.015)
    assert found.surplus == pytest.approx(0.2 * mask.sum() * area)
    assert found.cut == pytest.approx(100 * 0.3 * area)
    assert found.filled == pytest.approx(30 * 0.1 * area)
    assert found.elsewhere == pytest.approx(50 * 0.2 * area)
    gone = (100 * 0.3 - 30 * 0.1 - 50 * 0.2) * area
    assert found.lost == pytest.approx(gone - 0.05 - 0.015)


def test_a_straight_trench_has_straight_edges_whatever_its_direction():
    found = assess(TRENCH, SCENE, np.zeros((150, 160)), trench())
    assert found.share == 1.0
    assert found.bowed < 0.01
    assert found.askew < radians(0.1)


def test_a_bowed_edge_and_one_askew_are_told_apart():
    flat = np.zeros((150, 160))
    askew = assess(TRENCH, SCENE, flat, trench(turned=radians(4)))
    assert askew.askew == pytest.approx(radians(4), abs=radians(0.1))
    assert askew.bowed < 0.01
    bowed = assess(TRENCH, SCENE, flat, trench(wave=0.1))
    along = np.linspace(0.04, 2.96, 80)
    wave = 0.1 * np.sin(2 * along)
    bow = wave - np.polyval(np.polyfit(along, wave, 1), along)
    assert bowed.bowed == pytest.approx(np.abs(bow).max(), abs=0.01)
    assert assess(TRENCH, SCENE, flat, trench(left=0.2)).bowed < 0.01


def test_the_right_edge_counts_as_the_left():
    soil = trench(wave=0.1)
    mirrored = TrenchDesign(tuple(TRENCH.point(3.0)[:2]), radians(30 - 180), 3.0, 0.9, 0.46, -0.02)
    flat = np.zeros((150, 160))
    this, other = (assess(design, SCENE, flat, soil) for design in (TRENCH, mirrored))
    assert other.bowed == pytest.approx(this.bowed, abs=1e-3)
    assert other.rms == pytest.approx(this.rms)


@pytest.mark.parametrize("height", [0.0, -0.4])
def test_a_trench_without_an_edge_is_no_straight_one(height):
    found = assess(TRENCH, SCENE, np.zeros((150, 160)), np.full((150, 160), height))
    assert found.bowed == np.inf
    assert "inf" in str(found)


def test_the_text_shows_every_number_beside_the_reference():
    flat = np.zeros((150, 160))
    machine = {"violations": 0.25, "given_up": 1, "time": 60.0, "margin": 0.5, "margin_time": 12.0}
    score = assess(TRENCH, SCENE, flat, trench(), **machine, swapped=("whole_body",))
    text = str(score)
    assert text.startswith("swapped in: whole_body")
    assert "within 5 cm [%]" in text
    assert "beyond limits [%]             25.0" in text
    assert "strokes given up                 1" in text
    assert "edge off its line [cm]" in text
    assert "least margin [m]              0.50" in text
    worse = replace(score, reference=replace(score, mean=0.123, swapped=()))
    row = next(line for line in str(worse).splitlines() if line.startswith("mean error"))
    assert row.split()[-2:] == [f"{100 * score.mean:.1f}".replace("-0.0", "0.0"), "12.3"]
    assert "edge" not in str(assess(SLOPE, SCENE, flat, flat))
    assert "margin" not in str(assess(SLOPE, SCENE, flat, flat))


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ((SLOPE, SCENE, np.zeros((3, 3)), np.zeros((150, 160))), ValueError, "before"),
        ((SLOPE, SCENE, np.zeros((150, 160)), np.full((150, 160), np.nan)), ValueError, "after"),
        (("slope", SCENE, np.zeros((150, 160)), np.zeros((150, 160))), TypeError, "design"),
        (
            (SlopeDesign((90.0, 0.0)), SCENE, np.zeros((150, 160)), np.zeros((150, 160))),
            ValueError,
            "no whole cell",
        ),
    ],
)
def test_bad_input_is_named(arguments, error, words):
    with pytest.raises(error, match=words):
        assess(*arguments)
