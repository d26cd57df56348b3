"""One closed loop, sample by sample, as the books write it: what `engine` does in lanes.

Slow and short. The tests hold the engine's numbers to these.
"""

from __future__ import annotations

from math import ceil

import numpy as np
from numpy.typing import NDArray

from backhoe.arm import dynamics
from backhoe.arm.closed_loop.task import COULOMB_SMOOTHING, Task
from backhoe.arm.integrate import motion, rk4
from backhoe.machine import Machine, variants

_BEND, _SHARE = 8.0, 0.05
"""Within so many smoothing speeds of rest, a step changes a speed by such a share of one."""

_SLOW, _NO_CHANGE, _IN_BEND = 4.0, 1e-5, 0.25
"""Within so many smoothing speeds of rest, a speed that changes by more than that [rad/s] in a
sample takes steps of that share of the time in which friction settles it."""

_STABLE = 1.0
"""Longest step anywhere, in times in which friction settles a slow speed."""

_LONGEST_TURN = 0.1
"""Largest turn of a link in one step [rad]."""

_MOST_STEPS = 64.0

NO_FRICTION = (0.0, 0.0, 0.0, 0.0)


def follow(task: Task, run: int = 0) -> tuple[NDArray, NDArray, NDArray]:
    """Let one run of a task follow its movement to the end, diverged or not.

    Returns:
        Angles [rad], speeds [rad/s] and torques [N m] at the m samples, shape (m, 4) each.
    """
    movement, dt = task.movement, task.movement.dt
    machine = variants.loaded(task.payload[run], task.machine)
    kp, ki, kd = (gain[run] for gain in task.gains)
    q, dq, integral = task.q0[run], movement.dq[0], task.integral[run]
    settling, log = task.settling_rates, np.empty((3, len(movement), 4))
    rate = last = np.zeros(4)
    for i in range(len(movement)):
        if i % task.state_every == 0:
            q_seen, dq_seen = q, dq
        error = movement.q[i] - q_seen
        if task.rate == "measured":
            rate = movement.dq[i] - dq_seen
        elif i > 0:
            rate = (task.filter_time * rate + error - last) / (task.filter_time + dt)
        last = error
        wanted = kp * error + ki * (integral + error * dt) + kd * rate
        if task.law == "pid+gravity":
            wanted = wanted + dynamics.gravity_torque(q_seen, task.model)
        elif task.law == "computed_torque":
            ddq = movement.ddq[i] + wanted
            wanted = dynamics.inverse_dynamics(q_seen, dq_seen, ddq, machine=task.model)
        torque = np.clip(wanted, -task.torque_limit, task.torque_limit)
        goes_on = (torque == wanted) | (wanted * error <= 0)
        integral = np.where(goes_on, integral + error * dt, integral)
        log[:, i] = q, dq, torque
        q, dq = _advance(task, i, machine, settling[i], q, dq, torque)
    return tuple(log)


def _advance(
    task: Task,
    i: int,
    machine: Machine,
    settling: NDArray,
    q: NDArray,
    dq: NDArray,
    torque: NDArray,
) -> list[NDArray]:
    """Angles and speeds at the next sample, by Runge-Kutta with the torque held."""

    def acceleration(t: float, q: NDArray, dq: NDArray) -> NDArray:
        taken = task.friction * dynamics.friction_torque(dq, machine, COULOMB_SMOOTHING)
        return dynamics.forward_dynamics(q, dq, torque - taken, machine=machine)

    movement, dt = task.movement, task.movement.dt
    count = max(
        steps(movement.dq[i], movement.ddq[i], NO_FRICTION, settling, dt),
        steps(dq, acceleration(0.0, q, dq), task.friction * machine.coulomb, settling, dt),
    )
    return np.split(rk4(motion(acceleration), np.r_[q, dq], dt / count, count).x[-1], 2)


def steps(dq, ddq, coulomb, settling, dt):
    """Steps in which friction's bend is passed in small parts, and a link turns little."""
    most, turn = 1.0, 0.0
    for k in range(4):
        speed, change = abs(dq[k]), abs(ddq[k]) * dt
        slow = speed < _SLOW * COULOMB_SMOOTHING and change > _NO_CHANGE
        most = max(most, dt * settling[k] / (_IN_BEND if slow else _STABLE))
        if coulomb[k] > 0 and speed < _BEND * COULOMB_SMOOTHING + change:
            most = max(most, change / (_SHARE * COULOMB_SMOOTHING))
        turn += speed + change
    most = max(most, turn * dt / _LONGEST_TURN)
    return ceil(min(most, _MOST_STEPS))
