"""Figures of lesson 10c: tries and weights, learning curves, the way of the teeth."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
from numpy.typing import ArrayLike

from backhoe.basics.inputs import numbers
from backhoe.view.plots.style import BLUE, ORANGE, STEEL, figure, styled

__all__ = ["curves", "strokes", "weighed"]

LARGEST = 0.5
"""Diameter of the circle of a try that has all the weight, in units of the parameters."""


@styled
def weighed(tries: ArrayLike, weights: Mapping[str, ArrayLike], goal: ArrayLike) -> Figure:
    """Tries of two parameters as circles, their areas the weights; an arrow to the next mean.

    Args:
        tries: shape (n, 2), around the mean 0 [1].
        weights: title -> weights, shape (n,) [1].
        goal: where the cost is least, shape (2,) [1].

    Raises:
        ValueError: no weights, or other shapes.
    """
    tries, goal = numbers(tries, "tries", ("n", 2)), numbers(goal, "goal", (2,))
    if not weights:
        raise ValueError("weighed needs at least one panel: title -> weights")
    fig, axes = figure(8.0, 3.1, 1, len(weights), sharex=True, sharey=True, squeeze=False)
    for ax, (title, shares) in zip(axes[0], weights.items(), strict=True):
        shares = numbers(shares, title, (len(tries),))
        ax.plot(*tries.T, ".", color=STEEL, ms=4, label="tries")
        for place, share in zip(tries, shares, strict=True):
            size = LARGEST * share**0.5
            ax.add_patch(Ellipse(place, size, size, fc=BLUE, ec="none", alpha=0.4))
        ax.plot(*goal, "x", color=ORANGE, ms=8, mew=2, label="cheapest")
        ax.annotate("", shares @ tries, (0, 0), arrowprops={"arrowstyle": "->", "lw": 2})
        ax.set(xlabel=r"$\theta_1$ [1]", title=title, aspect="equal")
    axes[0, 0].set_ylabel(r"$\theta_2$ [1]")
    axes[0, -1].legend(loc="lower right", fontsize=8)
    return fig


@styled
def curves(costs: Mapping[str, ArrayLike]) -> Figure:
    """Cost of the best try so far: median over the seeds, and a band from the best to the worst.

    Args:
        costs: method -> costs of all tries, shape (seeds, tries) [1]; inf where one failed.

    Raises:
        ValueError: no method, or another shape.
    """
    if not costs:
        raise ValueError("curves needs at least one method: name -> costs (seeds, tries)")
    fig, ax = figure()
    for name, table in costs.items():
        table = numbers(table, name, ("seeds", "tries"), finite=False)
        best = np.minimum.accumulate(table, axis=1)
        count = np.arange(1, best.shape[1] + 1)
        (line,) = ax.plot(count, np.median(best, axis=0), label=name)
        ax.fill_between(
            count, best.min(axis=0), best.max(axis=0), color=line.get_color(), alpha=0.15, lw=0
        )
    ax.set(xlabel="tries", ylabel="cost of the best so far [1]")
    ax.legend()
    return fig


@styled
def strokes(ways: Mapping[str, ArrayLike], ground: ArrayLike) -> Figure:
    """Ways of the bucket's teeth from the side, and the heap before.

    Args:
        ways: label -> x, z, shape (n, 2) [m].
        ground: x and height of the ground, shape (m, 2) [m].

    Raises:
        ValueError: another shape.
    """
    ground = numbers(ground, "ground", ("m", 2), meaning="x, height [m]")
    fig, ax = figure(6.8, 3.6)
    ax.fill_between(*ground.T, ground[:, 1].min() - 0.2, color=STEEL, alpha=0.3, lw=0)
    for label, way in ways.items():
        ax.plot(*numbers(way, label, ("n", 2)).T, label=label)
    ax.set(xlabel="$x$ [m]", ylabel="$z$ [m]", aspect="equal")
    ax.legend()
    return fig
