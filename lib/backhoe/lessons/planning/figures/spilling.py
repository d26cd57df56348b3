"""Figures of lesson 11b: ways to the truck from above, and what they are worth."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle
from numpy.typing import ArrayLike

from backhoe.arm.kinematics import forward_kinematics
from backhoe.basics.inputs import numbers
from backhoe.planning.search import pitch
from backhoe.simulation.scene import Scene
from backhoe.view.appearance import truck_boxes
from backhoe.view.plots.style import GREY, GROUND, STEEL, figure, styled

__all__ = ["judged", "ways"]


@styled
def ways(postures: Mapping[str, ArrayLike], scene: Scene, band: tuple[float, float]) -> Figure:
    """The teeth's ways from above among heap and truck, and the bucket's pitch along them.

    Args:
        postures: label -> joint angles, shape (n, 4) [rad].
        scene: with heaps and a truck.
        band: pitches between which nothing falls, lower and upper [rad].

    Raises:
        ValueError: no way, or one of another shape.
    """
    if not postures:
        raise ValueError("ways needs at least one way: label -> joint angles (n, 4)")
    fig, (left, right) = figure(7.4, 3.9, 1, 2)
    for heap in scene.heaps:
        left.add_patch(Circle((heap.x, heap.y), heap.radius, fc=GROUND, ec="none", alpha=0.5))
    for low, high in truck_boxes(scene.truck):
        left.add_patch(Rectangle(low[:2], *(high - low)[:2], fc="none", ec=STEEL, lw=1.2))
    right.axhspan(*np.degrees(band), color=GREY, alpha=0.25, lw=0)
    for label, way in postures.items():
        q = numbers(way, label, ("n", 4), meaning="joint angles [rad]")
        left.plot(*forward_kinematics(q)[:, :2, 3].T, label=label)
        right.plot(np.degrees(q[:, 0]), np.degrees(pitch(q)))
    left.set(xlabel="$x$ [m]", ylabel="$y$ [m]", aspect="equal", xlim=(-3.5, 9), ylim=(-4.5, 7.5))
    right.set(xlabel="swing [deg], heap at -90, truck at 0", ylabel="pitch of the bucket [deg]")
    fig.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return fig


@styled
def judged(results: Mapping[str, ArrayLike]) -> Figure:
    """What each planner spilled and how near it came, one dot a job.

    Args:
        results: planner -> spilled [l] and clearance [m] of each job, shape (jobs, 2).

    Raises:
        ValueError: no results, or some of another shape.
    """
    if not results:
        raise ValueError("judged needs at least one planner: name -> (jobs, 2)")
    fig, axes = figure(7.4, 0.9 + 0.32 * len(results), 1, 2, sharey=True)
    labels = "spilled [l]", "least clearance [m]"
    for ax, label, column in zip(axes, labels, (0, 1), strict=True):
        for row, (name, values) in enumerate(results.items()):
            found = numbers(values, name, ("jobs", 2), meaning="litres and clearance")[:, column]
            ax.plot(found, np.full(len(found), row), "o", ms=5, alpha=0.6)
        ax.set(xlabel=label, yticks=range(len(results)), yticklabels=list(results))
    axes[1].axvline(0.0, color=GREY, lw=1)
    axes[0].invert_yaxis()
    return fig
