"""The small map at the top of every lesson: which part of the machine it is about."""

from collections.abc import Collection

from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from backhoe import FLOORS
from backhoe.view.plots.style import DARK, GREY, ORANGE, figure, styled

_PLACES = {
    "machine": (0, 0),
    "simulation": (0, 1),
    "localisation": (1, 1),
    "perception": (2, 1),
    "planning": (3, 1),
    "whole_body": (3, 0),
    "arm": (2, 0),
    "vehicle": (1, 0),
}
STAGES = {floor: FLOORS[floor] for floor in _PLACES}
"""The floors of the library that the data pass, and what each answers."""
_ARROWS = (
    ("simulation", "localisation"),
    ("localisation", "perception"),
    ("perception", "planning"),
    ("planning", "whole_body"),
    ("whole_body", "arm"),
)
_WIDTH, _HEIGHT = 0.86, 0.6


@styled
def data_way(lit: str | Collection[str] = ()) -> Figure:
    """The way of the data through the machine, with the parts named in `lit` highlighted.

    Args:
        lit: one name or several of `STAGES`; "tour" for all of them.

    Raises:
        ValueError: a name is not one of the stages.
    """
    names = set(STAGES) if lit == "tour" else {lit} if isinstance(lit, str) else set(lit)
    if unknown := names - set(STAGES):
        raise ValueError(f"unknown part {sorted(unknown)}: the parts are {', '.join(STAGES)}")
    fig, ax = figure(6.8, 2.3)
    arrow = {"arrowstyle": "-|>", "color": GREY, "lw": 1.4, "shrinkA": 0, "shrinkB": 0}
    for start, end in _ARROWS:
        (x0, y0), (x1, y1) = _PLACES[start], _PLACES[end]
        dx, dy = _WIDTH / 2 * (x1 - x0), _HEIGHT / 2 * (y1 - y0)
        ax.annotate("", (x1 - dx, y1 - dy), (x0 + dx, y0 + dy), arrowprops=arrow)
    left, top = -_WIDTH / 2, _HEIGHT / 2
    ax.annotate("", (0.25, 1 - top), (0.75, top), arrowprops=arrow)
    ax.annotate("", (0.4, 1 - top), (1.75, top), arrowprops=arrow)
    bow = arrow | {"connectionstyle": "arc3,rad=-0.12"}
    ax.annotate("", (1.25, -top), (2.75, -top), arrowprops=bow)
    ax.annotate("", (-0.1, 1 - top), (-0.1, top), arrowprops=arrow)
    for name, idea in STAGES.items():
        x, y = _PLACES[name]
        on = name in names
        box = FancyBboxPatch(
            (x + left, y - top),
            _WIDTH,
            _HEIGHT,
            boxstyle="round,pad=0,rounding_size=0.06",
            facecolor=ORANGE if on else "#f4f4f4",
            edgecolor=DARK if on else GREY,
            linewidth=1.8 if on else 1.0,
        )
        ax.add_patch(box)
        weight = "bold" if on else "normal"
        ax.text(x, y + 0.11, idea, ha="center", va="center", size=10, color=DARK, weight=weight)
        ax.text(x, y - 0.14, name.replace("_", " "), ha="center", va="center", size=9, color=DARK)
    ax.set(xlim=(-0.47, 3.47), ylim=(-0.55, 1.36))
    ax.axis("off")
    return fig
