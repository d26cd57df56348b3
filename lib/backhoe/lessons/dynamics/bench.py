"""The bare arm on a test bench in PyBullet, at any step, and the stand from which it falls.

`open_world` always runs at 1 ms with all damping off. Here lesson 02 shows why: the base cannot
move, joints have no limits and no friction, torques are not cut, and what PyBullet does unless told
otherwise can be left on. The stand lifts the arm, so that no ground is in its way.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics, integrate, kinematics
from backhoe.basics.inputs import numbers, positive
from backhoe.machine import BACKHOE, JOINTS, Machine, replace
from backhoe.simulation import bullet
from backhoe.simulation.urdf import urdf
from backhoe.view.replay import Replay, from_joints
from backhoe.view.replay.recording import Line

__all__ = ["let_go", "on_a_stand", "watch"]

STAND = 1.5
"""Height of the stand between undercarriage and house [m]."""

_JOINTS = "joints (swing, boom, stick, bucket)"


def let_go(
    q: ArrayLike,
    torque: ArrayLike,
    seconds: float,
    dt: float = 0.001,
    *,
    damping: bool = False,
    motors: bool = False,
    machine: Machine = BACKHOE,
) -> integrate.Rollout:
    """Let the arm go from rest under constant joint torques and watch it.

    Args:
        q: joint angles at the start, shape (4,) [rad].
        torque: constant joint torques, shape (4,) [N m].
        seconds: how long [s].
        dt: PyBullet's step [s].
        damping: leave PyBullet's default damping of every link on.
        motors: leave PyBullet's default velocity motors on.
        machine: the arm.

    Returns:
        Times (n,) [s] and states (q, dq) of shape (n, 8). Without PyBullet the same integrator runs
        on the library's own equations, without damping and motors.

    Raises:
        ValueError: a wrong shape, a value that is not finite, or a time or step not positive.
    """
    q = numbers(q, "q", (4,), meaning=_JOINTS)
    torque = numbers(torque, "torque", (4,), meaning=f"{_JOINTS} [N m]")
    seconds, dt = positive(seconds, "seconds", "s"), positive(dt, "dt", "s")
    steps = round(seconds / dt)
    try:
        server = bullet.Server()
    except ImportError:
        return integrate.semi_implicit_euler(
            lambda t, q, dq: dynamics.forward_dynamics(q, dq, torque, machine=machine),
            np.concatenate([q, np.zeros(4)]),
            dt,
            steps,
        )
    try:
        server.setTimeStep(dt)
        server.setGravity(0, 0, -machine.gravity)
        body = server.load_urdf(urdf(machine, base="fixed"), useFixedBase=True)
        index = server.joints(body)
        joints = [index[name] for name in JOINTS]
        if not damping:
            server.free(body)
        if not motors:
            server.switch_off(body, joints)
        for joint, angle in zip(joints, q, strict=True):
            server.resetJointState(body, joint, angle)
        states = np.empty((steps + 1, 8))
        states[0] = _read(server, body, joints)
        for step in range(steps):
            server.push(body, joints, torque)
            states[step + 1] = _read(server, body, joints)
    finally:
        server.disconnect()
    return integrate.Rollout(dt * np.arange(steps + 1), states)


def on_a_stand(machine: Machine = BACKHOE) -> Machine:
    """The machine with its house on a stand."""
    return replace(machine, base=replace(machine.base, height=machine.base.height + STAND))


def watch(times: ArrayLike, q: ArrayLike, beside: ArrayLike, title: str, alt: str) -> Replay:
    """A replay of the arm on the stand, with a line where the teeth of another fall went.

    Args:
        times: rising, shape (n,) [s].
        q: joint angles, shape (n, 4) [rad].
        beside: joint angles of the other fall, shape (m, 4) [rad].
        title, alt: as in `replay.from_joints`.

    Raises:
        ValueError: as `replay.from_joints`, or `beside` has a wrong shape or value.
    """
    arm = on_a_stand()
    way = kinematics.forward_kinematics(beside, machine=arm)[..., :3, 3]
    x, top = arm.base.offset, arm.base.height
    corners = ((x + a, b) for a in (-0.4, 0.4) for b in (-0.4, 0.4))
    legs = [[(*at, top - STAND), (*at, top)] for at in corners]
    grey = (0.35, 0.35, 0.35, 1.0)
    lines = (Line(way), *(Line(leg, grey) for leg in legs))
    return from_joints(times, q, title=title, alt=alt, machine=arm, lines=lines)


def _read(server: bullet.Server, body: int, joints: list[int]) -> NDArray:
    states = server.getJointStates(body, joints)
    return np.array([state[0] for state in states] + [state[1] for state in states])
