"""Pure pursuit, the field's reference: steer for a point on the path, a look-ahead L away.

The arc that leaves along the vehicle's axis and passes through a point (x, y) of the vehicle's
frame, at the distance L, has the curvature 2 y / L^2 (Coulter, "Implementation of the Pure Pursuit
Path Tracking Algorithm", CMU-RI-TR-92-01, 1992). The point is where the path leaves the circle of
radius L round the vehicle; if the path is farther away than that, it is the circle's point in the
direction of the path's nearest point. Beyond its end the path goes straight on, and the vehicle
stops when it has passed the end.

In trajectory mode the speed is the goal's, and more the farther it is ahead along the path.

It drives forwards only, so for a point behind it the vehicle turns as tightly as it ever does, with
the curvature 2 / L: 2 y / L^2 would go to zero there, and the vehicle away.
"""

from __future__ import annotations

from math import atan2, copysign, hypot, inf, pi, sin, sqrt

from numpy.typing import ArrayLike, NDArray

from backhoe.basics.angles import wrap
from backhoe.basics.inputs import not_negative, positive
from backhoe.vehicle.tracking.foot import Foot
from backhoe.vehicle.tracking.polyline import points_array
from backhoe.vehicle.tracking.protocol import Goal, situation


class PurePursuit:
    """Pure pursuit. It remembers how far along the path it has come.

    The path's nearest point is looked for from there to `window` ahead. In path mode it is not
    looked for beyond the current way-point, so that none is left out: a vehicle that cuts a corner
    by more than the arrival distance turns back for it. Keep L well below the size of the corners.

    Args:
        lookahead: L [m]. Short follows closely and swings, long cuts corners. The tightest turn
            asks for omega = 2 v / L: beyond the vehicle's limits it has to stop for turning.
        speed: forward speed [m/s]; None: the goal's.
        window: how far ahead the nearest point may lie along the path [m]; None: 2 L.
        catch_up: in trajectory mode, extra speed for each metre of path that the goal is ahead,
            up to L of them [1/s]; it waits for a goal that is behind.

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
        self.catch_up = not_negative(catch_up, "catch_up", "1/s")
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
            points = points_array(goal.path, "goal.path")
            self._path, self._foot = goal.path, Foot(points, self.window)
            self._goal = Foot(points, self.window)
        limit = inf if goal.waypoint is None else self._foot.arc[goal.waypoint]
        self._foot.move_to(now.x, now.y, limit)
        if self._passed(now.x, now.y):
            return 0.0, 0.0
        x, y = self._target(now.x, now.y)
        bearing = wrap(atan2(y - now.y, x - now.x) - now.theta)
        steering = sin(bearing) if abs(bearing) <= pi / 2 else copysign(1.0, bearing)
        v = self._wanted_speed(now.x + now.dx, now.y + now.dy, goal)
        return v, v * 2 * steering / self.lookahead

    def _target(self, x: float, y: float) -> tuple[float, float]:
        """The foot if it is farther than L, else where the path leaves the circle."""
        foot = self._foot
        if foot.distance >= self.lookahead:
            return foot.place
        for ax, ay, ux, uy, length in foot.segments[foot.segment :]:
            if hypot(ax + length * ux - x, ay + length * uy - y) > self.lookahead:
                break
        else:
            ax, ay, ux, uy, _ = self._last()
        along = (x - ax) * ux + (y - ay) * uy
        aside = (x - ax) * uy - (y - ay) * ux
        t = along + sqrt(max(self.lookahead**2 - aside**2, 0.0))
        return ax + t * ux, ay + t * uy

    def _passed(self, x: float, y: float) -> bool:
        if self._foot.way < self._foot.arc[-1]:
            return False
        ax, ay, ux, uy, length = self._last()
        return (x - ax) * ux + (y - ay) * uy >= length

    def _last(self) -> list[float]:
        return next(segment for segment in reversed(self._foot.segments) if segment[4] > 0)

    def _wanted_speed(self, goal_x: float, goal_y: float, goal: Goal) -> float:
        speed = goal.speed if self.speed is None else self.speed
        if goal.waypoint is not None:
            return speed
        self._goal.move_to(goal_x, goal_y)
        lead = min(self._goal.way - self._foot.way, self.lookahead)
        return max(speed + self.catch_up * lead, 0.0)
