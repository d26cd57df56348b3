"""Figures of sittings 14a and 14b: grounds side by side, as believed and as they are."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, positive
from backhoe.view.plots.style import PALE, RED, figure, styled

__all__ = ["grounds"]


@styled
def grounds(
    across: ArrayLike,
    up: ArrayLike,
    panels: Mapping[str, ArrayLike],
    labels: tuple[str, str],
    marks: Mapping[str, ArrayLike] | None = None,
    highest: float = 1.2,
    bar: str = "height [m]",
    cmap: str = "YlOrBr",
) -> Figure:
    """Numbers of a ground in cells, side by side, with lines on them; unknown cells are grey.

    Args:
        across, up: of the cells' middles, evenly spaced, shapes (columns,) and (rows,).
        panels: title -> values in the unit of `bar`, NaN where unknown, shape (rows, columns) [m].
        labels: quantity and unit along both axes.
        marks: title of a panel -> points of a line, shape (n, 2), in the axes' units.
        highest: where the colours end; they begin at 0.
        bar: what the colours are.
        cmap: Matplotlib's name of the colours.

    Raises:
        ValueError: no panel, or shapes that do not fit.
    """
    if not panels:
        raise ValueError("grounds needs at least one panel: title -> values (rows, columns)")
    across, up = numbers(across, "across", ("columns",)), numbers(up, "up", ("rows",))
    highest = positive(highest, "highest")
    fig, axes = figure(3.0 * len(panels) + 0.8, 3.4, 1, len(panels), squeeze=False, sharey=True)
    for ax, (title, values) in zip(axes[0], panels.items(), strict=True):
        values = numbers(values, title, (len(up), len(across)), finite=False)
        mesh = ax.pcolormesh(_edges(across), _edges(up), values, cmap=cmap, vmin=0.0, vmax=highest)
        if marks and title in marks:
            ax.plot(*numbers(marks[title], "marks", ("n", 2)).T, "o-", color=RED, markersize=4)
        ax.set_title(title)
        ax.set(xlabel=labels[0], facecolor=PALE)
        ax.grid(False)
    axes[0, 0].set_ylabel(labels[1])
    fig.colorbar(mesh, ax=list(axes[0]), label=bar)
    return fig


def _edges(middles: NDArray) -> NDArray:
    """Edges of evenly spaced cells, one more than their middles."""
    step = middles[1] - middles[0]
    return np.r_[middles - step / 2, middles[-1] + step / 2]
