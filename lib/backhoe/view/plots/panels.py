"""Curves in panels above each other: joints over their references, responses over commands."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from backhoe.machine import JOINTS
from backhoe.view.plots.style import KINDS, LOOKS, draw_lines, figure, styled


@styled
def joint_tracking(time: ArrayLike, q: ArrayLike, q_ref: ArrayLike) -> Figure:
    """Measured joint angles over their references, one panel a joint.

    Args:
        time: shape (n,) [s].
        q, q_ref: measured and wanted joint angles, shape (n, 4) [rad].
    """
    fig, axes = figure(6.8, 5.4, rows=4, sharex=True)
    panels = zip(axes, JOINTS, np.degrees(q).T, np.degrees(q_ref).T, strict=True)
    for ax, name, angle, wanted in panels:
        ax.plot(time, angle, color=LOOKS[name][0], label="measured")
        ax.plot(time, wanted, **KINDS["reference"], label="wanted")
        ax.set_ylabel(f"{name} [deg]")
    axes[0].legend(ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    axes[-1].set_xlabel("time [s]")
    return fig


@styled
def stacked(
    x: ArrayLike,
    panels: Mapping[str, Mapping[str, ArrayLike]],
    kinds: Mapping[str, str] | None = None,
    xlabel: str = "time [s]",
    **settings: object,
) -> Figure:
    """Curves in panels above each other over one axis, such as a response and its command.

    Args:
        x: values of the common axis, shape (n,).
        panels: label of the vertical axis with its unit -> {label of a curve: values (n,)}.
        kinds: label of a curve -> "reference", "truth", "estimate" or "printed".
        settings: passed to `Axes.set` of every panel, such as `xscale="log"`.

    Raises:
        ValueError: no panel, or a kind of no curve.
    """
    if not panels:
        raise ValueError("stacked needs at least one panel: ylabel -> {label: values}")
    kinds = dict(kinds or {})
    if lost := set(kinds) - {label for curves in panels.values() for label in curves}:
        raise ValueError(f"no curve called {sorted(lost)}")
    fig, axes = figure(6.8, 1.2 + 2.1 * len(panels), rows=len(panels), squeeze=False, sharex=True)
    for ax, (ylabel, curves) in zip(axes[:, 0], panels.items(), strict=True):
        draw_lines(ax, x, curves, {label: kinds[label] for label in curves if label in kinds})
        ax.set(ylabel=ylabel, **settings)
        if any(not label.startswith("_") for label in curves):
            ax.legend(fontsize=9)
    axes[-1, 0].set_xlabel(xlabel)
    return fig
