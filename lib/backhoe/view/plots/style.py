"""How every figure of the course looks, and how it is shown.

A figure is a plain `matplotlib.figure.Figure`: no window, no pyplot, no global state, so it can be
drawn on a machine without a screen. Colours are the Okabe-Ito palette, which colour-blind readers
can tell apart; the background is white on light and dark pages alike. One meaning per line style:
a reference is dashed, a truth is solid and dark, an estimate is solid and coloured with its band.
"""

from collections.abc import Callable, Mapping
from functools import wraps
from io import BytesIO
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

BLUE, ORANGE, GREEN, RED = "#0072B2", "#E69F00", "#009E73", "#D55E00"
PURPLE, SKY, DARK, GREY, PALE = "#CC79A7", "#56B4E9", "#1a1a1a", "#6e6e6e", "#d9d9d9"
COLOURS = (BLUE, ORANGE, GREEN, RED, PURPLE, SKY)
LINK_COLOURS = {"boom": ORANGE, "stick": BLUE, "bucket": RED}
GROUND, STEEL = "#b08d66", "#8a8f94"

KINDS: dict[str, dict[str, Any]] = {
    "reference": {"color": GREY, "linestyle": "--", "linewidth": 1.8},
    "truth": {"color": DARK, "linestyle": "-", "linewidth": 2.0},
    "estimate": {"linestyle": "-", "linewidth": 1.8},
    "printed": {"color": RED, "linestyle": ":", "linewidth": 2.2},
}

STYLE = {
    "axes.axisbelow": True,
    "axes.edgecolor": GREY,
    "axes.grid": True,
    "axes.labelsize": 11,
    "axes.prop_cycle": matplotlib.cycler(color=COLOURS),
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 11,
    "font.size": 11,
    "grid.color": "#e6e6e6",
    "legend.fontsize": 10,
    "legend.frameon": False,
    "lines.linewidth": 1.8,
    "lines.solid_capstyle": "round",
    "xtick.labelsize": 10,
    "ytick.labelsize": 10,
}


def styled(draw: Callable) -> Callable:
    """Decorator: `draw` works in the course's style, whatever the reader's own settings are."""

    @wraps(draw)
    def drawn(*args: Any, **keywords: Any) -> Any:
        with matplotlib.rc_context():
            matplotlib.rcdefaults()
            matplotlib.rcParams.update(STYLE)
            return draw(*args, **keywords)

    return drawn


@styled
def figure(
    width: float = 6.8, height: float = 4.0, rows: int = 1, columns: int = 1, **subplots: Any
) -> tuple[Figure, Any]:
    """An empty figure of `width` x `height` [in] with its axes, as `Figure.subplots` gives them.

    Call it inside a function decorated with `styled`, or text added later looks different.
    """
    fig = Figure(figsize=(width, height), dpi=120, layout="constrained", facecolor="white")
    return fig, fig.subplots(rows, columns, **subplots)


@styled
def png(fig: Figure) -> bytes:
    """The figure as a PNG file's bytes, the same bytes for the same figure."""
    file = BytesIO()
    fig.savefig(file, format="png", metadata={"Software": None})
    return file.getvalue()


def bundle(fig: Figure, alt: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """What a notebook stores of the figure: its data and metadata, with `alt` in both.

    Raises:
        ValueError: `alt` is empty, so a reader without the picture would have nothing.
    """
    if not isinstance(alt, str) or not alt.strip():
        raise ValueError("a figure needs a text alternative: say in `alt` what it shows")
    text = " ".join(alt.split())
    return {"image/png": png(fig), "text/plain": text}, {"image/png": {"alt": text}}


def show(fig: Figure, alt: str) -> None:
    """Display the figure in the notebook, with `alt` for readers who do not see it.

    The notebook stores the picture and, as its plain text, `alt`. Outside a notebook `alt` is
    printed.

    Raises:
        ValueError: `alt` is empty.
    """
    from IPython import get_ipython
    from IPython.display import display

    data, metadata = bundle(fig, alt)
    if get_ipython() is None:
        print(data["text/plain"])
    else:
        display(data, metadata=metadata, raw=True)


@styled
def lines(
    x: ArrayLike,
    series: Mapping[str, ArrayLike],
    xlabel: str,
    ylabel: str,
    kinds: Mapping[str, str] | None = None,
    title: str = "",
    **settings: Any,
) -> Figure:
    """Curves over one axis, each with a label and, where it has one, its kind.

    Args:
        x: values of the horizontal axis, shape (n,).
        series: label -> values, each of shape (n,), or shorter to stop early.
        xlabel, ylabel: quantity with its unit, such as "time [s]".
        kinds: label -> "reference", "truth", "estimate" or "printed"; others get a colour.
        settings: passed to `Axes.set`, such as `yscale="log"`.

    Raises:
        ValueError: a kind is unknown, or a label in `kinds` has no series.
    """
    fig, ax = figure()
    draw_lines(ax, x, series, kinds)
    ax.set(xlabel=xlabel, ylabel=ylabel, title=title, **settings)
    ax.legend()
    return fig


def draw_lines(
    ax: Axes,
    x: ArrayLike,
    series: Mapping[str, ArrayLike],
    kinds: Mapping[str, str] | None = None,
) -> None:
    """The curves of `lines` in axes that are there already; same arguments and errors."""
    kinds = dict(kinds or {})
    if lost := set(kinds) - set(series):
        raise ValueError(f"no series called {sorted(lost)}: there are {sorted(series)}")
    if unknown := set(kinds.values()) - set(KINDS):
        raise ValueError(f"unknown kind {sorted(unknown)}: the kinds are {', '.join(KINDS)}")
    x = np.asarray(x, dtype=float)
    for label, values in series.items():
        y = np.asarray(values, dtype=float)
        ax.plot(x[: len(y)], y, label=label, **KINDS.get(kinds.get(label, ""), {}))
