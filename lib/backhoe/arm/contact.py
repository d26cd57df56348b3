"""What the joints feel of a push at the bucket's tip, and what their torques tell of that push.

Soil pushes the tip with a force F and, about the tip, with a moment N that would raise the bucket's
pitch. Both do work: F dx + N dp = w dX with w = (F, N), X the tip's place and the bucket's pitch.
With dX = J dq, J (4, 4), the joints feel

    tau = J^T w,

and since J is square the push follows from the torques: w = J^-T tau. The equation of motion says
how much of the actuators' torque is left over for that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.arm import kinematics
from backhoe.arm.kinematics import joint_vector
from backhoe.arm.kinematics.forward import leading_shape
from backhoe.basics.inputs import instance, numbers
from backhoe.machine import BACKHOE, Machine

WORST_POSTURE = 1e6
"""Condition number of J from which on the torques do not tell the push [own units]."""

PUSH = "force x, y, z [N] and moment that raises the pitch [N m]"


def contact_jacobian(q: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """J of the tip's place and of the bucket's pitch.

    Args:
        q: joint angles, shape (..., 4) [rad].
        machine: whose arm.

    Returns:
        J with (x, y, z, pitch) rates = J dq, shape (..., 4, 4) [m/rad, last row 1].

    Raises:
        ValueError: the last axis is not 4, or a value is not finite.
        TypeError: machine is no Machine.
    """
    q = joint_vector(q)
    instance(machine, "machine", Machine)
    J = np.empty((*q.shape, 4))
    J[..., :3, :] = kinematics.jacobian(q, machine=machine)[..., :3, :]
    J[..., 3, :] = 0.0, 1.0, 1.0, 1.0
    return J


def joint_torque(q: ArrayLike, push: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """Torque with which a push at the tip turns the joints.

    Args:
        q: joint angles, shape (..., 4) [rad].
        push: force on the tip in the base frame [N] and moment raising its pitch [N m], (..., 4).
        machine: whose arm.

    Returns:
        J^T w, shape (..., 4) [N m].

    Raises:
        ValueError: a last axis is not 4, a value is not finite, or leading axes do not fit.
        TypeError: machine is no Machine.
    """
    push = numbers(push, "push", (..., 4), meaning=PUSH)
    J = contact_jacobian(q, machine)
    leading_shape(J[..., 0], push)
    return np.einsum("...ij,...i->...j", J, push)


def push_from(q: ArrayLike, torque: ArrayLike, machine: Machine = BACKHOE) -> NDArray:
    """The push at the tip that turns the joints with given torques.

    Args:
        q: joint angles, shape (..., 4) [rad].
        torque: of the push, shape (..., 4) [N m]: what the motion needs less what the actuators
            give.
        machine: whose arm.

    Returns:
        J^-T tau, force in the base frame [N] and moment raising the pitch [N m], shape (..., 4).

    Raises:
        ValueError: a last axis is not 4, a value is not finite, leading axes do not fit, or a
            posture in which the joints do not tell: stick and boom in one line, or the tip on the
            swing axis.
        TypeError: machine is no Machine.
    """
    torque = numbers(torque, "torque", (..., 4), meaning="torques of the joints [N m]")
    turned = np.swapaxes(contact_jacobian(q, machine), -1, -2)
    leading_shape(turned[..., 0], torque)
    if (np.linalg.cond(turned) > WORST_POSTURE).any():
        raise ValueError("in this posture the joints do not tell the push: J is singular")
    return np.linalg.solve(turned, torque[..., None])[..., 0]
