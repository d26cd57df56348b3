"""Where the bucket is, in the terms of soil: tip, heading of the arm's plane, pitch.

Along the heading runs u, across it v (to the right), both from the tip; z is up. The pitch is that
of the tip frame's x axis (pin through teeth), from the horizontal outwards, positive up.
"""

from __future__ import annotations

from math import atan2, cos, hypot, isfinite, sin
from typing import NamedTuple

from numpy.typing import ArrayLike

from backhoe.basics.angles import wrap
from backhoe.basics.inputs import numbers, real_numbers


class BucketPose(NamedTuple):
    """Tip (x, y, z) [m], heading (unit vector outwards along the arm) and pitch [rad]."""

    tip: tuple[float, float, float]
    heading: tuple[float, float]
    pitch: float

    def point(self, u: float, v: float) -> tuple[float, float]:
        """World (x, y) of a point u along the heading and v to its right [m]."""
        (x, y, _), (ex, ey) = self.tip, self.heading
        return x + u * ex + v * ey, y + u * ey - v * ex

    def components(self, vx: float, vy: float) -> tuple[float, float]:
        """A horizontal world vector along the heading and to its right."""
        ex, ey = self.heading
        return vx * ex + vy * ey, vx * ey - vy * ex

    @property
    def mouth_side(self) -> float:
        """+1 if the mouth looks outwards, -1 if it looks back at the machine."""
        return 1.0 if sin(self.pitch) > 0 else -1.0


def from_transform(T_tip: ArrayLike) -> BucketPose:
    """Read the pose of the tip frame, shape (4, 4).

    Raises:
        ValueError: wrong shape, not finite, no rotation, or the arm's plane lies on its side.
    """
    T = real_numbers(T_tip, "T_tip")
    if T.shape != (4, 4):
        numbers(T, "T_tip", (4, 4))
    (_, _, across_x, x), (_, _, across_y, y), (x_up, y_up, z_up, z), last = T.tolist()
    level = hypot(across_x, across_y)
    if not isfinite(x + y + z + level + x_up + y_up + z_up):
        numbers(T, "T_tip", (4, 4))
    unit = x_up * x_up + y_up * y_up + z_up * z_up
    if level < 0.5 or abs(unit - 1) > 1e-6 or last != [0.0, 0.0, 0.0, 1.0]:
        raise ValueError(
            "T_tip must be a rotation and a position, its third axis across an upright arm, "
            f"got rows {T.tolist()[2]} and {last}"
        )
    return BucketPose((x, y, z), (-across_y / level, across_x / level), atan2(x_up, y_up))


def turn(a: BucketPose, b: BucketPose) -> float:
    """Change of heading from a to b [rad]."""
    (ax, ay), (bx, by) = a.heading, b.heading
    return atan2(ax * by - ay * bx, ax * bx + ay * by)


def distance(a: BucketPose, b: BucketPose) -> float:
    """How far the tip moves from a to b [m]."""
    (ax, ay, az), (bx, by, bz) = a.tip, b.tip
    return hypot(bx - ax, by - ay, bz - az)


def between(a: BucketPose, b: BucketPose, part: float) -> BucketPose:
    """The pose a `part` of the way from a to b."""
    tip = tuple(p + part * (q - p) for p, q in zip(a.tip, b.tip, strict=True))
    angle = part * turn(a, b)
    (ex, ey), c, s = a.heading, cos(angle), sin(angle)
    pitch = a.pitch + part * wrap(b.pitch - a.pitch)
    return BucketPose(tip, (c * ex - s * ey, s * ex + c * ey), pitch)
