"""Trackers compared, each measure on an axis of its own unit."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from backhoe.vehicle.tracking import Comparison
from backhoe.view.plots.style import figure, looks, styled


@styled
def measures(
    before: Comparison, after: Comparison, fields: Mapping[str, tuple[str, float]]
) -> Figure:
    """How each measure of each tracker changes from one comparison to another.

    A row of panels a path, a panel a measure, a line a tracker: from a hollow marker, before, to a
    full one, after. A column has one axis in the measure's unit, so that no tracker sets the scale
    of another's figure.

    Args:
        before, after: the same trackers on the same paths.
        fields: field of `tracking.Assessment` -> its label with the unit, and that unit in 1/SI.

    Raises:
        ValueError: trackers or paths differ, or a field is none.
    """
    if (before.trackers, before.paths) != (after.trackers, after.paths):
        raise ValueError("both comparisons must have the same trackers and paths, in one order")
    if lost := set(fields) - set(before.values):
        raise ValueError(f"no field called {sorted(lost)}: there are {', '.join(before.values)}")
    names, size = before.trackers, (len(before.paths), len(fields))
    fig, axes = figure(6.8, 1.9 * size[0] + 0.9, *size, squeeze=False, sharex="col", sharey=True)
    styles = [(style["color"], style.get("marker", "o")) for style in looks(names)]
    for (row, column), ax in np.ndenumerate(axes):
        field, (label, unit) = list(fields.items())[column]
        for place, (colour, marker) in enumerate(styles):
            ends = [unit * each.values[field][row, place] for each in (before, after)]
            ax.plot(ends, [place, place], color=colour, lw=2.2)
            for end, face in zip(ends, ("white", colour), strict=True):
                ax.plot(end, place, marker, color=colour, mfc=face, ms=7)
        ax.set_xlabel(label, visible=row == size[0] - 1)
        ax.set_ylabel("tracker", visible=False)
        ax.set_title("" if column else before.paths[row], weight="bold", loc="left")
    axes[0, 0].set_yticks(np.arange(len(names)), names)
    axes[0, 0].set(ylim=(len(names) - 0.5, -0.5))
    return fig
