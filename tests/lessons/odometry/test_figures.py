"""The figures of lesson 06: what they show is what was computed, and bad input is refused."""

import numpy as np
import pytest
from matplotlib.colors import to_rgba

from backhoe.lessons.odometry import figures
from backhoe.localisation import odometry
from backhoe.view.plots import style

T = np.array([0.0, 0.5, 1.2, 1.6])
V = np.array([0.2, 0.7, 0.4, 0.9])
STEPS = np.array([0.1, 0.2, 0.4])
ERRORS = {"first": 3 * STEPS, "second": 0.5 * STEPS**2}
ARC = odometry.integrate(np.zeros(3), np.ones(10), np.ones(10), 0.1)
ENDS = {"one": {"cw": [(0.1, 0.2), (0.3, 0.4)], "ccw": [(0.0, -0.1)]}}
TWO_SIDES = {"two sides": [(0, 0.3, 0, np.nan), (0, -0.3, 0, np.nan)]}


def speed(t):
    return np.interp(t, T, V)


def area(path):
    x, y = path.vertices[:-1].T
    return 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


@pytest.mark.parametrize("panel, rule", [(0, odometry.euler_sum), (1, odometry.bilinear_sum)])
def test_the_areas_drawn_are_those_that_are_summed(panel, rule):
    shapes = figures.areas(T, V, speed).axes[panel].collections[0].get_paths()
    np.testing.assert_allclose([area(shape) for shape in shapes], np.diff(rule(T, V)), rtol=1e-12)


def test_the_guides_have_whole_slopes_and_lie_above_the_errors_nearest_to_them():
    ax = figures.error_orders(STEPS, ERRORS).axes[0]
    guides = [line for line in ax.lines if line.get_linestyle() == "--"]
    assert len(guides) == 2
    for slope, guide, errors in zip((1, 2), guides, ERRORS.values(), strict=True):
        assert odometry.order(*guide.get_data()) == pytest.approx(slope)
        assert (guide.get_ydata() > errors).all()
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")


def test_steps_are_labelled_as_they_are():
    ax = figures.error_orders(STEPS, ERRORS).axes[0]
    assert [label.get_text() for label in ax.get_xticklabels()] == ["0.1", "0.2", "0.4"]


def test_one_step_is_drawn_to_scale_from_its_start_to_each_end():
    ax = figures.one_step(ARC[0], ARC, {"Euler": (1.0, 0.0, 0.0)}, {"Euler": "printed"}).axes[0]
    assert ax.get_aspect() == 1.0
    arc, chord = ax.lines[:2]
    np.testing.assert_allclose(arc.get_xydata(), ARC[:, :2])
    np.testing.assert_allclose(chord.get_xydata(), [(0, 0), (1, 0)])
    assert chord.get_linestyle() == ":"


def test_the_crosses_are_the_centres_of_the_groups():
    ax = figures.end_places(ENDS).axes[0]
    crosses = [line.get_xydata()[0] for line in ax.lines if line.get_marker() == "+"]
    np.testing.assert_allclose(crosses, [(0.2, 0.3), (0.0, -0.1)])


def test_wheels_without_rollers_slide_nowhere_and_all_panels_have_one_scale():
    robots = TWO_SIDES | {"with rollers": [(0.5, 0.0, np.pi / 2, 0.0)]}
    left, right = figures.wheeled(robots).axes
    assert [len(ax.texts) for ax in (left, right)] == [2 + 1, 3 + 1]
    assert left.get_xlim() == right.get_xlim()
    colours = {text.arrow_patch.get_edgecolor() for text in right.texts}
    assert len(colours) == 3


def test_the_default_mecanum_wheels_slide_where_the_librarys_robot_feels_nothing():
    ax = figures.wheeled().axes[2]
    rolling = odometry.mecanum(0.1, 0.3, 0.25).rolling
    arrows = [text for text in ax.texts if text.arrow_patch.get_edgecolor() == to_rgba(style.GREEN)]
    for text in arrows:
        place, way = np.array(text.xyann), np.subtract(text.xy, text.xyann)
        wheel = [(0.3, 0.25), (0.3, -0.25), (-0.3, 0.25), (-0.3, -0.25)].index(tuple(place))
        assert rolling[wheel, :2] @ way == pytest.approx(0, abs=1e-12)
    assert len(arrows) == 8


@pytest.mark.parametrize(
    "draw",
    [
        lambda: figures.areas(T, V, speed),
        lambda: figures.error_orders(STEPS, ERRORS),
        lambda: figures.one_step(ARC[0], ARC, {"Euler": (1.0, 0.0, 0.0)}),
        lambda: figures.end_places(ENDS),
        lambda: figures.wheeled(TWO_SIDES),
        figures.wheeled,
    ],
    ids=["areas", "error_orders", "one_step", "end_places", "wheeled", "wheeled by default"],
)
def test_figures_are_the_same_when_drawn_again_and_their_axes_have_units(draw):
    fig = draw()
    assert style.png(fig) == style.png(draw())
    for ax in fig.axes:
        assert "[" in ax.get_xlabel()
    assert "[" in fig.axes[0].get_ylabel()


@pytest.mark.parametrize(
    "call, match",
    [
        (lambda: figures.areas(T, V[1:], speed), "v must be a speed for each time"),
        (lambda: figures.areas(T[::-1], V, speed), "must rise"),
        (lambda: figures.areas(T, V * np.nan, speed), "v must be finite"),
        (lambda: figures.error_orders(STEPS, {"a": [1.0, 2.0]}), r"a must have shape \(3,\)"),
        (lambda: figures.error_orders(STEPS, {"a": [1.0, 0.0, 2.0]}), "errors must be above 0"),
        (lambda: figures.error_orders(STEPS, ERRORS, kinds={"b": "truth"}), "no errors called"),
        (lambda: figures.error_orders([0.1], {"a": [1.0]}), "2 or more"),
        (lambda: figures.error_orders(STEPS, {}), "one rule at least"),
        (lambda: figures.one_step(ARC[0, :2], ARC, {}), r"pose must have shape \(3,\)"),
        (lambda: figures.one_step(ARC[0], ARC, {"a": (1, 2, 3, 4)}), "a must be x, y, psi"),
        (lambda: figures.one_step(ARC[0], ARC, {}, {"b": "truth"}), "no end called"),
        (lambda: figures.end_places({}), "at least one panel"),
        (
            lambda: figures.end_places({"a": {"cw": np.zeros((3, 3))}}),
            r"cw must have shape \(n, 2\)",
        ),
        (lambda: figures.wheeled({}), "at least one robot"),
        (
            lambda: figures.wheeled({"a": [(0, 0, 0)]}),
            r"a must be wheels \(x, y, drive, free\), shape \(n, 4\)",
        ),
    ],
)
def test_bad_input_is_named(call, match):
    with pytest.raises(ValueError, match=match):
        call()
