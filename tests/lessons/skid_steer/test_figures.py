"""The figures of lesson 04: what they show is what was computed, and bad input is refused."""

import numpy as np
import pytest

from backhoe.lessons.skid_steer import figures
from backhoe.vehicle import skid_steer
from backhoe.vehicle.skid_steer import HUSKY
from backhoe.view import plots
from backhoe.view.plots import style

TURN = {"left turn": (0.5, -0.1, 1.0)}
SPEED = np.linspace(-1, 1, 201)
LAWS = {"smooth": 0.2 * np.arctan(10 * SPEED), "linear": 2.0 * SPEED}


def arrows(ax, colour):
    """Start and end of each arrow of that colour, shape (n, 2, 2)."""
    found = [
        text for text in ax.texts if text.arrow_patch and text.arrow_patch.get_edgecolor() == colour
    ]
    return np.array([(text.xyann, text.xy) for text in found])


def rgba(colour):
    from matplotlib.colors import to_rgba

    return to_rgba(colour)


def test_slip_arrows_are_the_librarys_contact_velocities():
    ax = figures.contacts(TURN, HUSKY, metres_per_speed=1.0).axes[0]
    shown = np.diff(arrows(ax, rgba(style.RED)), axis=1)[:, 0]
    slip = skid_steer.contact_velocity(TURN["left turn"], vehicle=HUSKY)
    np.testing.assert_allclose(sorted(shown[:, 1]), sorted(slip[:, 1]), atol=1e-12)
    np.testing.assert_allclose(shown[:, 0], 0, atol=1e-12)


def test_slip_along_the_rims_appears_when_their_speeds_are_given():
    case, rims = {"spin": (0.0, 0.0, 1.0)}, {"spin": (-0.5, 0.5)}
    ax = figures.contacts(case, HUSKY, rims, slip_only=True, metres_per_speed=1.0).axes[0]
    shown = np.diff(arrows(ax, rgba(style.RED)), axis=1)[:, 0]
    wheels = np.array([-0.5, 0.5, -0.5, 0.5]) / HUSKY.wheel_radius
    slip = skid_steer.contact_velocity(case["spin"], wheels, HUSKY)
    np.testing.assert_allclose(sorted(shown[:, 0]), sorted(slip[:, 0]), atol=1e-12)
    assert len(arrows(ax, rgba(style.BLUE))) == 0


def test_the_centre_of_rotation_is_the_point_that_stands_still():
    ax = figures.contacts(TURN, HUSKY).axes[0]
    (centre,) = [line for line in ax.lines if line.get_marker() == "P"]
    x, y = centre.get_xydata()[0]
    v_x, v_y, omega = TURN["left turn"]
    np.testing.assert_allclose([v_x - omega * y, v_y + omega * x], 0.0, atol=1e-12)


def test_a_vehicle_that_drives_straight_has_no_centre_and_no_slip():
    ax = figures.contacts({"straight": (1.0, 0.0, 0.0)}, HUSKY).axes[0]
    assert not [line for line in ax.lines if line.get_marker() == "P"]
    assert len(arrows(ax, rgba(style.RED))) == 0


def test_paths_are_drawn_to_scale_with_their_headings():
    angle = np.linspace(0, np.pi, 50)
    half = np.c_[2 * np.sin(angle), 2 - 2 * np.cos(angle), angle]
    ax = plots.paths({"half": half}, {"half": "reference"}, marks=3).axes[0]
    assert ax.get_aspect() == 1.0
    assert ax.lines[0].get_linestyle() == "--"
    headings = [line.get_marker()[2] for line in ax.lines[1:]]
    np.testing.assert_allclose(headings, [-90.0, np.degrees(angle[24]) - 90.0, 90.0])


def test_the_ratio_of_the_friction_laws_is_one_at_rest_and_grows():
    curve = figures.friction_laws(LAWS, SPEED, 0.05).axes[1].lines[0].get_ydata()
    assert curve[0] == pytest.approx(1.0, abs=0.01)
    assert (np.diff(curve) > 0).all()


def test_stacked_panels_share_their_axis_and_label_it_once():
    fig = plots.stacked(
        [0, 1], {"v [m/s]": {"is": [0, 1]}, "F [N]": {"left": [1, 2]}}, {"is": "truth"}
    )
    assert [ax.get_ylabel() for ax in fig.axes] == ["v [m/s]", "F [N]"]
    assert [ax.get_xlabel() for ax in fig.axes] == ["", "time [s]"]
    assert fig.axes[0].lines[0].get_color() == style.DARK


@pytest.mark.parametrize(
    "draw",
    [
        lambda: figures.contacts(TURN, HUSKY),
        lambda: plots.paths({"a": np.zeros((4, 3))}),
        lambda: figures.friction_laws(LAWS, SPEED, 0.05),
        lambda: plots.stacked([0, 1], {"v [m/s]": {"is": [0, 1]}}),
    ],
    ids=["contacts", "paths", "friction_laws", "stacked"],
)
def test_figures_are_the_same_when_drawn_again_and_their_axes_have_units(draw):
    fig = draw()
    assert plots.png(fig) == plots.png(draw())
    for ax in fig.axes:
        assert "[" in ax.get_xlabel()
    assert "[" in fig.axes[0].get_ylabel()


@pytest.mark.parametrize(
    "call, match",
    [
        (lambda: figures.contacts({}, HUSKY), "at least one case"),
        (lambda: figures.contacts({"a": (1, 0)}, HUSKY), r"twist of .a. must have shape \(3,\)"),
        (lambda: figures.contacts({"a": (1, 0, np.nan)}, HUSKY), r"twist of .a. must be finite"),
        (
            lambda: figures.contacts(TURN, HUSKY, {"left turn": (1, 2, 3)}),
            r"speeds must have shape \(2,\)",
        ),
        (lambda: figures.contacts(TURN, HUSKY, {"right turn": (1, 2)}), "no case called"),
        (lambda: plots.paths({"a": np.zeros((4, 2))}), r"shape \(n, 3\)"),
        (lambda: plots.paths({"a": np.zeros((4, 3))}, {"b": "truth"}), "no drive called"),
        (lambda: figures.friction_laws({"smooth": SPEED}, SPEED, 0.1), "'linear'"),
        (lambda: plots.stacked([0], {}), "at least one panel"),
        (lambda: plots.stacked([0], {"v [1]": {"a": [0]}}, {"b": "truth"}), "no curve called"),
    ],
)
def test_bad_input_is_named(call, match):
    with pytest.raises(ValueError, match=match):
        call()
