"""Figures of the course: one style, text alternatives, nothing that needs a screen.

Every drawing function returns a Matplotlib figure; `show(fig, alt)` puts it into the notebook.
"""

from backhoe.plots.drawing import arm, elbows, frames, posture
from backhoe.plots.interactive import sliders
from backhoe.plots.reach import reachable, singularities, velocity_ellipses, workspace
from backhoe.plots.style import COLOURS, KINDS, draw_lines, figure, lines, png, show, styled
from backhoe.plots.tracks import turn
from backhoe.plots.way import STAGES, data_way

__all__ = [
    "COLOURS",
    "KINDS",
    "STAGES",
    "arm",
    "data_way",
    "draw_lines",
    "elbows",
    "figure",
    "frames",
    "lines",
    "png",
    "posture",
    "reachable",
    "show",
    "singularities",
    "sliders",
    "styled",
    "turn",
    "velocity_ellipses",
    "workspace",
]
