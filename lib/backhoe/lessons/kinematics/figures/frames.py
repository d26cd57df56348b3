"""The machine from its side, its frames, and where it can get to."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.machine import BACKHOE, Machine
from backhoe.view.plots.drawing import (
    HEIGHT_LABEL,
    draw_arm,
    draw_from_above,
    metre_ticks,
    side_axes,
)
from backhoe.view.plots.style import DARK, GREEN, LINK_COLOURS, figure, styled

CELL = 0.05


@lru_cache(maxsize=8)
def reachable(machine: Machine = BACKHOE, point: int = 3) -> NDArray:
    """Cells of the arm's plane that a point of the arm can enter within the joint limits.

    Args:
        machine: numbers and limits.
        point: 2 for the bucket's pin, 3 for its teeth.

    Returns:
        Cell centres, shape (n, 2): distance from the swing axis and height [m].
    """
    samples = 101 if point == 3 else 601
    boom, stick, bucket = (
        np.linspace(low, high, samples)
        for low, high in zip(machine.lower[1:], machine.upper[1:], strict=True)
    )
    boom, stick, bucket = np.meshgrid(
        boom, stick, bucket if point == 3 else bucket[:1], indexing="ij"
    )
    reach, height, pitch = machine.swing.offset, machine.base.height + machine.swing.height, 0.0
    for q, link in zip((boom, stick, bucket)[:point], machine.links, strict=False):
        pitch = pitch + q + link.angle_offset
        reach = reach + link.length * np.cos(pitch)
        height = height + link.length * np.sin(pitch)
    columns, rows = np.round(reach / CELL).astype(int), np.round(height / CELL).astype(int)
    low, span = rows.min(), np.ptp(rows) + 1
    columns, rows = np.divmod(np.unique(columns * span + rows - low), span)
    return CELL * np.column_stack((columns, rows + low))


@styled
def workspace(q: ArrayLike | None = None, machine: Machine = BACKHOE) -> Figure:
    """Reach within the joint limits: a section through the arm's plane, and the ground from above.

    Args:
        q: posture drawn in the section, shape (4,) [rad]; None draws no arm.
        machine: numbers and limits.

    Raises:
        ValueError: q has a wrong shape or value.
    """
    fig, (side, top) = figure(6.8, 10.4, 2, 1, height_ratios=(1.0, 1.2))
    teeth, pin = reachable(machine, 3), reachable(machine, 2)
    _fill(side, teeth, LINK_COLOURS["bucket"], "-", "teeth")
    _fill(side, pin, LINK_COLOURS["stick"], "--", "bucket pin")
    (low, bottom), (high, top_edge) = teeth.min(axis=0) - 0.6, teeth.max(axis=0) + 0.6
    side_axes(side, (min(low, -high), high, bottom, top_edge), machine)
    side.set(ylabel=HEIGHT_LABEL, title="side: section through the arm")
    if q is not None:
        draw_arm(side, q, machine)
    side.legend(loc="upper left")

    ground = teeth[np.abs(teeth[:, 1]) < CELL / 2][:, 0]
    angle = np.linspace(0, 2 * np.pi, 200)
    around = np.column_stack((np.cos(angle), np.sin(angle)))
    centre = np.array([machine.base.offset, 0.0])
    outer, inner = (centre + radius * around for radius in (ground.max(), ground.min()))
    colour = LINK_COLOURS["bucket"]
    top.fill(*np.vstack((outer, inner[::-1])).T, color=colour, alpha=0.25, lw=0)
    top.plot(*outer.T, color=colour)
    top.plot(*inner.T, color=colour)
    for q1 in (-90.0, 0.0):
        draw_from_above(top, np.radians([q1, 20.0, 0.0, 60.0]), machine)
    top.text(ground.max() - 0.6, 0.4, "$q_1=-90°$", ha="right")
    top.text(0.8, ground.max() - 1.2, "$q_1=0$")
    top.set(title="top: where the teeth reach level ground", aspect="equal")
    metre_ticks(top)
    return fig


def _fill(ax: Axes, cells: NDArray, colour: str, style: str, label: str) -> None:
    rows = np.round(cells / CELL).astype(int)
    low = rows.min(axis=0) - 1
    grid = np.zeros(rows.max(axis=0) - low + 2)
    grid[tuple((rows - low).T)] = 1.0
    x, z = ((low[k] + np.arange(grid.shape[k])) * CELL for k in (0, 1))
    ax.contourf(x, z, grid.T, levels=[0.5, 1.5], colors=[colour], alpha=0.28, zorder=1)
    ax.contour(x, z, grid.T, levels=[0.5], colors=[colour], linestyles=style, zorder=3)
    ax.fill([], [], color=colour, alpha=0.4, label=label)


_ARROW = {"arrowstyle": "-|>", "lw": 2, "shrinkA": 0, "shrinkB": 0}


@styled
def arm(
    *postures: ArrayLike,
    labels: Sequence[str] = (),
    machine: Machine = BACKHOE,
) -> Figure:
    """The machine from its side, in the vertical plane of the arm; more postures side by side.

    Args:
        postures: joint angles, each of shape (4,) [rad].
        labels: a title for each posture.

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
        side_axes(ax, (-3.2, 9.0, -4.2, 7.2))
    axes[0, 0].set_ylabel(HEIGHT_LABEL)
    for ax, label in zip(axes[0], labels, strict=False):
        ax.set_title(label)
    return fig


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
