"""The hand of a moving robot along a path: what the controller tells, and what comes of it.

A drive with the lag L goes on by L v after it was told to stand. So the place where the hand would
come to rest, seen from where it is, answers at once to what is told, as the hand of a robot without
lag does: a controller that knows the lag steers that place, and takes it to L times the wanted
velocity ahead of the path.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import function, numbers, positive, whole
from backhoe.whole_body.linear import minimum_norm
from backhoe.whole_body.manipulability import manipulability
from backhoe.whole_body.plant import lags
from backhoe.whole_body.robots import Robot, hand, jacobian
from backhoe.whole_body.tracking import wanted_velocity

FASTEST = 3.0
"""A path on which the hand must go faster jumps [m/s]."""

MOST = 10_000_000
"""Steps that a log may have."""

_CALL = "path(times) -> places"
_SOLVE = "solve(J, b, preferred) -> v"
_PREFERRED = "preferred(q) -> v0"


@dataclass(frozen=True, eq=False)
class Following:
    """What happened, one row for each step's beginning and one for the end.

    Attributes:
        robot: whose hand followed.
        time: shape (n,) [s].
        q, v: posture and velocities that it had, shapes (n, 3 + joints) and (n, 2 + joints).
        told: velocities that the controller wanted, shape (n - 1, 2 + joints).
        goal: where the hand should be, shape (n, 3) [m].
        w_arm, w: manipulability of arm and whole robot, shapes (n,) [m^3].
    """

    robot: Robot
    time: NDArray
    q: NDArray
    v: NDArray
    told: NDArray
    goal: NDArray
    w_arm: NDArray
    w: NDArray

    @property
    def hand(self) -> NDArray:
        """Where the hand was, shape (n, 3) [m]."""
        return hand(self.q, self.robot)

    @property
    def error(self) -> NDArray:
        """How far the hand was from its goal, shape (n,) [m]."""
        return np.linalg.norm(self.goal - self.hand, axis=-1)


def follow(
    plant: object,
    path: Callable,
    *,
    W: ArrayLike = 0.9,
    preferred: Callable | None = None,
    solve: Callable | None = None,
    lag: ArrayLike = 0.0,
    duration: float | None = None,
    fastest: float = FASTEST,
) -> Following:
    """Let a plant's hand follow a path by linear equations, one solution a step.

    Args:
        plant: `KinematicPlant` or another with `robot`, `q`, `v`, `time`, `dt` and `step(v)`, such
            as `simulation.WholeBodyPlant`; it goes on from where it is.
        path: places at times, called as path(t) with t (n,) [s] from 0, it returns (n, 3) [m].
        W: as for `wanted_velocity`.
        preferred: velocities for the null space, called as preferred(q), it returns (2 + joints,);
            zero if None: then the least velocities.
        solve: of J v = b, called as solve(J, b, v0), it returns v (2 + joints,);
            default `minimum_norm`.
        lag: of the drives as the controller knows it, shape () or (2 + joints,) [s]; 0 takes the
            velocities for those that were told, as the slides do.
        duration: how long [s]; default the path's.
        fastest: largest speed that the path may ask for [m/s].

    Returns:
        The log.

    Raises:
        ValueError: a path that jumps, malformed arguments, or what `solve` raises, with the time.
        TypeError: path, preferred or solve cannot be called.
    """
    robot, dt = plant.robot, plant.dt
    solve = minimum_norm if solve is None else solve
    function(path, "path", _CALL), function(solve, "solve", _SOLVE)
    lag = lags(lag, robot)
    duration = positive(path.duration if duration is None else duration, "duration", "s")
    count = whole(max(round(duration / dt), 1), "duration over dt", most=MOST)
    goal = numbers(path(dt * np.arange(count + 1)), _CALL, (count + 1, 3), meaning="points [m]")
    wanted_velocity(goal[:-1], goal[:-1], goal[1:], 0.0, dt, fastest=fastest)  # for its check
    prefer = _still(robot) if preferred is None else function(preferred, "preferred", _PREFERRED)
    rate = np.gradient(goal, dt, axis=0)
    q, v, told, start = [plant.q], [plant.v], [], plant.time
    for k in range(count):
        now, v0 = q[-1], prefer(q[-1])
        place, there, after = now, goal[k], goal[k + 1]
        if lag.any():
            place, J = now + _rates(now, lag * v[-1]), jacobian(now, robot)
            there = there + J @ (lag * solve(J, rate[k], v0))
            after = after + J @ (lag * solve(J, rate[k + 1], v0))
        b = wanted_velocity(hand(place, robot), there, after, W, dt)
        try:
            told.append(solve(jacobian(place, robot), b, v0))
        except ValueError as error:
            error.add_note(f"this happened {k * dt:.2f} s after the start")
            raise
        plant.step(told[-1])
        q.append(plant.q)
        v.append(plant.v)
    q = np.array(q)
    J = jacobian(q, robot)
    time = start + dt * np.arange(count + 1)
    parts = manipulability(J[..., 2:]), manipulability(J)
    return Following(robot, time, q, np.array(v), np.array(told), goal, *parts)


def _still(robot: Robot) -> Callable:
    nothing = np.zeros(2 + robot.joints)
    return lambda q: nothing


def _rates(q: NDArray, v: NDArray) -> NDArray:
    """How the coordinates change: the platform drives along its heading."""
    return np.array([v[0] * np.cos(q[2]), v[0] * np.sin(q[2]), *v[1:]])
