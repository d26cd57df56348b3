"""How fast an estimate becomes right when the sampling time shrinks.

`winding` is a motion whose speeds both vary and whose pose is known in closed form: the radius of
its path grows evenly with the heading, so the position is an integral over psi alone,

    x = int (R + k psi) cos psi dpsi = (R + k psi) sin psi + k cos psi - k.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import number, numbers, positive, whole


@dataclass(frozen=True)
class Motion:
    """A motion known at every time.

    Attributes:
        v, omega: forward speed [m/s] and turning speed [rad/s] at times t (...) [s].
        pose: x, y, psi at times t, shape (..., 3) [m, m, rad].
        duration: how long it lasts from t = 0 [s].
    """

    v: Callable[[ArrayLike], NDArray]
    omega: Callable[[ArrayLike], NDArray]
    pose: Callable[[ArrayLike], NDArray]
    duration: float

    def instants(self, steps: int) -> NDArray:
        """Times evenly over the duration, shape (steps + 1,) [s]."""
        return np.linspace(0.0, self.duration, steps + 1)


def winding(
    duration: float = 20.0,
    turning: float = 0.3,
    swing: float = 0.5,
    frequency: float = 0.5,
    radius: float = 1.5,
    growth: float = 0.3,
) -> Motion:
    """A spiral outwards with psi = turning t + swing sin(frequency t).

    Args:
        duration: how long [s].
        turning: mean turning speed [rad/s].
        swing: amplitude of the swinging heading [rad]; -turning/frequency starts from rest.
        frequency: of the swinging [rad/s].
        radius: of the path at psi = 0, R [m].
        growth: of that radius with the heading, k [m/rad].

    Returns:
        The motion, from the origin along x.

    Raises:
        ValueError: duration is not positive, or another value is not a finite number.
    """
    duration = positive(duration, "duration", "s")
    turning, swing = number(turning, "turning", "rad/s"), number(swing, "swing", "rad")
    frequency, radius = number(frequency, "frequency", "rad/s"), number(radius, "radius", "m")
    growth = number(growth, "growth", "m/rad")

    def heading(t: NDArray) -> NDArray:
        return turning * t + swing * np.sin(frequency * t)

    def omega(t: ArrayLike) -> NDArray:
        return turning + swing * frequency * np.cos(frequency * np.asarray(t))

    def v(t: ArrayLike) -> NDArray:
        return (radius + growth * heading(np.asarray(t))) * omega(t)

    def pose(t: ArrayLike) -> NDArray:
        psi = heading(np.asarray(t))
        arm = radius + growth * psi
        x = arm * np.sin(psi) + growth * (np.cos(psi) - 1)
        y = radius - arm * np.cos(psi) + growth * np.sin(psi)
        return np.stack([x, y, psi], axis=-1)

    return Motion(v, omega, pose, duration)


def final_errors(
    estimator: Callable[[NDArray, NDArray, NDArray], ArrayLike],
    steps: Sequence[int] = (100, 200, 400, 800, 1600),
    motion: Motion | None = None,
) -> tuple[NDArray, NDArray]:
    """Error of an estimator at the end of a motion, for several sampling times.

    Args:
        estimator: called with t, v, omega, each (N+1,), sampled at the instants; gives poses whose
            last row is the pose at the end, shape (..., 3) [m, m, rad].
        steps: n numbers of intervals N.
        motion: default `winding()`.

    Returns:
        Sampling times [s] and distances from the true end [m], shape (n,) each.

    Raises:
        ValueError: a number of intervals is not whole or below 1, or what the estimator gives does
            not end in a pose of 3 numbers.
    """
    motion = winding() if motion is None else motion
    truth = motion.pose(motion.duration)
    errors = []
    for count in steps:
        t = motion.instants(whole(count, "steps", least=1))
        poses = estimator(t, motion.v(t), motion.omega(t))
        poses = numbers(poses, "the estimator's poses", (..., 3), meaning="values (x, y, psi)")
        errors.append(np.hypot(*(poses.reshape(-1, 3)[-1] - truth)[:2]))
    return motion.duration / np.array(steps), np.array(errors)


def order(steps: ArrayLike, errors: ArrayLike) -> float:
    """Order of convergence: slope of log(error) over log(step), by least squares.

    Args:
        steps: sampling times, two or more, shape (n,) [s].
        errors: an error for each, above 0, shape (n,) [any unit].

    Returns:
        p with error ~ step^p.

    Raises:
        ValueError: shapes that differ, fewer than two, a value not above 0 (an error of 0 has no
            order: take a harder motion).
    """
    steps = numbers(steps, "steps", ("n",))
    errors = numbers(errors, "errors", steps.shape)
    if len(steps) < 2 or (steps <= 0).any() or (errors <= 0).any():
        raise ValueError("steps and errors must be above 0, 2 or more: an error of 0 has no order")
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])
