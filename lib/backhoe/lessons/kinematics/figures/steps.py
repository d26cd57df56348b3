"""A turn of the tracks, seen from above."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from numpy.typing import ArrayLike

from backhoe.basics.inputs import numbers
from backhoe.machine import BACKHOE, Machine
from backhoe.view.plots.style import DARK, GREEN, GREY, ORANGE, PURPLE, figure, styled


@styled
def turn(
    poses: ArrayLike, centre: ArrayLike | None = None, machine: Machine = BACKHOE, title: str = ""
) -> Figure:
    """A drive seen from above, with both tracks and the centre that they turn about.

    Args:
        poses: x, y [m] and heading [rad] along the way, shape (n, 3).
        centre: instantaneous centre of rotation, shape (2,) [m]; None draws none.
        machine: gauge, length and width of the tracks.

    Raises:
        ValueError: poses are not of shape (n, 3).
    """
    poses = numbers(poses, "poses", ("n", 3), meaning="x, y, heading")
    fig, ax = figure(6.8, 4.8)
    half = machine.tracks.gauge / 2
    left = np.column_stack((-np.sin(poses[:, 2]), np.cos(poses[:, 2])))
    for side, colour, style, text in (
        (half, GREEN, "-.", "left track"),
        (-half, PURPLE, ":", "right track"),
        (0.0, GREY, "--", "middle"),
    ):
        ax.plot(*(poses[:, :2] + side * left).T, color=colour, ls=style, label=text)
    for index in (0, len(poses) // 2, -1):
        _undercarriage(ax, poses[index], machine)
    if centre is not None:
        ax.plot(*centre, "P", color=ORANGE, mec=DARK, ms=12, label="centre of rotation", zorder=6)
        for index in (0, len(poses) // 2, -1):
            ax.plot(*np.array([centre, poses[index, :2]]).T, ":", color=GREY, zorder=1)
    ax.set(xlabel="$x$ [m]", ylabel="$y$ [m]", aspect="equal", title=title)
    ax.margins(0.06)
    fig.legend(loc="outside lower center", ncols=2)
    return fig


def _undercarriage(ax: Axes, pose: ArrayLike, machine: Machine) -> None:
    tracks = machine.tracks
    x, y, heading = pose
    R = np.array([[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]])
    size = tracks.length / 2, tracks.shoe_width / 2
    box = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * size
    arrow = np.array([(0.2, 0.16), (0.2, -0.16), (1.1, 0.0)])
    for outline, shift, alpha in (
        (box, tracks.gauge / 2, 0.35),
        (box, -tracks.gauge / 2, 0.35),
        (arrow, 0.0, 0.9),
    ):
        placed = np.add(outline, (0.0, shift)) @ R.T + (x, y)
        ax.add_patch(Polygon(placed, facecolor=GREY, edgecolor=DARK, alpha=alpha, zorder=2))
