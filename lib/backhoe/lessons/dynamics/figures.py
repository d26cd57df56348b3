"""Figures of forces and motion: weights on the arm, fields over it, falls in sequence."""

from collections.abc import Callable, Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics, kinematics
from backhoe.lessons.dynamics.bench import STAND, on_a_stand
from backhoe.machine import BACKHOE, Machine
from backhoe.machine.variants import loaded
from backhoe.view.plots.drawing import (
    HEIGHT_LABEL,
    draw_arm,
    plane_points,
    side_axes,
)
from backhoe.view.plots.style import DARK, GREY, LINK_COLOURS, LOOKS, STEEL, figure, styled

SIDE = (-2.6, 8.8, 0.0, 6.0)


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
def falls(motions: Mapping[str, ArrayLike], machine: Machine = BACKHOE) -> Figure:
    """Falls from a stand side by side, in the arm's plane: a dashed start, and what follows.

    Args:
        motions: title -> joint angles at equal time steps, shape (n, 4) [rad].

    Raises:
        ValueError: no motion, or a wrong shape.
    """
    if not motions:
        raise ValueError("no motion to draw")
    machine, rows = on_a_stand(machine), -(-len(motions) // 2)
    fig, axes = figure(6.8, 0.4 + 2.1 * rows, rows, 2, squeeze=False)
    for ax, (title, q) in zip(axes.flat, motions.items(), strict=False):
        points = plane_points(q, machine)
        side_axes(ax, SIDE, machine)
        foot = (-0.5, machine.base.height - 0.2 - STAND)
        ax.add_patch(Rectangle(foot, 1.0, STAND, facecolor=STEEL, edgecolor=GREY, zorder=1))
        shades = np.linspace(0.2, 1.0, len(points) - 1)
        for chain, shade in zip(points[1:], shades, strict=True):
            for name, ends in zip(LINK_COLOURS, _pairs(chain), strict=True):
                colour, marker = LOOKS[name]
                look = {"color": colour, "alpha": shade, "marker": marker}
                look["label"] = name if shade == 1.0 else f"_{name}"
                ax.plot(*ends.T, lw=2.2, zorder=5, markevery=[1], ms=4.5, **look)
        ax.plot(*points[0].T, "--", color=GREY, lw=1.8, zorder=6, label="start")
        ax.set(title=title, xlabel="reach [m]", ylabel="height [m]")
    for ax in axes.flat[len(motions) :]:
        ax.axis("off")
        ax.legend(*[some[-4:] for some in axes[0, 0].get_legend_handles_labels()], loc="center")
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
        ax.set(xlabel="reach [m]", ylabel="height [m]")
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
    fig, blank = figure(6.8, 3.9)
    blank.remove()
    grid = fig.add_gridspec(2, 2, width_ratios=(1.4, 1.0), height_ratios=(1.0, 2.0))
    ax = fig.add_subplot(grid[:, 0])
    draw_arm(ax, q, machine)
    side_axes(ax, (-2.6, 9.2, -4.4, 8.0), machine)
    ax.set_ylabel(HEIGHT_LABEL)
    large, small = fig.add_subplot(grid[0, 1]), fig.add_subplot(grid[1, 1])
    for bars, names, limit in ((large, ["boom"], 330), (small, ["stick", "bucket"], 66)):
        for shift, hatch, variant in ((-0.2, "", machine), (0.2, "///", full)):
            torque = dict(zip(LINK_COLOURS, dynamics.gravity_torque(q, variant)[1:], strict=True))
            for row, name in enumerate(names):
                _bar(bars, torque[name] / 1e3, row + shift, LINK_COLOURS[name], hatch)
        bars.axvline(0.0, color=GREY, lw=1)
        bars.set(xlim=(-limit / 2, limit), ylim=(len(names) - 0.5, -0.5))
        bars.set_yticks(range(len(names)), names)
        bars.set(xlabel="holding torque [kN m]", ylabel="joint")
    large.set_title(f"striped: with {load:g} t")
    return fig


def _bar(ax: Axes, value: float, row: float, colour: str, hatch: str) -> None:
    alpha = 0.55 if hatch else 0.9
    ax.barh(row, value, 0.36, color=colour, edgecolor=GREY, hatch=hatch, alpha=alpha)
    away = {"xytext": (4 if value >= 0 else -4, 0), "textcoords": "offset points"}
    side = "left" if value >= 0 else "right"
    ax.annotate(f"{value:.1f}", (value, row), **away, va="center", ha=side, size=9)


def _joint(joint: int) -> str:
    return ("swing", "boom", "stick", "bucket")[joint]


def _centre_of_mass(q: ArrayLike, name: str, machine: Machine) -> NDArray:
    """Reach and height [m] of the centre of mass of a link."""
    x, y, z = kinematics.forward_kinematics(q, f"{name}_com", machine=machine)[:3, 3]
    swing = np.asarray(q, dtype=float)[0] + np.pi / 2
    return np.array([(x - machine.base.offset) * np.cos(swing) + y * np.sin(swing), z])


def _pairs(chain: NDArray) -> NDArray:
    """Both ends of each link, shape (3, 2, 2), of its joints and teeth, shape (4, 2)."""
    return np.stack((chain[:-1], chain[1:]), axis=1)


def _coloured(fig: Figure, ax: Axes, x: NDArray, y: NDArray, values: NDArray, label: str) -> None:
    bands = ax.contourf(x, y, values, levels=12, cmap="viridis", zorder=1.5)
    lines = ax.contour(x, y, values, levels=bands.levels[::2], colors="white", linewidths=0.8)
    lines.set_zorder(1.6)
    ax.clabel(lines, fmt="%.0f", fontsize=9)
    fig.colorbar(bands, ax=ax, label=label)


__all__ = ["candidates", "falls", "gravity_map", "holding", "least_eigenvalue", "weights"]
