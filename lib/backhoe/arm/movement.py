"""Movements of the arm in time: where the joints should be, how fast, and how they accelerate.

`loading` is the 35 s movement on which the arm's controllers are tuned and judged. The thesis shows
it in figures (3.2 to 3.4) and prints no numbers but its times and its fastest speed; the way-points
are ours, laid out for the scene in which the mission digs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.basics import inputs
from backhoe.machine import BACKHOE, JOINTS, Machine

__all__ = ["PHASES", "Movement", "from_postures", "from_targets", "loading"]

PHASES = {"wait": (0.0, 5.0), "load": (5.0, 20.0), "return": (20.0, 35.0)}
"""Begin and end of the phases of `loading` [s]; the arm rests at each of these times."""

_LOADING = (
    ("parked", 0.0, -90, 4.6, 2.6, 60),
    ("wait", 5.0, -90, 6.0, 3.6, 60),
    ("cut in", 7.0, -90, 6.4, 2.0, 84),
    ("pull", 8.5, -90, 5.6, 1.5, 68),
    ("curl", 10.5, -90, 5.9, 1.2, 6),
    ("lift", 12.5, -90, 5.9, 3.2, -25),
    ("over the truck", 16.5, 0, 5.7, 3.9, -21),
    ("empty", 20.0, 0, 5.7, 3.9, 90),
    ("wait again", 35.0, -90, 6.0, 3.6, 60),
)
"""Name, time [s], swing [deg], reach from the swing axis and height [m], bucket [deg]."""

_NO_MOTION = 1e-12
"""Angles closer than this are one angle [rad]: the joint then waits exactly, without rounding."""


@dataclass(frozen=True, eq=False)
class Movement:
    """Reference of a movement, one row for each sample.

    Attributes:
        t: times, evenly spaced and rising, shape (n,), n at least 2 [s].
        q, dq, ddq: joint angles, speeds and accelerations, shape (n, 4) [rad, rad/s, rad/s^2].

    Raises:
        ValueError: another shape, a value that is not finite, times that do not rise evenly.
    """

    t: NDArray
    q: NDArray
    dq: NDArray
    ddq: NDArray

    def __post_init__(self) -> None:
        checked = {"t": inputs.times(self.t, "Movement.t")}
        for name in ("q", "dq", "ddq"):
            shape = (len(checked["t"]), 4)
            checked[name] = inputs.numbers(getattr(self, name), f"Movement.{name}", shape)
        for name, values in checked.items():
            object.__setattr__(self, name, values)
        steps = np.diff(self.t)
        if np.ptp(steps) > 1e-6 * self.dt:
            raise ValueError(
                f"Movement.t must be evenly spaced, its steps are {steps.min():g} to "
                f"{steps.max():g} s"
            )

    def __len__(self) -> int:
        return len(self.t)

    @property
    def dt(self) -> float:
        """Time between two samples [s]."""
        return float((self.t[-1] - self.t[0]) / (len(self.t) - 1))

    @property
    def speed(self) -> NDArray:
        """Norm of the four joint speeds, shape (n,) [rad/s]: Fig. 3.4 of the thesis."""
        return np.linalg.norm(self.dq, axis=1)


def from_postures(
    times: ArrayLike,
    postures: ArrayLike,
    dt: float = 1e-3,
    machine: Machine = BACKHOE,
    rest: Sequence[int] = (),
) -> Movement:
    """A movement through joint angles: quintic splines between the points at which the arm rests.

    Position, speed and acceleration are continuous everywhere and zero speed and acceleration hold
    at rest; between two rests without a way-point this is the minimum-jerk movement.

    Args:
        times: when, rising from 0, whole multiples of dt, shape (m,) with m at least 2 [s].
        postures: joint angles then, shape (m, 4) [rad].
        dt: sampling time [s].
        machine: whose joint ranges and speeds are not to be left.
        rest: indices of the way-points at which the arm stops, besides the first and the last.

    Returns:
        The movement, with a sample at 0 and at the last time.

    Raises:
        ValueError: another shape, a value that is not finite, times that do not rise from 0 or are
            no multiples of dt, rest out of range, or a joint that leaves its range or is too fast.
    """
    times, steps = _way_times(times, dt)
    meaning = "joint angles [rad], one row for each time"
    postures = inputs.numbers(postures, "postures", (len(times), 4), meaning=meaning)
    stops = sorted({0, len(times) - 1, *inputs.indices(rest, "rest", len(times))})
    movement = Movement(dt * np.arange(steps[-1] + 1), *_spline(times, postures, steps, stops, dt))
    _within_range(movement, machine)
    _within_speed(movement, machine)
    return movement


def from_targets(
    times: ArrayLike,
    targets: ArrayLike,
    dt: float = 1e-3,
    machine: Machine = BACKHOE,
    rest: Sequence[int] = (),
) -> Movement:
    """A movement of the stick's tip and the bucket's joint, by inverse kinematics.

    The way-points are turned into joint angles and joined there, so the tip does not move on
    straight lines between them.

    Args:
        times: when, as for `from_postures` [s].
        targets: x, y, z of the stick's tip in the base frame [m] and the angle of the bucket's
            joint [rad], shape (m, 4).
        dt, machine, rest: as for `from_postures`.

    Returns:
        The movement.

    Raises:
        ValueError: a target that the arm does not reach, and as for `from_postures`.
    """
    return from_postures(
        times, kinematics.inverse_kinematics(targets, machine=machine), dt, machine, rest
    )


def loading(dt: float = 1e-3, machine: Machine = BACKHOE) -> Movement:
    """The loading movement: wait for the task, dig and load a truck, return; 35 s.

    The arm goes to where it waits (0 to 5 s), cuts into the heap, lifts, swings to the truck and
    tips out (5 to 20 s), and comes back (20 to 35 s). It rests at the ends of each phase. The norm
    of the joint speeds has its peak while the bucket tips out, at the thesis's 59.5 deg/s.

    Source: Mastalli 2013, section 3.4.1 and Figs. 3.2 to 3.4, which give the times, the phases and
    the fastest speed; the way-points are ours.

    Args:
        dt: sampling time [s]; 0.5 s is a multiple of it.
        machine: the machine.

    Returns:
        The movement, 35 s / dt + 1 samples.

    Raises:
        ValueError: 0.5 s is no multiple of dt, or this machine does not reach the way-points.
    """
    names, seconds, swing, reach, height, bucket = zip(*_LOADING, strict=True)
    across = np.radians(swing)
    targets = np.stack(
        [
            machine.base.offset - reach * np.sin(across),
            reach * np.cos(across),
            np.array(height),
            np.radians(bucket),
        ],
        axis=-1,
    )
    rest = [names.index(name) for name in ("wait", "lift", "over the truck", "empty")]
    return from_targets(seconds, targets, dt, machine, rest)


def _way_times(times: ArrayLike, dt: float) -> tuple[NDArray, NDArray]:
    """Times of the way-points and the samples on which they fall."""
    dt, times = inputs.positive(dt, "dt", "s"), inputs.times(times, "times")
    if times[0] != 0:
        raise ValueError(f"times must rise from 0, got {times}")
    steps = np.round(times / dt).astype(int)
    if np.abs(steps * dt - times).max() > 1e-6 * dt:
        raise ValueError(f"times must be multiples of dt = {dt:g} s, got {times}")
    return times, steps


def _spline(
    times: NDArray, postures: NDArray, steps: NDArray, stops: list[int], dt: float
) -> tuple[NDArray, NDArray, NDArray]:
    """Angles, speeds and accelerations on the samples, a spline from each stop to the next."""
    from scipy.interpolate import make_interp_spline

    still = [(1, np.zeros(4)), (2, np.zeros(4))]
    found = np.empty((3, steps[-1] + 1, 4))
    for first, last in pairwise(stops):
        way = slice(first, last + 1)
        spline = make_interp_spline(times[way], postures[way], k=5, bc_type=(still, still))
        samples = np.arange(steps[first], steps[last] + 1)
        for order in range(3):
            found[order, samples] = spline(np.minimum(samples * dt, times[last]), nu=order)
        found[1:, samples[[0, -1]]] = 0.0
        waiting = np.flatnonzero(np.ptp(postures[way], axis=0) < _NO_MOTION)
        found[0, samples[:, None], waiting] = postures[first, waiting]
        found[1:, samples[:, None], waiting] = 0.0
    return tuple(found)


def _within_range(movement: Movement, machine: Machine) -> None:
    excess = np.maximum(machine.lower - movement.q, movement.q - machine.upper)
    row, joint = np.unravel_index(excess.argmax(), excess.shape)
    if excess[row, joint] > 1e-9:
        raise ValueError(
            f"the {JOINTS[joint]} would be at {np.degrees(movement.q[row, joint]):.1f} deg at "
            f"{movement.t[row]:.2f} s, outside its range of "
            f"{np.degrees(machine.lower[joint]):.0f} to {np.degrees(machine.upper[joint]):.0f} deg:"
            " move or add a way-point"
        )


def _within_speed(movement: Movement, machine: Machine) -> None:
    share = np.abs(movement.dq) / machine.speed_limit
    row, joint = np.unravel_index(share.argmax(), share.shape)
    if share[row, joint] > 1.0:
        raise ValueError(
            f"the {JOINTS[joint]} would turn at {abs(movement.dq[row, joint]):.2f} rad/s at "
            f"{movement.t[row]:.2f} s, its limit is {machine.speed_limit[joint]:.2f}: take "
            f"{share[row, joint]:.2f} times as long there"
        )
