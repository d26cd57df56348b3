"""Figures of a mission: how the joints followed, and where the soil went."""

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from backhoe.machine import JOINTS
from backhoe.plots.style import COLOURS, KINDS, figure, styled


@styled
def joint_tracking(time: ArrayLike, q: ArrayLike, q_ref: ArrayLike) -> Figure:
    """Measured joint angles over their references, one panel a joint.

    Args:
        time: shape (n,) [s].
        q, q_ref: measured and wanted joint angles, shape (n, 4) [rad].
    """
    fig, axes = figure(6.8, 6.4, rows=4, sharex=True)
    panels = zip(axes, JOINTS, np.degrees(q).T, np.degrees(q_ref).T, strict=True)
    for ax, name, angle, wanted in panels:
        ax.plot(time, angle, **{**KINDS["truth"], "label": "measured"})
        ax.plot(time, wanted, **{**KINDS["reference"], "color": COLOURS[1], "label": "wanted"})
        ax.set_ylabel(f"{name} [deg]")
    axes[0].legend(ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    axes[-1].set_xlabel("time [s]")
    return fig


@styled
def soil(time: ArrayLike, bucket_volume: ArrayLike, truck_volume: ArrayLike) -> Figure:
    """Soil in the bucket and in the truck over time.

    Args:
        time: shape (n,) [s].
        bucket_volume, truck_volume: shape (n,) [m^3].
    """
    fig, ax = figure(6.8, 3.2)
    ax.plot(time, truck_volume, color=COLOURS[0], label="in the truck")
    ax.plot(time, bucket_volume, color=COLOURS[3], label="in the bucket")
    ax.set(xlabel="time [s]", ylabel="volume of soil [m^3]")
    ax.legend(loc="upper left")
    return fig
