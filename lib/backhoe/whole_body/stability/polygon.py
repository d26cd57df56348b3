"""The support polygon: where the tracks carry, and how far inside of it a point is.

The tracks rest on the ground from axle to axle and to the outer edges of their shoes; what they
stand on is the rectangle around both. Makers' lifting charts fit lines that lie nearer, about a
roller's width outside the middle of the track: there a machine tips on ground that gives way.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import instance, numbers
from backhoe.machine import BACKHOE, Machine

EDGES = ("front", "left", "rear", "right")
"""The edges of `support_polygon`, in its order."""


def support_polygon(machine: Machine = BACKHOE) -> NDArray:
    """Corners of what the tracks stand on, counter-clockwise from front right.

    Args:
        machine: whose tracks.

    Returns:
        x, y in the vehicle's axes, shape (4, 2) [m]; edge k runs from corner k to the next one and
        is `EDGES[k]`.
    """
    tracks = instance(machine, "machine", Machine).tracks
    x, y = tracks.length / 2, (tracks.gauge + tracks.shoe_width) / 2
    return np.array([[x, -y], [x, y], [-x, y], [-x, -y]])


def distances(points: ArrayLike, polygon: ArrayLike) -> NDArray:
    """How far points lie inside each edge of a polygon; negative outside.

    Args:
        points: x, y, shape (..., 2) [m].
        polygon: corners of a convex polygon, counter-clockwise, shape (n, 2) [m].

    Returns:
        Distances from the lines through the edges, shape (..., n) [m].

    Raises:
        ValueError: a wrong shape, a value that is not finite, or a polygon that is clockwise, not
            convex or without area.
    """
    points = numbers(points, "points", (..., 2), meaning="x, y [m]")
    corners, along = _edges(polygon)
    to = points[..., None, :] - corners
    return along[:, 0] * to[..., 1] - along[:, 1] * to[..., 0]


def _edges(polygon: ArrayLike) -> tuple[NDArray, NDArray]:
    """Corners (n, 2) [m] of a checked polygon and unit vectors (n, 2) along its edges [1]."""
    corners = numbers(polygon, "polygon", ("n", 2), meaning="corners x, y [m]")
    sides = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(sides[:, 0], sides[:, 1])
    x, y = corners.T
    area = float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    if len(corners) < 3 or lengths.min() == 0.0 or area <= 1e-12 * lengths.max() ** 2:
        raise ValueError(
            "polygon must enclose an area, its corners in counter-clockwise order, got "
            f"{len(corners)} corners around {area:.3g} m^2"
        )
    along = sides / lengths[:, None]
    ahead = np.roll(along, -1, axis=0)
    turns = along[:, 0] * ahead[:, 1] - along[:, 1] * ahead[:, 0]
    if turns.min() < -1e-9:
        corner = int((turns.argmin() + 1) % len(corners))
        raise ValueError(f"polygon must be convex, it bends inwards at corner {corner}")
    return corners, along
