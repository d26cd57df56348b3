"""Figures that several lessons share: one style, text alternatives, nothing that needs a screen.

Every drawing function returns a Matplotlib figure; `show(fig, alt)` puts it into the notebook. What
one lesson alone draws is in its `backhoe.lessons.<name>.figures`.
"""

from backhoe.view.plots.angles import joint_angles
from backhoe.view.plots.drawing import posture
from backhoe.view.plots.interactive import sliders
from backhoe.view.plots.panels import joint_tracking, stacked
from backhoe.view.plots.paths import from_above, paths
from backhoe.view.plots.standing import balance, lifting_chart, margin
from backhoe.view.plots.style import (
    COLOURS,
    KINDS,
    LOOKS,
    draw_lines,
    figure,
    lines,
    looks,
    png,
    show,
    styled,
)
from backhoe.view.plots.way import STAGES, data_way

__all__ = [
    "COLOURS",
    "KINDS",
    "LOOKS",
    "STAGES",
    "balance",
    "data_way",
    "draw_lines",
    "figure",
    "from_above",
    "joint_angles",
    "joint_tracking",
    "lifting_chart",
    "lines",
    "looks",
    "margin",
    "paths",
    "png",
    "posture",
    "show",
    "sliders",
    "stacked",
    "styled",
]
