"""How every figure of the course looks, and how it is shown.

A figure is a plain `matplotlib.figure.Figure`: no window, no pyplot, no global state, so it can be
drawn on a machine without a screen. Colours are the Okabe-Ito palette, which colour-blind readers
can tell apart; the background is transparent, and words are of a grey for light and dark pages.
One meaning per look: a reference is dashed, a truth is solid and black and nothing else is black,
an estimate is solid and coloured with its band. What has a name in `LOOKS` has its colour and its
marker in all figures of the course: the marker tells it where colours do not print.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from io import BytesIO
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import Normal, Stroke
from numpy.typing import ArrayLike

from backhoe.view.plots.told import told

BLUE, ORANGE, GREEN, RED = "#0072B2", "#E69F00", "#009E73", "#D55E00"
PURPLE, SKY, DARK, GREY, PALE = "#CC79A7", "#56B4E9", "#1a1a1a", "#707070", "#d9d9d9"
BROWN = "#8b5a2b"
COLOURS = (BLUE, ORANGE, GREEN, RED, PURPLE, SKY)
MARKERS = "os^DvP"
GROUND, STEEL = "#b08d66", "#8a8f94"
SHARP, QUICK = 200, 120
"""Dots per inch of a figure in a notebook, and of one that moves with a slider."""

MANY = 300_000
"""Details, pixels or hundredths of a face, from which on a figure is drawn at `QUICK`."""

GRAMMAR = {
    "joints": {
        "swing": (PURPLE, "s"),
        "boom": (ORANGE, "o"),
        "stick": (BLUE, "^"),
        "bucket": (RED, "D"),
    },
    "controllers of a joint": {
        "pid": (BLUE, "o"),
        "pid+gravity": (ORANGE, "s"),
        "computed_torque": (GREEN, "^"),
    },
    "controllers of a path": {
        "P": (SKY, "v"),
        "PI": (BLUE, "o"),
        "Scaglia v1": (ORANGE, "s"),
        "Scaglia v2": (GREEN, "^"),
        "Scaglia v3": (RED, "D"),
        "pure pursuit": (PURPLE, "P"),
        "mine": (BROWN, "*"),
    },
    "rules of odometry": {
        "Euler": (ORANGE, "v"),
        "midpoint": (GREEN, "s"),
        "Runge-Kutta": (PURPLE, "^"),
        "exact arc": (BLUE, "o"),
    },
    "robots on wheels": {
        "linear model": (SKY, "v"),
        "loose wheels": (ORANGE, "s"),
        "stiff wheels": (BLUE, "o"),
        "faster rims": (GREEN, "^"),
        "all driven": (PURPLE, "P"),
        "front driven": (RED, "D"),
    },
    "tracks": {"left track": (ORANGE, "s"), "right track": (BLUE, "o")},
    "integrators": {
        "explicit Euler": (RED, "v"),
        "semi-implicit Euler": (BLUE, "o"),
        "symplectic Euler": (GREEN, "s"),
        "trapezoid": (ORANGE, "^"),
        "RK4": (PURPLE, "D"),
    },
    "filters": {
        "odometry": (ORANGE, "v"),
        "EKF": (BLUE, "o"),
        "UKF": (GREEN, "s"),
        "particles": (PURPLE, "^"),
        "smoother": (SKY, "D"),
    },
}
"""Kind of thing -> name -> colour and marker: two of a kind are drawn beside each other."""

LOOKS = {name: look for group in GRAMMAR.values() for name, look in group.items()}
"""Name -> its colour and its marker, in all figures of the course."""

LINK_COLOURS = {name: LOOKS[name][0] for name in ("boom", "stick", "bucket")}

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
    "axes.facecolor": "none",
    "axes.labelcolor": GREY,
    "axes.titlecolor": GREY,
    "font.size": 11,
    "grid.alpha": 0.25,
    "grid.color": "#808080",
    "legend.fontsize": 10,
    "legend.frameon": False,
    "lines.linewidth": 1.8,
    "lines.solid_capstyle": "round",
    "text.color": GREY,
    "xtick.color": GREY,
    "xtick.labelsize": 10,
    "ytick.color": GREY,
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
    fig = Figure(figsize=(width, height), dpi=QUICK, layout="constrained", facecolor="none")
    return fig, fig.subplots(rows, columns, **subplots)


@styled
def png(fig: Figure, dpi: float = SHARP) -> bytes:
    """The figure as a PNG file's bytes, the same bytes for the same figure.

    What is black gets a white edge, so that it can be seen on a dark page.
    """
    for curve in fig.findobj(lambda one: isinstance(one, Line2D) and one.get_color() == DARK):
        edge = Stroke(linewidth=curve.get_linewidth() + 1.6, foreground="white")
        curve.set_path_effects([edge, Normal()])
    file = BytesIO()
    smaller = {"optimize": dpi <= QUICK}  # what is drawn so has many details
    fig.savefig(file, format="png", dpi=dpi, metadata={"Software": None}, pil_kwargs=smaller)
    return file.getvalue()


def bundle(
    fig: Figure, alt: str, dpi: float | None = None
) -> tuple[dict[str, Any], dict[str, Any]]:
    """What a notebook stores of the figure: its data and metadata, with `alt` in both.

    Behind `alt`, which says what the figure means, comes what is drawn, as `told` reads it. A
    figure of photographs or of thousands of faces is not drawn sharper than `QUICK`: its file would
    be megabytes.

    Raises:
        ValueError: `alt` is empty, so a reader without the picture would have nothing.
    """
    if not isinstance(alt, str) or not alt.strip():
        raise ValueError("a figure needs a text alternative: say in `alt` what it shows")
    text = f"{' '.join(alt.split())}\n{told(fig)}".strip()
    about = {"alt": text, "width": round(fig.get_figwidth() * QUICK)}
    picture = png(fig, dpi or (QUICK if _details(fig) > MANY else SHARP))
    return {"image/png": picture, "text/plain": text}, {"image/png": about}


def _details(fig: Figure) -> int:
    """Pixels of its photographs, and a hundred for each face of its solids."""
    pixels = sum(np.prod(image.get_size()) for ax in fig.axes for image in ax.images)
    faces = sum(len(group.get_paths()) for ax in fig.axes for group in ax.collections)
    return int(pixels + 100 * faces)


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
    own = iter(looks([label for label in series if label not in kinds]))
    for label, values in series.items():
        y = np.asarray(values, dtype=float)
        style = KINDS[kinds[label]] if label in kinds else next(own)
        ax.plot(x[: len(y)], y, label=label, **style)


def looks(labels: Sequence[str]) -> list[dict[str, Any]]:
    """How curves with these labels are drawn, so that all differ with and without colour.

    A label that is a name in `LOOKS`, or begins with one, looks as that name does everywhere;
    others take the colours that are left. One curve alone has no marker.

    Returns:
        Keywords for `Axes.plot`, in the order of the labels.
    """
    known = [_look(label) for label in labels]
    pairs = [*zip(COLOURS, MARKERS, strict=True), (BROWN, "*"), (GREY, "X")]
    free = [pair for pair in pairs if not any(pair[0] == one[0] for one in known if one)] or pairs
    styles, taken = [], []
    for place, (label, one) in enumerate(zip(labels, known, strict=True)):
        if one is None:
            one = free[sum(look is None for look in known[:place]) % len(free)]
        dashes = ("-", "-.", ":", (0, (6, 1, 1, 1, 1, 1)))[taken.count(one) % 4]
        taken.append(one)
        style = {"color": one[0], "linestyle": dashes}
        if len(labels) > 1 and not label.startswith("_"):
            style |= {"marker": one[1], "markersize": 5, "markevery": (0.04 * (place % 4), 0.16)}
        styles.append(style)
    return styles


def _look(label: str) -> tuple[str, str] | None:
    found = (name for name in LOOKS if re.match(rf"{re.escape(name)}(?![\w+])", label))
    return LOOKS.get(next(found, ""))
