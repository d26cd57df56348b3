"""The figures of lesson 02: what they show is what was computed, and bad input is refused."""

import numpy as np
import pytest

from backhoe.arm import dynamics
from backhoe.lessons.dynamics import figures, printed
from backhoe.machine import BACKHOE
from backhoe.machine.variants import reading

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
    shown = texts(figures.holding(10.0, 0.0, 0.0).axes[1])
    empty = dynamics.gravity_torque(np.radians([0.0, 10.0, 0.0, 0.0]))[1:] / 1e3
    assert {f"{value:.1f}" for value in empty} <= shown
    assert len(shown) == 6


def test_falls_draws_every_posture_and_marks_the_start():
    ax = figures.falls({"still": np.tile(HELD, (5, 1))}).axes[0]
    chains = [line for line in ax.lines if len(line.get_xdata()) == 4]
    assert len(chains) == 5
    assert len({line.get_color() for line in chains}) == 2


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
        (lambda: figures.falls({}), "0 views for 0 motions"),
        (lambda: figures.falls({"a": [HELD]}, views=("back",)), "unknown view"),
        (lambda: figures.weights([0.0, 1.0]), "4 joints"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
