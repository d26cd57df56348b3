"""Figures of lesson 11a: ways through a yard, and two joints of the arm as a map."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from numpy.typing import ArrayLike

from backhoe.basics.inputs import numbers
from backhoe.planning.search import Log
from backhoe.view.plots.drawing import draw_arm, side_axes
from backhoe.view.plots.style import (
    COLOURS,
    DARK,
    GREEN,
    GREY,
    GROUND,
    KINDS,
    PALE,
    RED,
    SKY,
    figure,
    styled,
)

__all__ = ["two_joints", "yard"]

START = {"marker": "o", "linestyle": "", "color": GREEN, "ms": 6, "zorder": 4}
GOAL = {"marker": "X", "linestyle": "", "color": RED, "ms": 7, "zorder": 4}


@styled
def yard(
    heaps: ArrayLike,
    reach: float,
    panels: Mapping[str, Mapping[str, ArrayLike]],
    limits: ArrayLike,
    trees: Mapping[str, Log] | None = None,
    columns: int = 2,
) -> Figure:
    """Ways from above through heaps, which are drawn as they are and as the machine's middle meets
    them.

    Args:
        heaps: middles and radii, shape (m, 3) [m].
        reach: of the machine about its middle [m].
        panels: title -> {label: way, shape (n, 2) [m]}; "optimum" is dashed. Ways begin at the
            start and end at the goal, where they get there.
        limits: of the yard, lower and upper corner, shape (2, 2) [m].
        trees: title -> what a search looked at, drawn pale.
        columns: panels in a row.

    Raises:
        ValueError: no panel, or shapes.
    """
    if not panels:
        raise ValueError("yard needs at least one panel: title -> {label: way (n, 2)}")
    heaps = numbers(heaps, "heaps", ("m", 3), meaning="middles and radii [m]")
    low, high = numbers(limits, "limits", (2, 2), meaning="lower and upper corner [m]")
    rows = -(-len(panels) // columns)
    height = 0.6 + rows * (0.6 + 4.4 / columns)
    fig, axes = figure(7.2, height, rows, columns, squeeze=False)
    labels = [label for ways in panels.values() for label in ways if label != "optimum"]
    colours = dict(zip(dict.fromkeys(labels), COLOURS * 3, strict=False))
    for ax, (title, ways) in zip(axes.flat, panels.items(), strict=False):
        for x, y, r in heaps:
            ax.add_patch(Circle((x, y), r, color=GROUND))
            ax.add_patch(Circle((x, y), r + reach, fill=False, edgecolor=GREY, lw=0.8))
        if trees and title in trees:
            log = trees[title]
            pieces = np.full((len(log.edges), 3, 2), np.nan)
            pieces[:, :2] = log.points[log.edges]
            ax.plot(*pieces.reshape(-1, 2).T, color=PALE, lw=0.8, label="_tree", zorder=1.5)
        for label, way in ways.items():
            look = KINDS["reference"] if label == "optimum" else {"color": colours[label]}
            way = numbers(way, label, ("n", 2), meaning="places x, y [m]")
            ax.plot(*way.T, label=label, **look, zorder=3)
        first = next(iter(ways.values()))
        for place, look, label in ((first[0], START, "start"), (first[-1], GOAL, "goal")):
            ax.plot(*place, **look, label=label)
        ax.set(title=title, xlabel="$x$ [m]", ylabel="$y$ [m]", aspect="equal")
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    for ax in axes.flat[len(panels) :]:
        ax.axis("off")
    handles = {h.get_label(): h for ax in axes.flat for h in ax.lines if h.get_label()[0] != "_"}
    fig.legend(handles.values(), handles, loc="outside lower center", ncols=min(len(handles), 6))
    return fig


@styled
def two_joints(
    boom: ArrayLike,
    stick: ArrayLike,
    free: ArrayLike,
    ways: Mapping[str, ArrayLike],
    boxes: ArrayLike,
    shown: ArrayLike,
) -> Figure:
    """Two joints as a map with the ways in it; beside it the arm from the side.

    Args:
        boom, stick: angles that were looked at, rising evenly, shapes (n,) and (m,) [rad].
        free: whether nothing is hit there, shape (m, n) [1].
        ways: label -> boom and stick along a way, shape (k, 2) [rad].
        boxes: obstacles in the arm's plane, lower and upper corner, distance from the swing axis
            and height, shape (b, 2, 2) [m].
        shown: postures that are drawn, the first dark, shape (p, 4) [rad].

    Raises:
        ValueError: shapes.
    """
    boom, stick = (np.degrees(numbers(a, "boom and stick", ("n",))) for a in (boom, stick))
    free = numbers(np.asarray(free, float), "free", (len(stick), len(boom)))
    shown = numbers(shown, "shown", ("p", 4), meaning="joints (swing, boom, stick, bucket)")
    fig, (chart, side) = figure(7.6, 3.9, 1, 2, width_ratios=(1.0, 1.15))
    edges = [np.append(a, 2 * a[-1] - a[-2]) - (a[1] - a[0]) / 2 for a in (boom, stick)]
    chart.pcolormesh(*edges, free, cmap=ListedColormap([GROUND, "white"]), vmin=0, vmax=1)
    for (label, way), colour in zip(ways.items(), COLOURS, strict=False):
        way = np.degrees(numbers(way, label, ("k", 2), meaning="boom, stick [rad]"))
        chart.plot(*way.T, color=colour, label=label)
    chart.plot(*way[0], **START, label="start")
    chart.plot(*way[-1], **GOAL, label="goal")
    chart.set(xlabel="boom [deg]", ylabel="stick [deg]", title="brown: hits something")
    chart.grid(False)
    for low, high in numbers(boxes, "boxes", ("b", 2, 2), meaning="corners r, z [m]"):
        corners = [low, (high[0], low[1]), high, (low[0], high[1])]
        side.add_patch(Polygon(corners, facecolor=SKY, edgecolor=DARK, lw=0.8))
    for k, q in enumerate(shown):
        draw_arm(side, q, alpha=1.0 if k == 0 else 0.35)
    side_axes(side, (-2.6, 9.4, -1.0, 7.6))
    side.set(ylabel="height $z$ [m]", title="from the side")
    fig.legend(loc="outside lower center", ncols=4)
    return fig
