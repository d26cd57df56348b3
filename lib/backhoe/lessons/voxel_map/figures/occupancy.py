"""Figures of lesson 09b: slices through a map, and its cubes as they are seen from afar."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib import colormaps
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, TwoSlopeNorm
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers, positive, whole
from backhoe.perception.octree.log_odds import L_MAX, L_MIN
from backhoe.view.plots.style import BLUE, DARK, GREY, ORANGE, PALE, RED, figure, styled

__all__ = ["cubes", "projected", "slices"]

_FREE_TO_OCCUPIED = LinearSegmentedColormap.from_list("map", [BLUE, "#ffffff", RED])
_LIGHT = (0.66, 0.82, 1.0)
"""Brightness of faces across x, y and z."""


@styled
def slices(
    panels: Mapping[str, tuple[ArrayLike, ArrayLike, ArrayLike]],
    xlabel: str,
    ylabel: str,
    truth: ArrayLike | None = None,
    sensor: ArrayLike | None = None,
    stretch: float = 1.0,
) -> Figure:
    """Log-odds of the voxels in a vertical slice: blue free, red occupied, grey unknown.

    Args:
        panels: title -> (edges along the slice, shape (n + 1,) [m]; edges upwards, (m + 1,) [m];
            log-odds, (m, n) [1], NaN where unknown), one panel below another.
        xlabel, ylabel: quantity with its unit.
        truth: a line of the true surface, shape (k, 2) [m].
        sensor: where the rays come from, shape (2,) [m].
        stretch: by which heights are drawn larger than lengths [1].

    Raises:
        ValueError: no panel, edges that do not fit the log-odds, or no stretch above 0.
    """
    if not panels:
        raise ValueError("slices needs a panel: title -> (edges, edges, log_odds)")
    drawn = {}
    for title, (x, y, odds) in panels.items():
        x, y = numbers(x, "edges", ("n",)), numbers(y, "edges", ("n",))
        odds = numbers(odds, title, (len(y) - 1, len(x) - 1), finite=False)
        drawn[title] = (x, y, odds)
    x, y, _ = next(iter(drawn.values()))
    stretch = positive(stretch, "stretch")
    high = 0.7 + 5.4 * stretch * (y[-1] - y[0]) / (x[-1] - x[0])
    fig, axes = figure(6.8, 0.4 + high * len(drawn), len(drawn), squeeze=False, sharex=True)
    for ax, (title, (x, y, odds)) in zip(axes[:, 0], drawn.items(), strict=True):
        ax.set_facecolor(PALE)
        ax.grid(False)
        colours = {"cmap": _FREE_TO_OCCUPIED, "norm": TwoSlopeNorm(0.0, L_MIN, L_MAX)}
        mesh = ax.pcolormesh(x, y, odds, edgecolor="white", linewidth=0.3, **colours)
        if truth is not None:
            ax.plot(*numbers(truth, "truth", ("n", 2)).T, color=DARK, lw=1.6, label="true surface")
        if sensor is not None:
            ax.plot(*numbers(sensor, "sensor", (2,)), "v", color=ORANGE, ms=8, label="laser")
        ax.set(aspect=stretch, ylabel=ylabel, xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
        ax.set_title(title, loc="left", fontsize=10)
    axes[-1, 0].set_xlabel(xlabel)
    fig.colorbar(mesh, ax=axes[:, 0], label="log-odds [1]", shrink=0.8, aspect=15)
    if axes[0, 0].get_legend_handles_labels()[0]:
        fig.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return fig


def projected(points: ArrayLike, turn: float, rise: float) -> NDArray:
    """Points as seen from afar, parallel rays: a metre across the view stays a metre.

    Args:
        points: shape (..., 3) [m].
        turn, rise: where the eye is, from x towards y, and above the horizontal [rad].

    Returns:
        To the right, upwards in the picture and towards the eye, shape (..., 3) [m].

    Raises:
        ValueError: another shape, or values that are not finite.
    """
    turn, rise = number(turn, "turn", "rad"), number(rise, "rise", "rad")
    right = [-np.sin(turn), np.cos(turn), 0.0]
    towards = np.array([np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)])
    axes = np.stack([right, np.cross(towards, right), towards])
    return numbers(points, "points", (..., 3)) @ axes.T


@styled
def cubes(
    panels: Mapping[str, tuple[ArrayLike, float, tuple[float, float]]],
    names: Mapping[str, ArrayLike] | None = None,
    heights: tuple[float, float] = (-0.5, 3.5),
    columns: int = 1,
) -> Figure:
    """Occupied voxels of one size as cubes, their colour by height, seen from afar.

    Args:
        panels: title -> (middles of the voxels, shape (n, 3) [m]; their edge [m]; `turn` and
            `rise` of the eye, as for `projected`, rise above 0 [rad]).
        names: words -> the place that they name, shape (3,) [m].
        heights: of the ends of the colour scale [m].
        columns: panels side by side.

    Raises:
        ValueError: no panel, middles of another shape, an edge that is not above 0, or columns
            that the panels do not fill.
    """
    if not panels:
        raise ValueError("cubes needs a panel: title -> (middles, edge, (turn, rise))")
    rows, rest = divmod(len(panels), whole(columns, "columns", least=1))
    if rest:
        raise ValueError(f"columns must divide the {len(panels)} panels, got {columns}")
    fig, axes = figure(6.8, 3.4 * rows, rows, columns, squeeze=False)
    for ax, (title, (middles, edge, eye)) in zip(axes.flat, panels.items(), strict=True):
        middles = numbers(middles, "middles", ("n", 3), meaning="x, y, z [m]")
        corners, across = _faces(middles, positive(edge, "edge", "m"), projected(np.eye(3), *eye))
        seen = projected(corners, *eye)
        share = (corners[:, 0, 2] - heights[0]) / (heights[1] - heights[0])
        colours = colormaps["viridis"](0.15 + 0.85 * np.clip(share, 0, 1))
        colours[:, :3] *= np.take(_LIGHT, across)[:, None]
        look = {"facecolors": colours, "edgecolors": (0, 0, 0, 0.35), "linewidths": 0.25}
        ax.add_collection(PolyCollection(seen[..., :2], **look))
        for text, place in (names or {}).items():
            at = projected(place, *eye)[:2]
            ax.text(*at, text, ha="center", fontsize=10, color=DARK, bbox=_LABEL)
        ax.autoscale_view()
        ax.set(aspect="equal", xlabel="across [m]", ylabel="upwards in the picture [m]")
        ax.set_title(title, loc="left", fontsize=10)
    return fig


_LABEL = {"facecolor": "white", "edgecolor": GREY, "alpha": 0.8, "boxstyle": "round,pad=0.2"}


def _faces(middles: NDArray, edge: float, axes: NDArray) -> tuple[NDArray, NDArray]:
    """Faces that the eye may see, the farthest first, and the axis that each lies across."""
    keys = np.round(middles / edge * 2).astype(int)
    there = {tuple(key) for key in keys.tolist()}
    corners, across, depth = [], [], []
    for axis in range(3):
        side = 1 if axes[axis, 2] > 0 else -1
        step = 2 * side * np.eye(3, dtype=int)[axis]
        open_ = np.array([tuple(key) not in there for key in (keys + step).tolist()])
        u, v = np.eye(3)[[(axis + 1) % 3, (axis + 2) % 3]] * edge / 2
        face = middles[open_] + side * np.eye(3)[axis] * edge / 2
        corners.append(face[:, None] + np.stack([-u - v, u - v, u + v, v - u]))
        across.append(np.full(len(face), axis))
        depth.append(middles[open_] @ axes[:, 2])
    order = np.argsort(np.concatenate(depth), kind="stable")
    return np.concatenate(corners)[order], np.concatenate(across)[order]
