"""The figures: drawn without a screen, in one style, with a text alternative, to scale."""

import matplotlib
import numpy as np
import pytest

from backhoe import kinematics, plots
from backhoe.machine import BACKHOE, replace
from backhoe.plots import drawing, style

DIG = np.radians([-90.0, 15.0, -10.0, 40.0])
PNG = b"\x89PNG\r\n"


@pytest.fixture(
    params=[
        lambda: plots.data_way("kinematics"),
        lambda: plots.arm(DIG),
        lambda: plots.arm(DIG, np.zeros(4), labels=("dig", "zero"), title="two"),
        lambda: plots.posture(DIG),
        lambda: plots.frames(DIG),
        lambda: plots.elbows(kinematics.pose(DIG)),
        lambda: plots.workspace(DIG),
        lambda: plots.velocity_ellipses([DIG]),
        lambda: plots.singularities(),
        lambda: plots.turn([[0, 0, 0], [1, 0.2, 0.4]], centre=(0, 3)),
        lambda: plots.lines([0, 1, 2], {"a": [1, 2, 3]}, "time [s]", "angle [rad]"),
    ],
    ids="way arm arms posture frames elbows workspace ellipses singularities turn lines".split(),
)
def draw(request):
    return request.param


def test_every_figure_becomes_the_same_png_when_drawn_again(draw):
    first, second = plots.png(draw()), plots.png(draw())
    assert first.startswith(PNG) and first == second


def test_every_axis_with_a_scale_has_a_label_with_a_unit(draw):
    fig = draw()
    for ax in fig.axes:
        if ax.axison and ax.get_label() != "<colorbar>":
            assert "[" in ax.get_xlabel() and "]" in ax.get_xlabel()
    labels = [ax.get_ylabel() for ax in fig.axes if ax.axison]
    assert not labels or any("[" in label for label in labels)


def test_figures_stay_white_and_styled_whatever_the_reader_has_set():
    with matplotlib.rc_context({"figure.facecolor": "black", "axes.grid": False, "font.size": 30}):
        fig = plots.arm(DIG)
        assert matplotlib.rcParams["font.size"] == 30
    assert fig.get_facecolor() == (1.0, 1.0, 1.0, 1.0)
    assert fig.axes[0].xaxis.label.get_size() == style.STYLE["axes.labelsize"]


def test_plane_points_are_the_forward_kinematics_for_any_swing():
    q = np.random.default_rng(1).uniform(-3, 3, (50, 4))
    points = drawing.plane_points(q)
    tip = kinematics.forward_kinematics(q)[:, :3, 3]
    axis = np.array([BACKHOE.base.offset, 0.0])
    np.testing.assert_allclose(
        np.abs(points[:, 3, 0]), np.linalg.norm(tip[:, :2] - axis, axis=1), atol=1e-12
    )
    np.testing.assert_allclose(points[:, 3, 1], tip[:, 2], atol=1e-12)


def test_reachable_cells_hold_random_postures_and_follow_the_machine():
    rng = np.random.default_rng(2)
    q = rng.uniform(BACKHOE.lower, BACKHOE.upper, (400, 4))
    cells = plots.reachable()
    points = drawing.plane_points(q)[:, 3]
    nearest = np.min(np.linalg.norm(points[:, None] - cells, axis=-1), axis=1)
    assert nearest.max() < 0.15
    longer = replace(BACKHOE, stick=replace(BACKHOE.stick, length=3.0))
    assert plots.reachable(longer)[:, 0].max() > cells[:, 0].max() + 0.8


def test_sizes_follow_the_machine():
    longer = replace(BACKHOE, boom=replace(BACKHOE.boom, length=6.0))
    assert plots.png(plots.arm(DIG)) != plots.png(plots.arm(DIG, machine=longer))


def test_bundle_carries_the_alternative_twice_and_on_one_line():
    data, metadata = style.bundle(plots.arm(DIG), "an arm\n   that digs")
    assert data["image/png"].startswith(PNG)
    assert data["text/plain"] == metadata["image/png"]["alt"] == "an arm that digs"


def test_show_outside_a_notebook_prints_the_alternative(capsys):
    plots.show(plots.arm(DIG), "an arm that digs")
    assert capsys.readouterr().out == "an arm that digs\n"


@pytest.mark.parametrize("alt", ["", "  \n", None])
def test_a_figure_without_alternative_is_refused(alt):
    with pytest.raises(ValueError, match="text alternative"):
        plots.show(plots.arm(DIG), alt)


def test_lines_use_the_style_of_their_kind_and_may_stop_early():
    fig = plots.lines(
        [0, 1, 2], {"wanted": [1, 1, 1], "is": [0, 1]}, "t [s]", "q [rad]", {"wanted": "reference"}
    )
    wanted, measured = fig.axes[0].lines
    assert wanted.get_linestyle() == "--" and len(measured.get_xdata()) == 2


@pytest.mark.parametrize(
    "call, match",
    [
        (lambda: plots.data_way("magic"), "the parts are machine"),
        (lambda: plots.arm(), "at least one posture"),
        (lambda: plots.arm(DIG, labels=("a", "b")), "2 labels for 1 postures"),
        (lambda: plots.arm([0, 0, 0]), "4 joints"),
        (lambda: plots.turn([0, 0, 0]), "shape"),
        (lambda: plots.elbows([30, 0, 0, 0]), "outside the reach"),
        (lambda: plots.lines([0], {"a": [0]}, "x", "y", {"a": "dotted"}), "the kinds are"),
        (lambda: plots.lines([0], {"a": [0]}, "x", "y", {"b": "truth"}), "no series called"),
        (lambda: plots.sliders(plots.posture, {"q": (0, 1, 2)}, "x"), "outside its range"),
    ],
)
def test_bad_input_is_named(call, match):
    with pytest.raises(ValueError, match=match):
        call()


def test_sliders_outside_a_notebook_leave_the_first_picture_as_text(capsys):
    asked = []

    def draw(boom, stick):
        asked.append((boom, stick))
        return plots.arm(np.radians([0, boom, stick, 0]))

    plots.sliders(draw, {"boom": (-50, 60, 10), "stick": (-60, 60, 0)}, "an arm")
    assert asked == [(10, 0)] and capsys.readouterr().out == "an arm\n"
