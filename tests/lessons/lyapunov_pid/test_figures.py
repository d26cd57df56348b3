"""The figures of lesson 03: what they show is what was computed, and bad input is refused."""

import numpy as np
import pytest

from backhoe.arm import lyapunov, movement
from backhoe.arm.pid import Gains
from backhoe.lessons import published
from backhoe.lessons.lyapunov_pid import figures

GRID = np.geomspace(0.1, 10.0, 4), np.geomspace(0.01, 1.0, 5)


@pytest.fixture(scope="module")
def printed_gains():
    table = published.load("mastalli_2013_eq_333")
    return Gains(*(np.array(table[name]) for name in ("K_p", "K_i", "K_d")))


def labelled(ax):
    return {line.get_label(): line.get_ydata() for line in ax.lines}


def test_a_movement_shows_its_angles_and_the_norm_of_its_speeds():
    move = movement.loading(dt=0.05)
    angles, speeds = figures.joint_movement(move, movement.PHASES).axes
    assert np.allclose(labelled(angles)["boom"], np.degrees(move.q[:, 1]))
    assert np.allclose(labelled(speeds)["norm"], np.degrees(move.speed))
    assert {text.get_text() for text in angles.texts} == set(movement.PHASES)


def test_constants_are_shown_in_the_units_of_their_axes():
    q = movement.loading(dt=0.5).q
    profile = lyapunov.profile(q)
    slope, symbol, eigenvalues, ratio = figures.arm_constants(np.arange(len(q)), profile).axes
    assert np.allclose(labelled(slope)["spectral norm"] * 1e3, profile.kg)
    assert np.allclose(labelled(symbol)["max |C|"] * 1e3, profile.symbol)
    assert np.allclose(labelled(eigenvalues)["smallest"] * 1e3, profile.lambda_min)
    assert np.allclose(labelled(ratio)["largest² / smallest"] * 1e6, profile.ratio)
    assert "[t m²]" in symbol.get_ylabel() and "[1000 t m²]" in ratio.get_ylabel()


def test_certificates_show_an_interval_or_say_that_there_is_none(printed_gains):
    judged = {
        route: lyapunov.check_gains(printed_gains, route=route) for route in ("scalar", "matrix")
    }
    ax = figures.certificates(judged).axes[0]
    below, above = (text.get_text() for text in ax.texts)
    assert "5.4 rad" in below and "no" in above
    bars = [line.get_xdata() for line in ax.lines if len(line.get_xdata()) == 2]
    matrix = judged["matrix"]
    assert any(np.allclose(bar, (matrix.alpha_low, matrix.alpha_high)) for bar in bars)


def test_margins_reach_to_the_right_exactly_where_the_condition_holds():
    ax = figures.margins({"holds": (20.0, 10.0), "fails": (1.0, 10.0)}).axes[0]
    fails, holds = (bar.get_width() for bar in ax.patches)
    assert holds == pytest.approx(np.log10(2)) and fails == pytest.approx(-1)


def test_the_demands_on_the_printed_gains_are_those_of_the_lesson(printed_gains):
    ax = figures.gain_demands(printed_gains).axes[0]
    names = [label.get_text() for label in ax.get_yticklabels()]
    widths = {bar.get_y() + bar.get_height() / 2: bar.get_width() for bar in ax.patches}
    holds = {names[round(row)] for row, width in widths.items() if width > 0}
    assert holds == {
        "springs beat gravity",
        "matrix: room for alpha",
        "drives: 0.05 rad fits",
    }


def test_joint_lines_draw_the_band_on_both_sides():
    fig = figures.joint_lines(np.arange(3), np.ones((3, 4)), "error [deg]", band=2.0)
    levels = {line.get_ydata()[0] for line in fig.axes[0].lines if len(line.get_xdata()) == 2}
    assert levels == {-2.0, 2.0}


def test_gain_space_leaves_out_what_ran_away():
    errors = np.full((4, 5), np.radians(1.0))
    errors[0, 0] = np.inf
    fig = figures.gain_space(
        *GRID, [errors], ["panel"], [np.ones(4)], [np.ones(4)], {"mine": (1, 0.1)}
    )
    cells = fig.axes[0].collections[0].get_array()
    assert cells.mask.sum() == 1 and cells.mask[0, 0]
    assert np.allclose(cells.compressed(), 1.0)


def test_gain_space_puts_the_borders_of_the_cells_between_their_centres():
    ax = figures.gain_space(*GRID, [np.ones((4, 5))], ["panel"]).axes[0]
    x, y = ax.collections[0].get_coordinates().reshape(6, 5, 2)[0, :, 0], ax.get_ylim()
    assert np.all((x[:-1] < GRID[0]) & (GRID[0] < x[1:]))
    assert y[0] < GRID[1][0] and GRID[1][-1] < y[1]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: figures.certificates({}), "no certificate to draw"),
        (lambda: figures.margins({}), "no condition to draw"),
        (
            lambda: figures.margins({"a": (1.0, 0.0)}),
            "a: what is needed must be one number above 0",
        ),
        (lambda: figures.margins({"a": (np.inf, 1.0)}), "a: what there is must be one finite"),
        (lambda: figures.gain_demands(Gains([1, 1, 1], [1] * 4, [1] * 4)), "4 gains"),
        (
            lambda: figures.joint_lines([0, 1], np.ones((3, 4)), "x"),
            "a row of 4 joints for each time",
        ),
        (lambda: figures.gain_space(*GRID, [np.ones((5, 4))], ["a"]), r"one \(4, 5\) array"),
        (lambda: figures.gain_space(*GRID, [np.ones((4, 5))], ["a", "b"]), "each of 2 titles"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
