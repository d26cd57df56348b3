"""Does it stand? The margin over a run, the balance from above, and the lifting chart."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from numpy.typing import ArrayLike

from backhoe.basics.inputs import alike, number, numbers
from backhoe.machine import BACKHOE, Machine
from backhoe.view.plots.drawing import (
    HEIGHT_LABEL,
    draw_arm,
    draw_from_above,
    metre_ticks,
    side_axes,
)
from backhoe.view.plots.style import BLUE, COLOURS, DARK, GREEN, GREY, MARKERS, RED, figure, styled
from backhoe.whole_body import stability


@styled
def margin(time: ArrayLike, distance: ArrayLike, least: float, at: float) -> Figure:
    """The margin of the balance over a run, and the least of all its steps.

    Args:
        time, distance: of the run, each of shape (n,) [s, m].
        least, at: the least margin [m] and when it was [s].

    Raises:
        ValueError: different lengths, or values that are not finite.
    """
    time, distance = numbers(time, "time", ("n",)), numbers(distance, "distance", ("n",))
    alike(time=time, distance=distance)
    least, at = number(least, "least", "m"), number(at, "at", "s")
    fig, ax = figure(6.8, 3.0)
    ax.axhspan(min(least, 0.0) - 0.2, 0.0, color=RED, alpha=0.12, lw=0)
    ax.axhline(0.0, color=RED, lw=1.2)
    ax.plot(time, distance, color=BLUE)
    ax.plot(at, least, "o", color=BLUE, mec=DARK)
    place = {"xytext": (6, -4), "textcoords": "offset points", "va": "top"}
    ax.annotate(f"{least:.2f} m at {at:.1f} s", (at, least), **place)
    ax.set(xlabel="time [s]", ylabel="margin to the edge [m]", ylim=(min(least, 0.0) - 0.2, None))
    return fig


@styled
def balance(q: ArrayLike, points: Mapping[str, ArrayLike], machine: Machine = BACKHOE) -> Figure:
    """Tracks, support polygon and arm from above, with places such as a centre of mass.

    Args:
        q: joint angles, shape (4,) [rad].
        points: label -> x, y in the vehicle's axes, shape (2,) [m].
        machine: its numbers.

    Raises:
        ValueError: q or a point has a wrong shape or value.
    """
    fig, ax = figure(6.8, 4.0)
    draw_from_above(ax, q, machine)
    corners = stability.support_polygon(machine)
    ax.add_patch(Polygon(corners, facecolor=GREEN, alpha=0.15, lw=0, zorder=1))
    ax.add_patch(Polygon(corners, fill=False, edgecolor=GREEN, lw=1.8, zorder=3))
    for (label, point), colour, mark in zip(points.items(), COLOURS, MARKERS, strict=False):
        x, y = numbers(point, label, (2,), meaning="x, y [m]")
        ax.plot(x, y, mark, color=colour, mec=DARK, ms=8, zorder=6, label=label)
    ax.set(xlim=(-3.0, 5.5), ylim=(-2.4, 2.4), aspect="equal")
    metre_ticks(ax, 1.0)
    ax.legend(loc="lower right")
    return fig


@styled
def lifting_chart(
    chart: stability.LiftingChart, q: ArrayLike, machine: Machine = BACKHOE
) -> Figure:
    """Rated loads over radius and height beside the machine, over the front and over the side.

    Args:
        chart: from `stability.lifting_chart`.
        q: joint angles of the arm that is drawn, shape (4,) [rad].
        machine: its numbers.

    Raises:
        ValueError: q has a wrong shape or value.
    """
    fig, axes = figure(6.8, 3.9, 1, 2, sharey=True)
    sides = (
        ("front", chart.front, chart.by_drives_front),
        ("side", chart.side, chart.by_drives_side),
    )
    high = float(max(np.max(chart.height) + 0.8, 4.0))
    for ax, (over, loads, drives) in zip(axes, sides, strict=True):
        draw_arm(ax, q, machine, alpha=0.25)
        limits = (
            -2.6,
            float(np.max(chart.radius)) + 1.0,
            min(float(np.min(chart.height)), 0) - 0.8,
        )
        side_axes(ax, (*limits, high), machine, over)
        for (k, j), load in np.ndenumerate(loads):
            if not np.isnan(load):
                text = f"{load / 1e3:.1f}" + "*" * bool(drives[k, j])
                at = chart.radius[j], chart.height[k]
                box = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": GREY, "lw": 0.5}
                ax.text(*at, text, ha="center", va="center", fontsize=9, bbox=box, zorder=7)
        ax.set(title=f"rated load over the {over} [t]", ylabel=HEIGHT_LABEL)
    return fig
