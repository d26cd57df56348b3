"""Figures of lesson 12a: the slides' robot in two views, the solutions of one equation."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers
from backhoe.view.plots.style import (
    BLUE,
    COLOURS,
    GREEN,
    GREY,
    GROUND,
    KINDS,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    figure,
    styled,
)
from backhoe.whole_body import SLIDES, SlidesRobot, hand

__all__ = ["solutions", "views"]

_REAR, _FRONT, _SIDE, _LOW, _DECK = -0.15, 0.1, 0.16, 0.05, 0.2
"""Drawn platform: behind the axle, ahead of the shoulder, half its width, heights [m]."""

_ARROWS = (ORANGE, GREEN, RED, PURPLE, SKY)


@styled
def views(
    scenes: Mapping[str, ArrayLike],
    path: ArrayLike | None = None,
    arrows: Mapping[str, ArrayLike] | None = None,
    robot: SlidesRobot = SLIDES,
) -> Figure:
    """The slides' robot from above and from the side, in one posture or several.

    Args:
        scenes: label -> postures x, y [m], theta, q1, q2, q3 [rad], shape (n, 6); later ones are
            drawn stronger.
        path: a dashed line for the hand, shape (n, 3) [m].
        arrows: name -> arrow at the hand of the first posture, shape (3,) [m]; one that a view
            sees end on is left out there.
        robot: its lengths.

    Raises:
        ValueError: shapes that do not fit, or a value is not finite.
    """
    fig, axes = figure(7.2, 4.4, 1, 2)
    for colour, (label, postures) in zip(COLOURS, scenes.items(), strict=False):
        postures = numbers(postures, label, ("n", 6))
        strengths = np.linspace(0.35 if len(postures) > 1 else 1.0, 1.0, len(postures))
        for q, alpha in zip(postures, strengths, strict=True):
            joints, shapes = _chain(q, robot), _outline(q, robot)
            for ax, rows, shape in zip(axes, ((0, 1), (0, 2)), shapes, strict=True):
                ax.plot(*shape.T, color=GREY, lw=1.0, alpha=alpha)
                last = label if q is postures[-1] or alpha == 1.0 else "_"
                ax.plot(
                    *joints[:, rows].T, "o-", color=colour, ms=4, lw=2.2, alpha=alpha, label=last
                )
    start = hand(next(iter(scenes.values()))[0], robot)
    for ax, rows, label in zip(axes, ([0, 1], [0, 2]), ("$y$ [m]", "$z$ [m]"), strict=True):
        if path is not None:
            ax.plot(*numbers(path, "path", ("n", 3))[:, rows].T, **KINDS["reference"], label="path")
        for colour, (name, arrow) in zip(_ARROWS, (arrows or {}).items(), strict=False):
            end = start[rows] + numbers(arrow, name, (3,))[rows]
            if np.linalg.norm(end - start[rows]) > 0.02:
                look = {"arrowstyle": "-|>", "color": colour, "lw": 2.2, "shrinkA": 0, "shrinkB": 0}
                ax.annotate("", end, start[rows], arrowprops=look, zorder=5)
                ax.update_datalim([end])
            ax.plot([], [], color=colour, label=name)
        ax.set(xlabel="$x$ [m]", ylabel=label, aspect="equal")
        ax.margins(0.06)
        ax.autoscale_view()
    axes[1].axhline(0.0, color=GROUND, lw=1.2)
    axes[0].set_title("from above"), axes[1].set_title("from the side")
    handles = {line.get_label(): line for line in axes[0].lines if line.get_label()[0] != "_"}
    fig.legend(handles.values(), handles, loc="outside lower center", ncols=min(len(handles), 6))
    return fig


@styled
def solutions(row: ArrayLike, b: float, preferred: ArrayLike, names: tuple[str, str]) -> Figure:
    """One equation for two velocities: its solutions, the least, and the one nearest to another.

    Args:
        row: coefficients, shape (2,), none of them zero.
        b: what row @ v should be, in its own unit.
        preferred: v0, shape (2,), in the units of `names`.
        names: of the two velocities with their units.

    Raises:
        ValueError: shapes that do not fit, or a value is not finite.
    """
    row, v0 = numbers(row, "row", (2,)), numbers(preferred, "preferred", (2,))
    b = number(b, "b")
    least = row * b / (row @ row)
    along = np.array([-row[1], row[0]]) / np.linalg.norm(row)
    nearest = least + along * (along @ v0)
    reach = 1.25 * max(map(np.linalg.norm, (least, nearest, v0)))
    fig, ax = figure(5.2, 4.9)
    ax.plot(
        *(least + np.outer([-2 * reach, 2 * reach], along)).T, color=BLUE, label="all solutions"
    )
    turn = np.linspace(0, 2 * np.pi, 73)
    circle = np.linalg.norm(least) * np.c_[np.cos(turn), np.sin(turn)]
    ax.plot(*circle.T, color=GREY, lw=1.0, ls=":", label="as large as the least")
    for name, start, end, colour in (
        ("least solution", np.zeros(2), least, BLUE),
        ("what is left of $v_0$", least, nearest, ORANGE),
    ):
        ax.plot(*np.array([start, end]).T, "o-", color=colour, lw=2.4, ms=5, label=name)
    ax.plot(*np.array([v0, nearest]).T, "--", color=ORANGE, lw=1.2, label="from $v_0$, square on")
    ax.text(*v0, "$v_0$  ", ha="right", va="center").set_in_layout(False)
    limits = {"xlim": (-reach, reach), "ylim": (-reach, reach)}
    ax.set(xlabel=names[0], ylabel=names[1], aspect="equal", **limits)
    fig.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return fig


def _chain(q: NDArray, robot: SlidesRobot) -> NDArray:
    """Deck, shoulder, elbow and hand in the world, shape (4, 3) [m]."""
    reach = robot.l2 * np.cos(q[4])
    elbow = [robot.a + reach * np.cos(q[3]), reach * np.sin(q[3])]
    flat = _in_the_world(q, [[robot.a, 0.0], [robot.a, 0.0], elbow])
    heights = [_DECK, robot.h, robot.h + robot.l2 * np.sin(q[4])]
    return np.vstack([np.c_[flat, heights], hand(q, robot)])


def _outline(q: NDArray, robot: SlidesRobot) -> tuple[NDArray, NDArray]:
    """The platform as a closed line from above, x and y, and from the side, x and z [m]."""
    front = robot.a + _FRONT
    corners = [[_REAR, -_SIDE], [front, -_SIDE], [front, _SIDE], [_REAR, _SIDE], [_REAR, -_SIDE]]
    above = _in_the_world(q, corners)
    ends = above[:, 0].min(), above[:, 0].max()
    return above, np.c_[np.take(ends, [0, 1, 1, 0, 0]), np.take((_LOW, _DECK), [0, 0, 1, 1, 0])]


def _in_the_world(q: NDArray, points: ArrayLike) -> NDArray:
    """Points (n, 2) of the platform seen from the world [m]."""
    c, s = np.cos(q[2]), np.sin(q[2])
    return q[:2] + np.asarray(points) @ np.array([[c, s], [-s, c]])
