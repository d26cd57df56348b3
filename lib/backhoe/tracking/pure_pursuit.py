"""Pure pursuit, the field's reference: steer for a point on the path, a look-ahead L away.

The arc that leaves along the vehicle's axis and passes through a point (x, y) of the vehicle's
frame, at the distance L, has the curvature 2 y / L^2 (Coulter, "Implementation of the Pure Pursuit
Path Tracking Algorithm", CMU-RI-TR-92-01, 1992). The point is where the path leaves the circle of
radius L round the vehicle; if the path is farther away than that, it is the circle's point in the
direction of the path's nearest point. Beyond its end the path goes straight on, and the vehicle
stops when it has passed the end.

It drives forwards only, so for a point behind it the vehicle turns as tightly as it ever does, with
the curvature 2 / L: 2 y / L^2 would go to zero there, and the vehicle away.
"""

from __future__ import annotations

from math import atan2, copysign, cos, hypot, pi, sin, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.tracking.path import positive
from backhoe.tracking.polyline import arc_length, points_array
from backhoe.tracking.pose_error import wrap
from backhoe.tracking.protocol import Goal, Situation, situation

__all__ = ["PurePursuit"]

_TIE = 1e-9


class PurePursuit:
    """Pure pursuit. It remembers how far along the path it has come.

    The nearest point is looked for from there to `window` ahead: at a crossing the vehicle goes
    straight on, and the end of a closed path is not taken for its start. In path mode it is not
    looked for beyond the current way-point, so that none is left out.

    Args:
        lookahead: L [m]. Short follows closely and swings, long cuts corners.
        speed: forward speed [m/s]; None: the goal's.
        window: how far ahead the nearest point may lie along the path [m]; None: 2 L.
        catch_up: in trajectory mode, extra speed for each metre that the goal is ahead [1/s].

    Raises:
        ValueError: lookahead, speed or window not positive, catch_up negative.
    """

    def __init__(
        self,
        lookahead: float = 0.4,
        speed: float | None = None,
        *,
        window: float | None = None,
        catch_up: float = 1.0,
    ) -> None:
        self.lookahead = positive(lookahead, "lookahead", "m")
        self.speed = None if speed is None else positive(speed, "speed", "m/s")
        self.window = 2 * self.lookahead if window is None else positive(window, "window", "m")
        if not 0 <= catch_up < np.inf:
            raise ValueError(f"catch_up must be 0 or more [1/s], got {catch_up!r}")
        self.catch_up = catch_up
        self.reset()

    def reset(self) -> None:
        """Forget how far along the path the vehicle has come."""
        self._path: NDArray | None = None

    def __call__(
        self, pose: ArrayLike, twist: ArrayLike, goal: Goal, dt: float
    ) -> tuple[float, float]:
        """v, omega [m/s, rad/s] for one sample; see `protocol.Tracker`."""
        now = situation(pose, twist, goal)
        if goal.path is not self._path:
            self._start(goal.path)
        self._advance(now.x, now.y, goal.waypoint)
        if self._progress >= self._arc[-1] and self._passed(now.x, now.y):
            return 0.0, 0.0
        x, y = self._target(now.x, now.y)
        bearing = wrap(atan2(y - now.y, x - now.x) - now.theta)
        steering = sin(bearing) if abs(bearing) <= pi / 2 else copysign(1.0, bearing)
        v = self._wanted_speed(now, goal)
        return v, v * 2 * steering / self.lookahead

    def _start(self, path: NDArray) -> None:
        points = points_array(path, "goal.path")
        steps = np.diff(points, axis=0)
        lengths = np.hypot(*steps.T)
        units = steps / np.where(lengths > 0, lengths, 1.0)[:, None]
        self._path, self._progress, self._segment, self._distance = path, 0.0, 0, 0.0
        self._arc = arc_length(points).tolist()
        self._segments = np.column_stack([points[:-1], units, lengths]).tolist()
        self._last = next(row for row in reversed(self._segments) if row[4] > 0)

    def _advance(self, x: float, y: float, waypoint: int | None) -> None:
        """Move on to the nearest point within the window; where two are as near, to the first."""
        limit, nearest = self._progress + self.window, np.inf
        if waypoint is not None:
            limit = max(min(limit, self._arc[waypoint]), self._progress)
        for i in range(self._segment, len(self._segments)):
            if self._arc[i] > limit:
                break
            ax, ay, ux, uy, length = self._segments[i]
            first, last = max(self._progress - self._arc[i], 0.0), min(length, limit - self._arc[i])
            t = min(max((x - ax) * ux + (y - ay) * uy, first), last)
            distance = hypot(x - ax - t * ux, y - ay - t * uy)
            if distance < nearest - _TIE:
                nearest, progress, segment = distance, self._arc[i] + t, i
        self._progress, self._segment, self._distance = progress, segment, nearest

    def _target(self, x: float, y: float) -> tuple[float, float]:
        """The nearest point if it is farther than L, else where the path leaves the circle."""
        if self._distance >= self.lookahead:
            ax, ay, ux, uy, _ = self._segments[self._segment]
            t = self._progress - self._arc[self._segment]
            return ax + t * ux, ay + t * uy
        for ax, ay, ux, uy, length in self._segments[self._segment :]:
            if hypot(ax + length * ux - x, ay + length * uy - y) > self.lookahead:
                break
        else:
            ax, ay, ux, uy, _ = self._last
        along = (x - ax) * ux + (y - ay) * uy
        aside = (x - ax) * uy - (y - ay) * ux
        t = along + sqrt(max(self.lookahead**2 - aside**2, 0.0))
        return ax + t * ux, ay + t * uy

    def _passed(self, x: float, y: float) -> bool:
        ax, ay, ux, uy, length = self._last
        return (x - ax) * ux + (y - ay) * uy >= length

    def _wanted_speed(self, now: Situation, goal: Goal) -> float:
        speed = goal.speed if self.speed is None else self.speed
        if goal.waypoint is not None:
            return speed
        ahead = now.dx * cos(now.theta) + now.dy * sin(now.theta)
        return max(speed + self.catch_up * ahead, 0.0)
