"""What the figures of lesson 12b show is what they were given."""

import numpy as np
import pytest

from backhoe.lessons.mobile_manipulation.figures import grading as figures
from drawn import Panel, proofs, track


def ellipses():
    bent = np.array([[0.2, 0.0], [0.2, 0.4], [0.5, 0.6]])
    flat = np.add(bent, (0.1, -0.2))
    wide, thin = np.array([[1.0, 0], [0, 0.5], [-1, 0]]), np.array([[0.1, 0.2], [-0.1, -0.2]])
    given = {"start": (bent, {"whole": wide, "arm": thin}), "end": (flat, {"whole": thin})}
    fig = figures.ellipses(given, scale=0.5)
    first = [track(bent, "arm"), track([[1.0, 0.6], [0.5, 0.85], [0.0, 0.6]], "whole")]
    first.append(track([[0.55, 0.7], [0.45, 0.5]], "arm"))
    second = [track(flat, "arm"), track([[0.65, 0.5], [0.55, 0.3]], "whole")]
    assert [ax.get_aspect() for ax in fig.axes] == [1.0, 1.0]
    return fig, [Panel("$x$ [m]", "$z$ [m]", first, "start"), Panel("$x$ [m]", "", second, "end")]


TestDrawn = proofs(figures, {"ellipses": ellipses})


def test_a_figure_without_panels_is_refused():
    with pytest.raises(ValueError, match="at least one panel"):
        figures.ellipses({})
