"""The equations of motion of the machine on its tracks: x, y, yaw and the four joints.

The arm's M, C and g are those of `arm.dynamics`. On tracks, the vehicle's x, y and yaw join the
four joints; house and arm and vehicle push each other in full.

Derivation. Let p be the point where the swing axis stands, w = (yaw rate + swing rate, boom, stick,
bucket rates), m the mass of house and arm and m s(q) its first moment about p in the world's plane.
Then with K = d(m s)/d(swing, boom, stick, bucket)

    m p'' + K w' + K' w = force on p,    M w' + C w + g + K^T p'' = joint torques.

In K the outward moment of the arm is g_2 over gravity, and its derivatives are the gravity torques
of the arm turned by 90 degrees, over gravity: nothing has to be derived twice. `engine` has the
same functions compiled.
"""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

import numpy as np

from backhoe.arm.dynamics.terms import Arm, gravity_torques, inertias, newton_euler, vectors
from backhoe.machine import Machine


class Carrier(NamedTuple):
    """What no posture changes.

    First moments about the swing axis, outward of the boom's joint and of the house, and leftward
    of the house [kg m]; masses of house with arm and of the undercarriage [kg]; yaw inertia of that
    [kg m^2]; offset of the swing axis, ahead of the vehicle's origin [m].
    """

    pins: float
    house: float
    leftward: float
    upper_mass: float
    track_mass: float
    track_inertia: float
    offset: float


def carrier_of(machine: Machine) -> Carrier:
    """The numbers of a machine with its load."""
    swing = machine.swing
    above_pins = machine.boom.mass + machine.stick.mass + machine.bucket.mass
    numbers = (
        above_pins * swing.offset,
        swing.mass * swing.com_radius * cos(swing.com_angle),
        swing.mass * swing.com_radius * sin(swing.com_angle),
        swing.mass + above_pins,
        machine.tracks.mass,
        machine.tracks.yaw_inertia,
        machine.base.offset,
    )
    return Carrier(*map(float, numbers))


def vectors_at(arm, boom, stick, bucket):
    """`terms.vectors` at joint angles [rad]."""
    p2 = boom + arm.o2
    p3 = p2 + (stick + arm.o3)
    p4 = p3 + (bucket + arm.o4)
    return vectors(arm, np.cos(p2), np.sin(p2), np.cos(p3), np.sin(p3), np.cos(p4), np.sin(p4))


def balance(arm, carrier, q, dq, M, forces):
    """Fill in the inertia matrix, and take off the forces what velocities and gravity need.

    Args:
        arm: `terms.arm_of` the loaded machine.
        carrier: its `Carrier`.
        q, dq: x, y, yaw, swing, boom, stick, bucket and their rates, shape (7,).
        M: inertia matrix, shape (7, 7), filled in.
        forces: along the seven coordinates, shape (7,); what accelerates is left.
    """
    v = vectors_at(arm, q[4], q[5], q[6])
    M11, M22, M23, M24, M33, M34, M44 = inertias(arm, v)
    M_arm = np.zeros((4, 4))
    M_arm[0, 0], M_arm[1, 1], M_arm[2, 2], M_arm[3, 3] = M11, M22, M33, M44
    M_arm[1, 2] = M_arm[2, 1] = M23
    M_arm[1, 3] = M_arm[3, 1] = M24
    M_arm[2, 3] = M_arm[3, 2] = M34
    w = np.array([dq[3] + dq[2], dq[4], dq[5], dq[6]])
    bias = np.array(newton_euler(arm, v, w[0], w[1], w[2], w[3], 0.0, 0.0, 0.0, 0.0))
    light = Arm(1.0, *arm[1:])  # where gravity is 1, gravity torques are moments [kg m]
    reach, slope = np.zeros(4), np.zeros(4)  # derivatives of the arm's height and outward moment
    reach[1], reach[2], reach[3] = gravity_torques(light, v)
    raised = vectors_at(arm, q[4] + np.pi / 2, q[5], q[6])
    slope[1], slope[2], slope[3] = gravity_torques(light, raised)

    yaw, yaw_rate = q[2], dq[2]
    outward, leftward = reach[1] + carrier.pins + carrier.house, carrier.leftward
    upper_mass, offset = carrier.upper_mass, carrier.offset
    heading = yaw + q[3] + np.pi / 2
    out_x, out_y = np.cos(heading), np.sin(heading)
    axis_x, axis_y = offset * np.cos(yaw), offset * np.sin(yaw)
    K = np.empty((2, 4))
    K[0, 0] = -outward * out_y - leftward * out_x
    K[1, 0] = outward * out_x - leftward * out_y
    radial, turned = -(w[0] ** 2) * outward, -(w[0] ** 2) * leftward
    for j in range(1, 4):
        K[0, j], K[1, j] = slope[j] * out_x, slope[j] * out_y
        turned += 2 * w[0] * slope[j] * w[j]
        for k in range(1, 4):
            radial -= reach[max(j, k)] * w[j] * w[k]
    pull_x = radial * out_x - turned * out_y - upper_mass * yaw_rate**2 * axis_x
    pull_y = radial * out_y + turned * out_x - upper_mass * yaw_rate**2 * axis_y

    M[0, 0] = M[1, 1] = upper_mass + carrier.track_mass
    M[0, 1] = M[1, 0] = 0.0
    forces[0] -= pull_x
    forces[1] -= pull_y
    forces[2] -= axis_x * pull_y - axis_y * pull_x
    for j in range(4):
        taken = bias[j] - yaw_rate**2 * (K[0, j] * axis_x + K[1, j] * axis_y)
        forces[3 + j] -= taken
        if j == 0:
            forces[2] -= taken
        M[0, 3 + j] = M[3 + j, 0] = K[0, j]
        M[1, 3 + j] = M[3 + j, 1] = K[1, j]
        M[2, 3 + j] = M[3 + j, 2] = M_arm[0, j] + axis_x * K[1, j] - axis_y * K[0, j]
        for k in range(4):
            M[3 + j, 3 + k] = M_arm[j, k]
    lever = axis_x * K[1, 0] - axis_y * K[0, 0]
    M[2, 2] = M_arm[0, 0] + 2 * lever + upper_mass * offset**2 + carrier.track_inertia
    M[0, 2] = M[2, 0] = K[0, 0] - upper_mass * axis_y
    M[1, 2] = M[2, 1] = K[1, 0] + upper_mass * axis_x
