"""Figures of lesson 12b: ground before and after the work, its errors, a trench across."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers, positive
from backhoe.view.plots.style import BLUE, COLOURS, DARK, KINDS, PALE, RED, figure, styled

__all__ = ["error_map", "surface_3d", "trench_section"]

_CUT_TO_LEFT = LinearSegmentedColormap.from_list("errors", [BLUE, "#f7f7f7", RED])
_STEPS = np.array([-4.0, -3.0, -2.0, -1.0, -0.5, 0.5, 1.0, 2.0, 3.0, 4.0])
"""Where the colours of errors change, in tolerances."""


@styled
def surface_3d(
    x: ArrayLike,
    y: ArrayLike,
    panels: Mapping[str, tuple[ArrayLike, ArrayLike]],
    turn: float,
    rise: float,
    tolerance: float = 0.05,
) -> Figure:
    """Ground as seen from afar, parallel rays, with the errors of its surface in colour.

    Args:
        x, y: of the cells, evenly spaced, shapes (columns,) and (rows,) [m].
        panels: title -> (heights, errors, NaN where none count), shapes (rows, columns) [m].
        turn, rise: where the eye is, from x towards y, and above the horizontal [rad].
        tolerance: of the errors; the colours end at four times as much [m].

    Raises:
        ValueError: no panel, or shapes that do not fit.
    """
    x, y = numbers(x, "x", ("columns",)), numbers(y, "y", ("rows",))
    turn, rise = number(turn, "turn", "rad"), number(rise, "rise", "rad")
    fig, axes = _panels(panels, "surface_3d", 3.6)
    for ax, (title, pair) in zip(axes, panels.items(), strict=True):
        z, errors = (numbers(v, title, (len(y), len(x)), finite=False) for v in pair)
        corners = _corners(x[None, :] + 0 * z), _corners(y[:, None] + 0 * z), _corners(z)
        dz_dy, dz_dx = np.gradient(z, y, x)
        light = 1 / np.hypot(1.0, np.hypot(dz_dx + 0.8 * np.cos(turn), dz_dy + 0.8))
        # what is far is painted first
        order = np.s_[:: -1 if np.sin(turn) < 0 else 1, :: -1 if np.cos(turn) < 0 else 1]
        across, up = (part[order] for part in _seen(*corners, turn, rise))
        ax.pcolormesh(across, up, light[order], cmap="gray", vmin=0.0, vmax=1.0, rasterized=True)
        mesh = ax.pcolormesh(across, up, errors[order], alpha=0.7, **_colours(tolerance))
        ax.set(aspect="equal", xlabel="across the view [m]")
    axes[0].set_ylabel("upwards in the picture [m]")
    _colour_bar(fig, mesh, list(axes), tolerance)
    return fig


@styled
def error_map(
    x: ArrayLike,
    y: ArrayLike,
    panels: Mapping[str, ArrayLike],
    tolerance: float = 0.05,
) -> Figure:
    """Errors of a finished surface from above; the title says which share is within the tolerance.

    The panels stand side by side, those of a long strip along x one below the other.

    Args:
        x, y: of the cells' middles, shapes (columns,) and (rows,) [m].
        panels: title -> soil minus design, NaN where it does not count, shape (rows, columns) [m].
        tolerance: what they may be [m].

    Raises:
        ValueError: no panel, shapes that do not fit, or no cell that counts.
    """
    x, y = numbers(x, "x", ("columns",)), numbers(y, "y", ("rows",))
    shape = (len(y), len(x))
    maps = {t: numbers(errors, t, shape, finite=False) for t, errors in panels.items()}
    counts = {title: np.isfinite(errors) for title, errors in maps.items()}
    for title, there in counts.items():
        if not there.any():
            raise ValueError(f"no cell of {title!r} has an error: all are NaN")
    there = np.any(list(counts.values()), axis=0)
    rows, columns = (np.flatnonzero(there.any(axis=axis)) for axis in (1, 0))
    part = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    strip = np.ptp(x[part[1]]) > 3 * np.ptp(y[part[0]])
    fig, axes = _panels(maps, "error_map", 3.2, strip)
    for ax, (title, errors) in zip(axes, maps.items(), strict=True):
        mesh = ax.pcolormesh(x[part[1]], y[part[0]], errors[part], **_colours(tolerance))
        share = 100 * (np.abs(errors[counts[title]]) <= tolerance).mean()
        ax.set_title(f"{title}: {share:.1f} % within {100 * tolerance:.0f} cm", fontsize=10)
        ax.set(aspect="equal", facecolor=PALE)
        ax.grid(False)
    for ax in axes[-1:] if strip else axes:
        ax.set_xlabel("$x$ [m]")
    for ax in axes if strip else axes[:1]:
        ax.set_ylabel("$y$ [m]")
    _colour_bar(fig, mesh, list(axes), tolerance)
    return fig


@styled
def trench_section(
    across: ArrayLike,
    sections: Mapping[str, ArrayLike],
    width: float,
    level: float,
    tolerance: float = 0.05,
) -> Figure:
    """A trench cut across: the soil at some places along it beside the design of its bottom.

    Args:
        across: from the middle line, positive to the left, shape (n,) [m].
        sections: label -> heights of the soil, shape (n,) [m].
        width: of the design's bottom [m].
        level: its height [m].
        tolerance: drawn around it [m].

    Raises:
        ValueError: shapes that do not fit.
    """
    across, level = numbers(across, "across", ("n",)), number(level, "level", "m")
    half, tolerance = positive(width, "width", "m") / 2, positive(tolerance, "tolerance", "m")
    fig, ax = figure(6.8, 2.4)
    ends = np.array([-half, half])
    ax.fill_between(ends, level - tolerance, level + tolerance, color=PALE, lw=0)
    for (label, z), colour in zip(sections.items(), COLOURS, strict=False):
        ax.plot(across, numbers(z, label, across.shape), color=colour, label=label)
    design = f"design, ±{100 * tolerance:.0f} cm"
    ax.plot(ends, [level, level], **KINDS["reference"], label=design)
    ax.set(xlabel="across, left is positive [m]", ylabel="$z$ [m]", aspect="equal")
    ax.invert_xaxis()
    fig.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return fig


def _panels(
    panels: Mapping, name: str, high: float, stacked: bool = False
) -> tuple[Figure, NDArray]:
    if not panels:
        raise ValueError(f"{name} needs at least one panel")
    grid = (len(panels), 1) if stacked else (1, len(panels))
    fig, axes = figure(7.4, high, *grid, squeeze=False, sharex=True, sharey=True)
    for ax, title in zip(axes.flat, panels, strict=True):
        ax.set_title(title, fontsize=10)
    return fig, axes.ravel()


def _corners(middles: NDArray) -> NDArray:
    """Values at corners of cells, shape (rows + 1, columns + 1), from those in their middles."""
    wide = np.pad(middles, 1, mode="reflect", reflect_type="odd")
    return (wide[1:, 1:] + wide[:-1, 1:] + wide[1:, :-1] + wide[:-1, :-1]) / 4


def _seen(x: NDArray, y: NDArray, z: NDArray, turn: float, rise: float) -> tuple[NDArray, NDArray]:
    """Where points are in the picture: to the right and upwards [m]."""
    towards = x * np.cos(turn) + y * np.sin(turn)
    return y * np.cos(turn) - x * np.sin(turn), z * np.cos(rise) - towards * np.sin(rise)


def _colours(tolerance: float) -> dict[str, object]:
    steps = positive(tolerance, "tolerance", "m") * _STEPS
    norm = BoundaryNorm(steps, _CUT_TO_LEFT.N, extend="both")
    return {"cmap": _CUT_TO_LEFT, "norm": norm, "rasterized": True}


def _colour_bar(fig: Figure, mesh: object, axes: list, tolerance: float) -> None:
    bar = fig.colorbar(mesh, ax=axes, shrink=0.9, aspect=18, label="soil over the design [cm]")
    bar.set_ticks(
        tolerance * _STEPS,
        labels=[f"{100 * tolerance * k:g}".replace("-", "\u2212") for k in _STEPS],
    )
    for edge in (-tolerance, tolerance):
        bar.ax.axhline(edge, color=DARK, lw=2.0)
