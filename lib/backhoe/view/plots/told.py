"""What a figure shows, in words that a program writes: for readers and for tests."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedFormatter, FuncFormatter

MOST = 8
"""Curves of a panel that are told one by one."""

FORMATS = FixedFormatter, FuncFormatter
"""What makes words of ticks."""


def told(fig: Figure) -> str:
    """One sentence on what is drawn: axes with their units and ranges, each curve's range in view.

    Numbers have two digits, so that the last digits of a processor do not matter. An empty figure
    gives an empty text.
    """
    panels = [ax for ax in fig.axes if ax.get_label() != "<colorbar>"]
    texts = [text for ax in panels if (text := "; ".join(_panel(ax)))]
    if len(texts) > 1:
        texts = [f"({number}) {text}" for number, text in enumerate(texts, start=1)]
    return f"Drawn: {' '.join(texts)}." if texts else ""


def _panel(ax: Axes) -> Iterator[str]:
    if ax.axison:
        sides = ((_name(ax, "x"), ax.get_xlim()), (_name(ax, "y"), ax.get_ylim()))
        yield ", ".join(f"{name or 'no name'} {_span(limits)}" for name, limits in sides)
    curves = [line for line in ax.lines if line.get_visible() and len(line.get_xdata())]
    named = [line for line in curves if not line.get_label().startswith("_")]
    for line in named[:MOST]:
        in_view = np.clip(np.asarray(line.get_ydata(), dtype=float), *sorted(ax.get_ylim()))
        yield f"{line.get_label()} {_span(in_view)}"
    others = {
        "other line": len(curves) - len(named[:MOST]),
        "shape": len(ax.patches),
        "group": len(ax.collections),
        "picture": len(ax.images),
        "text": len(ax.texts),
    }
    counts = [f"{count} {name}{'s' * (count > 1)}" for name, count in others.items() if count]
    if counts:
        yield ", ".join(counts)


def _name(ax: Axes, side: str) -> str:
    """The label of an axis, or that of a panel with the same limits; "names" of a list of words."""
    limits = getattr(ax, f"get_{side}lim")()
    alike = [ax, *(one for one in ax.figure.axes if getattr(one, f"get_{side}lim")() == limits)]
    words = isinstance(getattr(ax, f"{side}axis").get_major_formatter(), FORMATS)
    labels = (getattr(one, f"get_{side}label")() for one in alike)
    return next(filter(None, labels), "names" if words else "")


def _span(values: object) -> str:
    numbers = np.asarray(values, dtype=float)
    numbers = numbers[np.isfinite(numbers)]
    if not numbers.size:
        return "empty"
    low, high = numbers.min(), numbers.max()
    small = 1e-6 * max(abs(low), abs(high))
    low, high = (_two_digits(0.0 if abs(end) <= small else end) for end in (low, high))
    return low if low == high else f"{low} to {high}"


def _two_digits(value: float) -> str:
    """Rounded by way of six digits: 0.0449999999 and 0.045 are the same number twice."""
    six = float(f"{value:.6g}")
    return f"{float(f'{six:.2g}'):g}"
