"""The route that `drive` takes unless told another: a G, as in the source.

Mastalli 2013 drives "a movement in the form of a G" of 100 s that ends in a curve (section 4.6.2,
and 3.5.2 for the control); no numbers are printed. This one is ours, sized for the machine.
"""

from __future__ import annotations

import numpy as np

from backhoe.vehicle.tracking import Path, from_points

SPEED = 0.4
"""Speed along the route [m/s]: ours."""

_RUN_UP, _RADIUS, _TURN, _BAR, _SPACING = 2.0, 3.5, 1.4, 2.6, 0.1


def default_route(speed: float = SPEED) -> Path:
    """A G from the origin along x, about 23 m long and 7 m high.

    A run-up of 2 m, three quarters of a circle of radius 3.5 m to the left, a tight quarter of
    radius 1.4 m inwards and the bar.

    Args:
        speed: that the times are for [m/s].

    Returns:
        A trajectory with way-points 0.1 m apart or closer.

    Raises:
        ValueError: speed is not positive.
    """
    bow, tight = np.radians(np.arange(-90, 181, 3)), np.radians(np.arange(180, 271, 5))
    outer = [_RUN_UP, _RADIUS] + _RADIUS * np.column_stack([np.cos(bow), np.sin(bow)])
    middle = [_RUN_UP - _RADIUS + _TURN, _RADIUS]
    inner = middle + _TURN * np.column_stack([np.cos(tight), np.sin(tight)])
    end = inner[-1] + [_BAR, 0.0]
    points = np.vstack([[0.0, 0.0], outer, inner[1:], end])
    return from_points(points, _SPACING).with_times(speed)
