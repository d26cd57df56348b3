"""The controller's law of one step, for `engine`: lesson 03's PID and the torque of gravity."""

from __future__ import annotations

from backhoe.arm.dynamics.terms import gravity_torques
from backhoe.simulation.moving_base import vectors_at
from backhoe.simulation.standing import arm_in


def hold(arm, gains, limit, integral, q_ref, dq_ref, q, dq, dt, torque):
    """Fill in the torques of `pid.PID` plus `dynamics.gravity_torque`; all of shape (4,).

    Args:
        arm: `terms.arm_of` the machine in an array, shape (21,).
        gains: rows kp, ki, kd, shape (3, 4) [N m/rad, N m/(rad s), N m s/rad].
        limit: of the PID's torque [N m].
        integral: of the error, brought forward in place [rad s].
        q_ref, dq_ref, q, dq: wanted and measured [rad, rad/s].
        dt: step [s].
        torque: filled in [N m].
    """
    arm = arm_in(arm)
    g2, g3, g4 = gravity_torques(arm, vectors_at(arm, q[1], q[2], q[3]))
    holding = (0.0, g2, g3, g4)
    for k in range(4):
        error = q_ref[k] - q[k]
        gathered = integral[k] + error * dt
        wanted = gains[0, k] * error + gains[1, k] * gathered + gains[2, k] * (dq_ref[k] - dq[k])
        applied = min(max(wanted, -limit[k]), limit[k])
        if applied == wanted or wanted * error <= 0:
            integral[k] = gathered
        torque[k] = applied + holding[k]
