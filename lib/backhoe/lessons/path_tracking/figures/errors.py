"""A vehicle, its way-points and the point that it aims at, from above."""

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
    DARK,
    GREEN,
    GREY,
    KINDS,
    ORANGE,
    PURPLE,
    RED,
    figure,
    styled,
)


@styled
def pose_errors(pose: ArrayLike, waypoint: ArrayLike, next_waypoint: ArrayLike) -> Figure:
    """The three errors of a pose: rho, Delta y and alpha, with the angle beta.

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
    ax.plot(*np.array([waypoint, following]).T, "o", color=PURPLE, ms=7, zorder=5)
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
    """A run with a circle about each point that just touches the path.

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
    ax.plot(*foot, "s", color=PURPLE, ms=6, label="nearest point")
    ax.plot(*target, "o", color=ORANGE, ms=9, label="point ahead", zorder=6)
    _vehicle(ax, pose, 0.35)
    ax.set(xlabel="$x$ [m]", ylabel="$y$ [m]", aspect="equal")
    ax.margins(0.1)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return fig


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
