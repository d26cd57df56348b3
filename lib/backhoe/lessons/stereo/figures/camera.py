"""Figures of lesson 08a: pictures with what lies on them, residuals, and how boards pay."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers
from backhoe.basics.inputs import picture as grey
from backhoe.view.plots.style import BLUE, COLOURS, GREY, ORANGE, figure, styled

__all__ = ["boards", "pictures", "residuals"]

_COLOURS = (ORANGE, BLUE, *COLOURS[2:])


@styled
def pictures(
    panels: Mapping[str, NDArray],
    marks: Sequence[Mapping[str, ArrayLike]] = (),
    lines: Sequence[Mapping[str, Sequence[ArrayLike]]] = (),
) -> Figure:
    """Grey pictures beside each other, with marks and lines on them.

    Args:
        panels: title -> picture, shape (height, width), uint8 [grey levels].
        marks: for each panel, label -> places, shape (n, 2) [pixels].
        lines: for each panel, label -> polylines, each of shape (n, 2) [pixels].

    Raises:
        ValueError: no picture, a panel that is none, or a place of another shape.
    """
    if not panels:
        raise ValueError("nothing to draw: give a title and a picture for each panel")
    height, width = np.shape(next(iter(panels.values())))[:2]
    legend = 0.35 if any(map(len, (*marks, *lines))) else 0.0
    across = 6.2 / len(panels) if len(panels) > 1 else 5.6
    tall = 0.5 + across * height / width + legend
    fig, axes = figure(across * len(panels), tall, 1, len(panels), squeeze=False, sharey=True)
    labels = list(dict.fromkeys(label for of in (*marks, *lines) for label in of))
    for k, (ax, (title, image)) in enumerate(zip(axes[0], panels.items(), strict=True)):
        ax.imshow(grey(image, title), cmap="gray", vmin=0, vmax=255)
        for label, places in (marks[k] if marks else {}).items():
            u, v = numbers(places, label, ("n", 2), meaning="columns and rows [pixels]").T
            colour = _COLOURS[labels.index(label)]
            ax.plot(u, v, "o", color=colour, mec="white", mew=0.7, ms=4.5, label=label)
        for label, each in (lines[k] if lines else {}).items():
            for number, line in enumerate(each):
                u, v = numbers(line, label, ("n", 2), meaning="columns and rows [pixels]").T
                ax.plot(
                    u,
                    v,
                    color=_COLOURS[labels.index(label)],
                    lw=1.3,
                    label="_" * (number > 0) + label,
                )
        ax.set(title=title, xlabel="column [pixels]", xlim=(-0.5, width - 0.5))
        ax.set(ylim=(height - 0.5, -0.5))
        ax.grid(False)
    axes[0, 0].set_ylabel("row [pixels]")
    handles = {line.get_label(): line for ax in axes[0] for line in ax.lines}
    shown = {label: line for label, line in handles.items() if label[0] != "_"}
    if shown:
        fig.legend(shown.values(), shown, loc="outside lower center", ncols=len(shown))
    return fig


@styled
def residuals(panels: Mapping[str, ArrayLike]) -> Figure:
    """Where corners are seen, less where the calibrated camera puts them, one panel a set.

    Args:
        panels: title -> errors across and down, shape (n, 2) [pixels].

    Raises:
        ValueError: no panel, or errors of another shape.
    """
    sets = {title: numbers(errors, title, ("n", 2)) for title, errors in panels.items()}
    if not sets:
        raise ValueError("nothing to draw: give a title and errors for each panel")
    fig, axes = figure(6.8, 4.1, 1, len(sets), squeeze=False, sharex=True, sharey=True)
    turn = np.linspace(0.0, 2 * np.pi, 91)
    most = 1.05 * max(np.abs(errors).max() for errors in sets.values())
    for ax, (title, errors) in zip(axes[0], sets.items(), strict=True):
        rms = np.sqrt((errors**2).sum(axis=1).mean())
        ax.plot(*errors.T, ".", color=BLUE, ms=3, alpha=0.5, label="corners")
        ax.plot(rms * np.cos(turn), rms * np.sin(turn), color=ORANGE, label="root mean square")
        ax.set(title=title, xlabel="across [pixels]", xlim=(-most, most), ylim=(-most, most))
        ax.set_aspect("equal")
    axes[0, 0].set_ylabel("down [pixels]")
    fig.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return fig


@styled
def boards(counts: ArrayLike, errors: ArrayLike, said: ArrayLike) -> Figure:
    """Error of a calibrated focal length over the number of boards, and what it says of itself.

    Args:
        counts: boards in a calibration, shape (n,).
        errors: of several calibrations with that many, shape (n, runs) [pixels].
        said: standard deviation that the calibrations give themselves, shape (n,) [pixels].

    Raises:
        ValueError: shapes.
    """
    counts = numbers(counts, "counts", ("n",), meaning="numbers of boards")
    errors = numbers(errors, "errors", (len(counts), "runs"), meaning="errors [pixels]")
    said = numbers(said, "said", (len(counts),), meaning="standard deviations [pixels]")
    fig, ax = figure(6.8, 3.8)
    each = np.repeat(counts, errors.shape[1])
    ax.plot(each, np.abs(errors).ravel(), "x", color=GREY, ms=4, alpha=0.6, label="one calibration")
    happened = np.sqrt((errors**2).mean(axis=1))
    ax.plot(counts, happened, "o-", color=BLUE, label="root mean square of these")
    ax.plot(counts, said, "s--", color=ORANGE, label="deviation that they give themselves")
    ax.set(xlabel="boards [1]", ylabel="error of $f_x$ [pixels]", yscale="log")
    ax.legend()
    return fig
