"""How well the arm moves, where it cannot, and the triangle that leads back to its angles."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Ellipse, Rectangle
from numpy.typing import ArrayLike

from backhoe.arm import kinematics
from backhoe.machine import BACKHOE, Machine
from backhoe.view.plots.drawing import HEIGHT_LABEL, draw_arm, plane_points, side_axes
from backhoe.view.plots.style import GREEN, GREY, PURPLE, RED, STEEL, figure, styled

DIRECTIONS = ((GREEN, "-", "fast direction"), (PURPLE, ":", "slow direction"))
"""Colour, line style and name of an ellipse's axes."""


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
        shape = Ellipse(pin, *(0.5 * sigma), angle=tilt, facecolor=GREEN, alpha=0.2, zorder=4)
        ax.add_patch(shape)
        for axis, length, (colour, style, _) in zip(U.T, sigma, DIRECTIONS, strict=True):
            ends = pin + np.outer((-0.25, 0.25), length * axis)
            ax.plot(*ends.T, color=colour, ls=style, lw=2, zorder=5)
    for colour, style, label in DIRECTIONS:
        ax.plot([], [], color=colour, ls=style, label=label)
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
    ax.plot(*np.array([shoulder, pin]).T, "-.", color=PURPLE, zorder=6)
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
        ax.add_patch(Arc(shoulder, 2 * radius, 2 * radius, color=PURPLE, zorder=8, **turn))
        half = np.radians((start + end) / 2)
        at = shoulder + (radius + 0.22) * np.array([np.cos(half), np.sin(half)])
        ax.text(*at, text, size=13, ha="center", va="center", zorder=9)
    ax.plot([shoulder[0], shoulder[0] + 3.2], [shoulder[1]] * 2, ":", color=GREY, zorder=3)
    return fig
