"""Dead reckoning: poses from velocities that were measured in the vehicle.

A pose is (x, y, psi), psi anticlockwise from the world's x axis and never wrapped. Within a step
the velocity is held, so psi changes evenly, and the methods differ only in the heading along which
they take the distance d = v dt, with psi_1 = psi_0 + omega dt and h = omega dt / 2:

| method | the step moves by | order, velocity held | where |
|---|---|---|---|
| `euler` | d at psi_0 | 1 | Mastalli (4.1), corrected |
| `midpoint` | d at psi_0 + h | 2 | Mastalli (4.2), corrected; Runge-Kutta of second order |
| `bilinear` | mean of d at psi_0 and at psi_1 | 2 | PUCP (11); Heun's rule is the same here |
| `rk4` | (d at psi_0 + 4 d at psi_0 + h + d at psi_1) / 6 | 4 | Simpson's rule here |
| `exact` | d sin(h)/h at psi_0 + h | exact | Mastalli (4.3), corrected; exp of SE(2) |

Heun and the trapezoid, and Runge-Kutta and Simpson, coincide because the rate of the pose does not
depend on x and y and psi is known at every instant. None is wrong for a straight line.

A velocity that varies and is known only at instants adds an error of its own: see `from_samples`.
"""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import alike, choice, number, numbers, steps, times

METHODS = ("euler", "midpoint", "bilinear", "rk4", "exact")
RULES = ("left", "right", "trapezoid")

_HEADINGS = {
    "euler": ((0.0, 1.0),),
    "midpoint": ((0.5, 1.0),),
    "bilinear": ((0.0, 1 / 2), (1.0, 1 / 2)),
    "rk4": ((0.0, 1 / 6), (0.5, 4 / 6), (1.0, 1 / 6)),
    "exact": ((0.5, 1.0),),
}
"""Where in the turn of a step each method looks, and the weight of what it sees."""

_SAMPLES = "samples, one for each time"


def integrate(
    pose0: ArrayLike, v: ArrayLike, omega: ArrayLike, dt: ArrayLike, method: str = "exact"
) -> NDArray:
    """Poses of a vehicle whose speeds are held from step to step.

    Args:
        pose0: x, y, psi at the start, shape (3,) for all rows or (..., 3) [m, m, rad].
        v: forward speed in each of N intervals, shape (..., N) [m/s].
        omega: turning speed, the shape of v [rad/s].
        dt: length of the intervals, one for all or shape (N,) [s].
        method: one of `METHODS`.

    Returns:
        Poses at the start and after each interval, shape (..., N+1, 3); psi is not wrapped.

    Raises:
        ValueError: shapes that do not fit, a value that is not finite, dt not above 0, an unknown
            method.
    """
    v, omega = numbers(v, "v", (..., "N")), numbers(omega, "omega", (..., "N"))
    alike(v=v, omega=omega)
    pose0 = numbers(pose0, "pose0", (..., 3), meaning="values (x, y, psi)")
    dt = steps(dt, v.shape[-1])
    way, turn = v * dt, omega * dt
    if pose0.ndim > 1 and pose0.shape[:-1] != turn.shape[:-1]:
        batch = "" if turn.ndim == 1 else f" or {(*turn.shape[:-1], 3)}"
        raise ValueError(
            f"pose0 must be (3,){batch} for velocities of shape {turn.shape}, got {pose0.shape}: "
            "one row of velocities for each start"
        )
    poses = np.empty((*turn.shape[:-1], turn.shape[-1] + 1, 3))
    poses[..., 0, :] = pose0
    poses[..., 1:, 2] = poses[..., 0, 2, None] + np.cumsum(turn, axis=-1)
    for axis, direction in enumerate(_direction(poses[..., :-1, 2], turn, method)):
        moved = np.cumsum(way * direction, axis=-1)
        np.add(moved, poses[..., :1, axis], out=poses[..., 1:, axis])
    return poses


def from_samples(
    pose0: ArrayLike,
    t: ArrayLike,
    v: ArrayLike,
    omega: ArrayLike,
    *,
    rule: str = "trapezoid",
    method: str = "midpoint",
) -> NDArray:
    """Poses from a velocity sampled at instants, between which it may vary.

    The rule turns N+1 samples into N held values (`intervals`), then `integrate` goes on. With
    "left" or "right" every method is of order 1; with "trapezoid" all are of order 2 but "euler",
    which stays at 1. "trapezoid" with "bilinear" averages the rates at both instants, v cos psi
    and v sin psi, as PUCP (11) does: there the heading at the end is known, so nothing is implicit.

    Args:
        pose0: x, y, psi at t[0], shape (3,) or (..., 3) [m, m, rad].
        t: instants, rising, shape (N+1,) [s].
        v, omega: samples at them, shape (..., N+1) [m/s], [rad/s].
        rule: one of `RULES`.
        method: one of `METHODS`.

    Returns:
        Poses at the instants, shape (..., N+1, 3); psi is not wrapped.

    Raises:
        ValueError: as for `integrate`; t that does not rise, an unknown rule.
    """
    t = times(t)
    v = numbers(v, "v", (..., len(t)), meaning=_SAMPLES)
    omega = numbers(omega, "omega", (..., len(t)), meaning=_SAMPLES)
    dt, turning = intervals(t, omega, rule)
    _, forward = intervals(t, v, rule)
    if rule == "trapezoid" and choice(method, "method", METHODS) == "bilinear":
        poses = integrate(pose0, forward, turning, dt, "euler")
        for axis, direction in enumerate(_cos_sin(poses[..., 2])):
            rate = v * direction
            np.cumsum((rate[..., 1:] + rate[..., :-1]) / 2 * dt, -1, out=poses[..., 1:, axis])
            poses[..., 1:, axis] += poses[..., :1, axis]
        return poses
    return integrate(pose0, forward, turning, dt, method)


def intervals(t: ArrayLike, u: ArrayLike, rule: str = "trapezoid") -> tuple[NDArray, NDArray]:
    """Samples at instants as values held between them.

    Args:
        t: instants, rising, shape (N+1,) [s].
        u: samples at them, shape (..., N+1), of any unit.
        rule: "left" holds the older sample, "right" the newer (PUCP (2), (3)), "trapezoid" the mean
            of both (PUCP (4), (5)).

    Returns:
        Lengths of the intervals (N,) [s], and held values (..., N).

    Raises:
        ValueError: t does not rise, u has another number of samples, an unknown rule.
    """
    t = times(t)
    u = numbers(u, "u", (..., len(t)), meaning=_SAMPLES)
    older, newer = u[..., :-1], u[..., 1:]
    held = {"left": older, "right": newer}.get(choice(rule, "rule", RULES))
    return np.diff(t), (older + newer) / 2 if held is None else held


def advance(pose: ArrayLike, distance: float, turn: float, method: str = "exact") -> NDArray:
    """One step from increments, as encoders give them: for loops and filters.

    Args:
        pose: x, y, psi, shape (3,) [m, m, rad].
        distance: way of the vehicle's middle, positive forwards [m].
        turn: change of heading, positive anticlockwise [rad].
        method: one of `METHODS`.

    Returns:
        The next pose, shape (3,) [m, m, rad]; psi is not wrapped.

    Raises:
        ValueError: pose is not 3 finite numbers, an increment not one, an unknown method.
    """
    x, y, psi = numbers(pose, "pose", (3,), meaning="values (x, y, psi)").tolist()
    d, turn = number(distance, "distance", "m"), number(turn, "turn", "rad")
    headings = _HEADINGS[choice(method, "method", METHODS)]
    if method == "exact" and turn:
        d *= sin(turn / 2) / (turn / 2)
    dx = d * sum(weight * cos(psi + share * turn) for share, weight in headings)
    dy = d * sum(weight * sin(psi + share * turn) for share, weight in headings)
    return np.array([x + dx, y + dy, psi + turn])


def _direction(start: NDArray, turn: NDArray, method: str) -> tuple[NDArray, NDArray]:
    """Mean of cos psi and sin psi over a step, each shape (..., N), as the method takes it."""
    chord = np.sinc(turn / (2 * np.pi)) if choice(method, "method", METHODS) == "exact" else 1.0
    mean_cos, mean_sin = 0.0, 0.0
    for share, weight in _HEADINGS[method]:
        part_cos, part_sin = _cos_sin(start + share * turn if share else start)
        mean_cos, mean_sin = mean_cos + weight * part_cos, mean_sin + weight * part_sin
    return chord * mean_cos, chord * mean_sin


def _cos_sin(angle: NDArray) -> tuple[NDArray, NDArray]:
    """cos and sin from the tangent of the half angle, twice as fast as apart."""
    t = np.tan(angle / 2)
    square = 1 + t * t
    return 2 / square - 1, 2 * t / square
