"""The figures of lesson 01: drawn from the machine's own numbers, refused where they cannot be."""

import numpy as np
import pytest

from backhoe.arm import kinematics
from backhoe.lessons.kinematics.figures import frames, inverse, steps
from backhoe.machine import BACKHOE, replace
from backhoe.view import plots
from backhoe.view.plots import drawing

DIG = np.radians([-90.0, 15.0, -10.0, 40.0])


@pytest.fixture(
    params=[
        lambda: frames.arm(DIG),
        lambda: frames.arm(DIG, np.zeros(4), labels=("dig", "zero")),
        lambda: frames.frames(DIG),
        lambda: inverse.elbows(kinematics.pose(DIG)),
        lambda: frames.workspace(DIG),
        lambda: inverse.velocity_ellipses([DIG]),
        lambda: inverse.singularities(),
        lambda: steps.turn([[0, 0, 0], [1, 0.2, 0.4]], centre=(0, 3)),
    ],
    ids="arm arms frames elbows workspace ellipses singularities turn".split(),
)
def draw(request):
    return request.param


def test_every_figure_becomes_the_same_png_when_drawn_again(draw):
    assert plots.png(draw()) == plots.png(draw())


def test_every_axis_with_a_scale_has_a_label_with_a_unit(draw):
    fig = draw()
    for ax in fig.axes:
        if ax.axison and ax.get_label() != "<colorbar>":
            assert "[" in ax.get_xlabel() and "]" in ax.get_xlabel()
    labels = [ax.get_ylabel() for ax in fig.axes if ax.axison]
    assert not labels or any("[" in label for label in labels)


def test_reachable_cells_hold_random_postures_and_follow_the_machine():
    rng = np.random.default_rng(2)
    q = rng.uniform(BACKHOE.lower, BACKHOE.upper, (400, 4))
    cells = frames.reachable()
    points = drawing.plane_points(q)[:, 3]
    nearest = np.min(np.linalg.norm(points[:, None] - cells, axis=-1), axis=1)
    assert nearest.max() < 0.15
    longer = replace(BACKHOE, stick=replace(BACKHOE.stick, length=3.0))
    assert frames.reachable(longer)[:, 0].max() > cells[:, 0].max() + 0.8


def test_sizes_follow_the_machine():
    longer = replace(BACKHOE, boom=replace(BACKHOE.boom, length=6.0))
    assert plots.png(frames.arm(DIG)) != plots.png(frames.arm(DIG, machine=longer))


@pytest.mark.parametrize(
    "call, match",
    [
        (lambda: frames.arm(), "at least one posture"),
        (lambda: frames.arm(DIG, labels=("a", "b")), "2 labels for 1 postures"),
        (lambda: frames.arm([0, 0, 0]), "4 joints"),
        (lambda: steps.turn([0, 0, 0]), "shape"),
        (lambda: inverse.elbows([30, 0, 0, 0]), "outside the reach"),
    ],
)
def test_bad_input_is_named(call, match):
    with pytest.raises(ValueError, match=match):
        call()
