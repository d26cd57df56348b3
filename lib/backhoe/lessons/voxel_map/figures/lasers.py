"""Figures of lesson 09a: clouds as dots, from above or in the plane of a line."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from backhoe.basics.inputs import numbers
from backhoe.view.plots.style import BLUE, DARK, GREEN, GREY, ORANGE, PURPLE, RED, figure, styled

__all__ = ["COLOURS", "dots"]

COLOURS = {
    "left laser": BLUE,
    "right laser": ORANGE,
    "stereo pair": GREEN,
    "kept": BLUE,
    "removed": GREY,
    "mixed pixels": RED,
    "true": BLUE,
    "the machine": ORANGE,
    "unknown": PURPLE,
}
"""One colour a sensor, and one for each fate of a point."""


@styled
def dots(
    panels: Mapping[str, Mapping[str, ArrayLike]],
    xlabel: str = "$x$ [m]",
    ylabel: str = "$y$ [m]",
    truth: ArrayLike | None = None,
    size: float = 1.5,
    **limits: object,
) -> Figure:
    """Points of clouds in a plane, one panel beside another, both axes to one scale.

    Args:
        panels: title -> {label: points, shape (n, 2) or more columns [m]}; of three columns the
            first two are drawn. A label in `COLOURS` has its colour.
        xlabel, ylabel: what the columns are, with their unit.
        truth: a true outline, shape (n, 2) [m], drawn in each panel.
        size: of a dot [points].
        limits: passed to `Axes.set`, such as xlim=(0, 10).

    Raises:
        ValueError: no panel, or points of another shape.
    """
    if not panels or not all(panels.values()):
        raise ValueError("dots needs a panel with points: title -> {label: points (n, 2)}")
    fig, axes = figure(
        7.2, 4.3 + 1.3 * (len(panels) == 1), 1, len(panels), squeeze=False, sharey=True
    )
    labels: dict[str, object] = {}
    for ax, (title, clouds) in zip(axes[0], panels.items(), strict=True):
        for label, points in clouds.items():
            x, y = np.reshape(points, (-1, np.shape(points)[-1])).T[:2]
            numbers(x, label, finite=False)
            (labels[label],) = ax.plot(
                x, y, ".", ms=size, mew=0, color=COLOURS.get(label, GREEN), label=label
            )
        if truth is not None:
            ax.plot(*numbers(truth, "truth", ("n", 2)).T, color=DARK, lw=1.2, label="truth")
            labels["truth"] = ax.lines[-1]
        ax.set(xlabel=xlabel, title=title, aspect="equal", **limits)
    axes[0, 0].set_ylabel(ylabel)
    fig.legend(
        labels.values(),
        labels,
        loc="outside lower center",
        ncols=4,
        markerscale=max(6 / size, 1),
    )
    return fig
