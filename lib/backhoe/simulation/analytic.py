"""The simulation without PyBullet: the exact equations of motion, written out.

The arm's M, C and g are those of `arm.dynamics`. On tracks, the vehicle's x, y and yaw join the
four joints; house and arm and vehicle push each other in full. There are no contacts, except that
the tracks rest on the ground and the bucket digs, and no cameras.

Derivation. Let p be the point where the swing axis stands, w = (yaw rate + swing rate, boom, stick,
bucket rates), m the mass of house and arm and m s(q) its first moment about p in the world's plane.
Then with K = d(m s)/d(swing, boom, stick, bucket)

    m p'' + K w' + K' w = force on p,    M w' + C w + g + K^T p'' = joint torques.

In K the outward moment of the arm is g_2 over gravity, and its derivatives are the gravity torques
of the arm turned by 90 degrees, over gravity: nothing has to be derived twice.
"""

from __future__ import annotations

from dataclasses import replace
from math import cos, sin

import numpy as np
from numba import njit
from numpy.typing import NDArray

from backhoe.arm import dynamics
from backhoe.arm.dynamics import terms
from backhoe.simulation.loop import Loop


class AnalyticWorld(Loop):
    """A `Loop` that integrates the exact dynamics by semi-implicit Euler; arguments as there."""

    backend = "analytic"

    def _integrate(self, pushed: NDArray) -> None:
        if self.base == "fixed":
            ddq = np.zeros(7)
            ddq[3:] = dynamics.forward_dynamics(
                self._q[3:], self._dq[3:], pushed[3:], machine=self._loaded
            )
        else:
            ddq = self._acceleration(pushed)
        self._dq = self._dq + self.dt * ddq
        self._q = self._q + self.dt * self._dq

    def _carry(self, payload: float) -> None:
        machine = self.machine
        bucket = replace(machine.bucket, mass=machine.bucket.mass + payload)
        self._loaded = replace(machine, bucket=bucket)
        swing = machine.swing
        above_pins = machine.boom.mass + machine.stick.mass + bucket.mass
        self._arm = terms.arm_of(self._loaded)
        self._light = self._arm._replace(g=1.0)
        self._fixed = np.array(
            [
                above_pins * swing.offset,
                swing.mass * swing.com_radius * cos(swing.com_angle),
                swing.mass * swing.com_radius * sin(swing.com_angle),
                swing.mass + above_pins,
                machine.tracks.mass,
                machine.tracks.yaw_inertia,
                machine.base.offset,
            ]
        )

    def _acceleration(self, pushed: NDArray) -> NDArray:
        """Accelerations of x, y, yaw and the joints, shape (7,)."""
        M, forces = np.empty((7, 7)), pushed.copy()
        _balance(self._arm, self._light, self._q, self._dq, self._fixed, M, forces)
        return np.linalg.solve(M, forces)


_vectors = njit(terms.vectors)
_inertias = njit(terms.inertias)
_gravity_torques = njit(terms.gravity_torques)
_newton_euler = njit(terms.newton_euler)


@njit
def _vectors_at(arm, boom, stick, bucket):
    p2 = boom + arm.o2
    p3 = p2 + (stick + arm.o3)
    p4 = p3 + (bucket + arm.o4)
    return _vectors(arm, np.cos(p2), np.sin(p2), np.cos(p3), np.sin(p3), np.cos(p4), np.sin(p4))


@njit(cache=True)
def _balance(arm, light, q, dq, fixed, M, forces):
    """Inertia matrix (7, 7) of the seven coordinates, and what is left of the forces (7,).

    Args:
        arm: `dynamics.terms.arm_of` the loaded machine.
        light: the same where gravity is 1: its gravity torques are moments [kg m].
        q, dq: coordinates and rates, shape (7,).
        fixed: what no posture changes: outward moments of the boom's joint and of the house, the
            house's leftward one [kg m], masses of house with arm and of the undercarriage [kg], yaw
            inertia of that [kg m^2], offset of the swing axis [m].
        M, forces: filled in; forces come as what pushes.
    """
    v = _vectors_at(arm, q[4], q[5], q[6])
    M11, M22, M23, M24, M33, M34, M44 = _inertias(arm, v)
    M_arm = np.zeros((4, 4))
    M_arm[0, 0], M_arm[1, 1], M_arm[2, 2], M_arm[3, 3] = M11, M22, M33, M44
    M_arm[1, 2] = M_arm[2, 1] = M23
    M_arm[1, 3] = M_arm[3, 1] = M24
    M_arm[2, 3] = M_arm[3, 2] = M34
    w = np.array([dq[3] + dq[2], dq[4], dq[5], dq[6]])
    bias = np.array(_newton_euler(arm, v, w[0], w[1], w[2], w[3], 0.0, 0.0, 0.0, 0.0))
    reach, slope = np.zeros(4), np.zeros(4)
    raised = _vectors_at(arm, q[4] + np.pi / 2, q[5], q[6])
    for moment, vectors in ((reach, v), (slope, raised)):
        moment[1], moment[2], moment[3] = _gravity_torques(light, vectors)
    _join(
        M,
        forces,
        M_arm,
        bias,
        reach,
        slope,
        w,
        (reach[1] + fixed[0] + fixed[1], fixed[2]),
        (q[2], dq[2], q[2] + q[3] + np.pi / 2),
        (fixed[3], fixed[4]),
        fixed[5],
        fixed[6],
    )


@njit(cache=True)
def _join(M, forces, M_arm, bias, reach, slope, w, moment, headings, masses, track_inertia, offset):
    """Join the vehicle's x, y, yaw to the arm's equations, in place.

    Args:
        M: inertia matrix of the seven coordinates, shape (7, 7), filled in.
        forces: forces on them, shape (7,); what velocities and gravity take is taken off.
        M_arm, bias: of house and arm on a fixed base, turning with w, shapes (4, 4) and (4,).
        reach, slope: derivatives of the arm's height and outward moment, shape (4,) [kg m].
        w: rates of the arm's plane, boom, stick and bucket, shape (4,) [rad/s].
        moment: first moment of house and arm about the swing axis, outward and leftward [kg m].
        headings: yaw [rad], its rate [rad/s] and the heading of the arm [rad].
        masses: of house and arm, and of the undercarriage [kg].
        track_inertia: yaw inertia of the undercarriage [kg m^2].
        offset: of the swing axis, ahead of the vehicle's origin [m].
    """
    outward, leftward = moment
    yaw, yaw_rate, heading = headings
    upper_mass, track_mass = masses
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

    M[0, 0] = M[1, 1] = upper_mass + track_mass
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
    M[2, 2] = M_arm[0, 0] + 2 * lever + upper_mass * offset**2 + track_inertia
    M[0, 2] = M[2, 0] = K[0, 0] - upper_mass * axis_y
    M[1, 2] = M[2, 1] = K[1, 0] + upper_mass * axis_x
