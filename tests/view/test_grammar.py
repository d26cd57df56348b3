"""One meaning per look: told apart in colour, without colour, and by colour-blind readers."""

from io import BytesIO
from itertools import combinations

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread

from backhoe.machine import JOINTS
from backhoe.vehicle.tracking import TRACKERS
from backhoe.view import plots
from backhoe.view.plots import style
from backhoe.view.plots.told import told

# Machado, Oliveira and Fernandes (2009), severity 1, in linear red, green and blue.
BLIND = {
    "red": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "green": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "blue": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
TO_XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)


def linear(colour):
    rgb = np.array(to_rgb(colour))
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def lab(colour, blind=None):
    """CIELAB of a colour as a reader sees it who is blind for one of the three."""
    rgb = linear(colour) if blind is None else np.clip(BLIND[blind] @ linear(colour), 0, 1)
    x, y, z = np.cbrt(TO_XYZ @ rgb / TO_XYZ.sum(axis=1))
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def contrast(colour, ground):
    light = sorted(TO_XYZ[1] @ linear(one) + 0.05 for one in (colour, ground))
    return light[1] / light[0]


@pytest.mark.parametrize("group", style.GRAMMAR)
def test_two_of_a_kind_differ_in_their_marker_and_to_each_eye_in_their_colour(group):
    for (colour, marker), (other, shape) in combinations(style.GRAMMAR[group].values(), 2):
        assert marker != shape
        for blind in (None, *BLIND):
            assert np.linalg.norm(lab(colour, blind) - lab(other, blind)) > 12


def test_the_grammar_has_all_that_it_is_about():
    assert list(style.GRAMMAR["joints"]) == list(JOINTS)
    assert set(TRACKERS) <= set(style.GRAMMAR["controllers of a path"])
    assert sum(map(len, style.GRAMMAR.values())) == len(style.LOOKS)


@pytest.mark.parametrize("ground", ["#ffffff", "#111111"])
def test_words_and_curves_can_be_read_on_light_and_dark_pages(ground):
    assert contrast(style.GREY, ground) > 3.5
    colours = {colour for colour, _ in style.LOOKS.values()}
    assert min(contrast(colour, ground) for colour in colours) > 1.9


def test_only_the_truth_is_black():
    black = [name for name, look in style.KINDS.items() if look.get("color") == style.DARK]
    assert black == ["truth"]
    assert style.DARK not in {colour for colour, _ in style.LOOKS.values()}


def test_a_name_looks_the_same_in_every_figure_and_variants_of_it_differ_in_their_dashes():
    first, printed, other = style.looks(["EKF", "EKF, no slip", "wheels"])
    assert (first["color"], first["marker"]) == style.LOOKS["EKF"]
    assert printed["color"] == first["color"] and printed["linestyle"] != first["linestyle"]
    assert other["color"] != first["color"]
    assert style.looks(["UKF", "EKF"])[1]["color"] == first["color"]
    assert style.looks(["PID"])[0]["color"] != style.LOOKS["P"][0]


def test_a_longer_name_is_not_its_beginning():
    plain, longer = style.looks(["pid", "pid+gravity"])
    assert (plain["color"], longer["color"]) == (style.BLUE, style.ORANGE)
    assert style.looks(["P with a limit"])[0]["color"] == style.LOOKS["P"][0]
    assert style.looks(["pure pursuit, 2 m"])[0]["color"] == style.LOOKS["pure pursuit"][0]


def test_many_curves_all_differ_without_colour():
    styles = style.looks([f"curve {k}" for k in range(20)])
    assert len({(one["marker"], one["linestyle"]) for one in styles}) == 20


def test_one_curve_alone_has_no_marker():
    assert "marker" not in style.looks(["height"])[0]


def test_black_is_seen_on_a_dark_page():
    fig = plots.lines([0, 1], {"is": [0, 1]}, "t [s]", "x [m]", {"is": "truth"})
    shown = imread(BytesIO(plots.png(fig)))
    opaque = shown[shown[..., 3] > 0.9][:, :3]
    assert (opaque.max(axis=1) < 0.15).any() and (opaque.min(axis=1) > 0.95).any()


def test_what_is_drawn_is_told_with_axes_units_and_ranges():
    fig = plots.lines([0, 1, 2], {"wanted": [1, 1, 1], "is": [0, 0.4567]}, "t [s]", "q [rad]")
    assert told(fig) == "Drawn: t [s] -0.1 to 2.1, q [rad] -0.05 to 1.1; wanted 1; is 0 to 0.46."


@pytest.mark.parametrize(
    "change",
    [
        lambda ax: ax.lines[0].remove(),
        lambda ax: ax.lines[0].set_data(ax.lines[0].get_ydata(), ax.lines[0].get_xdata()),
        lambda ax: ax.set_xlabel("time [min]"),
        lambda ax: ax.lines[0].set_label("no name"),
        lambda ax: ax.set_ylim(0, 99),
    ],
    ids="empty swapped unit name range".split(),
)
def test_another_figure_is_told_otherwise(change):
    fig = plots.lines([0, 1, 2], {"wanted": [1, 3, 8]}, "t [s]", "q [rad]")
    before = told(fig)
    change(fig.axes[0])
    assert told(fig) != before


def test_the_last_digits_of_a_processor_are_not_told():
    values = np.array([0.045, 0.125, 8.45])
    one, other = (
        told(plots.lines([0, 1, 2], {"x": values * factor}, "t [s]", "x [m]"))
        for factor in (1 - 1e-14, 1 + 1e-14)
    )
    assert one == other


def test_what_leaves_the_view_is_told_up_to_its_edge():
    """How high a pole's spike is depends on the processor."""
    fig = plots.lines([0, 1, 2], {"gain": [1, 4.7e15, -3]}, "t [s]", "x [m]", ylim=(20, 0))
    assert "gain 0 to 20" in told(fig)


def test_a_shared_axis_is_told_by_the_name_that_it_has_in_another_panel():
    fig = plots.stacked([0, 1], {"x [m]": {"a": [120, 340]}, "y [m]": {"b": [0, 1]}})
    assert told(fig).count("time [s] -0.05 to 1.1") == 2 and "a 120 to 340" in told(fig)
    fig.axes[1].set_xlabel("")
    assert told(fig).count("no name") == 2


def test_an_axis_of_words_has_names_in_place_of_a_quantity():
    fig = plots.lines([0, 1], {"a": [0, 1]}, "t [s]", "")
    fig.axes[0].set_yticks([0, 1], ["first", "second"])
    assert "names -0.05 to 1.1" in told(fig)


def test_a_photograph_is_not_drawn_sharper_than_it_is():
    widths = []
    for rows in (400, 800):
        fig, ax = style.figure()
        ax.imshow(np.zeros((rows, 500)))
        data, about = style.bundle(fig, "grey")
        assert about["image/png"]["width"] == 816
        widths.append(imread(BytesIO(data["image/png"])).shape[1])
    assert widths == [1360, 816]


def test_an_empty_figure_and_empty_curves_are_told_too():
    fig, ax = style.figure()
    ax.axis("off")
    assert told(fig) == ""
    fig = plots.lines([0, 1], {"x": [np.nan, np.nan]}, "t [s]", "x [m]")
    assert "x empty" in told(fig)
