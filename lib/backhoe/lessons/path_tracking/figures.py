"""Figures of lesson 05: a vehicle, its way-points and its goal from above; runs; radar charts."""

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Polygon
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import wrap
from backhoe.basics.inputs import numbers
from backhoe.view.plots.paths import places
from backhoe.view.plots.style import (
    BLUE,
    COLOURS,
    DARK,
    GREEN,
    GREY,
    KINDS,
    ORANGE,
    RED,
    figure,
    styled,
)


class Chart(Protocol):
    """What `radar` draws: values of each tracker in each field, 0 to 1, and what 1 stands for."""

    fields: Sequence[str]
    trackers: Sequence[str]
    values: ArrayLike
    scales: ArrayLike


@styled
def pose_errors(pose: ArrayLike, waypoint: ArrayLike, next_waypoint: ArrayLike) -> Figure:
    """The three errors of eq. (5.1): rho, Delta y and alpha, with the angle beta.

    Args:
        pose: x, y [m] and heading [rad] of the vehicle, shape (3,).
        waypoint, next_waypoint: places, shape (2,) [m].

    Raises:
        ValueError: another shape, or values that are not finite.
    """
    pose = numbers(pose, "pose", (3,))
    waypoint = numbers(waypoint, "waypoint", (2,))
    following = numbers(next_waypoint, "next_waypoint", (2,))
    fig, ax = figure(6.8, 4.0)
    place, theta = pose[:2], pose[2]
    ahead = _axes_of(theta)[0]
    foot = place + (waypoint - place) @ ahead * ahead
    ax.plot(*np.array([waypoint, following]).T, **KINDS["reference"])
    ax.plot(*np.array([waypoint, following]).T, "o", color=DARK, ms=7, zorder=5)
    for point, name in ((waypoint, "$WP_n$"), (following, "$WP_{n+1}$")):
        ax.annotate(name, point, (-8, 6), textcoords="offset points", va="bottom", ha="right")
    _dimension(ax, place, waypoint, r"$\rho$", BLUE)
    _dimension(ax, foot, waypoint, r"$\Delta y$", RED)
    reach = 1.08 * max(np.linalg.norm(foot - place), 0.5)
    ax.plot(*np.array([place, place + reach * ahead]).T, color=GREY, lw=1.0)
    ax.annotate("$x$ of the vehicle", place + reach * ahead, (4, -12), textcoords="offset points")
    _angle(ax, place, theta, _bearing(waypoint - place), 0.8, r"$\beta$", BLUE)
    size = 0.5 * np.linalg.norm(following - waypoint)
    ax.plot(*np.array([waypoint, waypoint + 1.3 * size * ahead]).T, color=GREY, lw=1.0)
    _angle(ax, waypoint, theta, _bearing(following - waypoint), size, r"$\alpha$", GREEN)
    _vehicle(ax, pose, 0.5)
    ax.set(xlabel="$X$ [m]", ylabel="$Y$ [m]", aspect="equal")
    ax.margins(0.12)
    return fig


@styled
def nearest(actual: ArrayLike, path: ArrayLike, distances: ArrayLike) -> Figure:
    """A run with a circle about each point that just touches the path, as the source's Fig. 5.2.

    Args:
        actual: points of the run, shape (n, 2) [m].
        path: way-points, shape (m, 2) [m].
        distances: of each point to the path, shape (n,) [m].

    Raises:
        ValueError: another shape, or as many distances as there are points were not given.
    """
    points = places(actual, "actual")
    radii = numbers(distances, "distances", (len(points),))
    fig, ax = figure(6.8, 3.2)
    ax.plot(*places(path, "path").T, **KINDS["reference"], label="path")
    ax.plot(*places(path, "path").T, "o", color=GREY, ms=5, label="way-points")
    circles = [Circle(point, radius) for point, radius in zip(points, radii, strict=True)]
    ax.add_collection(PatchCollection(circles, facecolor=BLUE, edgecolor=BLUE, alpha=0.16))
    ax.plot(*points.T, "-o", color=BLUE, ms=4, label="run")
    ax.set(xlabel="$x$ [m]", ylabel="$y$ [m]", aspect="equal")
    ax.margins(0.08)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return fig


@styled
def pursuit(
    pose: ArrayLike, path: ArrayLike, foot: ArrayLike, target: ArrayLike, curvature: float
) -> Figure:
    """Pure pursuit: the nearest point, the point ahead and the arc that leads there.

    Args:
        pose: x, y [m] and heading [rad], shape (3,).
        path: way-points, shape (n, 2) [m].
        foot, target: nearest point of the path and the point to steer to, shape (2,) [m].
        curvature: of the arc, positive to the left [1/m].

    Raises:
        ValueError: another shape, or values that are not finite.
    """
    pose = numbers(pose, "pose", (3,))
    foot, target = numbers(foot, "foot", (2,)), numbers(target, "target", (2,))
    fig, ax = figure(6.8, 3.8)
    ax.plot(*places(path, "path").T, **KINDS["reference"], label="path")
    ax.plot(*np.array([pose[:2], foot]).T, ":", color=GREY)
    ax.plot(*_arc(pose, target, curvature).T, color=BLUE, lw=2.4, label="arc")
    ahead = _axes_of(pose[2])[0]
    beside = pose[:2] + (target - pose[:2]) @ ahead * ahead
    ax.plot(*np.array([pose[:2], beside]).T, color=GREY, lw=1.0)
    _dimension(ax, target, beside, "$y_L$", RED)
    _dimension(ax, pose[:2], target, "$d$", GREEN)
    ax.plot(*foot, "s", color=DARK, ms=6, label="nearest point")
    ax.plot(*target, "o", color=ORANGE, mec=DARK, ms=9, label="point ahead", zorder=6)
    _vehicle(ax, pose, 0.35)
    ax.set(xlabel="$x$ [m]", ylabel="$y$ [m]", aspect="equal")
    ax.margins(0.1)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return fig


@styled
def radar(charts: Mapping[str, Chart], labels: Mapping[str, str] | None = None) -> Figure:
    """Radar charts, one panel a path: every measure over its worst value, smaller is better.

    Args:
        charts: title -> what `tracking.compare(...).radar(path)` gives.
        labels: field -> how an axis is written; others are written as they are.

    Raises:
        ValueError: no chart, or its values are not one for each tracker and field.
    """
    if not charts:
        raise ValueError("nothing to draw: give a title and a chart for each panel")
    columns = min(len(charts), 2)
    rows = -(-len(charts) // columns)
    spare = rows * columns - len(charts)
    fig, axes = figure(
        6.8,
        2.75 * rows + (0.0 if spare else 0.6),
        rows,
        columns,
        squeeze=False,
        subplot_kw={"projection": "polar"},
    )
    for ax, (title, chart) in zip(axes.flat, charts.items(), strict=False):
        _spokes(ax, title, chart, labels or {})
    handles = axes.flat[0].get_legend_handles_labels()
    if spare:
        axes.flat[-1].axis("off")
        axes.flat[-1].legend(*handles, loc="center", fontsize=11)
    else:
        fig.legend(*handles, loc="outside lower center", ncols=3)
    return fig


def _spokes(ax: Axes, title: str, chart: Chart, labels: Mapping[str, str]) -> None:
    values = np.asarray(chart.values, dtype=float)
    if values.shape != (len(chart.trackers), len(chart.fields)):
        raise ValueError(
            f"{title}: {len(chart.trackers)} trackers and {len(chart.fields)} fields need values "
            f"of that shape, got {values.shape}"
        )
    angles = np.linspace(0.0, 2 * np.pi, len(chart.fields), endpoint=False)
    for tracker, row, colour in zip(chart.trackers, values, COLOURS * 3, strict=False):
        ax.plot([*angles, angles[0]], [*row, row[0]], "-o", color=colour, ms=3, label=tracker)
    names = [
        f"{labels.get(field, field)}\n{scale:.2g}"
        for field, scale in zip(chart.fields, chart.scales, strict=True)
    ]
    ax.set_xticks(angles, names, size=9)
    for angle, name in zip(angles, ax.get_xticklabels(), strict=True):
        name.set_ha("center" if abs(np.sin(angle)) < 0.1 else "right" if angle < np.pi else "left")
    ax.tick_params(axis="x", pad=1)
    ax.set_yticks([0.5, 1.0], ["", ""])
    ax.set(ylim=(0.0, 1.05), theta_offset=np.pi / 2)
    ax.set_title(title, weight="bold")


def _bearing(way: NDArray) -> float:
    return float(np.arctan2(way[1], way[0]))


def _axes_of(theta: float) -> NDArray:
    return np.array([[np.cos(theta), np.sin(theta)], [-np.sin(theta), np.cos(theta)]])


def _dimension(ax: Axes, start: NDArray, end: NDArray, text: str, colour: str) -> None:
    arrow = {"arrowstyle": "<->", "color": colour, "lw": 1.6, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", end, start, arrowprops=arrow)
    along = end - start
    aside = np.array([-along[1], along[0]]) / max(np.linalg.norm(along), 1e-9)
    ax.annotate(
        text, (start + end) / 2, 12 * aside, textcoords="offset points", color=colour,
        ha="center", va="center", size=12,
    )  # fmt: skip


def _angle(
    ax: Axes, at: NDArray, start: float, end: float, radius: float, text: str, colour: str
) -> None:
    turn = wrap(end - start)
    low, high = np.degrees(sorted((start, start + turn)))
    ax.add_patch(Arc(at, 2 * radius, 2 * radius, theta1=low, theta2=high, color=colour, lw=1.6))
    middle = start + turn / 2
    ax.text(
        *(at + 1.22 * radius * np.array([np.cos(middle), np.sin(middle)])), text, color=colour,
        ha="center", va="center", size=12,
    )  # fmt: skip


def _vehicle(ax: Axes, pose: NDArray, length: float) -> None:
    turn = _axes_of(pose[2])
    box = np.array([(-1, -0.6), (1, -0.6), (1, 0.6), (-1, 0.6)]) * length / 2
    nose = np.array([(0.35, 0.3), (0.35, -0.3), (0.95, 0.0)]) * length / 2
    for outline, colour in ((box, "#f2c14e"), (nose, DARK)):
        ax.add_patch(Polygon(outline @ turn + pose[:2], facecolor=colour, edgecolor=DARK, zorder=4))


def _arc(pose: NDArray, target: NDArray, curvature: float, count: int = 60) -> NDArray:
    """The arc from the pose that is `curvature` curved, as far as the target."""
    way = target - pose[:2]
    if abs(curvature) < 1e-9:
        return np.array([pose[:2], target])
    angle = 2 * (_bearing(way) - pose[2])
    angle = (angle + 2 * np.pi) % (4 * np.pi) - 2 * np.pi
    turned = np.linspace(0.0, angle, count)
    ahead, left = _axes_of(pose[2])
    x, y = np.sin(turned) / curvature, (1 - np.cos(turned)) / curvature
    return pose[:2] + x[:, None] * ahead + y[:, None] * left
