"""Figures of forces and motion: weights on the arm, fields over it, falls in sequence."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics, kinematics
from backhoe.machine import BACKHOE, Machine
from backhoe.machine.variants import loaded
from backhoe.view.plots.drawing import HEIGHT_LABEL, draw_arm, metre_ticks, plane_points, side_axes
from backhoe.view.plots.style import DARK, GREEN, GREY, LINK_COLOURS, RED, figure, styled

SIDE = (-2.6, 8.8, -2.6, 6.0)


@styled
def weights(q: ArrayLike, machine: Machine = BACKHOE) -> Figure:
    """Side view with centres of mass, weights, and their lever arms to the boom's joint.

    Args:
        q: joint angles, shape (4,) [rad].

    Raises:
        ValueError: q has a wrong shape or value.
    """
    fig, ax = figure(6.8, 4.4)
    shoulder = draw_arm(ax, q, machine, alpha=0.45)[0]
    side_axes(ax, (-2.6, 8.2, -1.4, 5.4), machine)
    ax.set_ylabel(HEIGHT_LABEL)
    ax.plot([shoulder[0]] * 2, [-1.4, shoulder[1]], ":", color=GREY, lw=1.2, zorder=5)
    label = np.array([0.15, 0.22])
    for level, (name, link) in enumerate(zip(LINK_COLOURS, machine.links, strict=True)):
        point = _centre_of_mass(q, name, machine)
        weight = link.mass * machine.gravity
        arrow = {"arrowstyle": "-|>", "color": DARK, "lw": 2.2, "shrinkA": 0, "shrinkB": 0}
        ax.annotate("", point - (0, 0.35 + weight / 3e4), point, arrowprops=arrow, zorder=7)
        ax.plot(*point, "o", ms=8, color=LINK_COLOURS[name], mec=DARK, zorder=8)
        ax.annotate(f"{name} {weight / 1e3:.1f} kN", point + label, weight="bold", zorder=9)
        height = -0.35 - 0.36 * level
        ax.plot([point[0]] * 2, [point[1], height], ":", color=LINK_COLOURS[name], zorder=3)
        span = {
            "arrowstyle": "<->",
            "color": LINK_COLOURS[name],
            "lw": 1.5,
            "shrinkA": 0,
            "shrinkB": 0,
        }
        ax.annotate("", (point[0], height), (shoulder[0], height), arrowprops=span, zorder=6)
        middle = (point[0] + shoulder[0]) / 2
        lever = ax.text(middle, height, f"{point[0] - shoulder[0]:.2f} m", size=10, zorder=7)
        lever.set(ha="center", va="center", bbox={"facecolor": "#f6f1ec", "lw": 0, "pad": 1.0})
    return fig


@styled
def gravity_map(joint: int = 1, machine: Machine = BACKHOE) -> Figure:
    """Gravity torque of one joint over the places that the bucket's pin can reach, bucket at zero.

    Args:
        joint: 1 boom, 2 stick, 3 bucket.

    Raises:
        ValueError: joint is not 1, 2 or 3.
    """
    if joint not in (1, 2, 3):
        raise ValueError(f"joint must be 1 (boom), 2 (stick) or 3 (bucket), got {joint!r}")
    boom, stick = np.meshgrid(
        np.linspace(machine.lower[1], machine.upper[1], 120),
        np.linspace(machine.lower[2], machine.upper[2], 90),
        indexing="ij",
    )
    q = np.stack((0 * boom, boom, stick, 0 * boom), axis=-1)
    pin = plane_points(q, machine)[..., 2, :]
    torque = dynamics.gravity_torque(q, machine=machine)[..., joint] / 1e3
    fig, ax = figure(6.8, 5.0)
    draw_arm(ax, np.radians([0.0, 20.0, 0.0, 0.0]), machine, alpha=0.55)
    side_axes(ax, (-2.6, 8.2, -4.4, 8.0), machine)
    _coloured(fig, ax, pin[..., 0], pin[..., 1], torque, "gravity torque [kN m]")
    ax.set(ylabel=HEIGHT_LABEL, title=f"torque that holds the {_joint(joint)}, pin at this place")
    return fig


@styled
def least_eigenvalue(
    mass_matrix: Callable[[NDArray], NDArray], bucket: float = 90.0, machine: Machine = BACKHOE
) -> Figure:
    """Least eigenvalue of an inertia matrix over boom and stick, with the line where it is zero.

    Args:
        mass_matrix: function of q, shape (..., 4) [rad], that gives M, shape (..., 4, 4).
        bucket: angle of the bucket's joint [deg].
        machine: whose joint limits the axes span.
    """
    boom, stick = (np.linspace(machine.lower[joint], machine.upper[joint], 121) for joint in (1, 2))
    q = np.zeros((121, 121, 4))
    q[..., 1], q[..., 2], q[..., 3] = boom, stick[:, None], np.radians(bucket)
    values = np.linalg.eigvalsh(mass_matrix(q))[..., 0]
    limit = np.abs(values).max()
    x, y = np.degrees(boom), np.degrees(stick)
    fig, ax = figure(6.8, 4.2)
    bands = ax.contourf(x, y, values, levels=np.linspace(-limit, limit, 21), cmap="RdBu_r")
    fig.colorbar(bands, ax=ax, label="least eigenvalue of M [kg m²]", format="%.0f")
    if values.min() < 0 < values.max():
        ax.contour(x, y, values, levels=[0.0], colors=DARK, linewidths=1.4)
    ax.set(xlabel="boom [deg]", ylabel="stick [deg]", title=f"bucket at {bucket:g} deg")
    ax.grid(False)
    return fig


@styled
def falls(
    motions: Mapping[str, ArrayLike],
    views: Sequence[str] = (),
    machine: Machine = BACKHOE,
) -> Figure:
    """Arm sequences side by side as in the thesis's figures: green the start, red what follows.

    Args:
        motions: title -> joint angles at equal time steps, shape (n, 4) [rad].
        views: "side" or "top" for each motion; the side unless told.

    Raises:
        ValueError: no motion, a wrong shape, or a view that is neither "side" nor "top".
    """
    views = tuple(views) or ("side",) * len(motions)
    if not motions or len(views) != len(motions):
        raise ValueError(f"{len(views)} views for {len(motions)} motions")
    if unknown := set(views) - {"side", "top"}:
        raise ValueError(f"unknown view {sorted(unknown)}: the views are side and top")
    count = len(motions)
    fig, axes = figure(6.8, 4.6 if count == 1 else 1.1 + 4.4 / count, 1, count, squeeze=False)
    for ax, view, (title, q) in zip(axes[0], views, motions.items(), strict=True):
        points = _chain(q, view, machine)
        if view == "side":
            side_axes(ax, SIDE, machine)
            ax.set_ylabel(HEIGHT_LABEL if ax is axes[0, 0] else "")
        else:
            ax.set(aspect="equal", xlabel="x, forward [m]", ylabel="y, left [m]")
            ax.set(xlim=(-9, 9), ylim=(-7.5, 7.5))
            metre_ticks(ax, 4.0)
            ax.plot(machine.base.offset, 0, "+", color=GREY, ms=12)
        shades = np.linspace(0.25, 1.0, len(points) - 1)
        for chain, shade in zip(points[1:], shades, strict=True):
            ax.plot(*chain.T, "-o", color=RED, alpha=shade, lw=1.6, ms=3.5, zorder=5)
        ax.plot(*points[0].T, "-o", color=GREEN, lw=2.6, ms=4.5, zorder=6)
        ax.set_title(title)
    return fig


@styled
def candidates(readings: Mapping[str, Machine], q: ArrayLike, torque: ArrayLike) -> Figure:
    """Readings of a table side by side: the arm that each means, and how far its gravity misses.

    Args:
        readings: title -> machine in that reading.
        q: joint angles of every arm, shape (4,) [rad].
        torque: gravity torque that the arm should have at q, shape (4,) [N m].
    """
    count = len(readings)
    fig, axes = figure(6.8, 1.3 + 3.6 / count, 1, count, sharey=True, squeeze=False)
    for ax, (title, machine) in zip(axes[0], readings.items(), strict=True):
        draw_arm(ax, q, machine, alpha=0.6)
        side_axes(ax, (0.0, 9.4, -0.8, 4.2), None)
        for name in LINK_COLOURS:
            point = _centre_of_mass(q, name, machine)
            ax.plot(*point, "o", ms=7, color=LINK_COLOURS[name], mec=DARK, zorder=8)
        miss = np.abs(dynamics.gravity_torque(q, machine=machine) - torque).max() / 1e3
        ax.set_title(f"{title}\nmisses by {miss:.2f} kN m")
        ax.set_xlabel("reach [m]")
    axes[0, 0].set_ylabel("height [m]")
    return fig


@styled
def holding(
    boom: float, stick: float, bucket: float, load: float = 1.0, machine: Machine = BACKHOE
) -> Figure:
    """The arm in a posture beside the torques that hold it there, empty and with a load.

    Args:
        boom, stick, bucket: joint angles [deg].
        load: extra mass at the bucket's centre of mass [t], for the striped bars.
    """
    full = loaded(1e3 * load, machine)
    q = np.radians([0.0, boom, stick, bucket])
    fig, (ax, bars) = figure(6.8, 3.9, 1, 2, width_ratios=(1.4, 1.0))
    draw_arm(ax, q, machine)
    side_axes(ax, (-2.6, 9.2, -4.4, 8.0), machine)
    ax.set_ylabel(HEIGHT_LABEL)
    for shift, hatch, variant in ((-0.2, "", machine), (0.2, "///", full)):
        torque = dynamics.gravity_torque(q, machine=variant)[1:] / 1e3
        look = {"color": list(LINK_COLOURS.values()), "edgecolor": DARK, "hatch": hatch}
        rows = np.arange(3) + shift
        bars.barh(rows, torque, height=0.36, alpha=0.9 if hatch == "" else 0.55, **look)
        for row, value in zip(rows, torque, strict=True):
            away = {"xytext": (4 if value >= 0 else -4, 0), "textcoords": "offset points"}
            side = "left" if value >= 0 else "right"
            bars.annotate(f"{value:.1f}", (value, row), **away, va="center", ha=side, size=9)
    bars.axvline(0.0, color=DARK, lw=1)
    bars.set(xlim=(-150, 330), xlabel="holding torque [kN m]", title=f"striped: with {load:g} t")
    bars.set_yticks(range(3), list(LINK_COLOURS))
    bars.invert_yaxis()
    return fig


def _joint(joint: int) -> str:
    return ("swing", "boom", "stick", "bucket")[joint]


def _centre_of_mass(q: ArrayLike, name: str, machine: Machine) -> NDArray:
    """Reach and height [m] of the centre of mass of a link."""
    x, y, z = kinematics.forward_kinematics(q, f"{name}_com", machine=machine)[:3, 3]
    swing = np.asarray(q, dtype=float)[0] + np.pi / 2
    return np.array([(x - machine.base.offset) * np.cos(swing) + y * np.sin(swing), z])


def _chain(q: ArrayLike, view: str, machine: Machine) -> NDArray:
    """Joints and teeth of each posture, (n, 4, 2): reach and height, or x and y from above."""
    if view == "side":
        return plane_points(q, machine)
    return kinematics.link_transforms(q, machine=machine)[..., :2, 3]


def _coloured(fig: Figure, ax: Axes, x: NDArray, y: NDArray, values: NDArray, label: str) -> None:
    bands = ax.contourf(x, y, values, levels=12, cmap="viridis", zorder=1.5)
    lines = ax.contour(x, y, values, levels=bands.levels[::2], colors="white", linewidths=0.8)
    lines.set_zorder(1.6)
    ax.clabel(lines, fmt="%.0f", fontsize=9)
    fig.colorbar(bands, ax=ax, label=label)


__all__ = ["candidates", "falls", "gravity_map", "holding", "least_eigenvalue", "weights"]
