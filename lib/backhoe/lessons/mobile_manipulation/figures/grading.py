"""Figures of lesson 12b: what a robot's hand can do, and a graded surface."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from backhoe.basics.inputs import numbers
from backhoe.view.plots.style import COLOURS, STEEL, figure, styled

__all__ = ["ellipses"]


@styled
def ellipses(
    panels: Mapping[str, tuple[ArrayLike, Mapping[str, ArrayLike]]], scale: float = 1.0
) -> Figure:
    """Arms from the side, and about their hands what these can reach in a moment.

    Args:
        panels: title -> (joints of the arm from the ground to the hand, shape (n, 2) [m], and label
            -> velocities of the hand, shape (points, 2)).
        scale: of the velocities [s].

    Raises:
        ValueError: no panel, or shapes that do not fit.
    """
    if not panels:
        raise ValueError("ellipses needs at least one panel: title -> (joints, {label: outline})")
    fig, axes = figure(7.2, 3.4, 1, len(panels), squeeze=False, sharex=True, sharey=True)
    for ax, (title, (joints, outlines)) in zip(axes[0], panels.items(), strict=True):
        joints = numbers(joints, title, ("n", 2))
        ax.plot(*joints.T, "o-", color=STEEL, lw=4, ms=6, label="arm")
        for (label, outline), colour in zip(outlines.items(), COLOURS, strict=False):
            around = joints[-1] + scale * numbers(outline, label, ("points", 2))
            ax.plot(*around.T, color=colour, label=label)
        ax.set(xlabel="$x$ [m]", aspect="equal")
        ax.set_title(title, fontsize=10)
    axes[0, 0].set_ylabel("$z$ [m]")
    fig.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return fig
