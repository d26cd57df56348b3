"""The arm as it looks: side view, frames, the two elbows, a slider's picture."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Polygon, Rectangle
from matplotlib.ticker import MultipleLocator
from numpy.typing import ArrayLike, NDArray

from backhoe import kinematics
from backhoe.machine import BACKHOE, Machine
from backhoe.plots.style import DARK, GREEN, GREY, GROUND, LINK_COLOURS, STEEL, figure, styled

REACH_LABEL = "distance from the swing axis [m]"
HEIGHT_LABEL = "height above the ground [m]"
_HOUSE = np.column_stack(
    (
        (-2.0, 0.95, 0.95, 0.3, 0.3, -0.85, -0.85, -2.0),
        (-0.2, -0.2, 0.1, 0.55, 1.75, 1.75, 0.75, 0.75),
    )
)
_ARROW = {"arrowstyle": "-|>", "lw": 2, "shrinkA": 0, "shrinkB": 0}
_THICKNESS = {"boom": (0.62, 0.38), "stick": (0.46, 0.26)}


@styled
def arm(
    *postures: ArrayLike,
    labels: Sequence[str] = (),
    machine: Machine = BACKHOE,
    title: str = "",
    limits: tuple[float, float, float, float] = (-3.2, 9.0, -4.2, 7.2),
) -> Figure:
    """The machine from its side, in the vertical plane of the arm; more postures side by side.

    Args:
        postures: joint angles, each of shape (4,) [rad].
        labels: a title for each posture.
        title: of the whole figure.
        limits: least and largest distance and height shown [m].

    Raises:
        ValueError: no posture, a wrong shape or value, or not one label a posture.
    """
    if not postures:
        raise ValueError("arm needs at least one posture of 4 joint angles")
    if labels and len(labels) != len(postures):
        raise ValueError(f"{len(labels)} labels for {len(postures)} postures")
    count = len(postures)
    height = 4.4 if count == 1 else 0.8 + 6.8 / count
    fig, axes = figure(6.8, height, 1, count, sharey=True, squeeze=False)
    for ax, q in zip(axes[0], postures, strict=True):
        draw_arm(ax, q, machine)
        side_axes(ax, limits)
    axes[0, 0].set_ylabel(HEIGHT_LABEL)
    for ax, label in zip(axes[0], labels, strict=False):
        ax.set_title(label)
    if title:
        fig.suptitle(title)
    return fig


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
    ax: Axes, limits: tuple[float, float, float, float], machine: Machine | None = BACKHOE
) -> None:
    """Equal axes with the ground and, unless `machine` is None, the body of the machine."""
    ax.axhline(0.0, color=GROUND, lw=1.2, zorder=1)
    ax.axhspan(limits[2], 0.0, color=GROUND, alpha=0.16, lw=0, zorder=0)
    if machine is not None:
        tracks, ring = machine.tracks, machine.base.height
        middle = -machine.base.offset
        half = tracks.length / 2
        shoe = _rounded(middle - half, 0.0, 2 * half, tracks.height, 0.3)
        house = np.add(_HOUSE, (0.0, ring))
        for outline, colour in ((shoe, STEEL), (house, "#f3dfae")):
            ax.add_patch(Polygon(outline, facecolor=colour, edgecolor=GREY, lw=1, zorder=2))
    ax.set(xlim=limits[:2], ylim=limits[2:], aspect="equal", xlabel=REACH_LABEL)
    metre_ticks(ax)


def metre_ticks(ax: Axes, step: float = 2.0) -> None:
    """Ticks every `step` metres on both axes."""
    ax.xaxis.set_major_locator(MultipleLocator(step))
    ax.yaxis.set_major_locator(MultipleLocator(step))


@styled
def frames(q: ArrayLike, machine: Machine = BACKHOE) -> Figure:
    """Side view with the frames of Table A.1: x along each link, y square to it, z out of the page.

    Raises:
        ValueError: q has a wrong shape or value.
    """
    fig, ax = figure(6.8, 4.6)
    points = draw_arm(ax, q, machine, alpha=0.35)
    side_axes(ax, (-2.6, 8.2, -1.6, 5.6), machine)
    ax.set_ylabel(HEIGHT_LABEL)
    T = kinematics.link_transforms(q, machine=machine)
    pitch = np.append(0.0, np.arctan2(T[:, 2, 0], T[:, 2, 1]))
    places = np.vstack(((-machine.base.offset, 0.0), points))
    names = ("base 0", "swing 1", "boom 2", "stick 3", "tip 4")
    for number, ((x, z), name) in enumerate(zip(places, names, strict=True)):
        angle = pitch[number]
        for turn, colour, letter in ((0.0, "#c0392b", "x"), (np.pi / 2, GREEN, "y")):
            letter = "z" if number == 0 and letter == "y" else letter
            ex, ez = 0.95 * np.cos(angle + turn), 0.95 * np.sin(angle + turn)
            ax.annotate("", (x + ex, z + ez), (x, z), arrowprops=_ARROW | {"color": colour})
            text = ax.text(x + 1.2 * ex, z + 1.2 * ez, letter, color=colour, weight="bold")
            text.set(ha="center", va="center")
        away = angle + (0.75 if number == 1 else 1.25) * np.pi
        beside = {"ha": "right" if np.cos(away) < 0 else "left", "va": "center", "zorder": 8}
        place = x + 0.28 * np.cos(away), z + 0.28 * np.sin(away)
        ax.text(*place, name, weight="bold", color=DARK, **beside)
    return fig


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
    ax.add_patch(Polygon(arrow, color=DARK))
    points = kinematics.link_transforms(q, machine=machine)[:, :2, 3]
    for name, start, end in zip(LINK_COLOURS, points[:-1], points[1:], strict=True):
        ax.plot(*np.array([start, end]).T, color=LINK_COLOURS[name], lw=5, alpha=0.9)
    ax.plot(machine.base.offset, 0.0, "o", color="white", mec=DARK, ms=6, zorder=5)
    ax.set(xlabel="forward $x$ [m]", ylabel="left $y$ [m]")


@styled
def elbows(target: ArrayLike, machine: Machine = BACKHOE) -> Figure:
    """Both solutions of the inverse kinematics of one target, with the triangle they come from.

    Args:
        target: x, y, z of the stick's tip [m] and the bucket joint's angle [rad], shape (4,).

    Raises:
        ValueError: the target is out of reach.
    """
    fig, ax = figure(6.8, 4.8)
    side_axes(ax, (-2.4, 8.4, -2.0, 6.2), machine)
    ax.set_ylabel(HEIGHT_LABEL)
    up, down = (
        kinematics.inverse_kinematics(target, elbow=side, machine=machine, limits=False)
        for side in ("up", "down")
    )
    low = plane_points(down, machine)
    ax.plot(*low[:3].T, "--", color=GREY, lw=2, zorder=3)
    place = {"ha": "center", "color": GREY}
    ax.text(low[1, 0], low[1, 1] - 0.5, "elbow down: outside the limits", **place)
    points = draw_arm(ax, up, machine, alpha=0.75)
    shoulder, elbow, pin = points[:3]
    ax.plot(*np.array([shoulder, pin]).T, color=DARK, lw=1.6, zorder=6)
    ax.text(elbow[0] - 0.5, elbow[1] + 0.45, "elbow up", weight="bold")
    for (x, z), dx, dz, text in (
        ((shoulder + pin) / 2, 0.1, 0.2, "$d$"),
        ((shoulder + elbow) / 2, -0.55, 0.45, "$L_2$"),
        ((elbow + pin) / 2, 0.4, 0.1, "$L_3$"),
    ):
        ax.text(x + dx, z + dz, text, size=13, zorder=9)
    rise = np.degrees(np.arctan2(*(pin - shoulder)[::-1]))
    boom = np.degrees(np.arctan2(*(elbow - shoulder)[::-1]))
    for start, end, radius, text in ((0.0, rise, 2.6, r"$\beta$"), (rise, boom, 1.7, r"$\gamma$")):
        turn = dict(zip(("theta1", "theta2"), sorted((start, end)), strict=True))
        ax.add_patch(Arc(shoulder, 2 * radius, 2 * radius, color=DARK, zorder=8, **turn))
        half = np.radians((start + end) / 2)
        at = shoulder + (radius + 0.22) * np.array([np.cos(half), np.sin(half)])
        ax.text(*at, text, size=13, ha="center", va="center", zorder=9)
    ax.plot([shoulder[0], shoulder[0] + 3.2], [shoulder[1]] * 2, ":", color=GREY, zorder=3)
    return fig


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
