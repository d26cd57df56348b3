"""Figures of the course: one style, text alternatives, nothing that needs a screen.

Every drawing function returns a Matplotlib figure; `show(fig, alt)` puts it into the notebook.
"""

from backhoe.plots.drawing import arm, elbows, frames, posture
from backhoe.plots.dynamics import (
    candidates,
    falls,
    gravity_map,
    holding,
    least_eigenvalue,
    weights,
)
from backhoe.plots.interactive import sliders
from backhoe.plots.kalman import beliefs, clouds, consistency, drives_with_ellipses, tunnels
from backhoe.plots.lyapunov import (
    arm_constants,
    certificates,
    gain_demands,
    gain_space,
    joint_lines,
    joint_movement,
    margins,
)
from backhoe.plots.odometry import areas, end_places, error_orders, one_step, wheeled
from backhoe.plots.reach import reachable, singularities, velocity_ellipses, workspace
from backhoe.plots.run import joint_tracking, soil
from backhoe.plots.skid_steer import contacts, friction_laws, paths, stacked
from backhoe.plots.style import COLOURS, KINDS, draw_lines, figure, lines, png, show, styled
from backhoe.plots.tracking import from_above, nearest, pose_errors, pursuit, radar
from backhoe.plots.tracks import turn
from backhoe.plots.way import STAGES, data_way

__all__ = [
    "COLOURS",
    "KINDS",
    "STAGES",
    "areas",
    "arm",
    "arm_constants",
    "beliefs",
    "candidates",
    "certificates",
    "clouds",
    "consistency",
    "contacts",
    "data_way",
    "draw_lines",
    "drives_with_ellipses",
    "elbows",
    "end_places",
    "error_orders",
    "falls",
    "figure",
    "frames",
    "friction_laws",
    "from_above",
    "gain_demands",
    "gain_space",
    "gravity_map",
    "holding",
    "joint_lines",
    "joint_movement",
    "joint_tracking",
    "least_eigenvalue",
    "lines",
    "margins",
    "nearest",
    "one_step",
    "paths",
    "png",
    "pose_errors",
    "posture",
    "pursuit",
    "radar",
    "reachable",
    "show",
    "singularities",
    "sliders",
    "soil",
    "stacked",
    "styled",
    "tunnels",
    "turn",
    "velocity_ellipses",
    "weights",
    "wheeled",
    "workspace",
]
