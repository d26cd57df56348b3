"""What the figures of lesson 12b show is what they were given."""

import numpy as np
import pytest

from backhoe.lessons.mobile_manipulation.figures import grading as figures
from drawn import Panel, proofs, track


def ellipses():
    """The hand by complex numbers; an ellipse from the square root of J J^T."""
    postures = {"bent": [0.1, 0.0, 0.0, 0.0, 0.9, -0.6], "straight": [0, 0, 0, 0, 0.4, 0.0]}
    panels = []
    for title, (x, _, _, _, q2, q3) in postures.items():
        shoulder = x + 0.2 + 0.4j
        elbow = shoulder + 0.275 * np.exp(1j * q2)
        end = elbow + 0.275 * np.exp(1j * (q2 + q3))
        arm = [x + 0.2, shoulder, elbow, end]
        turned = [1j * (end - shoulder), 1j * (end - elbow)]
        items = [track(np.transpose([np.real(arm), np.imag(arm)]), "arm")]
        fig = figures.ellipses(postures, scale=0.5)
        lines = fig.axes[len(panels)].lines[1:]
        for line, label, ways in zip(
            lines, ("the arm's", "the whole's"), (turned, [1.0, *turned]), strict=True
        ):
            points = line.get_xydata()
            J = np.array([np.real(ways), np.imag(ways)])
            v = np.linalg.pinv(J) @ (points - [end.real, end.imag]).T / 0.5
            reach = np.linalg.norm(v, axis=0)  # the least velocities that go there
            assert reach.max() == pytest.approx(1.0, abs=1e-6)
            assert title == "straight" or reach == pytest.approx(1.0)
            items.append(track(points, label))
        panels.append(Panel("$x$ [m]", "" if panels else "$z$ [m]", items, title))
    return fig, panels


TestDrawn = proofs(figures, {"ellipses": ellipses})


def test_a_figure_without_postures_is_refused():
    with pytest.raises(ValueError, match="at least one panel"):
        figures.ellipses({})
