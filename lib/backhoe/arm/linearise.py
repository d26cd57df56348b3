"""The arm about a posture as a linear system of python-control: poles, margins, step responses.

At rest at q, with the torque g(q), small deviations x of the angles obey

    M(q) d2x + F_v dx + (dg/dq) x = u

with u the torque beyond g(q). Centrifugal and Coriolis torques are of second order in the speeds
and drop out. So does Coulomb friction, which has no linear part at rest: the real joints are damped
better than these poles say, and stick.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import dynamics
from backhoe.arm.lyapunov.extremes import gravity_slope
from backhoe.arm.pid import Gains
from backhoe.basics.inputs import choice, instance, numbers
from backhoe.machine import BACKHOE, JOINTS, Machine

if TYPE_CHECKING:
    from control import StateSpace

__all__ = ["LAWS", "arm", "loop"]

LAWS = ("pid", "pid+gravity")
"""Laws whose closed loop `arm` gives; "pid+gravity" adds g(q) at the measured q."""


def arm(
    q: ArrayLike,
    machine: Machine = BACKHOE,
    *,
    gains: Gains | None = None,
    law: str = "pid",
    friction: bool = True,
    name: str | None = None,
) -> StateSpace:
    """The arm at rest at a posture, alone or under PID control, as a linear system.

    Source: the linearisation of Mastalli 2013, eqs. (2.12) and (3.5), the latter with -K_d dq.

    Args:
        q: the posture, shape (4,) [rad].
        machine: the arm; a loaded one from `variants.loaded`.
        gains: None for the arm alone; or of shape (4,) each [N m/rad, N m/(rad s), N m s/rad].
            They may have any sign: -K_d is (3.5) as printed.
        law: "pid", or "pid+gravity" with the gravity torque of the measured posture added.
        friction: whether the joints have viscous friction.
        name: of the system; "arm" and "arm under pid", or the other law, unless told.

    Returns:
        Deviations from q. Alone: states q_* and dq_*, inputs tau_* beyond g(q), outputs q_*, with
        * the names of `JOINTS`. Under control: states xi_* (integral of the error), q_* and dq_*,
        inputs ref_* (where q should be, at rest), outputs q_*.

    Raises:
        ValueError: q is not four finite angles, gains are not three times four finite numbers, or
            an unknown law.
    """
    q = _posture(q)
    choice(law, "law", LAWS)
    if gains is None:
        A, B = _plant(q, machine, friction, compensated=False)
        return _system(A, B, "tau", name or "arm")
    kp, ki, kd = _gains(gains)
    A, B = _plant(q, machine, friction, compensated=law == "pid+gravity")
    feedback = B @ np.hstack([-np.diag(kp), -np.diag(kd)])
    closed = np.block(
        [[np.zeros((4, 4)), -np.eye(4), np.zeros((4, 4))], [B * ki, A + feedback]],
    )
    entering = np.vstack([np.eye(4), B * kp])
    return _system(closed, entering, "ref", name or f"arm under {law}")


def loop(
    q: ArrayLike,
    gains: Gains,
    joint: str,
    machine: Machine = BACKHOE,
    *,
    law: str = "pid",
    friction: bool = True,
) -> StateSpace:
    """What goes once round one joint's loop, cut open at its torque, the others closed.

    Args:
        q, gains, machine, law, friction: as for `arm`.
        joint: one of `JOINTS`.

    Returns:
        L with one input and one output, the torque of the joint before and after a turn with
        the sign changed: the loop is closed by 1 / (1 + L), so `control.margin` reads its margins.

    Raises:
        ValueError: as for `arm`, or an unknown joint.
    """
    import control

    k = JOINTS.index(choice(joint, "joint", JOINTS))
    kp, ki, kd = _gains(gains)
    open_gains = Gains(*(np.where(np.arange(4) == k, 0.0, gain) for gain in (kp, ki, kd)))
    others = arm(q, machine, gains=open_gains, law=law, friction=friction)
    push = np.zeros((12, 1))
    push[4:] = _plant(_posture(q), machine, friction, compensated=False)[1][:, [k]]
    C = np.zeros((1, 12))
    C[0, [k, 4 + k, 8 + k]] = -ki[k], kp[k], kd[k]
    return control.ss(
        others.A,
        push,
        C,
        0,
        states=list(others.state_labels),
        inputs=[f"tau_{joint}"],
        outputs=["-tau_pid"],
        name=f"loop of the {joint}",
    )


def _plant(
    q: NDArray, machine: Machine, friction: bool, compensated: bool
) -> tuple[NDArray, NDArray]:
    """A (8, 8) and B (8, 4) of the states (q, dq) with the torques as inputs."""
    mobility = np.linalg.inv(dynamics.mass_matrix(q, machine))
    stiffness = np.zeros((4, 4)) if compensated else gravity_slope(q, machine=machine)
    damping = np.diag(machine.viscous) if friction else np.zeros((4, 4))
    A = np.block([[np.zeros((4, 4)), np.eye(4)], [-mobility @ stiffness, -mobility @ damping]])
    return A, np.vstack([np.zeros((4, 4)), mobility])


def _system(A: NDArray, B: NDArray, entering: str, name: str) -> StateSpace:
    import control

    kinds = ("q", "dq") if len(A) == 8 else ("xi", "q", "dq")
    C = np.zeros((4, len(A)))
    C[:, 4 * kinds.index("q") :][:, :4] = np.eye(4)
    return control.ss(
        A,
        B,
        C,
        np.zeros((4, 4)),
        states=[f"{kind}_{joint}" for kind in kinds for joint in JOINTS],
        inputs=[f"{entering}_{joint}" for joint in JOINTS],
        outputs=[f"q_{joint}" for joint in JOINTS],
        name=name,
    )


def _posture(q: ArrayLike) -> NDArray:
    return numbers(q, "q", (4,), meaning="one posture of 4 joint angles [rad]")


def _gains(gains: Gains) -> NDArray:
    instance(gains, "gains", Gains, "give pid.Gains(kp=..., ki=..., kd=...)")
    return numbers(gains, "gains", (3, 4), meaning="kp, ki and kd of 4 joints")
