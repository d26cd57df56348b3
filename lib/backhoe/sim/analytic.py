"""The simulation without PyBullet: the exact equations of motion, written out.

The arm's M, C and g are those of `backhoe.dynamics`. On tracks, the vehicle's x, y and yaw join the
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
from math import cos, pi, sin

import numpy as np
from numba import njit
from numpy.typing import NDArray

from backhoe import dynamics
from backhoe.sim.loop import Loop
from backhoe.sim.urdf import undercarriage_inertia

_BOOM_UP = np.array([0.0, pi / 2, 0.0, 0.0])


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
        bucket = self.machine.bucket
        self._loaded = replace(self.machine, bucket=replace(bucket, mass=bucket.mass + payload))
        self._light = replace(self._loaded, gravity=1.0)

    def _acceleration(self, pushed: NDArray) -> NDArray:
        """Accelerations of x, y, yaw and the joints, shape (7,)."""
        machine, q = self._loaded, self._q[3:]
        w = self._dq[3:].copy()
        w[0] += self._dq[2]
        swing = machine.swing
        above_pins = machine.boom.mass + machine.stick.mass + machine.bucket.mass
        reach = dynamics.gravity_torque(q, self._light)
        outward = (
            reach[1]
            + above_pins * swing.offset
            + swing.mass * swing.com_radius * cos(swing.com_angle)
        )
        M, forces = np.empty((7, 7)), pushed.copy()
        _join(
            M,
            forces,
            dynamics.mass_matrix(q, machine),
            dynamics.inverse_dynamics(q, w, np.zeros(4), machine=machine),
            reach,
            dynamics.gravity_torque(q + _BOOM_UP, self._light),
            w,
            (outward, swing.mass * swing.com_radius * sin(swing.com_angle)),
            (self._q[2], self._dq[2], self._q[2] + q[0] + pi / 2),
            (swing.mass + above_pins, machine.tracks.mass),
            undercarriage_inertia(machine),
            machine.base.offset,
        )
        return np.linalg.solve(M, forces)


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
