"""Movements asked for by name, one after another: goals, a queue, feedback, results, cancelling.

Mastalli 2013, section 6.7.3, sends a queue of movements from a client to a server, each with its
time and its goal. Here both live in one process: `ActionServer.send` gives the client an `Action`
to look at, and whoever runs the machine asks the server at every step what the joints should do.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm.kinematics import inverse_kinematics
from backhoe.basics.inputs import function, instance, not_negative, numbers, positive, times
from backhoe.machine import BACKHOE, Machine
from backhoe.mission.parts import smooth_trajectory

BRAKING = 0.5
"""Time in which a cancelled movement comes to rest [s]."""

EVERY = 0.1
"""Between two reports of an action [s]."""

THERE = 0.06
"""A movement has succeeded when no joint is further from its end [rad]..."""

PATIENCE = 1.0
"""...at the latest so long after its time [s]."""

_CALL = "motion(q) -> times (n,), joint angles (n, 4), from q at time 0"


class Feedback(NamedTuple):
    """How an action goes: `time` since it began [s], `done`, the share of its time [1], and `off`,
    the furthest that a joint is from where it should be [rad]."""

    time: float
    done: float
    off: float


@dataclass(frozen=True)
class Goal:
    """A movement that is wanted: its name, and what makes way-points of the joints.

    Args:
        name: for reports.
        motion: motion(q) -> times (n,) from 0 [s], joint angles (n, 4) [rad] that begin at q; they
            are joined smoothly, and a ValueError makes the action fail.
    """

    name: str
    motion: Callable

    def __post_init__(self) -> None:
        instance(self.name, "Goal.name", str)
        function(self.motion, "Goal.motion", _CALL)


@dataclass(eq=False)
class Action:
    """What a client knows of a goal that it has sent.

    Attributes:
        goal: what was asked for.
        status: "queued", "active", "cancelling", and in the end "succeeded", "failed" or
            "cancelled".
        result: in the end, why, in words.
        feedback: every `EVERY` seconds while it is active.
    """

    goal: Goal
    status: str = "queued"
    result: str = ""
    feedback: list[Feedback] = field(default_factory=list)

    @property
    def done(self) -> bool:
        """Whether it is over."""
        return self.status in ("succeeded", "failed", "cancelled")


class ActionServer:
    """Takes goals, and says at every step where the joints should be.

    Args:
        q: where the joints are, shape (4,) [rad].
        dt: time between two steps [s].
        machine: whose speed limits hold.

    Raises:
        ValueError: q is not 4 finite angles, or dt is not positive.
    """

    def __init__(self, q: ArrayLike, dt: float, machine: Machine = BACKHOE) -> None:
        self.q_ref = numbers(q, "q", (4,), meaning="joint angles").copy()
        self.dq_ref = np.zeros(4)
        self.dt, self.machine = positive(dt, "dt", "s"), machine
        self.queue: list[Action] = []
        self._way: tuple[NDArray, NDArray] = np.empty((0, 4)), np.empty((0, 4))
        self._step = self._brake = 0

    @property
    def active(self) -> Action | None:
        """The action that moves the machine, or the next to do so."""
        return self.queue[0] if self.queue else None

    def send(self, goal: Goal) -> Action:
        """Put a goal at the end of the queue.

        Raises:
            TypeError: it is no Goal.
        """
        action = Action(instance(goal, "goal", Goal))
        self.queue.append(action)
        return action

    def cancel(self, action: Action, why: str = "the client cancelled it") -> None:
        """End an action: one that waits never begins, the active one comes to rest smoothly.

        Raises:
            ValueError: it is over already, or of another server.
        """
        if action.done or not any(action is waiting for waiting in self.queue):
            raise ValueError(
                f"only an action that waits or moves can be cancelled: {action.goal.name!r} is "
                f"{action.status if action.done else 'not in this queue'}"
            )
        action.result = why
        if action.status == "active":
            action.status, self._brake = "cancelling", 0
        elif action.status == "queued":
            self._end(action, "cancelled", why)

    def cancel_all(self, why: str) -> None:
        """Cancel all that is queued or active."""
        for action in [action for action in self.queue if action.status != "cancelling"]:
            self.cancel(action, why)

    def step(self, q: NDArray) -> tuple[NDArray, NDArray]:
        """Where the joints should be at the end of this step.

        Args:
            q: where they are, shape (4,) [rad].

        Returns:
            Angles and speeds, shape (4,) each [rad, rad/s]. Without a goal: where they were.
        """
        action = self.active
        if action is not None and action.status == "queued":
            action = self._begin(action)
        if action is None:
            self.dq_ref = np.zeros(4)
            return self.q_ref, self.dq_ref
        if action.status == "cancelling":
            return self._come_to_rest(action)
        path, speeds = self._way
        if self._step < len(path):
            self.q_ref, self.dq_ref = path[self._step], speeds[self._step]
        self._step += 1
        self._report(action, q)
        return self.q_ref, self.dq_ref

    def _begin(self, action: Action) -> Action | None:
        try:
            t, q_way = action.goal.motion(self.q_ref.copy())
            t = times(t, "times")
            q_way = numbers(q_way, "q_way", (len(t), 4), meaning="joint angles")
            self._way = self._trajectory(t - t[0], q_way)
        except ValueError as error:
            self._end(action, "failed", f"it cannot be done: {error}")
            for waiting in list(self.queue):
                self._end(waiting, "cancelled", f"{action.goal.name!r} before it failed")
            return None
        action.status, self._step = "active", 0
        return action

    def _trajectory(self, at: NDArray, q_way: NDArray) -> tuple[NDArray, NDArray]:
        """Angles and speeds at all steps after the first; slower where a joint cannot follow."""
        q_way = np.vstack([self.q_ref, q_way[1:]])
        for _ in range(4):
            t = np.arange(1, round(at[-1] / self.dt) + 1) * self.dt
            q, dq = smooth_trajectory(at, q_way, np.minimum(t, at[-1]))
            excess = float((np.abs(dq) / self.machine.speed_limit).max())
            if excess <= 1.0:
                break
            at = at * excess * 1.01
        return q, dq

    def _report(self, action: Action, q: NDArray) -> None:
        count, every = len(self._way[0]), round(EVERY / self.dt)
        if self._step < count and self._step % every:
            return
        off = float(np.abs(self.q_ref - q).max())
        if self._step % every == 0 or self._step == count:
            done = min(self._step / count, 1.0)
            action.feedback.append(Feedback(self._step * self.dt, done, off))
        if self._step < count:
            return
        if off < THERE:
            self._end(action, "succeeded", f"there, within {off:.3f} rad")
        elif self._step > count + PATIENCE / self.dt:
            self._end(action, "failed", f"a joint is {off:.2f} rad from where it should be")

    def _come_to_rest(self, action: Action) -> tuple[NDArray, NDArray]:
        steps = round(BRAKING / self.dt)
        if self._brake == 0:
            self._falling = self.dq_ref.copy()
        self._brake += 1
        self.dq_ref = self._falling * (1 - self._brake / steps)
        self.q_ref = self.q_ref + self.dq_ref * self.dt
        if self._brake >= steps:
            self._end(action, "cancelled", action.result)
        return self.q_ref, self.dq_ref

    def _end(self, action: Action, status: str, result: str) -> None:
        action.status, action.result = status, result
        self.queue = [waiting for waiting in self.queue if waiting is not action]


def reach(name: str, target: ArrayLike, duration: float, machine: Machine = BACKHOE) -> Goal:
    """A goal to go to straight in the joints, with minimum jerk.

    Args:
        name: for reports.
        target: x, y, z of the stick's tip [m] and the bucket's angle [rad], shape (4,).
        duration: [s].
        machine: whose arm.

    Raises:
        ValueError: target is not 4 finite numbers, or duration is not positive. That the target is
            out of reach makes the action fail.
    """
    target = numbers(target, "target", (4,), meaning="x, y, z and the bucket's angle")
    duration = positive(duration, "duration", "s")

    def motion(q: NDArray) -> tuple[NDArray, NDArray]:
        end = inverse_kinematics(target, machine=machine)
        s = np.linspace(0.0, 1.0, 41)
        share = s**3 * (10 - 15 * s + 6 * s**2)
        return duration * s, q + share[:, None] * (end - q)

    return Goal(name, motion)


def along(
    name: str, t: ArrayLike, path: ArrayLike, begin: float = 1.0, machine: Machine = BACKHOE
) -> Goal:
    """A goal to follow a path of the stick's tip, after some time to come to its beginning.

    Args:
        name: for reports.
        t: times, rising, shape (n,) [s].
        path: x, y, z of the stick's tip [m] and the bucket's angle [rad], shape (n, 4).
        begin: time from where the machine is to the path's first point [s]; 0 if it is there.
        machine: whose arm.

    Raises:
        ValueError: shapes, or a time that is negative.
    """
    t = times(t, "t")
    path = numbers(path, "path", (len(t), 4), meaning="x, y, z and the bucket's angle")
    begin = not_negative(begin, "begin", "s")

    def motion(q: NDArray) -> tuple[NDArray, NDArray]:
        q_way = inverse_kinematics(path, machine=machine)
        later = t - t[0] + begin
        if begin == 0.0:
            return later, q_way
        return np.r_[0.0, later], np.vstack([q, q_way])

    return Goal(name, motion)
