"""Where the arm can get to, how well it moves there, and where it cannot move at all."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Ellipse, Polygon, Rectangle
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.basics.inputs import numbers
from backhoe.machine import BACKHOE, Machine
from backhoe.view.plots.drawing import (
    HEIGHT_LABEL,
    draw_arm,
    draw_from_above,
    metre_ticks,
    plane_points,
    side_axes,
)
from backhoe.view.plots.style import BLUE, DARK, GREEN, GREY, ORANGE, RED, STEEL, figure, styled

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
    _fill(side, teeth, BLUE, "teeth")
    _fill(side, pin, ORANGE, "bucket pin")
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
    top.fill(*np.vstack((outer, inner[::-1])).T, color=BLUE, alpha=0.25, lw=0)
    top.plot(*outer.T, color=BLUE)
    top.plot(*inner.T, color=BLUE)
    for q1 in (-90.0, 0.0):
        draw_from_above(top, np.radians([q1, 20.0, 0.0, 60.0]), machine)
    top.text(ground.max() - 0.6, 0.4, "$q_1=-90°$", ha="right")
    top.text(0.8, ground.max() - 1.2, "$q_1=0$")
    top.set(title="top: where the teeth reach level ground", aspect="equal")
    metre_ticks(top)
    return fig


@styled
def velocity_ellipses(postures: ArrayLike, machine: Machine = BACKHOE) -> Figure:
    """How the bucket's pin moves when boom and stick turn at a joint speed of norm 1 rad/s.

    Each ellipse is the set of velocities in the arm's plane, drawn at a quarter of its size (m/s on
    the metre scale); a thin one means a direction that is hard to move in.

    Args:
        postures: joint angles, shape (n, 4) [rad].

    Raises:
        ValueError: postures have a wrong shape or value.
    """
    fig, ax = figure(6.8, 4.8)
    side_axes(ax, (-2.6, 9.0, -3.4, 6.4), machine)
    ax.set_ylabel(HEIGHT_LABEL)
    for q in np.atleast_2d(np.asarray(postures, dtype=float)):
        shoulder, elbow, pin, _ = plane_points(q, machine)
        arms = pin - np.array([shoulder, elbow])
        J = np.stack((-arms[:, 1], arms[:, 0]))
        U, sigma, _ = np.linalg.svd(J)
        ax.plot(*np.array([shoulder, elbow, pin]).T, "-o", color=STEEL, lw=3, ms=4, zorder=3)
        tilt = np.degrees(np.arctan2(U[1, 0], U[0, 0]))
        shape = Ellipse(pin, *(0.5 * sigma), angle=tilt, facecolor=BLUE, alpha=0.3, zorder=4)
        ax.add_patch(shape)
        for axis, length, colour in zip(U.T, sigma, (BLUE, RED), strict=True):
            ends = pin + np.outer((-0.25, 0.25), length * axis)
            ax.plot(*ends.T, color=colour, lw=2, zorder=5)
    ax.plot([], [], color=BLUE, label="fast direction")
    ax.plot([], [], color=RED, label="slow direction")
    ax.legend(loc="upper left")
    return fig


@styled
def singularities(machine: Machine = BACKHOE) -> Figure:
    """|det J| of the pose over the boom's and the stick's whole turn, with the limits as a box."""
    fig, ax = figure(6.8, 4.6)
    boom, stick = np.meshgrid(np.linspace(-180, 180, 181), np.linspace(-180, 180, 181))
    q = np.zeros((*boom.shape, 4))
    q[..., 1], q[..., 2] = np.radians(boom), np.radians(stick)
    pin = plane_points(q, machine)[..., 2, 0]
    bend = np.radians(stick) + machine.stick.angle_offset
    det = np.abs(pin * machine.boom.length * machine.stick.length * np.sin(bend))
    shown = ax.contourf(boom, stick, det, levels=np.arange(0, 85, 10), cmap="viridis", extend="max")
    fig.colorbar(shown, ax=ax, label=r"$|\,\det\, J\,|$ [m$^3$]")
    ax.contour(boom, stick, pin, levels=[0.0], colors="white", linestyles="--", linewidths=2)
    straight = np.degrees(-machine.stick.angle_offset)
    for angle in (straight, straight - 180):
        ax.axhline(angle, color="white", lw=2)
    (_, low2, low3, _), (_, high2, high3, _) = np.degrees(machine.lower), np.degrees(machine.upper)
    ax.add_patch(
        Rectangle((low2, low3), high2 - low2, high3 - low3, fill=False, edgecolor=RED, lw=2.5)
    )
    ax.text(low2 + 4, low3 + 5, "within the limits", color="white", weight="bold")
    ax.text(-172, straight + 5, "arm stretched", color="white")
    ax.text(-172, straight - 175, "arm folded", color="white")
    ax.text(122, -40, "pin over\nthe axis", color="white")
    ax.set(xlabel="boom $q_2$ [deg]", ylabel="stick $q_3$ [deg]")
    ax.set(xticks=range(-180, 181, 60), yticks=range(-180, 181, 60))
    ax.grid(False)
    return fig


def _fill(ax: Axes, cells: NDArray, colour: str, label: str) -> None:
    rows = np.round(cells / CELL).astype(int)
    low = rows.min(axis=0) - 1
    grid = np.zeros(rows.max(axis=0) - low + 2)
    grid[tuple((rows - low).T)] = 1.0
    x, z = ((low[k] + np.arange(grid.shape[k])) * CELL for k in (0, 1))
    ax.contourf(x, z, grid.T, levels=[0.5, 1.5], colors=[colour], alpha=0.28, zorder=1)
    ax.contour(x, z, grid.T, levels=[0.5], colors=[colour], linewidths=1.6, zorder=3)
    ax.fill([], [], color=colour, alpha=0.4, label=label)


_ARROW = {"arrowstyle": "-|>", "lw": 2, "shrinkA": 0, "shrinkB": 0}


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
    for side, colour, text in ((half, BLUE, "left track"), (-half, RED, "right track")):
        ax.plot(*(poses[:, :2] + side * left).T, color=colour, label=text)
    ax.plot(*poses[:, :2].T, color=DARK, label="middle")
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
