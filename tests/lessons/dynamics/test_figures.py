"""The figures of lesson 02: what they show is what was computed, and bad input is refused."""

import numpy as np
import pytest

from backhoe.arm import dynamics, integrate
from backhoe.lessons import published
from backhoe.lessons.dynamics import figures, printed
from backhoe.machine import BACKHOE
from backhoe.machine.variants import reading
from backhoe.view.plots.style import LINK_COLOURS

HELD = np.radians([0.0, 15.0, 10.0, 20.0])


def texts(ax):
    return {text.get_text() for text in ax.texts}


def test_weights_times_their_shown_lever_arms_are_the_boom_torque():
    written = texts(figures.weights(HELD).axes[0])
    arms = {float(text.removesuffix(" m")) for text in written if text.endswith(" m")}
    weights = {float(text.split()[-2]) for text in written if text.endswith("kN")}
    torque = sum(w * a for w, a in zip(sorted(weights, reverse=True), sorted(arms), strict=True))
    assert torque == pytest.approx(dynamics.gravity_torque(HELD)[1] / 1e3, abs=0.5)


def test_holding_shows_the_empty_and_the_loaded_torques():
    shown = set().union(*map(texts, figures.holding(10.0, 0.0, 0.0).axes[1:]))
    empty = dynamics.gravity_torque(np.radians([0.0, 10.0, 0.0, 0.0]))[1:] / 1e3
    assert {f"{value:.1f}" for value in empty} <= shown
    assert len(shown) == 6


def test_falls_draws_every_posture_and_marks_the_start():
    ax = figures.falls({"still": np.tile(HELD, (5, 1))}).axes[0]
    starts = [line for line in ax.lines if line.get_linestyle() == "--"]
    links = [line for line in ax.lines if line.get_label().strip("_") in LINK_COLOURS]
    assert [len(line.get_xdata()) for line in starts] == [4]
    assert len(links) == 4 * 3
    assert all(line.get_color() == LINK_COLOURS[line.get_label().strip("_")] for line in links)


def test_no_posture_of_the_three_falls_is_drawn_below_the_ground():
    """The stand is there for that."""
    case = published.load("mastalli_2013_free_fall")
    start = np.concatenate([np.radians(case["start_deg"]), np.zeros(4)])
    motions = {}
    for number in (1, 2, 3):
        torque = np.array(case[f"case_{number}"]["torque"])

        def acceleration(t, q, dq, torque=torque):
            return dynamics.forward_dynamics(q, dq, torque)

        rolled = integrate.rk4(integrate.motion(acceleration), start, 0.02, 50)
        motions[f"case {number}"] = rolled.x[:, :4]
    for ax in figures.falls(motions).axes[:3]:
        links = [line for line in ax.lines if line.get_label().strip("_") in LINK_COLOURS]
        assert min(line.get_ydata().min() for line in links) > 0.3


def test_the_zero_line_is_drawn_only_where_definiteness_is_lost():
    lost = figures.least_eigenvalue(printed.mass_matrix).axes[0].collections
    kept = figures.least_eigenvalue(dynamics.mass_matrix).axes[0].collections
    assert len(lost) == len(kept) + 1


def test_candidates_say_how_far_they_miss():
    torque = dynamics.gravity_torque(HELD)
    fig = figures.candidates(
        {"hang": BACKHOE, "straight": reading([-1.9, -3.8, 14.1, -11.4])}, HELD, torque
    )
    titles = [ax.get_title() for ax in fig.axes]
    assert titles[0].endswith("misses by 0.00 kN m")
    assert not titles[1].endswith("misses by 0.00 kN m")


def test_gravity_map_spans_the_torques_within_the_limits():
    fig = figures.gravity_map()
    low, high = fig.axes[1].get_ylim()
    q = np.random.default_rng(1).uniform(BACKHOE.lower, BACKHOE.upper, (1000, 4))
    q[:, 3] = 0.0
    torque = dynamics.gravity_torque(q)[:, 1] / 1e3
    assert low <= torque.min() and torque.max() <= high


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: figures.gravity_map(0), "joint must be"),
        (lambda: figures.falls({}), "no motion to draw"),
        (lambda: figures.weights([0.0, 1.0]), "4 joints"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
