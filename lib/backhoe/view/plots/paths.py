"""Drives seen from above."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers
from backhoe.view.plots.style import GREEN, KINDS, PURPLE, RED, figure, looks, styled


@styled
def from_above(
    scenes: Mapping[str, Mapping[str, ArrayLike]],
    reference: str = "path",
    columns: int = 0,
    marks: Mapping[str, ArrayLike] | None = None,
    kinds: Mapping[str, str] | None = None,
    height: float | None = None,
) -> Figure:
    """Paths and runs from above, one panel a scene.

    Args:
        scenes: title of a panel -> {label: points or poses, shape (n, 2) or (n, 3) [m]}.
        reference: label of what is drawn dashed.
        columns: panels in a row; 0 for all of them.
        marks: label -> places marked in every panel, shape (n, 2) [m].
        kinds: label -> "reference", "truth", "estimate" or "printed"; others get a colour.
        height: of the figure [in].

    Raises:
        ValueError: no scene, or a line that is not of shape (n, 2) or (n, 3).
    """
    if not scenes:
        raise ValueError("nothing to draw: give a title and {label: points} for each panel")
    columns = columns or len(scenes)
    rows = -(-len(scenes) // columns)
    fig, axes = figure(6.8, height or 6.4 / columns * rows + 0.6, rows, columns, squeeze=False)
    labels = list(dict.fromkeys(label for lines in scenes.values() for label in lines))
    coloured = [label for label in labels if label != reference and label not in (kinds or {})]
    styles = dict(zip(coloured, looks(coloured), strict=True))
    for ax, (title, lines) in zip(axes.flat, scenes.items(), strict=False):
        for label, points in lines.items():
            kind = "reference" if label == reference else (kinds or {}).get(label, "")
            style = styles[label] if label in styles else KINDS[kind]
            ax.plot(*places(points, label).T, label=label, **style)
        for mark, colour, (label, points) in zip(
            "oXP" * 3, (RED, PURPLE, GREEN) * 3, (marks or {}).items(), strict=False
        ):
            ax.plot(*places(points, label).T, mark, color=colour, ms=6, label=label, zorder=6)
        ax.set(title=title, xlabel="$x$ [m]", ylabel="$y$ [m]", aspect="equal")
        ax.margins(0.08)
    for ax in axes.flat[len(scenes) :]:
        ax.axis("off")
    handles = {h.get_label(): h for ax in axes.flat for h in ax.lines}
    fig.legend(handles.values(), handles, loc="outside lower center", ncols=min(len(handles), 5))
    return fig


def places(points: ArrayLike, name: str) -> NDArray:
    """x, y of points or poses, shape (n, 2) [m]; ValueError if there are no such two columns."""
    array = numbers(points, name, ("n", "m"), meaning="rows of x, y", finite=False)
    if array.shape[1] < 2:
        raise ValueError(f"{name} must be of shape (n, 2) or wider, got shape {array.shape}")
    return array[:, :2]


@styled
def paths(
    drives: Mapping[str, ArrayLike],
    kinds: Mapping[str, str] | None = None,
    marks: int = 7,
    title: str = "",
) -> Figure:
    """Drives seen from above, with small arrows that show where the vehicle heads.

    Args:
        drives: label -> poses x, y [m] and heading [rad], shape (n, 3).
        kinds: label -> "reference", "truth", "estimate" or "printed"; others get a colour.
        marks: arrows on each drive.

    Raises:
        ValueError: poses that are not of shape (n, 3), or a kind of no drive.
    """
    kinds = dict(kinds or {})
    if lost := set(kinds) - set(drives):
        raise ValueError(f"no drive called {sorted(lost)}: there are {sorted(drives)}")
    fig, ax = figure(6.8, 5.0)
    styles = iter(looks([label for label in drives if label not in kinds]))
    for label, poses in drives.items():
        poses = numbers(poses, f"the drive {label!r}", ("n", 3), meaning="poses x, y, heading")
        style = KINDS[kinds[label]] if label in kinds else next(styles)
        (line,) = ax.plot(*poses[:, :2].T, label=label, **style)
        for index in np.linspace(0, len(poses) - 1, marks).astype(int):
            _arrowhead(ax, poses[index], line.get_color())
    ax.set(xlabel="$x$ [m]", ylabel="$y$ [m]", aspect="equal", title=title)
    ax.margins(0.08)
    fig.legend(loc="outside lower center", ncols=2)
    return fig


def _arrowhead(ax: Axes, pose: NDArray, colour: str) -> None:
    direction = np.degrees(pose[2]) - 90.0
    ax.plot(
        *pose[:2], marker=(3, 0, direction), ms=10, color=colour, mec="white", mew=0.8, zorder=5
    )
