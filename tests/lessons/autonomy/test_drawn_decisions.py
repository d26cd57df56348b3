"""What the figures of lessons 14a and 14b show is what they were given."""

import numpy as np
import pytest

from backhoe.lessons.autonomy.figures import decisions as figures
from drawn import Panel, cells, proofs, track


def grounds():
    x, y = np.array([1.0, 1.5, 2.0]), np.array([-1.0, 1.0])
    panels = {
        "believed": np.array([[0.1, 0.4, 0.2], [1.0, 0.3, 0.6]]),
        "true": np.array([[0.3, 0.9, 0.2], [0.5, 0.7, 0.8]]),
    }
    mark = [(1.0, -1.0), (1.5, 0.5)]
    fig = figures.grounds(x, y, panels, ("reach [m]", "direction [deg]"), {"true": mark})
    edges = [0.75, 1.25, 1.75, 2.25], [-2.0, 0.0, 2.0]
    told = [
        Panel(
            "reach [m]",
            "" if title == "true" else "direction [deg]",
            [cells(*edges, values), *([track(mark)] if title == "true" else [])],
            title,
        )
        for title, values in panels.items()
    ]
    return fig, told


TestDrawn = proofs(figures, {"grounds": grounds})


def test_a_figure_without_grounds_is_refused():
    with pytest.raises(ValueError, match="at least one panel"):
        figures.grounds([0, 1], [0, 1], {}, ("x [m]", "y [m]"))
