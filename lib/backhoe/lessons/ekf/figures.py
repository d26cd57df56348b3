"""Figures of lesson 07: beliefs, errors in their bands, drives with ellipses, honesty, clouds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers
from backhoe.view.plots.paths import places
from backhoe.view.plots.style import BLUE, DARK, KINDS, LOOKS, PALE, figure, looks, styled

__all__ = ["beliefs", "clouds", "consistency", "drives_with_ellipses", "promises", "tunnels"]


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
        ax.set(ylim=(0, top), xlabel="place [1]", ylabel="belief [1]")
        ax.set_title(title, loc="left", fontsize=10)
    _outside(axes[:, 0])
    axes[-1, 0].set(xticks=np.arange(len(values)))
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
        for (label, (errors, deviations)), look in zip(series.items(), looks(series), strict=True):
            _tunnel(ax, time, label, errors, deviations, look)
        ax.set(xlabel=xlabel, ylabel=ylabel, **settings)
        ax.legend(fontsize=9, loc="upper left", ncols=2 * len(series))
    _outside(axes[:, 0])
    return fig


@styled
def promises(
    time: ArrayLike, panels: Mapping[str, tuple[ArrayLike, ArrayLike]], ylabel: str
) -> Figure:
    """What deviation filters claim over time, and what happened to their errors, a panel each.

    Args:
        time: shape (n,) [s].
        panels: name of a filter -> (what happened, what it claims), shape (n,) each.
        ylabel: quantity with its unit.

    Raises:
        ValueError: no panel, or values that do not fit the time.
    """
    time = numbers(time, "time", ("n",))
    if not panels:
        raise ValueError("promises needs a panel: name -> (happened, claimed)")
    fig, axes = figure(6.8, 3.4, 1, len(panels), squeeze=False, sharey=True)
    for ax, (name, (happened, claimed)) in zip(axes[0], panels.items(), strict=True):
        happened, claimed = (numbers(one, name, time.shape) for one in (happened, claimed))
        ax.plot(time, happened, label="happened", **KINDS["truth"])
        ax.plot(time, claimed, label="claimed", **looks(["EKF"])[0])
        ax.set(title=name, xlabel="time [s]", ylabel=ylabel)
    fig.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
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
    own = iter(looks([label for label in values if label not in kinds]))
    for label, curve in values.items():
        t, y = numbers(time[label], label, ("n",)), numbers(curve, label, ("n",), finite=False)
        if len(t) != len(y):
            raise ValueError(f"{label!r} has {len(t)} times and {len(y)} values")
        ax.plot(t, y, label=label, **(KINDS[kinds[label]] if label in kinds else next(own)))
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
    at = list(marks)
    ax.plot(*truth.T, label="truth", marker="o", ms=5, markevery=at, **KINDS["truth"])
    own = iter(looks([label for label in estimates if label not in kinds]))
    for label, (poses, covariances) in estimates.items():
        poses = places(poses, label)
        look = KINDS[kinds[label]] if label in kinds else next(own)
        (line,) = ax.plot(*poses.T, label=label, **look)
        if covariances is not None:
            for mark in at:
                _ellipse(ax, poses[mark], np.asarray(covariances)[mark], line.get_color())
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
    ax.plot(*points.T, ".", color=LOOKS["particles"][0], ms=3, alpha=0.35, label=label)
    for (name, (mean, P)), look in zip(ellipses.items(), looks(ellipses), strict=True):
        mean, P = (np.round(array, 9) + 0.0 for array in (mean, P))  # a mark snaps to a pixel
        mean, mark = mean[:2], look.get("marker", "o")
        _ellipse(ax, mean, P, look["color"], 2.2)
        ax.plot(*mean, mark, color=look["color"], mec="white", ms=9, label=f"{name}, 95 %")
    ax.set(xlabel="$x$ [m]", ylabel="$y$ [m]", aspect="equal", title=title)
    fig.legend(loc="outside lower center", ncols=3)
    return fig


def _outside(axes: Sequence[Axes]) -> None:
    """The common horizontal axis has its label below the last panel alone."""
    for ax in axes[:-1]:
        ax.xaxis.label.set_visible(False)


def _tunnel(
    ax: Axes,
    time: NDArray,
    label: str,
    errors: ArrayLike,
    deviations: ArrayLike,
    look: Mapping[str, object],
) -> None:
    errors, deviations = np.asarray(errors, float), np.asarray(deviations, float)
    if errors.shape[-1:] != time.shape or deviations.shape != time.shape or errors.ndim > 2:
        raise ValueError(
            f"{label!r} needs errors (n,) or (runs, n) and deviations (n,) for n = {len(time)}, "
            f"got {errors.shape} and {deviations.shape}"
        )
    thin = {"lw": 0.7, "alpha": 0.6} if errors.ndim > 1 else {}
    drawn = ax.plot(time, errors.T, **{**look, **thin})
    drawn[0].set_label(label)
    band = {"color": look["color"], "alpha": 0.22, "lw": 0, "label": "2 sigma claimed"}
    ax.fill_between(time, -2 * deviations, 2 * deviations, **band)


def _ellipse(
    ax: Axes,
    mean: NDArray,
    P: NDArray,
    colour: str,
    width: float = 1.2,
) -> None:
    from backhoe.localisation.kalman import ellipse

    outline = ellipse(mean, P[:2, :2])
    ax.fill(*outline.T, facecolor=colour, alpha=0.12, zorder=2)
    ax.plot(*outline.T, color=colour, lw=width, zorder=3)
