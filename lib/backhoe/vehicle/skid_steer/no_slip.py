"""The kinematic and the linear model over many samples, vectorised over runs.

In both, each speed runs from where it is to the value that its command gives, by one rate (infinite
in the kinematic model): speed(t) = final + (speed - final) exp(-rate t). Heading follows in closed
form, and position by Gauss's rule within each sample. `plant` has the same for one vehicle, step by
step.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from backhoe.vehicle.skid_steer.kinematics import wheel_speeds
from backhoe.vehicle.skid_steer.linear_model import rates
from backhoe.vehicle.skid_steer.vehicle import Vehicle

NODES, WEIGHTS = (x / 2 for x in np.polynomial.legendre.leggauss(4))
"""Gauss's rule over an interval from -1/2 to 1/2."""


def states(
    command: NDArray, vehicles: Sequence[Vehicle], start: NDArray, dt: float, model: str
) -> NDArray:
    """States at the ends of the samples, from rest.

    Args:
        command: v_ref and omega_ref, shape (2, runs, n) [m/s, rad/s].
        vehicles: one a run.
        start: first poses, shape (runs, 3) [m, m, rad].
        dt: sample time [s].
        model: "kinematic" or "linear".

    Returns:
        Pose, velocity and wheel speeds as in `slipping`, shape (runs, n + 1, 10).
    """
    gain, rate = (x[..., None] for x in gain_and_rate(vehicles, model))
    final = gain * command
    speed = _speeds(final, np.exp(-rate * dt))
    theta, place = _poses(final, speed[..., :-1] - final, rate, dt, start)
    x_icr = np.array([[p.x_icr] for p in vehicles])
    place = place - x_icr * (np.exp(1j * theta) - np.exp(1j * theta[:, :1]))
    twist = np.moveaxis(speed, 0, -1)
    wheels = np.stack([wheel_speeds(twist[i], p) for i, p in enumerate(vehicles)])
    columns = (place.real, place.imag, theta, speed[0], -x_icr * speed[1], speed[1])
    return np.concatenate([np.stack(columns, axis=-1), wheels, wheels], axis=-1)


def gain_and_rate(vehicles: Sequence[Vehicle], model: str) -> tuple[NDArray, NDArray]:
    """Steady speed over command, and the rate towards it [1/s], for v and omega: (2, runs) each."""
    if model == "kinematic":
        return np.ones((2, len(vehicles))), np.full((2, len(vehicles)), np.inf)
    drive_v, drag_v, drive_omega, drag_omega = np.array([rates(p) for p in vehicles]).T
    pull = np.stack([drive_v, drive_omega])
    total = pull + np.stack([drag_v, drag_omega])
    return pull / total, total


def _speeds(final: NDArray, decay: NDArray) -> NDArray:
    speed = np.zeros((*final.shape[:-1], final.shape[-1] + 1))
    for k in range(final.shape[-1]):
        speed[..., k + 1] = final[..., k] + (speed[..., k] - final[..., k]) * decay[..., 0]
    return speed


def _poses(
    final: NDArray, missing: NDArray, rate: NDArray, dt: float, start: NDArray
) -> tuple[NDArray, NDArray]:
    """Headings and complex positions X + iY, (runs, n + 1) each, with `missing` = speed - final."""

    def turned(t: float) -> NDArray:
        return final[1] * t - missing[1] * np.expm1(-rate[1] * t) / rate[1]

    theta = np.cumsum(np.c_[start[:, 2], turned(dt)], axis=1)
    move = np.zeros(final.shape[1:], complex)
    for t, weight in zip(dt * (NODES + 0.5), dt * WEIGHTS, strict=True):
        v = final[0] + missing[0] * np.exp(-rate[0] * t)
        move += weight * v * np.exp(1j * (theta[:, :-1] + turned(t)))
    first = start[:, 0] + 1j * start[:, 1]
    return theta, np.cumsum(np.c_[first, move], axis=1)
