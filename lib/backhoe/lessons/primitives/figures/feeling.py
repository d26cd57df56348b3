"""Figure of lesson 10c: two digs through ground with a rock, with feeling and without."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import NDArray

from backhoe.basics.inputs import instance
from backhoe.mission.feeling import START, STOP
from backhoe.simulation.soil import Rock
from backhoe.view.plots.style import BLUE, ORANGE, STEEL, figure, styled

__all__ = ["rock_dug"]

COLOURS = (ORANGE, BLUE)


class Felt(Protocol):
    """What is drawn of a `mission.feeling.FeltDig`."""

    time: NDArray
    strain: NDArray
    edge: NDArray


@styled
def rock_dug(runs: Mapping[str, Felt], rock: Rock) -> Figure:
    """Where the bucket's edge went beside a rock, seen from the side, and what it felt.

    Args:
        runs: name -> `mission.feeling.FeltDig`, one or two: time (n,) [s], strain (n,) [1], edge
            (n, 3) [m].
        rock: that lies there.

    Raises:
        ValueError: no run, or more than two.
        TypeError: rock is no `Rock`.
    """
    instance(rock, "rock", Rock)
    if not 1 <= len(runs) <= len(COLOURS):
        raise ValueError(f"rock_dug needs one or two runs: name -> FeltDig, got {len(runs)}")
    fig, (side, felt) = figure(7.6, 3.4, 1, 2)
    side.add_patch(Circle((rock.x, rock.z), rock.radius, color=STEEL, label="rock"))
    for (name, run), colour in zip(runs.items(), COLOURS, strict=False):
        side.plot(run.edge[:, 0], run.edge[:, 2], color=colour, label=name)
        felt.plot(run.time, run.strain, color=colour)
    for level, style in ((START, ":"), (STOP, "--"), (1.0, "-")):
        felt.axhline(level, color=STEEL, lw=0.9, ls=style)
    side.set(xlabel="$x$ [m]", ylabel="$z$ of the edge [m]", aspect="equal")
    felt.set(xlabel="time [s]", ylabel="strain [1]")
    fig.legend(*side.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return fig
