"""Figures of a mission: how the joints followed, and where the soil went."""

from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from backhoe.view.plots.style import BROWN, LINK_COLOURS, figure, styled


@styled
def soil(time: ArrayLike, bucket_volume: ArrayLike, truck_volume: ArrayLike) -> Figure:
    """Soil in the bucket and in the truck over time.

    Args:
        time: shape (n,) [s].
        bucket_volume, truck_volume: shape (n,) [m^3].
    """
    fig, ax = figure(6.8, 3.2)
    ax.plot(time, truck_volume, color=BROWN, ls="-.", label="in the truck")
    ax.plot(time, bucket_volume, color=LINK_COLOURS["bucket"], label="in the bucket")
    ax.set(xlabel="time [s]", ylabel="volume of soil [m^3]")
    ax.legend(loc="upper left")
    return fig
