"""What the figures of lesson 09a show is what they were given."""

import numpy as np
import pytest

from backhoe.lessons.voxel_map.figures import lasers as figures
from drawn import Panel, proofs, track

ONE = np.array([[0.0, 1.0, 5.0], [2.0, 0.5, 6.0], [3.0, 2.5, 7.0]])
OTHER = np.array([[1.0, 2.0], [2.5, 0.0]])
TRUTH = np.array([[0.5, 0.5], [2.0, 0.5], [2.0, 2.0]])


def dots():
    given = {"first": {"left laser": ONE, "kept": OTHER}, "second": {"removed": OTHER[::-1]}}
    one = [track(ONE[:, :2], "left laser"), track(OTHER, "kept"), track(TRUTH, "truth")]
    other = [track(OTHER[::-1], "removed"), track(TRUTH, "truth")]
    fig = figures.dots(given, "ahead [m]", "left [m]", truth=TRUTH)
    return fig, [
        Panel("ahead [m]", "left [m]", one, "first"),
        Panel("ahead [m]", "", other, "second"),
    ]


def dots_alone():
    fig = figures.dots({"all": {"unknown": ONE}}, xlim=(-1, 4), ylim=(0, 3))
    return fig, [Panel("$x$ [m]", "$y$ [m]", [track(ONE[:, :2], "unknown")], "all")]


def test_points_without_a_panel_or_of_another_shape_are_refused():
    with pytest.raises(ValueError, match="dots needs a panel"):
        figures.dots({})
    with pytest.raises(ValueError, match="dots needs a panel"):
        figures.dots({"a": {}})
    with pytest.raises(ValueError, match="truth"):
        figures.dots({"a": {"kept": ONE}}, truth=ONE)


TestDrawn = proofs(figures, {"dots": dots, "dots alone": dots_alone})
