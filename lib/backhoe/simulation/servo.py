"""The joints' drives: torques that make joint speeds follow wanted ones.

The wanted speed adds up to a wanted angle. What is missing of both asks for an acceleration,

    ddq = 2 w (dq_ref - dq) + w^2 (q_ref - q),

and the arm's own equation of motion, with what is in the bucket, says which torque gives it. So all
joints answer alike, like a mass under critical damping with the bandwidth w, and none pulls at the
others. Friction is made up for; the ground's push on the bucket is not: it bends each joint as a
spring of the joint's inertia times w^2. `engine` has the same function compiled.
"""

from __future__ import annotations

import numpy as np

from backhoe.arm.dynamics.terms import newton_euler
from backhoe.simulation.forces import COULOMB_SMOOTHING
from backhoe.simulation.moving_base import vectors_at
from backhoe.simulation.standing import arm_in

BANDWIDTH = 25.0
"""w, of all joints [rad/s]: ours, well above what a path asks for and well below the 1 kHz."""


def speed_torque(arm, friction, limit, bandwidth, state, speed, dt, angle, torque):
    """Fill in the torques of one step, and move the wanted angles on.

    A joint at its torque limit does not gather angle that it then has to make up for.

    Args:
        arm: `terms.arm_of` the machine in an array, last the mass of bucket and load [kg], (21,).
        friction: rows viscous [N m s/rad] and Coulomb [N m], shape (2, 4).
        limit: of the torques, shape (4,) [N m].
        bandwidth: w [rad/s].
        state: rows angles [rad] and speeds [rad/s], shape (2, 4).
        speed: wanted speeds, shape (4,) [rad/s].
        dt: step [s].
        angle: wanted angles, shape (4,) [rad]; brought forward in place.
        torque: shape (4,) [N m], filled in.
    """
    arm = arm_in(arm)
    q, dq = state[0], state[1]
    v = vectors_at(arm, q[1], q[2], q[3])
    wanted = np.empty(4)
    for k in range(4):
        wanted[k] = 2 * bandwidth * (speed[k] - dq[k]) + bandwidth**2 * (angle[k] - q[k])
    tau = newton_euler(
        arm, v, dq[0], dq[1], dq[2], dq[3], wanted[0], wanted[1], wanted[2], wanted[3]
    )
    for k in range(4):
        rubbing = friction[0, k] * speed[k]
        rubbing += friction[1, k] * np.tanh(speed[k] / COULOMB_SMOOTHING)
        asked = tau[k] + rubbing
        torque[k] = min(max(asked, -limit[k]), limit[k])
        if torque[k] == asked or (asked > 0.0) != (speed[k] > 0.0):
            angle[k] += speed[k] * dt
