"""The figures: drawn without a screen, in one style, with a text alternative, to scale."""

import matplotlib
import numpy as np
import pytest

from backhoe import FLOORS
from backhoe.arm import kinematics
from backhoe.machine import BACKHOE
from backhoe.view import plots
from backhoe.view.plots import drawing, style

DIG = np.radians([-90.0, 15.0, -10.0, 40.0])
PNG = b"\x89PNG\r\n"


@pytest.fixture(
    params=[
        lambda: plots.data_way("arm"),
        lambda: plots.posture(DIG),
        lambda: plots.lines([0, 1, 2], {"a": [1, 2, 3]}, "time [s]", "angle [rad]"),
    ],
    ids="way posture lines".split(),
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


def test_figures_stay_transparent_and_styled_whatever_the_reader_has_set():
    with matplotlib.rc_context({"figure.facecolor": "black", "axes.grid": False, "font.size": 30}):
        fig = plots.posture(DIG)
        assert matplotlib.rcParams["font.size"] == 30
    assert fig.get_facecolor()[3] == fig.axes[0].get_facecolor()[3] == 0.0
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


def test_bundle_carries_the_alternative_twice_and_on_one_line():
    data, metadata = style.bundle(plots.posture(DIG), "an arm\n   that digs")
    assert data["image/png"].startswith(PNG)
    assert data["text/plain"] == metadata["image/png"]["alt"]
    assert data["text/plain"].startswith("an arm that digs\nDrawn: (1) distance from the swing")


def test_show_outside_a_notebook_prints_the_alternative(capsys):
    plots.show(plots.posture(DIG), "an arm that digs")
    assert capsys.readouterr().out.startswith("an arm that digs\nDrawn: ")


@pytest.mark.parametrize("alt", ["", "  \n", None])
def test_a_figure_without_alternative_is_refused(alt):
    with pytest.raises(ValueError, match="text alternative"):
        plots.show(plots.posture(DIG), alt)


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
        return plots.posture(np.radians([0, boom, stick, 0]))

    plots.sliders(draw, {"boom": (-50, 60, 10), "stick": (-60, 60, 0)}, "an arm")
    assert asked == [(10, 0)] and capsys.readouterr().out.startswith("an arm\n")


def test_the_map_of_the_machine_shows_floors_of_the_library_by_their_names():
    words = {text.get_text() for text in plots.data_way("arm").axes[0].texts}
    for floor, question in plots.STAGES.items():
        assert FLOORS[floor] == question and {question, floor.replace("_", " ")} <= words
    assert set(FLOORS) - set(plots.STAGES) == {"basics", "view", "mission", "lessons", "course"}


def test_the_bucket_is_drawn_from_its_pin_to_its_teeth_with_the_shell_between():
    """The outline is the shell's profile in the frame of the teeth, along the bucket."""
    pin, teeth = drawing.plane_points(DIG)[-2:]
    angle = np.arctan2(*(teeth - pin)[::-1])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    outline = drawing._bucket(pin, teeth, BACKHOE)
    np.testing.assert_allclose((outline - teeth) @ turn, BACKHOE.shell.profile, atol=1e-12)
