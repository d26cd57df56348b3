"""Figures of lesson 12b: what the hand of the slides' robot can do in a moment."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from backhoe.basics.inputs import numbers
from backhoe.view.plots.style import BLUE, ORANGE, STEEL, figure, styled
from backhoe.whole_body import SLIDES, ellipsoid, hand, jacobian

__all__ = ["ellipses"]


@styled
def ellipses(postures: Mapping[str, ArrayLike], scale: float = 0.25) -> Figure:
    """The small robot from its side, and about its hand where that can go in a moment.

    Args:
        postures: title -> q of `SLIDES` that heads along x, its arm ahead, shape (6,) [m, rad].
        scale: the moment [s].

    Raises:
        ValueError: no posture, or one of another shape.
    """
    if not postures:
        raise ValueError("ellipses needs at least one panel: title -> posture q (6,)")
    fig, axes = figure(7.2, 3.4, 1, len(postures), squeeze=False, sharex=True, sharey=True)
    for ax, (title, q) in zip(axes[0], postures.items(), strict=True):
        q = numbers(q, title, (6,), meaning="x, y, theta and the three joints")
        foot, end = np.array([q[0] + SLIDES.a, 0.0]), hand(q, SLIDES)[::2]
        shoulder = np.add(foot, (0.0, SLIDES.h))
        elbow = shoulder + SLIDES.l2 * np.array([np.cos(q[4]), np.sin(q[4])])
        ax.plot(*np.transpose([foot, shoulder, elbow, end]), "o-", color=STEEL, lw=4, label="arm")
        J = jacobian(q, SLIDES)[::2]
        for columns, colour, label in ((J[:, 2:], BLUE, "the arm's"), (J, ORANGE, "the whole's")):
            around = end + scale * ellipsoid(columns).surface(65)
            ax.plot(*around.T, color=colour, label=label)
        ax.set(xlabel="$x$ [m]", aspect="equal")
        ax.set_title(title, fontsize=10)
    axes[0, 0].set_ylabel("$z$ [m]")
    fig.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return fig
