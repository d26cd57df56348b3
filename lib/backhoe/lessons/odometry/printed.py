"""Odometry exactly as printed: the PUCP guide's (1), (10), (11) and Algorithms 1 to 4, Mastalli's
(4.1) to (4.3) and Algorithm 1. His (2.10) is `backhoe.lessons.kinematics.printed.track_matrix`.

Not for use: lesson 06 tests them, `backhoe.localisation.odometry` has the right ones. What the
print leaves open is read so:

- Algorithms 3 and 4 of the guide ask for f(x_k, .) before x_k exists. On a controller the variable
  holds what the loop before left in it, x_{k-1}, and zeros the first time;
- Mastalli's theta_{k-1} is psi_{k-1}, and the omega_k of (4.2) and of his Algorithm 1, which he
  does not define, is omega_{k-1} unless given;
- his sprockets come in the order right, left, as he prints them.

Reference: PUCP guide 2024; Mastalli 2013, section 4.1.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.localisation.odometry.streaming import State

__all__ = [
    "THRESHOLD",
    "algorithm_1",
    "algorithm_2",
    "algorithm_3",
    "algorithm_4",
    "mastalli_algorithm_1",
    "position_1",
    "right_side_10",
    "right_side_11",
    "roll_out",
    "step_41",
    "step_42",
    "step_43",
]

THRESHOLD = 0.001
"""Below it, sign included, Mastalli's Algorithm 1 takes a motion for straight [rad/s]."""

Rate = Callable[[NDArray, NDArray], ArrayLike]


def position_1(t: ArrayLike, v: ArrayLike, x0: float = 0.0) -> NDArray:
    """x(t) of PUCP (1), the integral of v without x(0), by trapezoids.

    Args:
        t: times, shape (n,) [s].
        v: speeds at them, shape (n,) [m/s].
        x0: where the movement begins, for which (1) has no place [m].

    Returns:
        Shape (n,) [m].
    """
    t, v = np.asarray(t, float), np.asarray(v, float)
    return np.concatenate([[0.0], np.cumsum((v[1:] + v[:-1]) / 2 * np.diff(t))])


def algorithm_1(J: ArrayLike, t: ArrayLike, omega: ArrayLike) -> NDArray:
    """PUCP Algorithm 1, linear estimation by Euler's method, from x = 0 and t_{k-1} = 0.

    Args:
        J: constant Jacobian, shape (n, m).
        t: what GetTime gives in each loop, shape (N,) [s].
        omega: what ReadSensors gives, shape (N, m) [rad/s].

    Returns:
        x_k after each loop, shape (N, n).
    """
    J = np.asarray(J, float)
    return algorithm_3(lambda x, u: J @ u, t, omega, len(J))


def algorithm_2(J: ArrayLike, t: ArrayLike, omega: ArrayLike) -> NDArray:
    """PUCP Algorithm 2, linear estimation by the bilinear method, omega_{k-1} = 0 at the start.

    Args, returns: as for `algorithm_1`.
    """
    J, omega = np.asarray(J, float), np.asarray(omega, float)
    x, old, t_old = np.zeros(len(J)), np.zeros(omega.shape[1]), 0.0
    estimates = []
    for time, u in zip(t, omega, strict=True):
        x = x + (time - t_old) / 2 * (J @ (u + old))
        old, t_old = u, time
        estimates.append(x)
    return np.array(estimates)


def algorithm_3(f: Rate, t: ArrayLike, omega: ArrayLike, size: int = 3) -> NDArray:
    """PUCP Algorithm 3, non-linear estimation by Euler's method, as a controller executes it.

    Args:
        f: rate f(x, omega) of x.
        t: what GetTime gives in each loop, shape (N,) [s].
        omega: what ReadSensors gives, shape (N, m) [rad/s].
        size: number of components of x.

    Returns:
        x_k after each loop, shape (N, size).
    """
    x, t_old = np.zeros(size), 0.0
    estimates = []
    for time, u in zip(t, np.asarray(omega, float), strict=True):
        x = x + (time - t_old) * np.asarray(f(x, u))
        t_old = time
        estimates.append(x)
    return np.array(estimates)


def algorithm_4(f: Rate, t: ArrayLike, omega: ArrayLike, size: int = 3) -> NDArray:
    """PUCP Algorithm 4, non-linear estimation by the bilinear method, as a controller executes it.

    Args, returns: as for `algorithm_3`.
    """
    x, old, t_old = np.zeros(size), np.zeros(size), 0.0
    estimates = []
    for time, u in zip(t, np.asarray(omega, float), strict=True):
        rate = np.asarray(f(x, u))
        x = x + (time - t_old) / 2 * (rate + old)
        old, t_old = rate, time
        estimates.append(x)
    return np.array(estimates)


def right_side_10(x_k: ArrayLike, state: State, t: float, u: ArrayLike, f: Rate) -> NDArray:
    """The right side of PUCP (10), which asks for the x_k that it is to give.

    Args:
        x_k: estimate at t, shape (n,), of any unit.
        state: time, estimate and sample before.
        t: time of the new sample [s].
        u: the sample, shape (m,), of any unit.
        f: rate f(x, u) of x.

    Returns:
        Shape (n,).
    """
    return state.x + (t - state.t) * np.asarray(f(x_k, u))


def right_side_11(x_k: ArrayLike, state: State, t: float, u: ArrayLike, f: Rate) -> NDArray:
    """The right side of PUCP (11). Args, returns: as for `right_side_10`."""
    return state.x + (t - state.t) / 2 * (np.asarray(f(x_k, u)) + np.asarray(f(state.x, state.u)))


def step_41(pose: ArrayLike, v: float, omega: float, T: float) -> NDArray:
    """Mastalli (4.1), Euler's method, with the heading psi_k of the end.

    Args:
        pose: x, y, psi at k-1, shape (3,) [m, m, rad].
        v, omega: at k-1 [m/s], [rad/s].
        T: sample time [s].

    Returns:
        Pose at k, shape (3,).
    """
    x, y, psi = pose
    psi = psi + omega * T
    return np.array([x + v * T * np.cos(psi), y + v * T * np.sin(psi), psi])


def step_42(
    pose: ArrayLike, v: float, omega: float, T: float, omega_k: float | None = None
) -> NDArray:
    """Mastalli (4.2), "Runge-Kutta of second order", at psi_k + omega_k T / 2.

    Args: as for `step_41`; omega_k of the new sample, default omega [rad/s].

    Returns:
        Pose at k, shape (3,).
    """
    x, y, psi = pose
    psi = psi + omega * T
    along = psi + (omega if omega_k is None else omega_k) * T / 2
    return np.array([x + v * T * np.cos(along), y + v * T * np.sin(along), psi])


def step_43(pose: ArrayLike, v: float, omega: float, T: float) -> NDArray:
    """Mastalli (4.3), "exact", with cos and sin changed over; omega must not be 0.

    Args, returns: as for `step_41`.
    """
    x, y, old = pose
    psi = old + omega * T
    dx = v / omega * (np.cos(psi) - np.cos(old))
    dy = -v / omega * (np.sin(psi) - np.sin(old))
    return np.array([x + dx, y + dy, psi])


def mastalli_algorithm_1(
    pose: ArrayLike,
    Omega_r: float,
    Omega_l: float,
    r: float,
    gauge: float,
    T: float,
) -> NDArray:
    """Mastalli's Algorithm 1: (4.2) if omega < 0.001, all turns to the right included, else (4.3).

    Args:
        pose: x, y, psi at k-1, shape (3,) [m, m, rad].
        Omega_r, Omega_l: speeds of the sprockets [rad/s].
        r, gauge: their radius and l, the distance between the tracks [m].
        T: sample time [s].

    Returns:
        Pose at k, shape (3,).
    """
    v, omega = (r * Omega_r + r * Omega_l) / 2, (r * Omega_r - r * Omega_l) / gauge
    return (step_42 if omega < THRESHOLD else step_43)(pose, v, omega, T)


def roll_out(step: Callable[..., NDArray], pose0: ArrayLike, *inputs: ArrayLike, T: float):
    """Repeat a step of this module.

    Args:
        step: called as step(pose, *inputs of the sample, T=T).
        pose0: x, y, psi at the start, shape (3,) [m, m, rad].
        inputs: such as v and omega, each of shape (N,).
        T: sample time [s].

    Returns:
        Shape (N+1, 3), the first row pose0.
    """
    poses = [np.asarray(pose0, float)]
    for sample in zip(*inputs, strict=True):
        poses.append(step(poses[-1], *map(float, sample), T=T))
    return np.array(poses)
