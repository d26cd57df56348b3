"""The arm as it looks: side view, frames, the two elbows, a slider's picture."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from matplotlib.ticker import MultipleLocator
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.machine import BACKHOE, Machine
from backhoe.view.plots.style import DARK, GREY, GROUND, LINK_COLOURS, STEEL, figure, styled

REACH_LABEL = "distance from the swing axis [m]"
HEIGHT_LABEL = "height above the ground [m]"
_HOUSE = np.column_stack(
    (
        (-2.0, 0.95, 0.95, 0.3, 0.3, -0.85, -0.85, -2.0),
        (-0.2, -0.2, 0.1, 0.55, 1.75, 1.75, 0.75, 0.75),
    )
)
_THICKNESS = {"boom": (0.62, 0.38), "stick": (0.46, 0.26)}


def plane_points(q: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """Boom's joint, stick's joint, bucket's pin and teeth in the plane of the arm.

    Args:
        q: joint angles, shape (..., 4) [rad].

    Returns:
        Distance from the swing axis and height of each point, shape (..., 4, 2) [m].
    """
    T = kinematics.link_transforms(q, machine=machine)
    swing = np.asarray(q, dtype=float)[..., 0] + np.pi / 2
    x = T[..., 0, 3] - machine.base.offset
    reach = x * np.cos(swing)[..., None] + T[..., 1, 3] * np.sin(swing)[..., None]
    return np.stack((reach, T[..., 2, 3]), axis=-1)


def draw_arm(ax: Axes, q: ArrayLike, machine: Machine = BACKHOE, alpha: float = 1.0) -> NDArray:
    """Draw boom, stick and bucket at q into `ax`; returns `plane_points(q)`."""
    points = plane_points(q, machine)
    for name, start, end in zip(LINK_COLOURS, points[:-1], points[1:], strict=True):
        outline = _bucket(start, end, machine) if name == "bucket" else _bar(start, end, name)
        look = {"facecolor": LINK_COLOURS[name], "edgecolor": DARK, "alpha": alpha}
        ax.add_patch(Polygon(outline, lw=1, zorder=4, **look))
    ax.plot(*points[:3].T, "o", color="white", mec=DARK, ms=5.5, alpha=alpha, zorder=5)
    return points


def side_axes(
    ax: Axes,
    limits: tuple[float, float, float, float],
    machine: Machine | None = BACKHOE,
    over: str = "front",
) -> None:
    """Equal axes with the ground and, unless `machine` is None, the body of the machine.

    The tracks are seen from their side, or from their ends with the arm `over` the "side".
    """
    ax.axhline(0.0, color=GROUND, lw=1.2, zorder=1)
    ax.axhspan(limits[2], 0.0, color=GROUND, alpha=0.16, lw=0, zorder=0)
    if machine is not None:
        tracks, ring = machine.tracks, machine.base.height
        if over == "front":
            rear = -machine.base.offset - tracks.length / 2
            shoes = [_rounded(rear, 0.0, tracks.length, tracks.height, 0.3)]
        else:
            inner = np.array([-1, 1]) * tracks.gauge / 2 - tracks.shoe_width / 2
            shoes = [_rounded(x, 0.0, tracks.shoe_width, tracks.height, 0.1) for x in inner]
        for shoe in shoes:
            ax.add_patch(Polygon(shoe, facecolor=STEEL, edgecolor=GREY, lw=1, zorder=2))
        house = np.add(_HOUSE, (0.0, ring))
        ax.add_patch(Polygon(house, facecolor="#f3dfae", edgecolor=GREY, lw=1, zorder=2))
    ax.set(xlim=limits[:2], ylim=limits[2:], aspect="equal", xlabel=REACH_LABEL)
    metre_ticks(ax)


def metre_ticks(ax: Axes, step: float = 2.0) -> None:
    """Ticks every `step` metres on both axes."""
    ax.xaxis.set_major_locator(MultipleLocator(step))
    ax.yaxis.set_major_locator(MultipleLocator(step))


@styled
def posture(q: ArrayLike, machine: Machine = BACKHOE) -> Figure:
    """One posture from its side and from above; what the sliders of lesson 01 move.

    Raises:
        ValueError: q has a wrong shape or value.
    """
    fig, (side, top) = figure(6.8, 3.5, 1, 2, width_ratios=(1.0, 1.0))
    draw_arm(side, q, machine)
    side_axes(side, (-3.0, 9.6, -5.4, 9.4), machine)
    side.set(ylabel=HEIGHT_LABEL, title="from the side")
    draw_from_above(top, q, machine)
    top.set(xlim=(-9.5, 9.5), ylim=(-9.5, 9.5), aspect="equal", title="from above")
    metre_ticks(side, 4.0)
    metre_ticks(top, 4.0)
    return fig


def draw_from_above(ax: Axes, q: ArrayLike, machine: Machine = BACKHOE) -> None:
    """Tracks, forward arrow and the arm at q in the base frame, seen from above."""
    tracks = machine.tracks
    for side in (-1, 1):
        corner = (-tracks.length / 2, side * tracks.gauge / 2 - tracks.shoe_width / 2)
        shoe = Rectangle(corner, tracks.length, tracks.shoe_width, facecolor=STEEL, edgecolor=GREY)
        ax.add_patch(shoe)
    nose = tracks.length / 2
    arrow = [(nose, 0.35), (nose, -0.35), (nose + 0.6, 0.0)]
    ax.add_patch(Polygon(arrow, color=GREY))
    points = kinematics.link_transforms(q, machine=machine)[:, :2, 3]
    for name, start, end in zip(LINK_COLOURS, points[:-1], points[1:], strict=True):
        ax.plot(*np.array([start, end]).T, color=LINK_COLOURS[name], lw=5, alpha=0.9)
    ax.plot(machine.base.offset, 0.0, "o", color="white", mec=DARK, ms=6, zorder=5)
    ax.set(xlabel="forward $x$ [m]", ylabel="left $y$ [m]")


def _bar(start: NDArray, end: NDArray, name: str) -> NDArray:
    along = (end - start) / np.hypot(*(end - start))
    across = np.array([-along[1], along[0]])
    wide, narrow = _THICKNESS[name]
    middle = start + 0.4 * (end - start)
    upper = [start + 0.14 * across, middle + wide / 2 * across, end + narrow / 2 * across]
    lower = [end - narrow / 2 * across, middle - wide / 2 * across, start - 0.14 * across]
    return np.array([*upper, end + 0.14 * along, *lower])


def _bucket(pin: NDArray, teeth: NDArray, machine: Machine) -> NDArray:
    along = (teeth - pin) / np.hypot(*(teeth - pin))
    profile = np.asarray(machine.shell.profile)
    return teeth + profile[:, :1] * along + profile[:, 1:] * np.array([-along[1], along[0]])


def _rounded(x: float, y: float, width: float, height: float, radius: float) -> NDArray:
    quarter = np.linspace(0.0, np.pi / 2, 7)
    pieces = []
    for right, top, turn in ((1, 1, 0), (0, 1, 1), (0, 0, 2), (1, 0, 3)):
        angle = quarter + turn * np.pi / 2
        across = x + radius + right * (width - 2 * radius) + radius * np.cos(angle)
        up = y + radius + top * (height - 2 * radius) + radius * np.sin(angle)
        pieces.append(np.column_stack((across, up)))
    return np.concatenate(pieces)
