"""Figures of lesson 09c: two layers, maps of the ground, how often a deviation holds."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from backhoe.basics.inputs import alike, numbers, truths
from backhoe.view.plots.style import BLUE, DARK, GREY, ORANGE, figure, styled

__all__ = ["coverage", "layers", "maps"]


@styled
def layers(points: ArrayLike, soil: ArrayLike) -> Figure:
    """A cloud from above and from behind the machine, its ground and what stands on it.

    Args:
        points: shape (n, 3) [m].
        soil: which of them are ground, shape (n,).

    Raises:
        ValueError: shapes that do not fit.
    """
    points = numbers(points, "points", ("n", 3))
    soil = truths(soil, "soil", (len(points),))
    fig, axes = figure(6.6, 7.0, 2, height_ratios=(3, 1))
    for ax, row, label in zip(axes, (0, 2), ("$x$ [m]", "$z$ [m]"), strict=True):
        for mask, colour, name in ((soil, GREY, "ground"), (~soil, ORANGE, "things")):
            ax.plot(*points[mask][:, [1, row]].T, ".", ms=1.5, color=colour, label=name)
        ends = points[:, 1].max() + 0.3, points[:, 1].min() - 0.3
        ax.set(xlabel="$y$ [m], left is left", ylabel=label, aspect="equal", xlim=ends)
    fig.legend(
        *axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, markerscale=6
    )
    return fig


@styled
def maps(
    x: ArrayLike,
    y: ArrayLike,
    panels: Mapping[str, ArrayLike],
    label: str,
    limits: tuple[float, float],
    outline: ArrayLike | None = None,
    colours: str = "viridis",
) -> Figure:
    """Values of cells from above, one panel beside another, in one scale of colours.

    Args:
        x, y: of the cells' middles, shapes (columns,) and (rows,) [m].
        panels: title -> values, shape (rows, columns), NaN where unknown.
        label: of the values, with their unit.
        limits: lowest and highest colour.
        outline: a line drawn on all of them, shape (n, 2) [m].
        colours: name of Matplotlib's scale.

    Raises:
        ValueError: shapes that do not fit.
    """
    x, y = numbers(x, "x", ("columns",)), numbers(y, "y", ("rows",))
    drawn = {
        title: numbers(values, title, (len(y), len(x)), finite=False)
        for title, values in panels.items()
    }
    tall = 1.4 + 7.0 / len(drawn) * np.ptp(y) / np.ptp(x)
    fig, axes = figure(7.2, min(tall, 6.5), 1, len(drawn), squeeze=False, sharey=True)
    for ax, (title, values) in zip(axes[0], drawn.items(), strict=True):
        mesh = ax.pcolormesh(
            x, y, values, vmin=limits[0], vmax=limits[1], cmap=colours, rasterized=True
        )
        if outline is not None:
            ax.plot(*numbers(outline, "outline", ("n", 2)).T, color=DARK, lw=1.2)
        ax.set(xlabel="$x$ [m]", aspect="equal")
        ax.set_title(title, fontsize=10)
    axes[0, 0].set_ylabel("$y$ [m]")
    fig.colorbar(mesh, ax=list(axes[0]), label=label, shrink=0.8)
    return fig


@styled
def coverage(runs: Mapping[str, tuple[ArrayLike, ArrayLike]], ylabel: str) -> Figure:
    """Errors of repeated measurements and what 1.96 deviations claim, one panel a method.

    Args:
        runs: title -> (errors, deviations), shapes (n,) each, in the unit of `ylabel`.
        ylabel: what the errors are, with their unit.

    Raises:
        ValueError: shapes that do not fit.
    """
    fig, axes = figure(6.8, 0.9 + 1.6 * len(runs), len(runs), squeeze=False, sharex=True)
    for ax, (title, (errors, deviations)) in zip(axes[:, 0], runs.items(), strict=True):
        errors, deviations = numbers(errors, title, ("n",)), numbers(deviations, title, ("n",))
        alike(errors=errors, deviations=deviations)
        ax.axhline(0.0, color=DARK, lw=1)
        run = np.arange(len(errors))
        inside = np.abs(errors) <= 1.96 * deviations
        for mask, colour in ((inside, BLUE), (~inside, ORANGE)):
            ends = [errors[mask] - 1.96 * deviations[mask], errors[mask] + 1.96 * deviations[mask]]
            bars = np.stack([*ends, np.full(mask.sum(), np.nan)], axis=1).ravel()
            ax.plot(np.repeat(run[mask], 3), bars, color=colour, lw=1.6)
            ax.plot(run[mask], errors[mask], "o", color=colour, ms=3.5)
        ax.set(ylabel=ylabel)
        ax.set_title(f"{title}: {inside.sum()} of {len(errors)} hold the truth", fontsize=10)
    axes[-1, 0].set_xlabel("run [1]")
    return fig
