"""Figures of lesson 06: areas under samples, orders of error, one step, end places, robots."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers, times
from backhoe.localisation.odometry import order
from backhoe.view.plots.style import (
    BLUE,
    COLOURS,
    DARK,
    GREEN,
    GREY,
    KINDS,
    ORANGE,
    PALE,
    RED,
    figure,
    looks,
    styled,
)

__all__ = ["areas", "end_places", "error_orders", "one_step", "wheeled"]


@styled
def areas(t: ArrayLike, v: ArrayLike, speed: Callable[[NDArray], NDArray]) -> Figure:
    """What the two sums of a sampled speed add up: rectangles and trapezoids under the curve.

    Args:
        t: instants of the samples, rising, shape (n,) [s].
        v: samples, shape (n,) [m/s].
        speed: the speed that was sampled, a function of an array of times [m/s].

    Raises:
        ValueError: fewer than two samples, t that does not rise, or shapes that do not fit.
    """
    t = times(t)
    v = numbers(v, "v", t.shape, meaning="a speed for each time")
    fig, (left, right) = figure(6.8, 3.5, columns=2, sharey=True)
    fine = np.linspace(t[0], t[-1], 400)
    right_edges = [(a, a, b, b) for a, b in pairwise(t)]
    rectangles = [(0, one, one, 0) for one in v[1:]]
    trapezoids = [(0, a, b, 0) for a, b in pairwise(v)]
    panels = ((left, rectangles, "Euler: rectangles"), (right, trapezoids, "bilinear: trapezoids"))
    for ax, heights, title in panels:
        shapes = [Polygon(np.c_[x, y]) for x, y in zip(right_edges, heights, strict=True)]
        ax.add_collection(PatchCollection(shapes, facecolor=BLUE + "33", edgecolor=BLUE, lw=1.2))
        ax.plot(fine, speed(fine), color=DARK, label="speed")
        ax.plot(t, v, "o", color=ORANGE, mec="white", ms=7, label="samples")
        ax.set(title=title, xlabel="time [s]", ylabel="speed [m/s]")
    fig.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return fig


@styled
def error_orders(
    steps: ArrayLike,
    errors: Mapping[str, ArrayLike],
    slopes: Sequence[int] = (1, 2),
    kinds: Mapping[str, str] | None = None,
    xlabel: str = "time step [s]",
    ylabel: str = "error at the end [m]",
) -> Figure:
    """Errors over step lengths, both on logarithmic axes, with lines of whole slopes beside them.

    Args:
        steps: lengths of the steps, shape (n,) [s].
        errors: label -> errors, shape (n,), above 0.
        slopes: whole orders drawn dashed, each through the largest error nearest to it.
        kinds: label -> "reference", "truth", "estimate" or "printed"; others get a colour.

    Raises:
        ValueError: an error that is not above 0, another number of errors than of steps, fewer than
            two steps, or a kind of no curve.
    """
    steps, kinds = numbers(steps, "steps", ("n",)), dict(kinds or {})
    if lost := set(kinds) - set(errors):
        raise ValueError(f"no errors called {sorted(lost)}: there are {sorted(errors)}")
    if not errors:
        raise ValueError("error_orders needs the errors of one rule at least: label -> errors")
    drawn = {label: numbers(values, label, steps.shape) for label, values in errors.items()}
    fits = {label: order(steps, values) for label, values in drawn.items()}
    fig, ax = figure(6.8, 4.2)
    for (label, values), style in zip(drawn.items(), looks(list(drawn)), strict=True):
        style |= KINDS.get(kinds.get(label, ""), {}) | {"markevery": 1}
        ax.plot(steps, values, label=label, **style)
    for slope in slopes:
        nearest = min(fits, key=lambda name: abs(fits[name] - slope))
        guide = 2.2 * drawn[nearest].max() * (steps / steps.max()) ** slope
        ax.plot(steps, guide, **KINDS["reference"])
        place = np.argmin(steps)
        ax.annotate(
            f"slope {slope}",
            (steps[place], guide[place]),
            (-6, 0),
            textcoords="offset points",
            color=GREY,
            ha="right",
            va="center",
        )
    ax.set(xscale="log", yscale="log", xlabel=xlabel, ylabel=ylabel)
    span = steps.max() / steps.min()
    ax.set_xlim(steps.min() / span**0.26, steps.max() * span**0.06)
    marked = np.sort(steps)[:: max(1, len(steps) // 4)]
    ax.set_xticks(marked, [f"{step:.2g}" for step in marked])
    ax.set_xticks([], minor=True)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return fig


@styled
def one_step(
    pose: ArrayLike,
    arc: ArrayLike,
    ends: Mapping[str, ArrayLike],
    kinds: Mapping[str, str] | None = None,
) -> Figure:
    """One long step from above: the true arc, and where each rule says that it ends.

    Args:
        pose: x, y, psi at the start, shape (3,) [m, m, rad].
        arc: poses of the true way, shape (n, 3) [m, m, rad].
        ends: label -> pose at the end, shape (3,) [m, m, rad].
        kinds: label -> "printed" and the like; others get a colour.

    Raises:
        ValueError: values of another shape or not finite, or a kind of no end.
    """
    pose, arc = numbers(pose, "pose", (3,)), numbers(arc, "arc", ("n", 3))
    kinds = dict(kinds or {})
    if lost := set(kinds) - set(ends):
        raise ValueError(f"no end called {sorted(lost)}: there are {sorted(ends)}")
    fig, ax = figure(6.8, 4.2)
    ax.plot(*arc[:, :2].T, **KINDS["truth"], label="true arc", zorder=5)
    for (label, end), style in zip(ends.items(), looks(list(ends)), strict=True):
        place = numbers(end, label, (3,), meaning="x, y, psi")
        style |= KINDS.get(kinds.get(label, ""), {}) | {"markevery": [1], "markersize": 8}
        ax.plot(*np.array([pose[:2], place[:2]]).T, **style, label=label)
    _vehicle(ax, pose, 0.08 * np.ptp(arc[:, :2], axis=0).max())
    ax.set(xlabel="$x$ [m]", ylabel="$y$ [m]", aspect="equal")
    ax.margins(0.1)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return fig


@styled
def end_places(panels: Mapping[str, Mapping[str, ArrayLike]]) -> Figure:
    """Where closed squares end, seen from where they began; crosses are the centres of the groups.

    Args:
        panels: title -> {label of a group: x, y at the end less the start, shape (n, 2) [m]}.

    Raises:
        ValueError: no panel, or places that are not of shape (n, 2).
    """
    if not panels:
        raise ValueError("end_places needs at least one panel: title -> {label: places}")
    fig, axes = figure(6.8, 3.6, columns=len(panels), squeeze=False, sharex=True, sharey=True)
    for ax, (title, groups) in zip(axes[0], panels.items(), strict=True):
        for colour, marker, (label, places) in zip(
            COLOURS * 3, "osD^vP" * 3, groups.items(), strict=False
        ):
            places = numbers(places, label, ("n", 2))
            ax.plot(*places.T, marker, color=colour, ms=5, alpha=0.7, label=label)
            ax.plot(*places.mean(axis=0), "+", color=colour, ms=16, mew=2, zorder=6)
        ax.plot(0, 0, "*", color=GREY, ms=12, label="start")
        ax.set(title=title, xlabel="$x$ [m]", ylabel="$y$ [m]", aspect="equal")
        ax.margins(0.15)
    handles = {h.get_label(): h for h in axes[0, 0].lines if not h.get_label().startswith("_")}
    fig.legend(handles.values(), handles, loc="outside lower center", ncols=len(handles))
    return fig


@styled
def wheeled(
    robots: Mapping[str, Sequence[tuple[float, float, float, float]]] | None = None,
) -> Figure:
    """Robots from above: where their wheels sit, which way they drive, which way they let it slide.

    Args:
        robots: title -> for each wheel x, y [m], the direction in which it drives the robot when it
            turns forwards, and the direction in which its rollers let it slide [rad]; NaN for a
            wheel without rollers. Default two sides, three omnidirectional and four mecanum
            wheels.

    Raises:
        ValueError: no robot, or a wheel that is not four numbers.
    """
    robots = _robots() if robots is None else robots
    if not robots:
        raise ValueError("wheeled needs at least one robot: title -> wheels (x, y, drive, free)")
    fig, axes = figure(6.8, 3.0, columns=len(robots), squeeze=False, sharey=True)
    farthest = 0.0
    for ax, (title, wheels) in zip(axes[0], robots.items(), strict=True):
        wheels = numbers(
            wheels, title, ("n", 4), meaning="wheels (x, y, drive, free)", finite=False
        )
        numbers(wheels[:, :3], title)
        farthest = max(farthest, _robot(ax, wheels))
        ax.set(title=title, xlabel="$x$ forward [m]", ylabel="$y$ to the left [m]", aspect="equal")
    span = (-1.65 * farthest, 1.65 * farthest)
    for ax in axes[0]:
        ax.set(xlim=span, ylim=span)
    handles = {h.get_label(): h for ax in axes[0] for h in ax.lines if h.get_label()[0] != "_"}
    fig.legend(handles.values(), handles, loc="outside lower center", ncols=len(handles))
    return fig


def _vehicle(ax: Axes, pose: NDArray, size: float) -> None:
    c, s = np.cos(pose[2]), np.sin(pose[2])
    corners = size * np.array([(-1.0, -0.7), (-1.0, 0.7), (0.2, 0.7), (0.9, 0.0), (0.2, -0.7)])
    outline = corners @ np.array([[c, s], [-s, c]]) + pose[:2]
    ax.add_patch(Polygon(outline, facecolor=PALE, edgecolor=GREY, zorder=4))


def _robots() -> dict[str, list[tuple[float, float, float, float]]]:
    ring = np.radians([0, 120, 240])
    corners = ((0.3, 0.25, 45), (0.3, -0.25, 135), (-0.3, 0.25, 135), (-0.3, -0.25, 45))
    return {
        "two sides": [(0.0, y, 0.0, np.nan) for y in (0.3, -0.3)],
        "three, omnidirectional": [
            (0.3 * np.cos(a), 0.3 * np.sin(a), a + np.pi / 2, a) for a in ring
        ],
        "four, mecanum": [(x, y, 0.0, np.radians(free)) for x, y, free in corners],
    }


def _robot(ax: Axes, wheels: NDArray) -> float:
    """Draw it; how far its farthest wheel is from the middle [m]."""
    reach = float(np.hypot(*wheels[:, :2].T).max())
    ax.add_patch(Circle((0, 0), 0.72 * reach, facecolor="#8080801a", edgecolor=GREY, zorder=1))
    for x, y, drive, free in wheels:
        along = np.array([np.cos(drive), np.sin(drive)])
        across = np.array([-along[1], along[0]])
        corners = np.array([(-1, -0.4), (1, -0.4), (1, 0.4), (-1, 0.4)]) * 0.2 * reach
        outline = corners @ np.array([along, across]) + (x, y)
        ax.add_patch(Polygon(outline, facecolor=PALE, edgecolor=GREY, zorder=2))
        _arrow(ax, (x, y), 0.62 * reach * along, "drives")
        if np.isfinite(free):
            roll = np.array([np.cos(free), np.sin(free)])
            for sign in (1, -1):
                _arrow(ax, (x, y), 0.4 * sign * reach * roll, "slides freely")
    _arrow(ax, (0, 0), (0.6 * reach, 0), "ahead")
    return reach


_ARROWS = {"drives": (BLUE, "-"), "slides freely": (GREEN, ":"), "ahead": (RED, "--")}


def _arrow(ax: Axes, start: ArrayLike, way: ArrayLike, label: str) -> None:
    end, (colour, dashes) = np.add(start, way), _ARROWS[label]
    style = {"arrowstyle": "-|>", "color": colour, "lw": 2.0, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", end, start, arrowprops=style | {"linestyle": dashes}, zorder=5)
    ax.plot(*np.array([start, end]).T, lw=0, label="_")
    ax.plot([], [], color=colour, linestyle=dashes, lw=2.0, label=label)
