"""Figures of lesson 07: beliefs, errors in their bands, drives with ellipses, honesty, clouds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers
from backhoe.view.plots.paths import places
from backhoe.view.plots.style import BLUE, COLOURS, DARK, GREY, KINDS, ORANGE, PALE, figure, styled

__all__ = ["beliefs", "clouds", "consistency", "drives_with_ellipses", "tunnels"]


@styled
def beliefs(
    panels: Mapping[str, ArrayLike], there: Sequence[int] | None = None, marked: ArrayLike = ()
) -> Figure:
    """Probabilities of places as bars, one panel above another.

    Args:
        panels: title -> probability of each place, shape (n,) [1].
        there: for each panel, the place where the machine truly is; None draws none.
        marked: places that look alike to the sensor; shaded.

    Raises:
        ValueError: no panel, another number of places in one, or of true places than of panels.
    """
    drawn = {title: numbers(values, title, ("n",)) for title, values in panels.items()}
    if not drawn or len({len(values) for values in drawn.values()}) > 1:
        raise ValueError("beliefs needs panels of one length: title -> probabilities (n,)")
    if there is not None and len(there) != len(drawn):
        raise ValueError(f"there must name a place for each of {len(drawn)} panels, got {there}")
    fig, axes = figure(6.8, 0.7 + 1.15 * len(drawn), len(drawn), squeeze=False, sharex=True)
    top = 1.15 * max(values.max() for values in drawn.values())
    for row, (ax, (title, values)) in enumerate(zip(axes[:, 0], drawn.items(), strict=True)):
        for place in np.asarray(marked, dtype=int):
            ax.axvspan(place - 0.5, place + 0.5, color=PALE, zorder=0)
        ax.bar(np.arange(len(values)), values, color=BLUE, width=0.8)
        if there is not None:
            ax.plot(there[row], 0.9 * top, "v", color=DARK, ms=8)
        ax.set(ylim=(0, top))
        ax.set_title(title, loc="left", fontsize=10)
    fig.supylabel("probability [1]", fontsize=11)
    axes[-1, 0].set(xlabel="place [1]", xticks=np.arange(len(values)))
    return fig


@styled
def tunnels(
    time: ArrayLike,
    panels: Mapping[str, Mapping[str, tuple[ArrayLike, ArrayLike]]],
    xlabel: str = "time [s]",
    **settings: object,
) -> Figure:
    """Errors within the bands that their estimators claim, plus and minus two deviations.

    Args:
        time: shape (n,) [s], or what `xlabel` says.
        panels: label of the vertical axis with its unit -> {label: (errors, deviations)}; errors
            of shape (n,), or (runs, n) for many thin lines; deviations of shape (n,).
        settings: passed to `Axes.set` of every panel.

    Raises:
        ValueError: no panel, or errors and deviations that do not fit the time.
    """
    time = numbers(time, "time", ("n",))
    if not panels:
        raise ValueError("tunnels needs a panel: ylabel -> {label: (errors, deviations)}")
    fig, axes = figure(6.8, 1.2 + 2.2 * len(panels), len(panels), squeeze=False, sharex=True)
    for ax, (ylabel, series) in zip(axes[:, 0], panels.items(), strict=True):
        for place, (label, (errors, deviations)) in enumerate(series.items()):
            _tunnel(ax, time, label, errors, deviations, COLOURS[place % len(COLOURS)])
        ax.set(ylabel=ylabel, **settings)
        ax.legend(fontsize=9, loc="upper left")
    axes[-1, 0].set_xlabel(xlabel)
    return fig


@styled
def consistency(
    time: Mapping[str, ArrayLike],
    values: Mapping[str, ArrayLike],
    band: tuple[float, float],
    ylabel: str,
    kinds: Mapping[str, str] | None = None,
    title: str = "",
) -> Figure:
    """NEES or NIS over time on a logarithmic axis, and the band of an honest filter.

    Args:
        time: label -> shape (n,) [s].
        values: label -> shape (n,), above 0.
        band: where an honest filter lies in 95 % of the instants.
        ylabel: what it is, with its unit.
        kinds: label -> "printed" and so on; others get a colour.

    Raises:
        ValueError: times and values of other labels or lengths, or a kind of no curve.
    """
    kinds = dict(kinds or {})
    if set(time) != set(values) or set(kinds) - set(values):
        raise ValueError(
            f"time, values and kinds must have the same labels, got {sorted(time)}, "
            f"{sorted(values)} and {sorted(kinds)}"
        )
    fig, ax = figure(6.8, 4.0)
    ax.axhspan(*band, color=PALE, zorder=0, label="95 % of an honest filter")
    for label, curve in values.items():
        t, y = numbers(time[label], label, ("n",)), numbers(curve, label, ("n",), finite=False)
        if len(t) != len(y):
            raise ValueError(f"{label!r} has {len(t)} times and {len(y)} values")
        ax.plot(t, y, label=label, **{"linewidth": 1.4, **KINDS.get(kinds.get(label, ""), {})})
    ax.set(yscale="log", xlabel="time [s]", ylabel=ylabel, title=title)
    fig.legend(loc="outside lower center", ncols=2)
    return fig


@styled
def drives_with_ellipses(
    truth: ArrayLike,
    estimates: Mapping[str, tuple[ArrayLike, ArrayLike | None]],
    marks: Sequence[int],
    kinds: Mapping[str, str] | None = None,
    title: str = "",
) -> Figure:
    """A drive from above: the truth, estimates of it, and where each claims to be, to 95 %.

    Args:
        truth: poses or places, shape (n, 2) or more columns [m].
        estimates: label -> (poses (n, 2...) [m], covariances (n, 2..., 2...) [m^2] or None).
        marks: indices at which the ellipses are drawn, and a dot on the truth.
        kinds: label -> "estimate", "printed" and so on; others get a colour.

    Raises:
        ValueError: shapes that do not fit, or a kind of no estimate.
    """
    truth, kinds = places(truth, "truth"), dict(kinds or {})
    if lost := set(kinds) - set(estimates):
        raise ValueError(f"no estimate called {sorted(lost)}: there are {sorted(estimates)}")
    fig, ax = figure(6.8, 5.0)
    ax.plot(*truth.T, label="truth", **KINDS["truth"])
    for label, (poses, covariances) in estimates.items():
        poses = places(poses, label)
        style = KINDS.get(kinds.get(label, ""), {})
        (line,) = ax.plot(*poses.T, label=label, **{"linewidth": 1.5, **style})
        if covariances is not None:
            for mark in marks:
                _ellipse(ax, poses[mark], np.asarray(covariances)[mark], line.get_color())
    ax.plot(*truth[list(marks)].T, "o", color=DARK, ms=5, zorder=6)
    ax.set(xlabel="$x$ [m]", ylabel="$y$ [m]", aspect="equal", title=title)
    ax.margins(0.06)
    fig.legend(loc="outside lower center", ncols=3)
    return fig


@styled
def clouds(
    points: ArrayLike,
    ellipses: Mapping[str, tuple[ArrayLike, ArrayLike]],
    label: str = "particles",
    title: str = "",
) -> Figure:
    """A cloud of places, and the ellipses in which filters claim 95 % of it.

    Args:
        points: shape (n, 2) or more columns [m].
        ellipses: label -> (mean (2...), covariance (2..., 2...)) [m, m^2].
        label: of the cloud.

    Raises:
        ValueError: points that are not rows of two numbers or more.
    """
    points = places(points, "points")
    fig, ax = figure(6.8, 4.6)
    ax.plot(*points.T, ".", color=GREY, ms=3, alpha=0.5, label=label)
    for place, (name, (mean, P)) in enumerate(ellipses.items()):
        colour = (BLUE, ORANGE, *COLOURS[2:])[place]
        _ellipse(ax, np.asarray(mean)[:2], np.asarray(P), colour, 2.2, name)
        ax.plot(*np.asarray(mean)[:2], "P", color=colour, mec=DARK, ms=9)
    ax.set(xlabel="$x$ [m]", ylabel="$y$ [m]", aspect="equal", title=title)
    fig.legend(loc="outside lower center", ncols=3)
    return fig


def _tunnel(
    ax: Axes, time: NDArray, label: str, errors: ArrayLike, deviations: ArrayLike, colour: str
) -> None:
    errors, deviations = np.asarray(errors, float), np.asarray(deviations, float)
    if errors.shape[-1:] != time.shape or deviations.shape != time.shape or errors.ndim > 2:
        raise ValueError(
            f"{label!r} needs errors (n,) or (runs, n) and deviations (n,) for n = {len(time)}, "
            f"got {errors.shape} and {deviations.shape}"
        )
    ax.fill_between(time, -2 * deviations, 2 * deviations, color=colour, alpha=0.22, lw=0)
    thin = errors.ndim > 1
    drawn = ax.plot(time, errors.T, color=colour, lw=0.7 if thin else 1.5, alpha=0.6 if thin else 1)
    drawn[0].set_label(label)


def _ellipse(
    ax: Axes,
    mean: NDArray,
    P: NDArray,
    colour: str,
    width: float = 1.2,
    label: str | None = None,
) -> None:
    from backhoe.localisation.kalman import ellipse

    outline = ellipse(mean, P[:2, :2])
    ax.fill(*outline.T, facecolor=colour, alpha=0.12, zorder=2)
    ax.plot(*outline.T, color=colour, lw=width, label=label, zorder=3)
