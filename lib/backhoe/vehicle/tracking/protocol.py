"""What a tracker and a plant are to each other: the one interface of this package.

A tracker is a callable that looks at the vehicle and at the goal and says how fast to drive:

    v, omega = tracker(pose, twist, goal, dt)

A plain function will do. A tracker that remembers something is a class with `__call__` and
`reset()`; one that is made for a certain sample time says so with `period` [s]. A plant is what is
driven: the equations of a vehicle or a simulated machine.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol, runtime_checkable

from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import numbers


class Goal(NamedTuple):
    """Where a tracker shall go now.

    Attributes:
        position: path mode: the current way-point; trajectory mode: where to be at the end of
            this sample, interpolated; shape (2,) [m].
        next_position: the one after it; the same again at the end of the path; shape (2,) [m].
        speed: how fast to drive there [m/s].
        path: all way-points, shape (n, 2) [m].
        time: mission time at the end of this sample [s].
        waypoint: number of the current way-point in path mode, None in trajectory mode.
    """

    position: NDArray
    next_position: NDArray
    speed: float
    path: NDArray
    time: float
    waypoint: int | None = None


class Tracker(Protocol):
    """Called once in each sample of `dt` seconds.

    It may have `reset()`, called before a run, and `period`, the sample time it wants [s].
    """

    def __call__(self, pose: NDArray, twist: NDArray, goal: Goal, dt: float) -> tuple[float, float]:
        """Speeds to drive with during this sample.

        Args:
            pose: x, y, heading (not wrapped), shape (3,) [m, m, rad].
            twist: measured forward and turning speed, shape (2,) [m/s, rad/s].
            goal: where to go.
            dt: sample time of the tracker [s].

        Returns:
            v, omega: forward and turning speed, anticlockwise positive [m/s, rad/s].
        """


@runtime_checkable
class Plant(Protocol):
    """A vehicle that is told speeds: pose (3,), twist (2,), time and dt [s], and `step`.

    It may have `limits`, a `tracking.Limits`, and `reset()`.
    """

    pose: NDArray
    twist: NDArray
    time: float
    dt: float

    def step(self, v: float, omega: float) -> object:
        """Move on by dt seconds with the wanted speeds v [m/s] and omega [rad/s]."""


class Situation(NamedTuple):
    """Pose and twist in plain floats, and the way to the goal: dx, dy [m]."""

    x: float
    y: float
    theta: float
    v: float
    omega: float
    dx: float
    dy: float


def situation(pose: ArrayLike, twist: ArrayLike, goal: Goal) -> Situation:
    """A tracker's arguments as floats, which Python adds faster than arrays of one.

    Raises:
        ValueError: pose is not three finite numbers, or twist or goal.position not two.
    """
    x, y, theta = numbers(pose, "pose", (3,), meaning="x, y, heading").tolist()
    v, omega = numbers(twist, "twist", (2,), meaning="v, omega").tolist()
    goal_x, goal_y = numbers(goal.position, "goal.position", (2,), meaning="x, y").tolist()
    return Situation(x, y, theta, v, omega, goal_x - x, goal_y - y)
