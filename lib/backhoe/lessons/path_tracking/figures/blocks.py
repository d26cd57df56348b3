"""Block diagrams of the chapter's controllers, all in one grammar.

From left to right: what it looks at, what it works out, its law, the limits, the vehicle. What is
measured comes back along the bottom.
"""

from collections.abc import Sequence
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from backhoe.basics.inputs import choice
from backhoe.view.plots.style import DARK, GREY, figure, styled


class Diagram(NamedTuple):
    """The boxes of a controller; each of the later two columns names where its arrows come from.

    Attributes:
        looks: what it looks at, the last of them measured.
        measured: how many of them are measured.
        works: what it works out -> numbers of the boxes of `looks` that it needs.
        laws: the laws of v and of omega -> numbers of the boxes of `works`.
    """

    looks: tuple[str, ...]
    measured: int
    works: dict[str, tuple[int, ...]]
    laws: dict[str, tuple[int, ...]]


_ERRORS = {r"$\rho$": (1, 2), r"$\Delta y$": (1, 2), r"$\alpha$": (0, 2)}
_PLACES = ("next way-point", "way-point", "pose")
_TO_GOAL = {"distance $d$": (0, 1), r"turn $h=\theta_d-\theta$": (0, 1)}
_GOAL = ("goal at $n+1$", "pose")

DIAGRAMS = {
    "P": Diagram(
        _PLACES,
        1,
        _ERRORS,
        {r"$k_\rho\,\rho$": (0,), r"$k_{\Delta y}\,\Delta y+k_\alpha\,\alpha$": (1, 2)},
    ),
    "PI": Diagram(
        _PLACES,
        1,
        _ERRORS,
        {
            r"$k_\rho\,\rho$": (0,),
            r"$k_{\Delta y}\Delta y+k_I\int\!\Delta y\,dt+k_\alpha\alpha$": (1, 2),
        },
    ),
    "Scaglia v1": Diagram(
        _GOAL, 1, _TO_GOAL, {r"$k_v\,d\,/\,T_0$": (0,), r"$k_w\,h\,/\,T_0$": (1,)}
    ),
    "Scaglia v2": Diagram(
        _GOAL, 1, _TO_GOAL, {r"$k_v\,d\,h\,/\,(T_0\sin h)$": (0, 1), r"$k_w\,2h\,/\,T_0$": (1,)}
    ),
    "Scaglia v3": Diagram(
        ("goal at $n+1$", "pose", r"twist $V_n,\,W_n$"),
        2,
        {"way to the goal": (0, 1), r"old velocity $V_n,\,W_n$": (1, 2)},
        {"its length: the new $V$": (0, 1), "turn to it, less old $W_n$": (0, 1)},
    ),
    "pure pursuit": Diagram(
        ("goal, its speed", "path", "pose"),
        1,
        {"lead of the goal": (0, 1, 2), "point ahead: $d,\\ y_L$": (1, 2)},
        {"its speed, and its lead": (0,), r"$v\;2\,y_L\,/\,d^2$": (1,)},
    ),
}
"""Name of a controller -> its diagram."""

_LEFT, _WIDTH, _HEIGHT = (0.0, 2.4, 5.2), (1.75, 2.1, 2.45), 0.56
_LIMITS, _VEHICLE, _END = 8.35, 9.75, 10.85


@styled
def controllers(names: Sequence[str]) -> Figure:
    """Block diagrams of controllers, one below the other.

    Args:
        names: of `DIAGRAMS`.

    Raises:
        ValueError: no name, or another one.
    """
    if not names:
        raise ValueError("nothing to draw: name a controller")
    diagrams = [DIAGRAMS[choice(name, "controller", DIAGRAMS)] for name in names]
    fig, axes = figure(6.8, 1.75 * len(names), len(names), 1, squeeze=False)
    for ax, name, diagram in zip(axes[:, 0], names, diagrams, strict=True):
        _draw(ax, diagram)
        ax.set_title(name, weight="bold", loc="left")
    return fig


def _draw(ax: Axes, diagram: Diagram) -> None:
    columns = (diagram.looks, tuple(diagram.works), tuple(diagram.laws))
    heights = [_heights(len(column)) for column in columns]
    for column, names in enumerate(columns):
        for name, y in zip(names, heights[column], strict=True):
            measured = column == 0 and names.index(name) >= len(names) - diagram.measured
            face = ("#e3edf5" if measured else "#f4f4f4", "#ffffff", "#fbeed0")[column]
            _box(ax, _LEFT[column], _WIDTH[column], y, name, face)
    for column, needs in enumerate((diagram.works.values(), diagram.laws.values())):
        for place, sources in enumerate(needs):
            for source in sources:
                start = _LEFT[column] + _WIDTH[column], heights[column][source]
                _arrow(ax, start, (_LEFT[column + 1], heights[column + 1][place]))
    for y, name in zip(heights[2], ("$v$", r"$\omega$"), strict=True):
        _arrow(ax, (_LEFT[2] + _WIDTH[2], y), (_LIMITS, y))
        ax.text(7.95, y + 0.08, name, ha="center", va="bottom", size=10)
    _box(ax, _LIMITS, 0.95, 1.0, "limits", "#f4f4f4", 2.0)
    _box(ax, _VEHICLE, 1.1, 1.0, "vehicle", "#f3dfae", 2.0)
    _arrow(ax, (_LIMITS + 0.95, 1.0), (_VEHICLE, 1.0))
    back, low = (_VEHICLE + _END) / 2, -0.55
    lowest = heights[0][-1] - _HEIGHT / 2
    ax.plot([back, back, _WIDTH[0] / 2], [0.0, low, low], color=GREY, lw=1.2)
    _arrow(ax, (_WIDTH[0] / 2, low), (_WIDTH[0] / 2, lowest))
    ax.text(5.2, low + 0.05, "measured", ha="center", va="bottom", size=8.5, color=GREY)
    ax.set(xlim=(-0.1, _END + 0.1), ylim=(low - 0.15, 2.15))
    ax.axis("off")


def _heights(count: int) -> list[float]:
    return [2.0 - (k + 0.5) * 2.0 / count for k in range(count)]


def _box(
    ax: Axes, left: float, width: float, y: float, name: str, face: str, height: float = _HEIGHT
) -> None:
    ax.add_patch(
        FancyBboxPatch(
            (left, y - height / 2), width, height, boxstyle="round,pad=0,rounding_size=0.08",
            facecolor=face, edgecolor=DARK, linewidth=1.0,
        )
    )  # fmt: skip
    ax.text(left + width / 2, y, name, ha="center", va="center", size=8.5)


def _arrow(ax: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    arrow = {"arrowstyle": "-|>", "color": GREY, "lw": 1.1, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", end, start, arrowprops=arrow)
