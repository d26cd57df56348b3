"""Geometries to drive: circle, square, figure of eight, and one's own points.

The source tries the first three (D'Angelo 2022, section 5.1) and starts the circle from its
centre. Here all three are driven from the origin with heading 0: the circle from its centre, the
square from its corner, the figure of eight from its crossing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers, positive, whole
from backhoe.vehicle.tracking.path import Path


def circle(
    radius: float = 1.5,
    *,
    points: int = 60,
    centre: ArrayLike = (0.0, 0.0),
    start_angle: float = 0.0,
) -> Path:
    """A closed circle, anticlockwise; its last point is its first.

    Args:
        radius: radius [m]; the source's is 1.5 m.
        points: number of segments, three or more.
        centre: x, y, shape (2,) [m].
        start_angle: direction from the centre to the first point [rad].

    Raises:
        ValueError: radius not positive, fewer than three points, centre or angle not finite.
    """
    radius = positive(radius, "radius", "m")
    angle = number(start_angle, "start_angle", "rad") + _turn(points)
    ring = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    return Path(numbers(centre, "centre", (2,)) + _close(ring))


def square(
    side: float = 2.0, *, spacing: float | None = 0.25, corner: ArrayLike = (0.0, 0.0)
) -> Path:
    """A closed square, anticlockwise, from a corner along x; its last point is its first.

    Args:
        side: length of a side [m].
        spacing: way-points on the sides are this far apart or closer [m]; None: corners alone.
        corner: x, y of the first point, shape (2,) [m].

    Raises:
        ValueError: side or spacing not positive, corner not two finite numbers.
    """
    side = positive(side, "side", "m")
    corners = side * np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
    path = Path(numbers(corner, "corner", (2,)) + corners)
    return path if spacing is None else path.resample(spacing)


def figure_eight(radius: float = 1.5, *, points: int = 120, centre: ArrayLike = (0.0, 0.0)) -> Path:
    """A closed figure of eight: Gerono's lemniscate x = R sin t, y = R sin t cos t.

    It starts at the crossing in the centre, at 45 degrees, with the right-hand loop, clockwise;
    its tightest curve, at x = R and x = -R, has radius R.

    Args:
        radius: R, half its length along x and the radius of the tightest curve [m].
        points: number of segments, three or more; a multiple of 4 has a point on the crossing
            and on both ends.
        centre: x, y of the crossing, shape (2,) [m].

    Raises:
        ValueError: radius not positive, fewer than three points, centre not two finite numbers.
    """
    radius = positive(radius, "radius", "m")
    t = _turn(points)
    loop = radius * np.column_stack([np.sin(t), np.sin(t) * np.cos(t)])
    return Path(numbers(centre, "centre", (2,)) + _close(loop))


def from_points(points: ArrayLike, spacing: float | None = None) -> Path:
    """A path through one's own points.

    Args:
        points: x, y of each, shape (n, 2), n >= 2 [m].
        spacing: add points on the segments, this far apart or closer [m]; None: none.

    Raises:
        ValueError: as `Path` and `Path.resample` say.
    """
    path = Path(points)
    return path if spacing is None else path.resample(spacing)


def _turn(points: int) -> NDArray:
    return np.linspace(0.0, 2 * np.pi, whole(points, "points", least=3), endpoint=False)


def _close(ring: NDArray) -> NDArray:
    return np.vstack([ring, ring[:1]])
