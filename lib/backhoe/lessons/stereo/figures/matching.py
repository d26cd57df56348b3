"""Figures of lesson 08b: pictures and maps of disparities, points from above."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive, whole
from backhoe.view.plots.style import BLUE, DARK, GREEN, GREY, PALE, RED, SKY, figure, styled

__all__ = ["along_the_rays", "maps", "verdicts"]

_VERDICT = ListedColormap([PALE, SKY, RED])
RIGHT_WITHIN = 1.0
"""A disparity that is so near the truth counts as right [pixels]."""


@styled
def maps(
    panels: Mapping[str, NDArray],
    limits: tuple[float, float] = (0.0, 70.0),
    every: int = 1,
) -> Figure:
    """Grey pictures and maps of disparities side by side, two in a row.

    Args:
        panels: title -> grey picture, uint8, or disparities, NaN where none; shape (rows, columns).
        limits: darkest and lightest disparity [pixels].
        every: so many rows and columns share one that is shown.

    Raises:
        ValueError: no panel, another shape, or `every` below 1.
    """
    if not panels:
        raise ValueError("maps needs a panel: title -> picture or disparities (rows, columns)")
    fig, axes = _grid(panels)
    shown = None
    for ax, (title, values) in zip(axes, panels.items(), strict=True):
        grey = np.asarray(values).dtype == np.uint8
        values = numbers(values, title, ("rows", "columns"), finite=False)
        if grey:
            _image(ax, values, every, cmap="gray", vmin=0, vmax=255)
        else:
            ax.set_facecolor(PALE)
            shown = _image(ax, values, every, cmap="viridis", vmin=limits[0], vmax=limits[1])
        ax.set_title(title, loc="left", fontsize=10)
    if shown is not None:
        fig.colorbar(shown, ax=axes, label="disparity [pixels]", shrink=0.7, aspect=30)
    return fig


@styled
def verdicts(panels: Mapping[str, NDArray], truth: ArrayLike, every: int = 1) -> Figure:
    """Where maps of disparities are right, wrong by more than a pixel, or without an answer.

    Args:
        panels: title -> disparities [pixels], NaN where none, shape (rows, columns).
        truth: the true ones, same shape; NaN for the sky, where every answer is wrong.
        every: as for `maps`.

    Raises:
        ValueError: no panel, another shape, or `every` below 1.
    """
    truth = numbers(truth, "truth", ("rows", "columns"), finite=False)
    if not panels:
        raise ValueError("verdicts needs a panel: title -> disparities (rows, columns)")
    fig, axes = _grid(panels)
    for ax, (title, values) in zip(axes, panels.items(), strict=True):
        d = numbers(values, title, truth.shape, finite=False)
        kind = np.where(np.isnan(d), 0, np.where(np.abs(d - truth) <= RIGHT_WITHIN, 1, 2))
        _image(ax, kind, every, cmap=_VERDICT, vmin=-0.5, vmax=2.5)
        ax.set_title(title, loc="left", fontsize=10)
    bar = fig.colorbar(axes[0].images[0], ax=axes, ticks=[0, 1, 2], shrink=0.7, aspect=30)
    bar.ax.set_yticklabels(["none", "right", "wrong"])
    return fig


@styled
def along_the_rays(
    truth: ArrayLike, seen: ArrayLike, deviations: ArrayLike, stretch: float = 1.0
) -> Figure:
    """True points from above, the ones that were seen, and the band along the ray of 2 deviations.

    Args:
        truth: ahead and to the left, shape (n, 2) [m].
        seen: the same points as they were measured, shape (n, 2) [m].
        deviations: of the depth of each, shape (n,) [m].
        stretch: errors and bands are drawn so many times as long.

    Raises:
        ValueError: shapes that do not fit, or a stretch that is not positive.
    """
    truth = numbers(truth, "truth", ("n", 2))
    seen = numbers(seen, "seen", truth.shape)
    deviations = numbers(deviations, "deviations", (len(truth),))
    stretch = positive(stretch, "stretch")
    fig, ax = figure(6.8, 4.0)
    along = truth / truth[:, :1] * deviations[:, None] * stretch
    shown = truth + stretch * (seen - truth)
    for place, ray in zip(truth, along, strict=True):
        ax.plot(*np.transpose([place - 2 * ray, place + 2 * ray]), color=BLUE, lw=5, alpha=0.35)
    ax.plot(*truth.T, ".", color=DARK, ms=4, label="truth")
    ax.plot(*shown.T, "x", color=GREEN, ms=5, label="seen")
    ax.plot(0, 0, "^", color=GREY, ms=9, label="left eye")
    ax.set(xlabel="ahead [m]", ylabel="to the left [m]", aspect="equal")
    ax.legend(loc="lower left")
    return fig


def _image(ax: Axes, values: NDArray, every: int, **colours: object) -> AxesImage:
    """Every n-th pixel, at the place of those that it stands for."""
    every = whole(every, "every", least=1)
    rows, columns = values.shape
    edges = (-0.5, columns - 0.5, rows - 0.5, -0.5)
    return ax.imshow(values[::every, ::every], extent=edges, interpolation="nearest", **colours)


def _grid(panels: Mapping[str, object]) -> tuple[Figure, NDArray]:
    columns = min(2, len(panels))
    rows = -(-len(panels) // columns)
    fig, axes = figure(6.8, 2.4 * rows + 0.5, rows, columns, squeeze=False)
    for ax in axes.flat:
        ax.grid(False)
    for ax in axes.flat[len(panels) :]:
        ax.set_axis_off()
    for ax in axes[-1]:
        ax.set_xlabel("column [pixels]")
    for ax in axes[:, 0]:
        ax.set_ylabel("row [pixels]")
    return fig, axes.flat[: len(panels)]
