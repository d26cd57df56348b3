"""How much soil a bucket holds at each pitch.

The shell's profile (tip frame of `machine.Shell`) is turned to the pitch. Soil stays where a wall
is under it and its surface, which ends at the lower lip, rises inwards at no more than the angle
of repose; above the mouth it heaps up to the slopes from all four edges. Teeth in the ground hold
more: there the surface starts as high above the lip as the soil outside.
"""

from __future__ import annotations

from functools import lru_cache
from math import cos, pi, sin, tan

import numpy as np

from backhoe.machine import Shell

Point = tuple[float, float]
Polygon = list[Point]

PITCHES = 120
SUPPORTS = (0.0, 0.15, 0.3, 0.5, 0.75, 1.0)
STRIPS = 6


class BucketFill:
    """The volume that stays in the bucket, tabulated once for a shell and an angle of repose [rad].

    Attributes:
        heaped: the most that it ever holds [m^3].
        table: volume for each pitch (rows, 3 degrees apart from -180) and height of soil outside
            above the teeth (columns, `SUPPORTS`) [m^3].
    """

    def __init__(self, shell: Shell, repose: float) -> None:
        self.table = np.array(_table(shell, repose))
        self.table.flags.writeable = False
        self.heaped = float(self.table[:, 0].max())
        self._rows = np.minimum(self.table, self.heaped).tolist()

    def retained(self, pitch: float, support: float = 0.0) -> float:
        """Volume that stays at this pitch [m^3], bilinear in the table.

        Args:
            pitch: of the tip's x axis, from the horizontal outwards, positive up [rad].
            support: height of the soil before the teeth above the teeth [m].
        """
        row, part = divmod((pitch + pi) / (2 * pi) * PITCHES % PITCHES, 1.0)
        low, high = self._rows[int(row) % PITCHES], self._rows[(int(row) + 1) % PITCHES]
        if support <= 0.0:
            return low[0] + part * (high[0] - low[0])
        k = 1
        while k < len(SUPPORTS) - 1 and support > SUPPORTS[k]:
            k += 1
        step = min((support - SUPPORTS[k - 1]) / (SUPPORTS[k] - SUPPORTS[k - 1]), 1.0)
        left = low[k - 1] + part * (high[k - 1] - low[k - 1])
        right = low[k] + part * (high[k] - low[k])
        return left + step * (right - left)

    def __repr__(self) -> str:
        return f"BucketFill(heaped {self.heaped:.2f} m^3)"


@lru_cache(maxsize=8)
def _table(shell: Shell, repose: float) -> tuple[tuple[float, ...], ...]:
    pitches = [-pi + 2 * pi * k / PITCHES for k in range(PITCHES)]
    return tuple(
        tuple(retained_volume(shell, pitch, repose, support) for support in SUPPORTS)
        for pitch in pitches
    )


def retained_volume(shell: Shell, pitch: float, repose: float, support: float = 0.0) -> float:
    """Volume that stays in the shell at one pitch [m^3], in strips across half the width."""
    c, s = cos(pitch), sin(pitch)
    profile = [(x * c - y * s, x * s + y * c) for x, y in shell.profile]
    half = shell.width / 2
    total = 0.0
    for k in range(STRIPS):
        from_side = half * (k + 0.5) / STRIPS
        total += retained_area(profile, tan(repose), support, from_side * tan(repose))
    return total / STRIPS * shell.width


def retained_area(profile: Polygon, slope: float, support: float, heap: float) -> float:
    """Area that stays in a turned profile [m^2].

    Args:
        profile: points (along, up) from the teeth to the top lip [m].
        slope: tangent of the angle of repose.
        support: height of the soil outside above the teeth [m].
        heap: how far the surface may rise above the mouth here, next to the side wall [m].
    """
    teeth, top = profile[0], profile[-1]
    teeth_low = teeth[1] <= top[1]
    lip, far = (teeth, top) if teeth_low else (top, teeth)
    level = lip[1] + (support if teeth_low else 0.0)
    mouth_up = top[0] > teeth[0] if _area(profile) > 0 else top[0] < teeth[0]
    across = far[0] - lip[0]
    inward = (1.0 if across >= 0 else -1.0) * (1.0 if mouth_up else -1.0)
    soil = list(profile)
    if mouth_up:
        rise = (level + far[1] + slope * abs(across)) / 2
        if rise > far[1]:
            soil += _from_top((lip[0] + inward * (rise - level) / slope, rise), lip, level, top)
        if abs(across) > 1e-9:
            tilt = (far[1] - lip[1]) / across
            soil = _clip(soil, (tilt, -1.0), heap + lip[1] - tilt * lip[0])
        outside = _area(_clip(soil, (-inward, 0.0), inward * lip[0]))
    else:
        reach = lip[0] - inward * max(support, 0.0) / slope
        soil = _clip(soil, (inward, 0.0), -inward * reach)
        outside = _area(_clip(soil, (-inward, 0.0), inward * lip[0]))
        outside = min(abs(outside), support * support / slope / 2)
    inside = _clip(soil, (inward, 0.0), -inward * lip[0])
    under_surface = _clip(inside, (inward * slope, -1.0), level - inward * slope * lip[0])
    return abs(_area(under_surface)) + abs(outside)


def _from_top(peak: Point, lip: Point, level: float, top: Point) -> Polygon:
    edge = (lip[0], level)
    return [peak, edge] if lip != top else [edge, peak]


def _clip(polygon: Polygon, normal: Point, offset: float) -> Polygon:
    """The part of a polygon where normal . p + offset >= 0 (Sutherland and Hodgman)."""
    kept: Polygon = []
    for (x0, y0), (x1, y1) in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        start = normal[0] * x0 + normal[1] * y0 + offset
        end = normal[0] * x1 + normal[1] * y1 + offset
        if start >= 0:
            kept.append((x0, y0))
        if (start >= 0) != (end >= 0):
            part = start / (start - end)
            kept.append((x0 + part * (x1 - x0), y0 + part * (y1 - y0)))
    return kept


def _area(polygon: Polygon) -> float:
    following = polygon[1:] + polygon[:1]
    return sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in zip(polygon, following, strict=True)) / 2
