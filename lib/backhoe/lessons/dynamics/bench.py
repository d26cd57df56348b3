"""The bare arm on a test bench in PyBullet: any step, and PyBullet's own defaults if wanted.

`open_world` always runs at 1 ms with all damping off. Here lesson 02 shows why: the base cannot
move, joints have no limits and no friction, torques are not cut, and what PyBullet does unless told
otherwise can be left on.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics, integrate
from backhoe.arm.kinematics import joint_vector
from backhoe.machine import BACKHOE, JOINTS, Machine
from backhoe.simulation import bullet
from backhoe.simulation.backends import announce_fallback
from backhoe.simulation.urdf import urdf

__all__ = ["let_go"]


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
        Times (n,) [s] and states (q, dq) of shape (n, 8). Without PyBullet one line says so, and
        the same integrator runs on the library's own equations, without damping and motors.

    Raises:
        ValueError: a wrong shape, a value that is not finite, or a time or step not positive.
    """
    q, torque = joint_vector(q), joint_vector(torque, "torque")
    if q.shape != (4,) or torque.shape != (4,):
        raise ValueError(f"one posture and one torque, please: got {q.shape} and {torque.shape}")
    if not (seconds > 0 and dt > 0):
        raise ValueError(f"seconds and dt must be positive, got {seconds!r} and {dt!r}")
    steps = round(seconds / dt)
    try:
        engine = bullet.pybullet()
    except ImportError:
        announce_fallback()
        return integrate.semi_implicit_euler(
            lambda t, q, dq: dynamics.forward_dynamics(q, dq, torque, machine=machine),
            np.concatenate([q, np.zeros(4)]),
            dt,
            steps,
        )
    client = bullet.connect()
    try:
        body, joints = _mount(engine, client, q, dt, damping, motors, machine)
        states = np.empty((steps + 1, 8))
        states[0] = _read(engine, client, body, joints)
        for step in range(steps):
            engine.setJointMotorControlArray(
                body, joints, engine.TORQUE_CONTROL, forces=torque.tolist(), physicsClientId=client
            )
            engine.stepSimulation(physicsClientId=client)
            states[step + 1] = _read(engine, client, body, joints)
    finally:
        engine.disconnect(physicsClientId=client)
    return integrate.Rollout(dt * np.arange(steps + 1), states)


def _mount(
    engine: object,
    client: int,
    q: NDArray,
    dt: float,
    damping: bool,
    motors: bool,
    machine: Machine,
) -> tuple[int, list[int]]:
    engine.setTimeStep(dt, physicsClientId=client)
    engine.setGravity(0, 0, -machine.gravity, physicsClientId=client)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "backhoe.urdf"
        path.write_text(urdf(machine, base="fixed"))
        body = engine.loadURDF(
            str(path),
            useFixedBase=True,
            flags=engine.URDF_USE_INERTIA_FROM_FILE,
            physicsClientId=client,
        )
    count = engine.getNumJoints(body, physicsClientId=client)
    names = [
        engine.getJointInfo(body, index, physicsClientId=client)[1].decode()
        for index in range(count)
    ]
    joints = [names.index(name) for name in JOINTS]
    if not damping:
        for index in range(-1, count):
            engine.changeDynamics(
                body,
                index,
                linearDamping=0,
                angularDamping=0,
                jointDamping=0,
                physicsClientId=client,
            )
    if not motors:
        engine.setJointMotorControlArray(
            body, joints, engine.VELOCITY_CONTROL, forces=[0.0] * 4, physicsClientId=client
        )
    for index, angle in zip(joints, q, strict=True):
        engine.resetJointState(body, index, angle, physicsClientId=client)
    return body, joints


def _read(engine: object, client: int, body: int, joints: list[int]) -> NDArray:
    states = engine.getJointStates(body, joints, physicsClientId=client)
    return np.array([state[0] for state in states] + [state[1] for state in states])
