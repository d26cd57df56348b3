"""Vehicles from above: what their wheels do on the ground, where they drive; friction laws."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers
from backhoe.view.plots.style import (
    BLUE,
    DARK,
    GREEN,
    GREY,
    ORANGE,
    PALE,
    RED,
    draw_lines,
    figure,
    styled,
)

if TYPE_CHECKING:
    from backhoe.vehicle.skid_steer import Vehicle

__all__ = ["contacts", "friction_laws"]


@styled
def contacts(
    cases: Mapping[str, ArrayLike],
    vehicle: Vehicle,
    wheels: Mapping[str, ArrayLike] | None = None,
    slip_only: bool = False,
    metres_per_speed: float = 0.5,
) -> Figure:
    """Vehicles side by side from above, with the velocities of their contact points on the ground.

    Blue is what a wheel can roll, red and dashed what it must slip: all that passes across it, and
    along it as much as its own speed differs from that of the ground under it.

    Args:
        cases: title -> twist of the centre of mass, v_x, v_y [m/s] and omega [rad/s], shape (3,).
        vehicle: whose wheels are drawn; front, rear, half track and wheels in m.
        wheels: title -> rolling speeds of the left and right wheels, shape (2,) [m/s]; cases
            without any roll as fast as the ground passes.
        slip_only: draw the slip alone, from the contact points on; else rolling and slip head to
            tail, and their sum.
        metres_per_speed: length of an arrow of 1 m/s [m].

    Raises:
        ValueError: no case, a twist that is not three finite numbers, or rolling speeds that are
            not two of them or belong to no case.
    """
    twists = {
        title: numbers(twist, f"the twist of {title!r}", (3,)) for title, twist in cases.items()
    }
    if not twists:
        raise ValueError("contacts needs at least one case: title -> (v_x, v_y, omega)")
    if lost := set(wheels or {}) - set(twists):
        raise ValueError(f"no case called {sorted(lost)}: there are {sorted(twists)}")
    fig, axes = figure(6.8, 4.4, columns=len(twists), squeeze=False, sharey=True)
    for ax, (title, twist) in zip(axes[0], twists.items(), strict=True):
        _body(ax, np.zeros(3), vehicle)
        rolling = (wheels or {}).get(title)
        _velocities(ax, twist, vehicle, rolling, slip_only, metres_per_speed)
        ax.set(xlabel="$x$ forward [m]", ylabel="$y$ to the left [m]", aspect="equal", title=title)
        ax.yaxis.label.set_visible(ax is axes[0, 0])
        ax.margins(0.12)
    lines, texts = axes[0, -1].get_legend_handles_labels()
    once = dict(zip(texts, lines, strict=True))
    fig.legend(once.values(), once.keys(), loc="outside lower center", ncols=4)
    return fig


@styled
def friction_laws(laws: Mapping[str, ArrayLike], speed: ArrayLike, reach: float) -> Figure:
    """Friction force over sliding speed, and its linear form as a multiple of the smooth one.

    Args:
        laws: label -> force as a share of the load, shape (n,) [1]; "smooth" and "linear" are
            compared on the right.
        speed: sliding speed, shape (n,), symmetric about zero [m/s].
        reach: speed up to which the linear form is good enough [m/s]; shaded.

    Raises:
        ValueError: there is no law called "smooth" or none called "linear".
    """
    if not {"smooth", "linear"} <= set(laws):
        raise ValueError(f"friction_laws compares 'smooth' with 'linear', got {sorted(laws)}")
    speed = np.asarray(speed, dtype=float)
    fig, (left, right) = figure(6.8, 3.9, columns=2)
    draw_lines(left, speed, laws)
    top = 1.35 * np.max(np.abs(laws["smooth"]))
    left.set(xlabel="sliding speed [m/s]", ylabel="friction over load [1]", ylim=(-top, top))
    fig.legend(loc="outside lower center", ncols=2, fontsize=9)
    fast = speed > 0
    ratio = np.asarray(laws["linear"])[fast] / np.asarray(laws["smooth"])[fast]
    right.plot(speed[fast], ratio, color=GREEN)
    right.set(xlabel="sliding speed [m/s]", ylabel="linear over smooth [1]", xlim=(0, None))
    right.text(1.3 * reach, 0.93 * ratio.max(), f"shaded: up to {1e3 * reach:.0f} mm/s", size=10)
    left.axvspan(-reach, reach, color=PALE, zorder=0)
    right.axvspan(0, reach, color=PALE, zorder=0)
    return fig


def _wheels(vehicle: Vehicle) -> NDArray:
    """Contact points: front left, front right, rear left, rear right, shape (4, 2) [m]."""
    c, front, rear = vehicle.half_track, vehicle.front, vehicle.rear
    return np.array([(front, c), (front, -c), (-rear, c), (-rear, -c)])


def _velocities(
    ax: Axes,
    twist: NDArray,
    vehicle: Vehicle,
    rolling: ArrayLike | None,
    slip_only: bool,
    scale: float,
) -> None:
    v_x, v_y, omega = twist
    sides = None if rolling is None else numbers(rolling, "the rolling speeds", (2,))
    centre = np.array([-v_y, v_x]) / omega if omega else None
    for point in _wheels(vehicle):
        over_ground = np.array([v_x - omega * point[1], v_y + omega * point[0]])
        along = over_ground[0] if sides is None else sides[0 if point[1] > 0 else 1]
        roll = point if slip_only else point + scale * np.array([along, 0.0])
        slip = scale * (over_ground - (along, 0.0))
        if centre is not None:
            ax.plot(*np.array([centre, point]).T, ":", color=GREY, lw=1.0, zorder=1)
        _arrow(ax, point, roll, BLUE, "rolls")
        _arrow(ax, roll, roll + slip, RED, "slips")
        if not slip_only:
            _arrow(ax, point, point + scale * over_ground, DARK, "moves over the ground")
    if centre is not None:
        marker = {"marker": "P", "color": ORANGE, "mec": GREY, "ms": 11, "ls": ""}
        ax.plot(*centre, **marker, label="centre of rotation", zorder=6)
    ax.plot(0, 0, "o", color=GREY, ms=5, zorder=6)


def _arrow(ax: Axes, start: NDArray, end: NDArray, colour: str, label: str) -> None:
    ax.plot(*np.array([start, end]).T, color=colour, lw=0, label="_")
    if np.hypot(*(end - start)) < 0.01:
        return
    width = 1.6 if colour == DARK else 2.6
    dashes = (0, (2.2, 0.7)) if colour == RED else "-"
    style = {"arrowstyle": "-|>", "color": colour, "lw": width, "shrinkA": 0, "shrinkB": 0}
    style["ls"] = dashes
    ax.annotate("", end, start, arrowprops=style, zorder=5 if colour == DARK else 4)
    ax.plot([], [], color=colour, lw=width, ls=dashes, label=label)


def _body(ax: Axes, pose: ArrayLike, vehicle: Vehicle) -> None:
    x, y, heading = pose
    R = np.array([[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]])
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    middle = (vehicle.front - vehicle.rear) / 2, 0.0
    hull = corners * ((vehicle.front + vehicle.rear) / 2, 0.62 * vehicle.half_track) + middle
    ax.add_patch(Polygon(hull @ R.T + (x, y), facecolor="#f1f1f1", edgecolor=GREY, zorder=2))
    tyre = corners * (vehicle.wheel_radius, vehicle.wheel_width / 2)
    for point in _wheels(vehicle):
        outline = (tyre + point) @ R.T + (x, y)
        ax.add_patch(Polygon(outline, facecolor=PALE, edgecolor=GREY, zorder=2.5))
