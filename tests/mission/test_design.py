"""Designs of earthwork: what is inside, how high it is, and how far soil is off."""

from math import atan2, cos, hypot, radians, sin

import numpy as np
import pytest

from backhoe.mission.design import SlopeDesign, TrenchDesign
from backhoe.simulation.scene import Scene

SCENE = Scene(corner=(-6.0, -6.0), rows=176, columns=166, cell=0.08)
SLOPE = SlopeDesign((1.5, -0.4), radians(25), ratio=1.7, length=3.1, width=1.3)
TRENCH = TrenchDesign((-2.0, 1.0), radians(-130), length=2.6, width=0.9, depth=0.5, fall=0.05)
BOTH = pytest.mark.parametrize("design", [SLOPE, TRENCH])


def test_a_slope_is_as_long_and_as_steep_as_it_says():
    foot, crest = SLOPE.point([0.0, SLOPE.run])
    rise = crest - foot
    assert np.linalg.norm(rise) == pytest.approx(3.1)
    assert hypot(*rise[:2]) == pytest.approx(1.7 * rise[2])
    assert atan2(rise[1], rise[0]) == pytest.approx(radians(25))
    assert SLOPE.crest == pytest.approx(rise[2])
    assert np.tan(SLOPE.angle) == pytest.approx(rise[2] / hypot(*rise[:2]))
    assert tuple(foot) == pytest.approx((1.5, -0.4, 0.0))


def test_a_trench_lies_below_the_ground_and_falls_along_its_way():
    near, far = TRENCH.point([0.0, 2.6])
    assert tuple(near) == pytest.approx((-2.0, 1.0, -0.5))
    assert far[2] == pytest.approx(-0.5 - 0.05 * 2.6)
    assert atan2(*(far - near)[1::-1]) == pytest.approx(radians(-130))


@BOTH
def test_points_come_back_as_they_went_and_left_is_left(design):
    rng = np.random.default_rng(1)
    along, across = rng.uniform(-1, 3, 50), rng.uniform(-2, 2, 50)
    x, y, _ = design.point(along, across).T
    assert np.allclose(design.along_across(x, y), (along, across))
    left = design.point(0.0, 1.0) - design.point(0.0, 0.0)
    assert left[:2] == pytest.approx((-sin(design.direction), cos(design.direction)))


@BOTH
def test_the_design_ends_at_its_border(design):
    inside = [(0.01, 0), (design.run - 0.01, 0), (1, design.width / 2 - 0.01)]
    outside = [(-0.01, 0), (design.run + 0.01, 0), (1, design.width / 2 + 0.01), (1, -0.9)]
    for (along, across), there in [(p, True) for p in inside] + [(p, False) for p in outside]:
        x, y, z = design.point(along, across)
        height = design.height(x, y)
        assert height == pytest.approx(z) if there else np.isnan(height)


@BOTH
@pytest.mark.parametrize("margin", [0.0, 0.13])
def test_a_cell_counts_when_its_four_corners_are_that_far_inside(design, margin):
    x, y = SCENE.grid()
    half, counts = SCENE.cell / 2, np.ones(x.shape, bool)
    for dx in (-half, half):
        for dy in (-half, half):
            along, across = design.along_across(x + dx, y + dy)
            counts &= (along >= margin) & (along <= design.run - margin)
            counts &= np.abs(across) <= design.width / 2 - margin
    mask = design.mask(SCENE, margin)
    assert counts.sum() > 150
    assert (mask == counts).all()


@BOTH
def test_errors_are_soil_minus_design_where_cells_count(design):
    x, y = SCENE.grid()
    soil = np.nan_to_num(design.height(x, y), nan=9.0) + 0.02 * np.sin(x)
    errors, mask = design.errors(soil, SCENE), design.mask(SCENE)
    assert (np.isfinite(errors) == mask).all()
    assert np.allclose(errors[mask], 0.02 * np.sin(x)[mask])


def test_a_square_along_the_border_counts():
    scene = Scene(corner=(0.05, 0.05), rows=10, columns=10, cell=0.1)
    assert TrenchDesign((0.0, 0.5), length=1.0, width=1.0).mask(scene).all()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: SlopeDesign((0, 0), ratio=0), "SlopeDesign.ratio"),
        (lambda: SlopeDesign((0, 0), length=-1.0), "SlopeDesign.length"),
        (lambda: SlopeDesign((0, 0, 0)), "SlopeDesign.foot"),
        (lambda: SlopeDesign((0, 0), direction=np.nan), "SlopeDesign.direction"),
        (lambda: TrenchDesign((0, "a")), "TrenchDesign.start"),
        (lambda: TrenchDesign((0, 0), depth=0.0), "TrenchDesign.depth"),
        (lambda: TrenchDesign((0, 0), length=4, depth=0.4, fall=-0.1), "TrenchDesign.fall"),
        (lambda: SLOPE.mask(SCENE, -0.1), "margin"),
        (lambda: SLOPE.errors(np.zeros((3, 4)), SCENE), "heights"),
    ],
)
def test_bad_input_is_named(make, words):
    with pytest.raises(ValueError, match=words):
        make()
