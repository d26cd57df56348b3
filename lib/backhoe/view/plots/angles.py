"""One joint seen from its side: which angle is q, which q*, which that of the centre of mass."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import choice
from backhoe.machine import BACKHOE, Machine
from backhoe.view.plots.drawing import HEIGHT_LABEL, draw_arm, side_axes
from backhoe.view.plots.style import BLUE, GREEN, GREY, PURPLE, figure, styled

LINKS = ("boom", "stick", "bucket")


@styled
def joint_angles(q: ArrayLike, link: str = "stick", machine: Machine = BACKHOE) -> Figure:
    """The three angles of a link about its joint, from the line before it.

    q* leads from the line of the link before, drawn on, to the line from this joint to the next; q
    leads to the same line from where it is at q = 0; q^cm leads to the centre of mass.

    Args:
        q: joint angles, shape (4,) [rad].
        link: "boom", whose line before is the level, "stick" or "bucket".
        machine: lengths [m] and angle offsets [rad].

    Raises:
        ValueError: q has a wrong shape or value, or an unknown link.
    """
    number = LINKS.index(choice(link, "link", LINKS))
    fig, ax = figure(6.8, 5.4)
    points = draw_arm(ax, q, machine, alpha=0.3)
    here = points[number]
    side_axes(ax, (here[0] - 3.4, here[0] + 3.4, here[1] - 2.9, here[1] + 2.3), machine)
    ax.set_ylabel(HEIGHT_LABEL)
    before = _slope(points[number] - points[number - 1]) if number else 0.0
    angle, offset = float(np.asarray(q)[number + 1]), machine.links[number].angle_offset
    mass = angle + machine.links[number].com_angle
    star, sub = angle + offset, number + 2
    _ray(ax, here, before, 3.0, "line before" if number else "level", GREY, "--")
    _ray(ax, here, before + offset, 2.6, f"$q_{sub}=0$", BLUE, ":")
    _ray(ax, here, before + star, 2.6, "to the next joint", GREEN, "-")
    at = here + machine.links[number].com_radius * _along(before + mass)
    ax.plot(*np.array([here, at]).T, color=PURPLE, ls="-.", lw=1.6, zorder=6)
    ax.plot(*at, "P", color=PURPLE, ms=11, label="centre of mass", zorder=7)
    for start, end, radius, colour, style, name in (
        (0.0, star, 1.9, GREEN, "-", f"$q_{sub}^*$"),
        (offset, star, 1.35, BLUE, ":", f"$q_{sub}$"),
        (0.0, mass, 0.8, PURPLE, "-.", f"$q_{sub}^{{cm}}$"),
    ):
        low, high = np.degrees(before + np.sort((start, end)))
        turn = {"theta1": low, "theta2": high, "color": colour, "ls": style, "lw": 2}
        ax.add_patch(Arc(here, 2 * radius, 2 * radius, zorder=8, **turn))
        middle = here + (radius + 0.22) * _along(before + (start + end) / 2)
        ax.text(*middle, name, size=13, color=colour, ha="center", va="center", zorder=9)
    ax.legend(loc="upper left")
    return fig


def _along(angle: float) -> NDArray:
    return np.array([np.cos(angle), np.sin(angle)])


def _slope(line: NDArray) -> float:
    return float(np.arctan2(line[1], line[0]))


def _ray(
    ax: Axes, start: NDArray, angle: float, length: float, label: str, colour: str, style: str
) -> None:
    ends = np.array([start, start + length * _along(angle)])
    ax.plot(*ends.T, color=colour, ls=style, lw=1.8, label=label, zorder=6)
